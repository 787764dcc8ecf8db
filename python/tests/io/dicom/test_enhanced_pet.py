"""Enhanced PET: values are SUV by body weight as those of single slices, told at other places.

The numbers expected here are worked out by hand: 74 kg and 370 MBq of F-18 (6586.2 s) injected at
08:30:45, one half-life before the time to which decay is corrected, 10:20:31.2: 74 000 g by 185 MBq
is an SUV of 0.0004 for 1 Bq/ml.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import palpate
import pytest
from palpate.bench import fuzz_dicom
from palpate.volumes.volume import Volume
from pydicom import dcmread
from pydicom.dataset import Dataset

HALVED = 0.0004
UNHALVED = 0.0002
STORED = 300 + np.arange(90.0).reshape(3, 5, 6)
INJECTED = "20140618083045"
CORRECTED_TO = "20140618102031.2"


def mapping(unit: str | None, slope: float) -> Dataset:
    item, code = Dataset(), Dataset()
    item.RealWorldValueSlope, item.RealWorldValueIntercept = slope, 0.0
    if unit is not None:
        code.CodeValue, code.CodingSchemeDesignator = unit, "UCUM"
        item.MeasurementUnitsCodeSequence = [code]
    return item


@pytest.fixture
def pet(tmp_path: Path) -> Callable[..., Volume]:
    """Reads enhanced PET of 2.5 Bq/ml for a stored 1; elements set to None are left out."""
    path = fuzz_dicom.dicom_folders(tmp_path)["enhanced-pet"][0]

    def read(
        *, item: dict[str, Any] | None = None, mappings: list[Dataset] | None = None, **changes: Any
    ) -> Volume:
        dataset = dcmread(path)
        shared = dataset.SharedFunctionalGroupsSequence[0]
        # what has no unit is no activity
        shared.PixelValueTransformationSequence[0].RescaleSlope = 7
        held = [mapping("Bq/ml", 2.5)] if mappings is None else mappings
        shared.RealWorldValueMappingSequence = held
        injection = dataset.RadiopharmaceuticalInformationSequence[0]
        told = {"DecayCorrectionDateTime": CORRECTED_TO, **changes}
        for holder, elements in ((dataset, told), (injection, item or {})):
            for name, value in elements.items():
                if value is None:
                    delattr(holder, name)
                else:
                    setattr(holder, name, value)
        made = tmp_path / "made.dcm"
        dataset.save_as(made)
        return palpate.read(made)

    return read


def check(volume: Volume, unit: str, factor: Any, *told: str) -> None:
    assert volume.unit == unit
    np.testing.assert_allclose(volume.values(), factor * STORED, rtol=2e-6)
    assert len(volume.warnings) == len(told), volume.warnings
    for sentence, words in zip(volume.warnings, told, strict=True):
        assert words in sentence


def test_activity_becomes_suv_by_body_weight(pet: Any) -> None:
    check(pet(), "SUVbw", 2.5 * HALVED)


def test_decay_corrected_to_the_injection_takes_the_whole_dose(pet: Any) -> None:
    check(pet(DecayCorrectionDateTime=INJECTED), "SUVbw", 2.5 * UNHALVED)


def test_activity_is_preferred_to_other_units_and_told_suv_is_taken(pet: Any) -> None:
    lean, activity = mapping("g/ml{SUVlbm}", 0.3), mapping("Bq/ml", 2.5)
    check(pet(mappings=[lean, activity]), "SUVbw", 2.5 * HALVED)
    check(pet(mappings=[lean]), "SUVlbm", 0.3)


def test_each_frame_has_its_own_slope(pet: Any, tmp_path: Path) -> None:
    pet()
    dataset = dcmread(tmp_path / "made.dcm")
    for number, groups in enumerate(dataset.PerFrameFunctionalGroupsSequence, 1):
        groups.RealWorldValueMappingSequence = [mapping("Bq/ml", float(number))]
    dataset.save_as(tmp_path / "frames.dcm")
    volume = palpate.read(tmp_path / "frames.dcm")
    slopes = np.array([1.0, 2.0, 3.0])[:, None, None]
    check(volume, "SUVbw", HALVED * slopes)
    # frames in different units are in none that is known
    dataset.PerFrameFunctionalGroupsSequence[1].RealWorldValueMappingSequence = [
        mapping("g/ml{SUVbw}", 2.0)
    ]
    dataset.save_as(tmp_path / "mixed.dcm")
    check(palpate.read(tmp_path / "mixed.dcm"), "", slopes, "tells no unit of its values")


@pytest.mark.parametrize(
    ("changes", "item", "words"),
    [
        ({"AttenuationCorrected": "NO"}, {}, "AttenuationCorrected is NO"),
        ({"DecayCorrected": "NO"}, {}, "DecayCorrected is NO"),
        ({"DecayCorrected": None}, {}, "DecayCorrected is missing"),
        ({"DecayCorrectionDateTime": None}, {}, "DecayCorrectionDateTime is missing"),
        ({"PatientWeight": None}, {}, "PatientWeight is missing"),
        ({}, {"RadionuclideTotalDose": "370"}, "RadionuclideTotalDose is 370"),
        ({}, {"RadionuclideHalfLife": None}, "RadionuclideHalfLife is missing"),
        (
            {"DecayCorrectionDateTime": "20140719102031"},
            {},
            "injection at 2014-06-18 08:30:45 does not fit the scan at 2014-07-19 10:20:31",
        ),
        (
            {"RadiopharmaceuticalInformationSequence": [Dataset(), Dataset()]},
            {},
            "RadiopharmaceuticalInformationSequence has 2 items",
        ),
    ],
)
def test_what_is_missing_or_impossible_is_told_and_values_stay(
    pet: Any, changes: dict[str, Any], item: dict[str, Any], words: str
) -> None:
    volume = pet(item=item, **changes)
    check(volume, "Bq/ml", 2.5, f"PET stays in Bq/ml, not SUV: {words}")


def test_values_in_other_units_or_in_none_stay_and_that_is_told(pet: Any) -> None:
    check(pet(mappings=[mapping("kBq/ml", 2.5)]), "", 2.5, "PET in kBq/ml is not converted")
    check(pet(mappings=[mapping(None, 2.5)]), "", 2.5, "tells no unit of its values")
    # without a mapping it is rescaled, which has no unit either
    check(pet(mappings=[]), "", 7.0, "tells no unit of its values")
