"""Labels are whole numbers of any size, kept as they are on any grid of the scan's voxels."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import nibabel
import numpy as np
import palpate
import pytest
import SimpleITK
from file_cases import case_input
from numpy.typing import NDArray
from palpate.base.errors import OptionError, VolumeFormatError
from palpate.labels.label_values import label_codes, label_values
from palpate.volumes.volume import Volume

SHAPE = (6, 7, 8)
"""Of arrays [x, y, z] of files."""
AFFINE = np.diag([-1.0, -1.5, 2.5, 1.0])


@pytest.fixture
def scan(tmp_path: Path) -> Volume:
    """A scan whose axes all differ."""
    nibabel.save(nibabel.Nifti1Image(np.zeros(SHAPE, np.int16), AFFINE), tmp_path / "scan.nii")
    return palpate.read(tmp_path / "scan.nii")


def labels_in(path: Path, scan: Volume) -> dict[str, int]:
    """Returns the number of voxels of each label."""
    found = palpate.read_labels(path, scan).labels
    return {label.segment.name: int(label.segment.mask().sum()) for label in found}


def some_labels(values: list[Any], kind: str) -> NDArray[Any]:
    picked = np.random.default_rng(4).integers(0, len(values), SHAPE)
    return np.array(values, kind)[picked]


# --- cases --------------------------------------------------------------------------------


@pytest.mark.data
@pytest.mark.parametrize("number", [100000, 614454277])
def test_ids_of_an_atlas_stay_what_they_are(data_folder: Path, number: int) -> None:
    folder = case_input(data_folder, 2)
    found = labels_in(folder / f"labels_{number}.nii.gz", palpate.read(folder / "scan.nii.gz"))
    assert found == {
        "label 1": 64, "label 2": 64, "label 300": 48, "label 1024": 36, f"label {number}": 27
    }  # fmt: skip


@pytest.mark.data
@pytest.mark.parametrize("name", ["same", "cropped", "x_reversed"])
def test_labels_above_int16_stay_what_they_are_on_any_grid(data_folder: Path, name: str) -> None:
    folder = case_input(data_folder, 3)
    found = labels_in(folder / f"{name}.nii.gz", palpate.read(folder / "scan.nii.gz"))
    assert list(found) == ["label 1", "label 40000"]


@pytest.mark.data
def test_layers_of_older_segmentations_are_their_segments(data_folder: Path) -> None:
    folder = case_input(data_folder, 15)
    scan = palpate.read(folder / "scan.nii.gz")
    assert labels_in(folder / "old.seg.nrrd", scan) == {"a": 60, "b": 72, "c": 18}


# --- kinds --------------------------------------------------------------------------------

LARGE = {
    "i1": [-100, 1, 100], "u1": [1, 2, 255], "i2": [-32768, 7, 32767], "u2": [1, 40000, 65535],
    "i4": [-5, 70000, 2**31 - 1], "u4": [1, 2**31, 2**32 - 1], "i8": [2**40, 2**40 + 1, 2**60],
    "u8": [1, 2**63 + 1, 2**64 - 1], "f4": [1, 300, 100000], "f8": [1, 300, 614454277],
}  # fmt: skip


@pytest.mark.parametrize("kind", LARGE)
@pytest.mark.parametrize("grid", ["same", "cropped", "flipped", "turned"])
def test_labels_of_any_kind_are_kept_on_any_grid(
    scan: Volume, tmp_path: Path, kind: str, grid: str
) -> None:
    wanted = sorted(LARGE[kind])
    labels, affine = some_labels([0, *wanted], kind), AFFINE.copy()
    if grid == "cropped":
        labels, affine[2, 3] = labels[:, :, 2:6], 5.0
    if grid == "flipped":
        labels, affine[0] = labels[::-1], [1.0, 0.0, 0.0, -5.0]
    if grid == "turned":
        labels, affine = labels.transpose(1, 0, 2), affine[:, [1, 0, 2, 3]]
    nibabel.save(nibabel.Nifti1Image(labels, affine, dtype=labels.dtype), tmp_path / "map.nii.gz")

    found = palpate.read_labels(tmp_path / "map.nii.gz", scan).labels
    assert [label.segment.name for label in found] == [f"label {value}" for value in wanted]
    whole = some_labels([0, *wanted], kind).T
    if grid == "cropped":
        whole[:2], whole[6:] = 0, 0
    for label, value in zip(found, wanted, strict=True):
        np.testing.assert_array_equal(label.segment.mask(), whole == np.array(value, kind))


def test_labels_that_a_slope_makes_are_whole(scan: Volume, tmp_path: Path) -> None:
    labels = some_labels([0, 1, 2], "i2")
    image = nibabel.Nifti1Image(labels, AFFINE)
    image.header.set_slope_inter(1000.0, 0.0)
    nibabel.save(image, tmp_path / "map.nii")
    packed = bytearray((tmp_path / "map.nii").read_bytes())
    packed[112:120] = np.array([1000.0, 0.0], np.float32).tobytes()
    packed[352:] = labels.tobytes(order="F")
    (tmp_path / "map.nii").write_bytes(packed)
    assert set(labels_in(tmp_path / "map.nii", scan)) == {"label 1000", "label 2000"}


def test_names_of_a_table_are_found_by_large_ids(scan: Volume, tmp_path: Path) -> None:
    labels = some_labels([0, 997, 614454277], "u4")
    nibabel.save(nibabel.Nifti1Image(labels, AFFINE), tmp_path / "atlas.nii.gz")
    (tmp_path / "atlas.csv").write_text("id,structure\n614454277,Hirnrinde, links\n997,root\n")
    assert set(labels_in(tmp_path / "atlas.nii.gz", scan)) == {"root", "Hirnrinde"}


def test_values_that_are_no_numbers_are_no_labels(scan: Volume, tmp_path: Path) -> None:
    labels = some_labels([0, 1, np.nan, np.inf], "f4")
    nibabel.save(nibabel.Nifti1Image(labels, AFFINE), tmp_path / "map.nii")
    assert labels_in(tmp_path / "map.nii", scan) == {"label 1": int((labels == 1).sum())}


def test_masks_of_any_kind_are_masks(scan: Volume, tmp_path: Path) -> None:
    folder = tmp_path / "masks"
    folder.mkdir()
    for name, kind, value in (("a", "u4", 2**31), ("b", "f4", 1e-6), ("c", "u2", 40000)):
        nibabel.save(
            nibabel.Nifti1Image(some_labels([0, value], kind), AFFINE), folder / f"{name}.nii.gz"
        )
    (folder / "._a.nii.gz").write_bytes(b"\x00\x05\x16\x07" + bytes(116))
    count = int((some_labels([0, 1], "u1")).sum())
    assert labels_in(folder, scan) == {"a": count, "b": count, "c": count}


def test_a_float_scan_is_no_label_map_and_found_so_early() -> None:
    noise = np.random.default_rng(1).normal(size=(50, 80, 80))
    with pytest.raises(OptionError, match="more than 4096 different values, as scans do"):
        label_values(Path("scan.nii"), noise, most=255)


def test_codes_of_no_labels_are_nothing() -> None:
    image = np.zeros((2, 3, 4), np.float32)
    assert label_values(Path("map.nii"), image, most=255) == []
    assert not label_codes(image, []).any()


# --- Slicer -------------------------------------------------------------------------------


def layered(path: Path, count: int, fields: dict[str, str]) -> list[NDArray[Any]]:
    """Writes layers of 0 and 1 with the fields of segments, and returns their masks [z, y, x]."""
    layers = [some_labels([0, 0, number + 1], "u1").T for number in range(count)]
    image = SimpleITK.GetImageFromArray(np.stack(layers, axis=-1), isVector=True)
    image.SetSpacing((1.0, 1.5, 2.5))
    for name, value in fields.items():
        image.SetMetaData(name, value)
    SimpleITK.WriteImage(image, str(path))
    return layers


def test_names_of_segments_keep_their_letters(scan: Volume, tmp_path: Path) -> None:
    names = ["Lendenwirbelkörper", "左肺"]
    fields = {f"Segment{number}_Name": name for number, name in enumerate(names)}
    path = tmp_path / "old.seg.nrrd"
    layers = layered(path, 2, fields)
    found = palpate.read_labels(path, scan).labels
    assert [label.segment.name for label in found] == names
    for label, layer in zip(found, layers, strict=True):
        np.testing.assert_array_equal(label.segment.mask(), layer != 0)
    # a program of yesterday
    path.write_bytes(path.read_bytes().replace("körper".encode(), "körper".encode("latin-1")))
    assert palpate.read_labels(path, scan).labels[0].segment.name == names[0]


def test_layers_that_no_segment_claims_are_refused(scan: Volume, tmp_path: Path) -> None:
    layered(tmp_path / "old.seg.nrrd", 3, {"Segment0_Name": "a", "Segment1_Name": "b"})
    with pytest.raises(VolumeFormatError, match="2 segments for 3 layers"):
        palpate.read_labels(tmp_path / "old.seg.nrrd", scan)


def test_segments_in_other_units_of_length_lie_in_the_scan(scan: Volume, tmp_path: Path) -> None:
    path = tmp_path / "old.seg.nrrd"
    layered(path, 2, {"Segment0_Name": "a", "Segment1_Name": "b"})
    text = path.read_bytes()
    directions = b"(1,0,0) (0,1.5,0) (0,0,2.5)"
    assert directions in text
    path.write_bytes(
        text.replace(directions, b"(1000,0,0) (0,1500,0) (0,0,2500)").replace(
            b"\nencoding", b'\nspace units: "um" "um" "um"\nencoding', 1
        )
    )
    assert len(palpate.read_labels(path, scan).labels) == 2
