"""Stored numbers become values by slope, intercept or table, whichever of them a file has."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import palpate
import pytest
from dicom_cases import case, values_of
from numpy.typing import NDArray
from pydicom import dcmread
from pydicom.dataset import Dataset, FileDataset
from pydicom.pixels.processing import apply_modality_lut
from pydicom.uid import UID

STORED = np.array([100 * k + np.arange(12).reshape(3, 4) for k in range(4)])
"""Numbers of the series that tests write."""

PARAMETRIC_MAP = "1.2.840.10008.5.1.4.1.1.30"
Values = Callable[[NDArray[Any]], NDArray[Any]]


@pytest.mark.data
def test_a_modality_lut_is_applied(data_folder: Path) -> None:
    volume = palpate.read(case(data_folder, 8))
    assert volume.range == (0.0, 3000.0)


@pytest.mark.data
@pytest.mark.parametrize("kind", ["missing", "empty"])
def test_a_slope_alone_is_applied(data_folder: Path, kind: str) -> None:
    assert palpate.read(case(data_folder, 9) / kind).range == (0.0, 2000.0)


def real_world(dataset: Dataset) -> None:
    mapping, unit = Dataset(), Dataset()
    unit.CodeValue, unit.CodingSchemeDesignator, unit.CodeMeaning = "um2/s", "UCUM", "um2/s"
    mapping.RealWorldValueSlope, mapping.RealWorldValueIntercept = 0.01, 3.0
    mapping.MeasurementUnitsCodeSequence = [unit]
    dataset.RealWorldValueMappingSequence = [mapping]


def test_real_world_values_are_those_of_files_without_a_slope(write_series: Any) -> None:
    def change(_: int, dataset: FileDataset) -> None:
        real_world(dataset)
        del dataset.RescaleSlope, dataset.RescaleIntercept

    volume = palpate.read(write_series(each=change))
    np.testing.assert_allclose(values_of(volume), STORED * 0.01 + 3.0, rtol=1e-6)
    assert "values are real world values, in um2/s" in volume.warnings


def test_a_slope_goes_before_real_world_values_but_in_parametric_maps(write_series: Any) -> None:
    volume = palpate.read(
        write_series(scale=(2.5, -1024.0), each=lambda _, dataset: real_world(dataset))
    )
    np.testing.assert_allclose(values_of(volume), STORED * 2.5 - 1024.0, atol=1e-3)

    def change(_: int, dataset: FileDataset) -> None:
        real_world(dataset)
        dataset.SOPClassUID = UID(PARAMETRIC_MAP)
        dataset.file_meta.MediaStorageSOPClassUID = UID(PARAMETRIC_MAP)

    folder = write_series(prefix="map", uid="1.2.9", scale=(1.0, 0.0), each=change)
    volume = palpate.read(folder, series="1.2.9")
    np.testing.assert_allclose(values_of(volume), STORED * 0.01 + 3.0, rtol=1e-6)


@pytest.mark.parametrize(
    ("left_out", "empty", "expected"),
    [
        ("RescaleIntercept", False, lambda stored: stored * 2.5),
        ("RescaleIntercept", True, lambda stored: stored * 2.5),
        ("RescaleSlope", False, lambda stored: stored - 1024.0),
        ("RescaleSlope", True, lambda stored: stored - 1024.0),
    ],
)
def test_what_is_missing_of_two_changes_nothing(
    write_series: Any, left_out: str, *, empty: bool, expected: Values
) -> None:
    def change(_: int, dataset: FileDataset) -> None:
        if empty:
            setattr(dataset, left_out, None)
        else:
            delattr(dataset, left_out)

    volume = palpate.read(write_series(scale=(2.5, -1024.0), each=change))
    np.testing.assert_allclose(values_of(volume), expected(STORED), atol=1e-3)


@pytest.mark.parametrize(
    ("name", "value", "told"),
    [
        ("RescaleSlope", b"0 ", "RescaleSlope is 0"),
        ("RescaleSlope", b"abc ", "RescaleSlope is no number"),
        ("RescaleIntercept", b"nan ", "RescaleIntercept is no number"),
    ],
)
def test_a_scale_that_gives_no_values_is_told(
    write_series: Any, name: str, value: bytes, told: str
) -> None:
    def change(_: int, dataset: FileDataset) -> None:
        # written as it stands
        setattr(dataset, name, 7)
        dataset[name]._value = "7" * len(value)

    folder = write_series(each=change)
    for path in folder.iterdir():
        content = path.read_bytes()
        tag = {"RescaleSlope": b"\x28\x00\x53\x10", "RescaleIntercept": b"\x28\x00\x52\x10"}[name]
        at = content.index(tag) + 8
        path.write_bytes(content[:at] + value + content[at + len(value) :])
    volume = palpate.read(folder)
    np.testing.assert_array_equal(values_of(volume), STORED)
    assert volume.unit == ""
    assert any(warning.startswith(told) for warning in volume.warnings)


def table(first: int, entries: NDArray[Any], bits: int, *, kind: str = "US") -> Dataset:
    item = Dataset()
    item.add_new("LUTDescriptor", "US" if first >= 0 else "SS", [len(entries), first, bits])
    item.add_new("LUTData", "OW", entries.astype("<u2").tobytes())
    item.ModalityLUTType = kind
    return item


@pytest.mark.parametrize("first", [0, 50])
@pytest.mark.parametrize("bits", [8, 16])
def test_tables_give_what_pydicom_gives(write_series: Any, first: int, bits: int) -> None:
    # fewer entries than numbers, so that both ends count
    entries = (np.arange(200) * 7) % (1 << bits)

    def change(_: int, dataset: FileDataset) -> None:
        del dataset.RescaleSlope, dataset.RescaleIntercept
        dataset.ModalityLUTSequence = [table(first, entries, bits)]

    folder = write_series(each=change)
    files = sorted(map(dcmread, folder.iterdir()), key=lambda one: one.ImagePositionPatient[2])
    expected = [apply_modality_lut(one.pixel_array, one) for one in files]
    np.testing.assert_array_equal(values_of(palpate.read(folder)), expected)


def test_a_table_of_signed_numbers_begins_below_zero(write_series: Any) -> None:
    def change(_: int, dataset: FileDataset) -> None:
        del dataset.RescaleSlope, dataset.RescaleIntercept
        dataset.PixelRepresentation = 1
        dataset.PixelData = (np.arange(12, dtype="<i2") - 6).tobytes()
        dataset.ModalityLUTSequence = [table(-6, np.arange(12) * 10, 16, kind="HU")]

    volume = palpate.read(write_series(each=change))
    np.testing.assert_array_equal(values_of(volume)[2].ravel(), np.arange(12) * 10)
    assert volume.unit == "HU"


def test_a_table_where_low_is_bright_is_turned_around(write_series: Any) -> None:
    def change(_: int, dataset: FileDataset) -> None:
        dataset.ModalityLUTSequence = [table(0, np.arange(1000) * 3, 16)]

    volume = palpate.read(
        write_series(each=change, Modality="MR", PhotometricInterpretation="MONOCHROME1")
    )
    np.testing.assert_array_equal(values_of(volume), 65535 - 3 * STORED)


def test_a_table_that_is_cut_off_is_told(write_series: Any) -> None:
    def change(number: int, dataset: FileDataset) -> None:
        if number == 0:
            item = table(0, np.arange(1000), 16)
            item.LUTDescriptor[0] = 5000
            dataset.ModalityLUTSequence = [item]

    volume = palpate.read(write_series(each=change))
    assert volume.dimensions == (4, 3, 3)
    assert any("1 file is damaged and was left out" in warning for warning in volume.warnings)
