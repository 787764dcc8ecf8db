"""What is kept with a scan goes with the scan, and with no other that has its name."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import SimpleITK
from made_scans import series_writer
from palpate.base.errors import OptionError
from palpate.io.reading import read
from palpate.saved.kept_with_scan import MOST_PARTS, KeptWithScan
from palpate.volumes.scan_hash import scan_identity
from palpate.volumes.scene import Scene
from palpate.volumes.second_scan import SecondScan

MARK = json.dumps({"kind": "point", "name": "lesion", "points": [[1, 2, 3]], "visible": True})


@pytest.fixture(autouse=True)
def state(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A state of its own."""
    monkeypatch.setenv("PALPATE_STATE", str(tmp_path / "state"))
    return tmp_path / "state"


def written(path: Path, seed: int = 1) -> Path:
    """Writes a small scan."""
    path.parent.mkdir(parents=True, exist_ok=True)
    values = np.random.default_rng(seed).integers(-1000, 2000, (6, 7, 8), np.int16)
    SimpleITK.WriteImage(SimpleITK.GetImageFromArray(values), str(path))
    return path


def kept_of(path: Path) -> KeptWithScan:
    """Returns what is kept of the scan of a file or folder."""
    return KeptWithScan(Scene(read(path)), on_disk=True)


def values_of(kept: KeptWithScan) -> dict[str, str]:
    """Returns the parts that are there."""
    return {name: part.value for name, part in kept.now().items() if part.value is not None}


def with_mark(path: Path) -> None:
    """Sets a mark on a scan and ends its session."""
    kept = kept_of(path)
    kept.change("mark.1", MARK)
    kept.write()


def test_two_files_of_one_name_have_nothing_in_common(tmp_path: Path) -> None:
    first, second = written(tmp_path / "a" / "ct.nii.gz"), written(tmp_path / "b" / "ct.nii.gz", 2)
    with_mark(first)
    assert values_of(kept_of(second)) == {}
    assert values_of(kept_of(first)) == {"mark.1": MARK}


def test_marks_come_back_in_the_order_in_which_they_were_set(tmp_path: Path) -> None:
    path = written(tmp_path / "ct.nii.gz")
    names = [f"mark.{number:x}" for number in (7, 3, 250, 11, 5, 90, 1, 64)]
    kept = kept_of(path)
    for name in names:
        kept.change(name, MARK)
    kept.write()
    assert list(values_of(kept_of(path))) == names


def test_the_same_scan_is_known_elsewhere_and_another_one_of_its_name_is_not(
    tmp_path: Path,
) -> None:
    path = written(tmp_path / "ct.nii.gz")
    with_mark(path)
    moved = path.rename(tmp_path / "other.nii.gz")
    assert values_of(kept_of(moved)) == {"mark.1": MARK}
    assert values_of(kept_of(written(path, 3))) == {}


def test_two_patients_of_one_protocol_and_two_series_of_one_patient_differ(
    tmp_path: Path,
) -> None:
    write = series_writer(tmp_path)
    # even where all values are the same, as in water phantoms
    anna, berta = (
        read(write(name, PatientName=name, PatientID=name, description="Abdomen 3.0 B30f"))
        for name in ("Anna", "Berta")
    )
    again = read(write("again", PatientName="Anna", PatientID="Anna"))
    assert len({scan_identity(each) for each in (anna, berta, again)}) == 3
    assert anna.name == berta.name
    assert anna.traits.patient == "Anna, Anna"
    assert scan_identity(read(tmp_path / "Anna")) == scan_identity(anna)


def test_a_removed_part_stays_removed_and_a_second_process_keeps_its_own(tmp_path: Path) -> None:
    path = written(tmp_path / "ct.nii.gz")
    with_mark(path)
    here, there = kept_of(path), kept_of(path)
    here.change("mark.1", None)
    here.change("mark.2", MARK)
    there.change("mark.3", MARK)
    here.write()
    there.write()
    assert sorted(values_of(kept_of(path))) == ["mark.2", "mark.3"]


def test_a_scene_has_its_own_and_leaves_those_of_its_scan(tmp_path: Path) -> None:
    path = written(tmp_path / "ct.nii.gz")
    with_mark(path)
    scene = Scene(read(path))
    kept = KeptWithScan(scene, view={"kept": {"mark.5": json.loads(MARK)}}, on_disk=True)
    assert list(values_of(kept)) == ["mark.5"]
    kept.change("mark.6", MARK)
    kept.write()
    assert list(values_of(kept_of(path))) == ["mark.1"]
    # what came after the scene was saved is there when it is opened again
    again = KeptWithScan(scene, view=kept_view(), on_disk=True)
    assert sorted(values_of(again)) == ["mark.5", "mark.6"]
    assert again.in_view()["mark.6"] == json.loads(MARK)


def kept_view() -> dict[str, object]:
    """Returns the view of a scene with a mark."""
    return {"kept": {"mark.5": json.loads(MARK)}}


def test_a_scene_of_an_earlier_version_brings_all_that_it_had(tmp_path: Path) -> None:
    scene = Scene(read(written(tmp_path / "ct.nii.gz")))
    second = read(written(tmp_path / "mr.nii.gz", 2))
    scene.second = SecondScan(second)
    old = {
        "marks": {"list": [json.loads(MARK), json.loads(MARK)]},
        "clip": {"box": {"on": True}},
        "slices": {"layout": "four"},
        "second": {"fusion": "blend", "of": "mr"},
        "../x": {},
    }
    found = values_of(KeptWithScan(scene, view={"remembered": old}))
    assert sorted(found) == ["clip", "mark.1", "mark.2", f"second.{scan_identity(second)}"]


def test_what_is_no_json_or_too_much_is_refused(tmp_path: Path) -> None:
    kept = kept_of(written(tmp_path / "ct.nii.gz"))
    for bad in ("", "{", "[" * 100_000):
        with pytest.raises(OptionError, match="JSON"):
            kept.change("clip", bad)
    for number in range(MOST_PARTS):
        kept.change(f"mark.{number:x}", "1")
    with pytest.raises(OptionError, match="no more is kept"):
        kept.change("clip", "1")


def test_a_damaged_file_is_none(tmp_path: Path, state: Path) -> None:
    path = written(tmp_path / "ct.nii.gz")
    with_mark(path)
    (file,) = (state / "scans").iterdir()
    file.write_bytes(file.read_bytes()[:-3])
    assert values_of(kept_of(path)) == {}
