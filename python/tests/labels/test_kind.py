"""Files that hold segments are known before they are taken for a scan, and scans are not."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import SimpleITK
from numpy.typing import NDArray
from palpate.base.errors import VolumeFormatError
from palpate.io.image_file import middle_of
from palpate.labels.kind import labels_told


def organs() -> NDArray[np.uint8]:
    labels = np.zeros((12, 40, 40), np.uint8)
    labels[2:10, 5:30, 5:20] = 1
    labels[4:8, 10:25, 22:35] = 13
    return labels


def noisy(kind: str) -> NDArray[Any]:
    rng = np.random.default_rng(3)
    return np.maximum(0.0, rng.normal(80.0, 40.0, (12, 40, 40))).clip(0, 255).astype(kind)


def test_label_maps_are_known_by_their_values(write_image: Any) -> None:
    for values, name, is_map in (
        (organs(), "a.nii.gz", True),
        (organs().astype(np.float32), "b.nrrd", True),
        (organs().astype(np.int16) * 100, "c.mha", False),
        (organs().astype(np.int16) * 100, "brain_aseg.mha", True),
        (organs().astype(np.int16) - 1, "d.mha", False),
        (organs() * 0.5, "e.nrrd", False),
        (noisy("u1"), "f.nii.gz", False),
        (noisy("i2"), "my_labels.nrrd", False),
        (np.zeros((4, 5, 6), np.uint8), "g.nrrd", False),
        (np.full((4, 5, 6), 7, np.uint8), "h.nrrd", False),
    ):
        told = labels_told(write_image(values, name))
        assert (told is not None) == is_map, name
        if told is not None:
            assert (told.name, told.what, told.image) == (name, "a label map", True)
    # a structure that is not in the middle slice
    corner = np.zeros((12, 40, 40), np.uint8)
    corner[1, 3:9, 3:9] = 4
    assert labels_told(write_image(corner, "corner.nii.gz")) is not None


def test_folders_of_masks_are_known(tmp_path: Path, write_image: Any) -> None:
    folder = tmp_path / "segmentations"
    folder.mkdir()
    for name in ("aorta", "liver", "spleen"):
        write_image((organs() == 1).astype(np.uint8), f"{name}.nii.gz").rename(
            folder / f"{name}.nii.gz"
        )
    (folder / "statistics.json").touch()
    told = labels_told(folder)
    assert told is not None
    assert (told.name, told.what, told.image) == ("segmentations", "a folder of 3 masks", False)
    # a scan beside them, and one with its own grid
    write_image(noisy("i2"), "ct.nii.gz").rename(folder / "ct.nii.gz")
    assert labels_told(folder) is None
    (folder / "ct.nii.gz").unlink()
    (folder / "slice.dcm").touch()
    assert labels_told(folder) is None
    assert labels_told(tmp_path / "nowhere") is None


def test_a_damaged_file_is_left_to_whoever_reads_it(tmp_path: Path, write_image: Any) -> None:
    path = write_image(organs(), "cut.nii.gz")
    path.write_bytes(path.read_bytes()[:60])
    assert labels_told(path) is None
    (tmp_path / "junk.nrrd").write_bytes(b"NRRD0004\ntype: what\n")
    assert labels_told(tmp_path / "junk.nrrd") is None


@pytest.mark.data
def test_real_segments_and_scans_are_told_apart(data_folder: Path) -> None:
    for place, what in (
        ("totalseg_tests/example_seg.nii.gz", "a label map"),
        ("totalseg_tests/example_ct.nii.gz", None),
        ("totalseg_tests/example_ct_sm.nii.gz", None),
        ("amos_0336/labels_from_meshes.nii.gz", "a label map"),
        ("amos_0336/amos_0336.mhd", None),
        ("cthead_stanford/CThead.mha", None),
        ("dcmqi_seg/liver.dcm", "a DICOM segmentation"),
        ("dicompyler_rt/rtss.dcm", "structures of radiotherapy (RTSTRUCT)"),
        ("dicompyler_rt/ct.0.dcm", None),
        ("dcmqi_seg/ct-3slice", None),
    ):
        assert (data_folder / place).exists(), place
        told = labels_told(data_folder / place)
        assert (told and told.what) == what, place


def test_slicers_segmentations_say_it_themselves(tmp_path: Path) -> None:
    image = SimpleITK.GetImageFromArray(organs())
    image.SetMetaData("Segment0_Name", "liver")
    path = tmp_path / "any.nrrd"
    SimpleITK.WriteImage(image, str(path))
    told = labels_told(path)
    assert told is not None
    assert told.what == "a segmentation of 3D Slicer"


@pytest.mark.parametrize("name", ["mask.nii.gz", "mask.mha", "mask.nrrd"])
def test_a_file_of_two_axes_is_neither_and_said_so(tmp_path: Path, name: str) -> None:
    path = tmp_path / name
    SimpleITK.WriteImage(SimpleITK.GetImageFromArray(organs()[5]), str(path))
    assert labels_told(path) is None
    with pytest.raises(VolumeFormatError, match="a 2-D image of 40 x 40 voxels"):
        middle_of(path)
