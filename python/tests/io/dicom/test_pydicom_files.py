"""pydicom's own test files: each has pydicom's values, or is refused for a true reason."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import palpate
import pydicom
import pytest
from dicom_cases import values_of
from numpy.typing import NDArray
from palpate.base.errors import PalpateError, VolumeFormatError
from palpate.io.dicom.header import read_header
from palpate.io.dicom.pixels import read_slice
from palpate.io.reading import list_series
from pydicom import dcmread
from pydicom.dataset import FileDataset
from pydicom.pixels.processing import apply_modality_lut

FILES = Path(pydicom.__file__).parent / "data"
NO_FILES = (".py", ".pyc", ".json", ".txt", ".icc", ".dump", ".gz")
TRUE_REASONS: dict[str, Callable[[FileDataset], bool]] = {
    "as colour images have": lambda told: (
        told.get("SamplesPerPixel", 1) > 1
        or told.get("PhotometricInterpretation") == "PALETTE COLOR"
    ),
    "is a 2-D image": lambda told: int(told.get("NumberOfFrames") or 1) == 1,
    "without an image of a scan": lambda told: (
        "Rows" not in told or told.get("Modality") in ("SEG", "RTDOSE")
    ),
    "is no image": lambda told: "Rows" not in told,
    "holds 24 series": lambda told: "DirectoryRecordSequence" in told,
    "lists no images": lambda told: "DirectoryRecordSequence" in told,
    "is damaged": lambda told: expected_of(told) is None,
}


def all_files() -> Iterator[Path]:
    files = (path for path in sorted(FILES.rglob("*")) if path.is_file())
    # of one set of files that are alike a few are enough
    return (
        path
        for path in files
        if path.suffix not in NO_FILES and path.name != "README" and "TINY" not in str(path.parent)
    )


def told_by(path: Path) -> FileDataset:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return dcmread(path, force=True)


def expected_of(told: FileDataset) -> NDArray[Any] | None:
    """Returns pydicom's values of a first slice; None where it cannot decode a file either."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            pixels = told.pixel_array if told.get("NumberOfFrames", 1) == 1 else told.pixel_array[0]
            # of doses in Gy
            return apply_modality_lut(pixels, told) * float(told.get("DoseGridScaling") or 1.0)
        except (AttributeError, RuntimeError, ValueError):
            return None


def refusal_of(path: Path, series: str | None = None) -> str | None:
    try:
        palpate.read(path, series=series)
    except PalpateError as error:
        return str(error)
    return None


def test_every_file_is_refused_for_a_true_reason() -> None:
    files = list(all_files())
    assert len(files) > 100
    read = []
    for path in files:
        said = refusal_of(path)
        if said is None:
            read.append(path.name)
            continue
        reasons = [true for words, true in TRUE_REASONS.items() if words in said]
        assert reasons, f"{path}: {said}"
        assert reasons[0](told_by(path)), said
    # doses are the only volumes among them
    assert all(name.startswith("rtdose") for name in read)


def test_single_slices_have_the_values_of_pydicom() -> None:
    compared = 0
    for path in all_files():
        header = None if path.name == "badVR.dcm" else read_header(path)
        if header is None or header.samples > 1:
            continue
        expected = expected_of(told_by(path))
        if expected is None:
            with pytest.raises(VolumeFormatError):
                read_slice(header, 0)
            continue
        if header.inverted:
            # turned around: as far below the highest number as pydicom's are above the lowest
            expected = expected.min() + expected.max() - expected
            expected += read_slice(header, 0).min() - expected.min()
        np.testing.assert_allclose(read_slice(header, 0), expected, rtol=1e-6)
        compared += 1
    assert compared > 50


@pytest.mark.parametrize("folder", ["98892001", "98892003", "77654033"])
def test_series_of_a_disc_have_the_values_of_pydicom(folder: str) -> None:
    place = FILES / "test_files" / "dicomdirtests" / folder
    for number, series in enumerate(list_series(place), 1):
        if series.slices < 2:
            continue
        files = [told_by(header.path) for header in series.headers]
        if (said := refusal_of(place, str(number))) is not None:
            assert "has a gap of" in said
            continue
        volume = palpate.read(place, series=str(number))
        if any("right grid" in warning for warning in volume.warnings):
            continue
        expected = np.array([apply_modality_lut(told.pixel_array, told) for told in files])
        np.testing.assert_array_equal(np.sort(values_of(volume), None), np.sort(expected, None))
