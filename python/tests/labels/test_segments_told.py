"""What of segments does not come into a scan is told by name and share, for every kind of file."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import palpate
import pytest
import SimpleITK
from numpy.typing import NDArray
from palpate.export.export import export_scene
from palpate.volumes.scene import Scene
from palpate.volumes.volume import Volume
from pydicom import dcmread

NAMES = ("inside", "half", "beyond", "none")


def masks() -> dict[str, NDArray[np.uint8]]:
    """Segments on a grid of 12 x 10 x 8 voxels; the scan has the first 6 columns of it."""
    found = {name: np.zeros((8, 10, 12), np.uint8) for name in NAMES}
    found["inside"][2:4, 2:4, 1:4] = 1
    found["half"][2:4, 6:8, 4:8] = 1
    found["beyond"][5:7, 2:4, 8:11] = 1
    return found


def scan(*, turned: bool = False) -> Volume:
    """A scan with half of "half"; "turned" so that no voxel of a file lies on one of it."""
    angle = 0.02 if turned else 0.0
    turn = np.array(
        [[np.cos(angle), -np.sin(angle), 0.0], [np.sin(angle), np.cos(angle), 0.0], [0, 0, 1]]
    )
    return Volume(np.zeros((8, 10, 6), np.int16), spacing=(1.0, 1.0, 1.0), direction=turn)


def map_at(folder: Path) -> Path:
    codes = sum(
        (code * mask for code, mask in enumerate(masks().values(), 1)), np.zeros((8, 10, 12))
    )
    SimpleITK.WriteImage(
        SimpleITK.GetImageFromArray(codes.astype(np.uint8)), str(folder / "a.nrrd")
    )
    (folder / "a.csv").write_text(
        "id,structure\n" + "".join(f"{code},{name}\n" for code, name in enumerate(NAMES, 1))
    )
    return folder / "a.nrrd"


def folder_at(folder: Path) -> Path:
    (folder / "masks").mkdir()
    for name, mask in masks().items():
        path = folder / "masks" / f"{name}.nii.gz"
        SimpleITK.WriteImage(SimpleITK.GetImageFromArray(mask), str(path))
    return folder / "masks"


def slicer_at(folder: Path) -> Path:
    image = SimpleITK.GetImageFromArray(np.stack([*masks().values()], axis=-1), isVector=True)
    for number, name in enumerate(NAMES):
        for key, value in {"Name": name, "LabelValue": "1", "Layer": str(number)}.items():
            image.SetMetaData(f"Segment{number}_{key}", value)
    SimpleITK.WriteImage(image, str(folder / "a.seg.nrrd"))
    return folder / "a.seg.nrrd"


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("made", [map_at, folder_at, slicer_at])
def test_what_is_lost_is_told_by_name_and_share(made: Any, tmp_path: Path, *, turned: bool) -> None:
    found = palpate.read_labels(made(tmp_path), scan(turned=turned), resample=turned)
    assert [label.segment.name for label in found.labels] in (
        ["half", "inside"],
        ["inside", "half"],
    )
    lost = "20 voxels of segments lie outside the scan (50 %): beyond (100 %), half (50 %)"
    assert lost in found.warnings
    # a label map holds no empty labels
    assert ("1 segment is empty: none" in found.warnings) == (made is not map_at)


def test_what_is_lost_of_frames_of_dicom_is_told(tmp_path: Path, write_series: Any) -> None:
    volume = palpate.read(write_series(StudyInstanceUID="1.2.5", FrameOfReferenceUID="1.2.9"))
    _, _, width = volume.shape
    scene = Scene(volume)
    for name, last in (("wall", width), ("nothing", 1)):
        mask = np.zeros(volume.shape, np.uint8)
        mask[:, 0, :last] = 1
        scene.add(volume.segment(mask, name=name))
    path = tmp_path / "a.dcm"
    export_scene(scene, path, keep_identity=True)
    # frames of segment 2 are left without their segment
    dataset = dcmread(path)
    dataset.SegmentSequence[1].SegmentNumber = 7
    dataset.save_as(path)
    narrow = Volume(
        np.ascontiguousarray(volume.array[:, :, : width // 2]),
        spacing=volume.spacing,
        origin=volume.origin,
        direction=volume.direction,
    )
    found = palpate.read_labels(path, narrow)
    assert "1 segment is empty: nothing" in found.warnings
    assert any("outside the scan (50 %): wall (50 %)" in told for told in found.warnings)


def test_of_many_empty_segments_the_first_are_named(tmp_path: Path) -> None:
    image = SimpleITK.GetImageFromArray(masks()["inside"])
    for number in range(9):
        image.SetMetaData(f"Segment{number}_Name", f"organ {number}")
        image.SetMetaData(f"Segment{number}_LabelValue", str(number + 1))
        image.SetMetaData(f"Segment{number}_Layer", "0")
    SimpleITK.WriteImage(image, str(tmp_path / "a.seg.nrrd"))
    found = palpate.read_labels(tmp_path / "a.seg.nrrd", scan())
    assert found.warnings[0] == (
        "8 segments are empty: organ 1, organ 2, organ 3, organ 4, organ 5 and 3 more"
    )


def test_what_falls_between_the_scans_voxels_is_named(tmp_path: Path) -> None:
    dot = np.zeros((9, 9, 9), np.uint8)
    dot[3, 3, 3] = 1
    dot[6:, 6:, 6:] = 2
    image = SimpleITK.GetImageFromArray(dot)
    image.SetSpacing((0.3, 0.3, 0.3))
    SimpleITK.WriteImage(image, str(tmp_path / "a.nrrd"))
    coarse = Volume(np.zeros((3, 3, 3), np.int16), spacing=(2.0, 2.0, 2.0))
    found = palpate.read_labels(tmp_path / "a.nrrd", coarse, resample=True)
    assert "smaller than a voxel, so not on the scan: label 1" in found.warnings
