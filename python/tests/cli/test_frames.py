"""``--frame``: one of several volumes of an image file, wherever scans are read."""

from __future__ import annotations

import json
import zipfile
from pathlib import Path
from typing import Any

import nibabel
import numpy as np
import palpate
import pytest
from palpate.base.errors import OptionError, SeriesChoiceError
from palpate.base.progress import silent
from palpate.cli.commands import run
from palpate.cli.scenes import add_second
from palpate.io.browse import MOST_PICTURED, browsed, previews
from palpate.saved.scene_scan import linked_scan, saved_scan
from palpate.volumes.scene import Scene
from palpate.volumes.siblings import Siblings
from palpate.volumes.volume import Volume
from running_server import LibraryClient

VALUES = np.random.default_rng(1).integers(0, 100, (7, 6, 5, 6)).astype(np.int16)
"""Shape [x, y, z, time]."""


@pytest.fixture
def cine(tmp_path: Path) -> Path:
    """A file of six volumes."""
    image = nibabel.Nifti1Image(VALUES, np.diag([1.0, 1.5, 2.5, 1.0]))
    image.header.set_xyzt_units("mm", "sec")
    nibabel.save(image, tmp_path / "cine.nii.gz")
    return tmp_path / "cine.nii.gz"


def told(capsys: pytest.CaptureFixture[str], *arguments: str | Path) -> Any:
    """Runs a command for programs; returns what it says."""
    assert run([*map(str, arguments), "--json"]) == 0
    return json.loads(capsys.readouterr().out)


def test_a_volume_is_asked_for_and_listed(cine: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["info", str(cine)]) == 2
    assert (
        "6 volumes; allowed: one of them, with --frame NUMBER from 1 to 6"
        in capsys.readouterr().err
    )
    for command in ("series", "import"):
        rows = told(capsys, command, cine)
        assert [row["frame"] for row in rows] == [1, 2, 3, 4, 5, 6]
        assert [row["number"] for row in rows] == [1] * 6
        assert run([command, str(cine)]) == 0
        assert "6 volumes: volume 1" in " ".join(capsys.readouterr().out.split())


@pytest.mark.parametrize("frame", [1, 4, 6])
def test_the_volume_asked_for_is_written(cine: Path, tmp_path: Path, frame: int) -> None:
    out = tmp_path / "one.nii.gz"
    assert run(["import", str(cine), "--frame", str(frame), "-o", str(out)]) == 0
    np.testing.assert_array_equal(nibabel.load(out).get_fdata(), VALUES[..., frame - 1])


def test_a_scene_finds_its_volume_again(cine: Path, tmp_path: Path) -> None:
    volume = palpate.read(cine, frame=3)
    assert volume.source is not None
    assert volume.source.options == {"frame": 3}
    scene = tmp_path / "a.palpate"
    scan = linked_scan(scene, saved_scan(volume, scene, copied=False), silent)
    np.testing.assert_array_equal(scan.array, VALUES[..., 2].T)


def test_volumes_of_archives_and_folders_are_chosen(cine: Path, tmp_path: Path) -> None:
    with zipfile.ZipFile(tmp_path / "cine.zip", "w") as archive:
        archive.write(cine, "scans/cine.nii.gz")
    folder = tmp_path / "folder"
    folder.mkdir()
    cine.rename(folder / cine.name)
    for place in (tmp_path / "cine.zip", folder):
        volume = palpate.read(place, frame=5)
        np.testing.assert_array_equal(volume.array, VALUES[..., 4].T)
        with browsed(place) as choices:
            assert [one.frame for one in choices] == [1, 2, 3, 4, 5, 6]
            assert dict(previews(choices)).keys() == set(range(6))
            for number, one in enumerate(choices):
                read = palpate.read(one.path, series=one.series, frame=one.frame)
                np.testing.assert_array_equal(read.array, VALUES[..., number].T)


def test_a_volume_of_dicom_is_a_series(write_series: Any) -> None:
    with pytest.raises(OptionError, match="those of DICOM are series"):
        palpate.read(write_series(), frame=1)


def test_the_page_lists_volumes_and_opens_one(client: LibraryClient, cine: Path) -> None:
    found, *pictures, last = client.job("find", {"path": str(cine)})
    assert last == {"kind": "done"}
    assert [one["part"] for one in found["scans"]] == [f"volume {n}" for n in range(1, 7)]
    assert len([one for one in pictures if one["kind"] == "picture"]) == 6
    assert client.job("open", {"find": found["find"], "choice": 3})[-1] == {"kind": "done"}
    (recent, *_) = client.about()["recent"]
    assert recent["frame"] == 4
    wanted = {key: recent[key] for key in ("path", "series", "frame", "raw", "voxel_size")}
    assert client.job("open", wanted)[-1] == {"kind": "done"}


def test_pictures_beyond_the_first_come_when_asked_for(
    client: LibraryClient, tmp_path: Path
) -> None:
    count = MOST_PICTURED + 3
    values = np.random.default_rng(2).integers(0, 100, (3, 4, 5, count)).astype(np.int16)
    path = tmp_path / "long.nii.gz"
    nibabel.save(nibabel.Nifti1Image(values, np.eye(4)), path)
    with zipfile.ZipFile(tmp_path / "long.zip", "w") as archive:
        archive.write(path, "scans/long.nii.gz")
    for place in (path, tmp_path / "long.zip"):
        found, *pictures = client.job("find", {"path": str(place)})
        late = [number for number, one in enumerate(found["scans"]) if one["late"]]
        assert late == [*range(MOST_PICTURED, count)]
        assert pictured(pictures) == {*range(MOST_PICTURED)}
        asked = client.job("pictures", {"find": found["find"], "choices": late[1:]})
        assert pictured(asked) == {*late[1:]}
        assert asked[-1] == {"kind": "done"}
    (failed,) = client.job("pictures", {"find": 99, "choices": [0]})
    assert "that list is gone" in failed["reason"]


def pictured(lines: list[Any]) -> set[int]:
    """Returns whose pictures came."""
    return {one["choice"] for one in lines if one["kind"] == "picture"}


def test_another_volume_of_the_open_scan_takes_its_place(
    client: LibraryClient, cine: Path, write_series: Any
) -> None:
    client.job("open", {"path": str(cine), "frame": 3})
    assert opened(client).traits.siblings == Siblings("frame", (1, 2, 3, 4, 5, 6), 3)
    assert client.job("volume", {"number": 4})[-1] == {"kind": "done"}
    np.testing.assert_array_equal(opened(client).array, VALUES[..., 3].T)
    assert client.about()["recent"][0]["frame"] == 4
    (failed,) = client.job("volume", {"number": 7})
    assert failed["reason"] == "volume 7 cannot be used. Use 1 to 6"
    np.testing.assert_array_equal(opened(client).array, VALUES[..., 3].T)
    # files that were dropped stay for as long as one of their volumes is open
    upload = client.upload({cine.name: cine.read_bytes()})
    found = client.job("find", {"upload": upload})[0]
    client.job("open", {"find": found["find"], "choice": 0})
    for number in (2, 6):
        assert client.job("volume", {"number": number})[-1] == {"kind": "done"}
        np.testing.assert_array_equal(opened(client).array, VALUES[..., number - 1].T)
    assert any("temporary copy" in one for one in opened(client).traits.warnings)
    client.job("open", {"path": str(write_series())})
    assert client.job("volume", {"number": 1})[-1]["kind"] == "failed"


def test_what_a_file_does_not_tell_is_told_on_the_page(client: LibraryClient, cine: Path) -> None:
    client.job("open", {"path": str(cine), "frame": 3})
    assert opened(client).unit == ""
    assert client.job("volume", {"unit": "HU"})[-1] == {"kind": "done"}
    assert client.job("volume", {"orientation": "RPI"})[-1] == {"kind": "done"}
    # as it was read before, but for that
    for _ in range(2):
        assert (opened(client).unit, opened(client).orientation) == ("HU", "RPI")
        assert not any("unit of the values" in one for one in opened(client).warnings)
        client.job("volume", {"number": 3})
    np.testing.assert_array_equal(opened(client).array, VALUES[..., 2].T)
    (failed,) = client.job("volume", {"orientation": "up"})
    assert "orientation 'up' is not known" in failed["reason"]
    assert client.ask("POST", "library/volume", {"unit": "stones"}).status_code == 400


def test_volumes_of_dicom_are_siblings(client: LibraryClient, write_series: Any) -> None:
    for echo in (1, 2, 3):
        folder = write_series(uid="1.2.3", prefix=f"e{echo}", EchoTime=10.0 * echo)
    write_series(uid="1.2.9", prefix="z", description="other")
    client.job("open", {"path": str(folder), "series": "2"})
    siblings = opened(client).traits.siblings
    assert siblings is not None
    assert (siblings.option, len(siblings.keys), siblings.number) == ("series", 3, 2)
    expected = palpate.read(folder, series=str(siblings.keys[2]))
    assert client.job("volume", {"number": 3})[-1] == {"kind": "done"}
    assert opened(client).name == expected.name != ""


def test_the_second_scan_is_one_of_several_volumes(
    client: LibraryClient, cine: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    client.job("open", {"path": str(cine), "frame": 1})
    found = client.job("find", {"path": str(cine)})[0]
    client.job("open", {"find": found["find"], "choice": 4, "beside": True})
    assert second_of(client) == 5
    assert client.job("volume", {"number": 2, "beside": True})[-1] == {"kind": "done"}
    assert second_of(client) == 2
    assert opened(client).traits.siblings == Siblings("frame", (1, 2, 3, 4, 5, 6), 1)
    # on the command line
    scene = Scene(palpate.read(cine, frame=1))
    add_second(scene, cine, None, frame=3, progress=silent)
    assert scene.second is not None
    np.testing.assert_array_equal(scene.second.volume.array, VALUES[..., 2].T)
    with pytest.raises(SeriesChoiceError, match="with --with-frame NUMBER from 1 to 6"):
        add_second(scene, cine, None, progress=silent)
    one = tmp_path / "one.nii.gz"
    assert run(["import", str(cine), "--frame", "1", "-o", str(one)]) == 0
    for option in ("--with-frame", "--with-series"):
        assert run(["open", str(one), option, "1", "--no-browser"]) == 2
        assert f"{option} 1 given; allowed: together with --with" in capsys.readouterr().err


def opened(client: LibraryClient) -> Volume:
    """Returns the scan that is open."""
    scan = client.workbench.opened
    assert scan is not None
    return scan.session.scene.volume


def second_of(client: LibraryClient) -> int:
    """Returns which volume the second scan is."""
    scan = client.workbench.opened
    assert scan is not None
    second = scan.session.scene.second
    assert second is not None
    assert second.volume.traits.siblings is not None
    return second.volume.traits.siblings.number
