"""What is assumed or changed in reading is told, once and truly."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import nibabel
import numpy as np
import palpate
import pytest
from palpate.cli.info import describe
from palpate.io.dicom.geometry import stack_of
from palpate.io.dicom.header import Frame
from palpate.io.reading import list_series
from palpate.server.messages.hello import scan_of
from palpate.volumes.stored_values import to_stored
from pydicom.dataset import FileDataset
from pydicom.uid import generate_uid

# --- values ---------------------------------------------------------------------------------


def map_of(folder: Path, values: Any) -> palpate.Volume:
    path = folder / "map.nii"
    nibabel.save(nibabel.Nifti1Image(np.asarray(values, np.float64), np.eye(4)), path)
    return palpate.read(path)


def test_what_single_precision_leaves_of_doubles_is_told(tmp_path: Path) -> None:
    values = 100.0 + np.random.default_rng(1).random((4, 5, 6))
    volume = map_of(tmp_path, values)
    (told,) = [one for one in volume.warnings if "64 bits" in one]
    off = float(np.abs(volume.values() - values.T).max())
    assert 0.0 < off < 1e-5
    assert f"differ by up to {off:.2g}" in told


def test_small_differences_of_large_doubles_are_kept(tmp_path: Path) -> None:
    values = 1e9 + np.random.default_rng(1).random((4, 5, 6))
    volume = map_of(tmp_path, values)
    np.testing.assert_array_equal(volume.values(), values.T)
    assert not any("64 bits" in one for one in volume.warnings)


@pytest.mark.parametrize("kind", [np.float32, np.int32])
def test_nothing_is_told_of_numbers_that_are_kept(kind: type) -> None:
    values: Any = (np.random.default_rng(1).random((4, 5, 6)) * 1e6).astype(kind)
    assert to_stored(values).off == 0.0
    # nor of rounding that no range shows
    assert to_stored(np.random.default_rng(1).random((4, 5, 6))).off == 0.0


def padded_with(write_series: Any, stored: int, **changes: Any) -> palpate.Volume:
    """Reads a series with 8 voxels of padding; others are 0 to 311, and HU 1024 less."""

    def change(_: int, dataset: FileDataset) -> None:
        pixels = dataset.pixel_array.copy()
        pixels[0, :2] = stored
        dataset.PixelData = pixels.tobytes()
        dataset.PixelPaddingValue = stored

    return palpate.read(write_series(f"padded-{stored}", each=change, **changes))


# as GE writes -2000, and the least that is stored
@pytest.mark.parametrize("stored", [63536, 0])
def test_padding_that_becomes_air_is_counted_and_no_warning(write_series: Any, stored: int) -> None:
    volume = padded_with(write_series, stored)
    assert volume.warnings == ()
    (told,) = volume.notes
    assert told == "8 voxels of padding were set to -1000 HU, as air (PixelPaddingValue)"
    assert np.count_nonzero(volume.values() == -1000) == 8
    described = describe(volume)
    assert (described["warnings"], described["notes"]) == ([], [told])
    assert scan_of(volume).notes == [told]


# amid the others, and as a scanner's highest number
@pytest.mark.parametrize("stored", [300, 400])
def test_padding_that_tissue_may_have_is_a_warning(write_series: Any, stored: int) -> None:
    volume = padded_with(write_series, stored)
    (told,) = volume.warnings
    assert f"as air (PixelPaddingValue): tissue may have their value, {stored - 1024} HU" in told
    assert volume.notes == ()
    # where no value of air is known, only what is below all others is padding without doubt
    magnetic = padded_with(write_series, stored + 1, Modality="MR", scale=(1.0, -50.0))
    (told,) = magnetic.warnings
    assert f"tissue may have their value, {stored + 1 - 50}, too" in told


def test_low_padding_of_scans_without_unit_is_no_warning(write_series: Any) -> None:
    magnetic = padded_with(write_series, 0, Modality="MR", scale=(1.0, 0.0))
    assert magnetic.warnings == ()
    assert "8 voxels of padding were set to 2, as air (PixelPaddingValue)" in magnetic.notes
    # which is in no unit that anybody could give
    assert "the unit of the values is unknown" in magnetic.notes


# --- places ---------------------------------------------------------------------------------


def sideways(*shifts: float, tilt: float = 0.0) -> tuple[str, ...]:
    """Returns what is told of 12 slices 2 mm apart, of which some are shifted along x [mm]."""
    from palpate.io.dicom.geometry import grid_of

    places = [(tilt * 2.0 * k + (shifts[k] if k < len(shifts) else 0.0)) for k in range(12)]
    frames = [
        Frame((x, 0, 2.0 * k), (1, 0, 0, 0, 1, 0), (1, 1), None) for k, x in enumerate(places)
    ]
    stack = stack_of("it", frames)
    assert stack is not None
    return grid_of("it", stack, columns=8, rows=8).told[:-1]


@pytest.mark.parametrize("at", [0, 5, 11])
def test_a_shifted_slice_is_no_tilt(at: int) -> None:
    shifts = np.zeros(12)
    shifts[at] = 3.0
    assert sideways(*shifts) == ("1 of 12 slices is shifted sideways, by up to 3.0 mm",)
    tilted = sideways(*shifts, tilt=0.3)
    assert tilted == (
        "slices are tilted by 16.7 degrees against their stack (gantry tilt)",
        "1 of 12 slices is shifted sideways, by up to 3.0 mm",
    )


def test_a_stack_that_goes_on_beside_itself_is_shifted() -> None:
    assert sideways(*([0.0] * 7), *([4.0] * 5)) == (
        "5 of 12 slices are shifted sideways, by up to 4.0 mm",
    )
    assert sideways(*np.round(0.268 * 2.0 * np.arange(12), 1)) == (
        "slices are tilted by 14.9 degrees against their stack (gantry tilt)",
    )


def test_the_spacing_of_a_detector_is_used_and_told(write_series: Any) -> None:
    def change(_: int, dataset: FileDataset) -> None:
        dataset.ImagerPixelSpacing = dataset.PixelSpacing
        del dataset.PixelSpacing

    volume = palpate.read(write_series(each=change))
    assert volume.spacing == (0.75, 0.5, 2.5)
    (told,) = volume.warnings
    assert "that of the detector (ImagerPixelSpacing)" in told


# --- sides of MetaImage ---------------------------------------------------------------------


def metaimage(folder: Path, *lines: str) -> palpate.Volume:
    head = ["NDims = 3", "DimSize = 2 3 4", "ElementType = MET_SHORT", "ElementSpacing = 1 2 3"]
    text = "\n".join([*head, *lines, "ElementDataFile = LOCAL", ""])
    (folder / "a.mha").write_bytes(text.encode() + np.arange(24, dtype=np.int16).tobytes())
    return palpate.read(folder / "a.mha")


def sides_told(volume: palpate.Volume) -> list[str]:
    return [one for one in volume.warnings if "orientation" in one.lower()]


def test_anatomical_orientation_counts_where_it_is_alone(tmp_path: Path) -> None:
    volume = metaimage(tmp_path, "AnatomicalOrientation = LPI")
    # the sides that axes come from
    assert [volume.orientation] == ["RAS"]
    assert volume.spacing == (1.0, 2.0, 3.0)
    (told,) = sides_told(volume)
    assert told == "axes lie toward RAS, as AnatomicalOrientation tells alone"
    (told,) = sides_told(metaimage(tmp_path, "AnatomicalOrientation = ???"))
    assert told.startswith("nothing tells the orientation")


def test_anatomical_orientation_that_does_not_count_is_told(tmp_path: Path) -> None:
    matrix = "TransformMatrix = 1 0 0 0 1 0 0 0 1"
    assert sides_told(metaimage(tmp_path, matrix, "AnatomicalOrientation = RAI")) == []
    volume = metaimage(tmp_path, matrix, "AnatomicalOrientation = LPS")
    assert volume.orientation == "LPS"
    (told,) = sides_told(volume)
    assert "toward LPS, as TransformMatrix tells" in told
    assert "which tells RAI, is not used" in told


# --- series of several scans ----------------------------------------------------------------


def mixed(write_series: Any, **tags: Any) -> Path:
    """Writes a series of four slices, and four of the same UID elsewhere with other tags."""
    write_series(uid="1.2.3", prefix="a", FrameOfReferenceUID="1.5.1")
    places = [(0.0, 0.0, 90.0 + 2.5 * k) for k in range(4)]
    folder: Path = write_series(uid="1.2.3", prefix="b", positions=places, **tags)
    return folder


def test_frames_of_reference_are_parted(write_series: Any) -> None:
    found = list_series(mixed(write_series, FrameOfReferenceUID="1.5.2"))
    assert [(one.part, one.slices) for one in found] == [
        ("frame of reference 1", 4),
        ("frame of reference 2", 4),
    ]


def test_modalities_are_parted(write_series: Any) -> None:
    folder = mixed(write_series, FrameOfReferenceUID="1.5.1", Modality="MR")
    found = list_series(folder)
    assert [(one.part, one.modality) for one in found] == [("CT", "CT"), ("MR", "MR")]
    assert palpate.read(folder, series="2").modality == "MR"


def test_a_frame_of_reference_for_each_slice_is_told(write_series: Any) -> None:
    def change(_: int, dataset: FileDataset) -> None:
        dataset.FrameOfReferenceUID = generate_uid()

    volume = palpate.read(write_series(each=change))
    assert volume.dimensions == (4, 3, 4)
    (told,) = volume.warnings
    assert told == "slices tell 4 different frames of reference: taken as one scan"
