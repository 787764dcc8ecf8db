"""Files of many frames: several stacks in one, one in several files, and nuclear medicine."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import palpate
import pytest
from dicom_cases import case, marker, values_of
from numpy.typing import NDArray
from palpate.base.errors import SeriesChoiceError, VolumeFormatError
from palpate.io.browse import browsed
from palpate.io.reading import list_series
from pydicom import dcmread
from pydicom.dataset import Dataset, FileDataset, FileMetaDataset
from pydicom.uid import EnhancedMRImageStorage, ExplicitVRLittleEndian, generate_uid

Place = tuple[float, float, float]
AXIAL = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0)
SAGITTAL = (0.0, 1.0, 0.0, 0.0, 0.0, -1.0)


def frame(position: Place, orientation: tuple[float, ...], stack: str = "") -> Dataset:
    """Returns the functional groups of a frame."""
    groups, plane, turn, measures, content = (Dataset() for _ in range(5))
    plane.ImagePositionPatient = list(position)
    turn.ImageOrientationPatient = list(orientation)
    measures.PixelSpacing, measures.SliceThickness = [0.5, 0.75], 2.0
    groups.PlanePositionSequence, groups.PlaneOrientationSequence = [plane], [turn]
    groups.PixelMeasuresSequence = [measures]
    if stack:
        content.StackID = stack
    groups.FrameContentSequence = [content]
    return groups


def enhanced(path: Path, frames: list[Dataset], values: NDArray[np.uint16]) -> FileDataset:
    meta = FileMetaDataset()
    meta.MediaStorageSOPClassUID = EnhancedMRImageStorage
    meta.MediaStorageSOPInstanceUID = generate_uid()
    meta.TransferSyntaxUID = ExplicitVRLittleEndian
    made = FileDataset("", {}, file_meta=meta, preamble=b"\0" * 128)
    made.SOPClassUID, made.SOPInstanceUID = EnhancedMRImageStorage, meta.MediaStorageSOPInstanceUID
    made.Modality, made.SeriesInstanceUID, made.SeriesDescription = "MR", "1.2.3", "knee"
    made.Rows, made.Columns = values.shape[1:]
    made.NumberOfFrames, made.SamplesPerPixel = len(values), 1
    made.PhotometricInterpretation, made.PixelRepresentation = "MONOCHROME2", 0
    made.BitsAllocated, made.BitsStored, made.HighBit = 16, 16, 15
    made.PerFrameFunctionalGroupsSequence = frames
    made.PixelData = values.astype("<u2").tobytes()
    made.save_as(path, enforce_file_format=True)
    return made


def numbers(count: int) -> NDArray[np.uint16]:
    """Frames whose values are 100 times their number and up."""
    return np.arange(count, dtype=np.uint16)[:, None, None] * 100 + np.arange(
        12, dtype=np.uint16
    ).reshape(3, 4)


@pytest.mark.data
def test_stacks_of_one_file_are_listed_and_read_one_by_one(data_folder: Path) -> None:
    path = case(data_folder, 22) / "two.dcm"
    with browsed(path) as choices:
        assert [(one.name, one.refused) for one in choices] == [
            ("series 1, stack 1", None),
            ("series 1, stack 2", None),
        ]
    assert [series.slices for series in list_series(path.parent)] == [12, 12]
    assert marker(palpate.read(path, series="1")) == [5.0, 6.0, 20.0]
    # tilted, and so moved down by sin 15° times its depth
    assert palpate.read(path, series="2").dimensions[2] == 12
    with pytest.raises(SeriesChoiceError, match="stack 1"):
        palpate.read(path)


@pytest.mark.parametrize("named", [True, False])
def test_frames_that_are_turned_are_other_stacks(tmp_path: Path, *, named: bool) -> None:
    upright = [frame((0, 0, 2.0 * k), AXIAL, "a" if named else "") for k in range(4)]
    turned = [frame((2.0 * k, 0, 0), SAGITTAL, "b" if named else "") for k in range(3)]
    # they take turns in the file
    order = [0, 4, 1, 5, 2, 6, 3]
    enhanced(tmp_path / "two.dcm", [(upright + turned)[at] for at in order], numbers(7))
    first = palpate.read(tmp_path / "two.dcm", series="1")
    second = palpate.read(tmp_path / "two.dcm", series="2")
    assert (first.orientation, second.orientation) == ("LPS", "PIR")
    names = ("knee, stack a", "knee, stack b") if named else ("knee, stack 1", "knee, stack 2")
    assert (first.name, second.name) == names
    np.testing.assert_array_equal(values_of(first)[:, 0, 0], [0, 200, 400, 600])
    # sagittal rows run to the back, columns down: their normal is to the right
    assert sorted(values_of(second)[:, 0, 0]) == [100, 300, 500]


@pytest.mark.parametrize("shift", [(0.0, 0.0, 60.0), (50.0, 0.0, 0.0)])
def test_parallel_stacks_apart_are_told_by_their_names(tmp_path: Path, shift: Place) -> None:
    first = [frame((0, 0, 2.0 * k), AXIAL, "1") for k in range(4)]
    second = [frame((shift[0], 0, 2.0 * k + shift[2]), AXIAL, "2") for k in range(4)]
    enhanced(tmp_path / "two.dcm", first + second, numbers(8))
    volumes = [palpate.read(tmp_path / "two.dcm", series=number) for number in "12"]
    assert [volume.origin for volume in volumes] == [(0, 0, 0), shift]
    np.testing.assert_array_equal(values_of(volumes[1])[:, 0, 0], [400, 500, 600, 700])


def test_stacks_that_go_on_evenly_are_one_volume(tmp_path: Path) -> None:
    frames = [frame((0, 0, 2.0 * k), AXIAL, str(k % 2 + 1)) for k in range(8)]
    enhanced(tmp_path / "one.dcm", frames, numbers(8))
    assert palpate.read(tmp_path / "one.dcm").dimensions == (4, 3, 8)


# --- concatenations ---------------------------------------------------------------------------


def concatenated(folder: Path, *, total: bool = True, placed: bool = True) -> None:
    """Writes 7 frames as three files, named against their order."""
    values = numbers(7)
    for number, part in enumerate((slice(0, 3), slice(3, 4), slice(4, 7)), 1):
        frames = [frame((0, 0, 2.0 * k), AXIAL) for k in range(7)][part]
        if not placed:
            for one in frames:
                del one.PlanePositionSequence
        path = folder / f"part{9 - number}.dcm"
        made = enhanced(path, frames, values[part])
        made.SOPInstanceUIDOfConcatenationSource, made.ConcatenationUID = "1.2.7", "1.2.8"
        made.InConcatenationNumber = number
        if total:
            made.InConcatenationTotalNumber = 3
        made.ConcatenationFrameOffsetNumber = part.start
        made.save_as(path)


@pytest.mark.parametrize("placed", [True, False])
def test_an_image_in_several_files_is_one_volume(tmp_path: Path, *, placed: bool) -> None:
    concatenated(tmp_path, placed=placed)
    volume = palpate.read(tmp_path)
    np.testing.assert_array_equal(values_of(volume)[:, 0, 0], np.arange(7) * 100)
    assert not any("missing" in warning for warning in volume.warnings)


@pytest.mark.parametrize(("lost", "total"), [(1, True), (2, False), (3, True)])
def test_a_missing_part_is_told(tmp_path: Path, lost: int, *, total: bool) -> None:
    concatenated(tmp_path, total=total)
    (tmp_path / f"part{9 - lost}.dcm").unlink()
    volume = palpate.read(tmp_path)
    assert f"parts {lost} of 3 files of the scan are missing" in volume.warnings


def test_two_images_in_several_files_are_two_volumes(tmp_path: Path) -> None:
    concatenated(tmp_path)
    (tmp_path / "more").mkdir()
    concatenated(tmp_path / "more")
    for path in (tmp_path / "more").iterdir():
        made = dcmread(path)
        made.SOPInstanceUIDOfConcatenationSource = "1.2.9"
        made.save_as(path)
    assert [series.slices for series in list_series(tmp_path)] == [7, 7]


# --- nuclear medicine -------------------------------------------------------------------------


@pytest.mark.data
@pytest.mark.parametrize(("name", "place"), [("plus", [5, 6, 20]), ("minus", [5, 6, -10])])
def test_slices_of_spect_lie_where_the_detector_tells(
    data_folder: Path, name: str, place: list[float]
) -> None:
    volume = palpate.read(case(data_folder, 17) / f"{name}.dcm")
    assert marker(volume) == place
    assert volume.spacing == (1.0, 1.5, 2.5)
    assert volume.orientation == "LPS"


@pytest.mark.data
def test_gated_spect_is_a_volume_for_each_time(data_folder: Path, tmp_path: Path) -> None:
    made = dcmread(case(data_folder, 17) / "plus.dcm")
    count = int(made.NumberOfFrames)
    made.ImageType = ["ORIGINAL", "PRIMARY", "RECON GATED TOMO", "EMISSION"]
    made.NumberOfFrames, made.NumberOfSlices = 2 * count, count
    made.SliceVector = [*range(1, count + 1)] * 2
    made.TimeSlotVector = [1] * count + [2] * count
    pixels = np.frombuffer(made.PixelData, "<u2")
    made.PixelData = np.concatenate([pixels, pixels // 2]).tobytes()
    made.save_as(tmp_path / "gated.dcm")
    first, second = (palpate.read(tmp_path / "gated.dcm", series=number) for number in "12")
    assert [one.name.split(", ")[-1] for one in (first, second)] == ["time slot 1", "time slot 2"]
    assert marker(first) == marker(second) == [5.0, 6.0, 20.0]
    assert second.range[1] == first.range[1] // 2


@pytest.mark.data
def test_projections_of_spect_have_no_place(data_folder: Path, tmp_path: Path) -> None:
    made = dcmread(case(data_folder, 17) / "plus.dcm")
    made.ImageType = ["ORIGINAL", "PRIMARY", "TOMO", "EMISSION"]
    made.save_as(tmp_path / "tomo.dcm")
    assert palpate.read(tmp_path / "tomo.dcm").orientation == "unknown"


def test_a_file_of_nothing_but_one_frame_is_no_volume(tmp_path: Path) -> None:
    enhanced(tmp_path / "one.dcm", [frame((0, 0, 0), AXIAL)], numbers(1))
    with pytest.raises(VolumeFormatError, match="2-D image"):
        palpate.read(tmp_path / "one.dcm")
