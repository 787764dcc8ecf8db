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
from palpate.base.errors import OptionError
from palpate.base.progress import silent
from palpate.cli.commands import run
from palpate.io.browse import browsed, previews
from palpate.saved.scene_scan import linked_scan, saved_scan
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
