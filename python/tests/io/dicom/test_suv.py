"""PET: values are SUV by body weight where the tags tell enough, else the file's, and it is told.

The numbers expected here are worked out by hand from the tags of ``pet``: 74 kg and 370 MBq of F-18
(6586.2 s) injected at 08:30:45, one half-life before a scan at 10:20:31.2.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import palpate
import pytest
from palpate.base.errors import VolumeFormatError
from palpate.export.export import export_scene
from palpate.volumes.scene import Scene
from palpate.volumes.volume import Volume
from pydicom import dcmread
from pydicom.dataset import Dataset, FileDataset

STORED = np.array([100 * k + np.arange(12).reshape(3, 4) for k in range(4)], float)
HALVED = 74.0 * 1000.0 / (370e6 / 2.0)
"""SUV of 1 Bq/ml: 74 000 g by 185 MBq, 0.0004."""
UNHALVED = 74.0 * 1000.0 / 370e6


def pharmaceutical(**changes: Any) -> Dataset:
    item = Dataset()
    item.RadionuclideTotalDose, item.RadionuclideHalfLife = "370000000", "6586.2"
    item.RadiopharmaceuticalStartTime = "083045.00"
    item.RadiopharmaceuticalStartDateTime = "20140618083045.00"
    for name, value in changes.items():
        if value is None:
            delattr(item, name)
        else:
            setattr(item, name, value)
    return item


@pytest.fixture
def pet(write_series: Any) -> Callable[..., Volume]:
    """Reads a PET series; tags set to None are left out."""

    def read(
        *, item: dict[str, Any] | None = None, each: Any = None, folder: str = "pet", **changes: Any
    ) -> Volume:
        tags = {
            "Modality": "PT",
            "Units": "BQML",
            "CorrectedImage": ["NORM", "ATTN", "SCAT", "DECY"],
            "DecayCorrection": "START",
            "PatientWeight": "74",
            "SeriesDate": "20140618",
            "SeriesTime": "102031.2",
            "AcquisitionDate": "20140618",
            "AcquisitionTime": "102031.2",
            "RadiopharmaceuticalInformationSequence": [pharmaceutical(**(item or {}))],
            **changes,
        }

        def finish(number: int, dataset: FileDataset) -> None:
            for name, value in tags.items():
                if value is None and name in dataset:
                    delattr(dataset, name)
            if each is not None:
                each(number, dataset)

        return palpate.read(write_series(folder, each=finish, scale=(2.5, 0.0), **tags))

    return read


def values_of(volume: Volume) -> Any:
    return volume.slope * volume.array.astype(float) + volume.intercept


def check(volume: Volume, unit: str, factor: float, *told: str) -> None:
    assert volume.unit == unit
    np.testing.assert_allclose(values_of(volume), 2.5 * factor * STORED, rtol=2e-6, atol=1e-9)
    assert len(volume.warnings) == len(told), volume.warnings
    for sentence, words in zip(volume.warnings, told, strict=True):
        assert words in sentence


def test_activity_becomes_suv_by_body_weight(pet: Any) -> None:
    check(pet(), "SUVbw", HALVED)


def test_decay_corrected_to_injection_takes_the_whole_dose(pet: Any) -> None:
    check(pet(DecayCorrection="ADMIN"), "SUVbw", UNHALVED)
    # no times are needed then
    times = {"SeriesTime": None, "AcquisitionTime": None}
    check(pet(folder="untimed", DecayCorrection="ADMIN", **times), "SUVbw", UNHALVED)


@pytest.mark.parametrize(
    ("changes", "item", "words"),
    [
        ({"PatientWeight": None}, {}, "PatientWeight is missing"),
        ({"PatientWeight": "0"}, {}, "PatientWeight is 0, allowed: 0.005 to 650 kg"),
        ({"PatientWeight": "74000"}, {}, "PatientWeight is 74000"),
        ({"CorrectedImage": ["NORM", "DECY"]}, {}, "CorrectedImage lacks ATTN"),
        ({"CorrectedImage": "ATTN"}, {}, "CorrectedImage lacks DECY"),
        ({"CorrectedImage": None}, {}, "CorrectedImage lacks ATTN and DECY"),
        ({"DecayCorrection": "NONE"}, {}, "DecayCorrection is NONE"),
        ({"DecayCorrection": None}, {}, "DecayCorrection is missing"),
        (
            {"RadiopharmaceuticalInformationSequence": None},
            {},
            "RadiopharmaceuticalInformationSequence is missing",
        ),
        (
            {"RadiopharmaceuticalInformationSequence": [pharmaceutical(), pharmaceutical()]},
            {},
            "RadiopharmaceuticalInformationSequence has 2 items",
        ),
        ({}, {"RadionuclideTotalDose": None}, "RadionuclideTotalDose is missing"),
        ({}, {"RadionuclideTotalDose": "370"}, "RadionuclideTotalDose is 370"),
        ({}, {"RadionuclideHalfLife": None}, "RadionuclideHalfLife is missing"),
        ({}, {"RadionuclideHalfLife": "0"}, "RadionuclideHalfLife is 0"),
        (
            {},
            {"RadiopharmaceuticalStartTime": None, "RadiopharmaceuticalStartDateTime": None},
            "RadiopharmaceuticalStartDateTime and RadiopharmaceuticalStartTime are missing",
        ),
        # a day after the scan, and a year before it
        (
            {},
            {"RadiopharmaceuticalStartDateTime": "20140619083045"},
            "injection at 2014-06-19 08:30:45 does not fit the scan at 2014-06-18 10:20:31",
        ),
        ({}, {"RadiopharmaceuticalStartDateTime": "20130618083045"}, "injection at 2013-06-18"),
        ({"AcquisitionTime": None}, {}, "AcquisitionDate or AcquisitionTime is missing"),
    ],
)
def test_what_is_missing_or_impossible_is_told_and_values_stay(
    pet: Any, changes: dict[str, Any], item: dict[str, Any], words: str
) -> None:
    check(pet(item=item, **changes), "Bq/ml", 1.0, f"PET stays in Bq/ml, not SUV: {words}")


def test_all_that_is_missing_is_told_at_once(pet: Any) -> None:
    volume = pet(PatientWeight=None, DecayCorrection=None)
    assert "DecayCorrection is missing" in volume.warnings[0]
    assert "PatientWeight is missing" in volume.warnings[0]


# --- times --------------------------------------------------------------------------------


def test_bed_positions_have_one_start(pet: Any) -> None:
    def later(number: int, dataset: FileDataset) -> None:
        # each slice of another bed, all corrected to the start of the scan
        dataset.AcquisitionTime = f"10{20 + 5 * number}31.2"

    check(pet(each=later), "SUVbw", HALVED)


def test_a_series_made_later_takes_its_earliest_acquisition(pet: Any) -> None:
    def later(number: int, dataset: FileDataset) -> None:
        dataset.AcquisitionTime = f"10{20 + 5 * number}31.2"

    check(pet(each=later, SeriesTime="154500"), "SUVbw", HALVED)


def test_a_series_of_ge_made_later_takes_the_scanners_own_start(pet: Any) -> None:
    def add(_: int, dataset: FileDataset) -> None:
        block = dataset.private_block(0x0009, "GEMS_PETD_01", create=True)
        block.add_new(0x0D, "DT", "20140618102031.20")
        dataset.AcquisitionTime = "104531"

    check(pet(each=add, SeriesTime="154500"), "SUVbw", HALVED)


def test_a_series_made_later_is_worked_out_from_its_frames(pet: Any) -> None:
    def frame(number: int, dataset: FileDataset) -> None:
        # beds of 180 s from 60 s on; of F-18 half of the counts come in the first 89.858 s
        dataset.AcquisitionTime = ("102131.2", "102431.2", "102731.2", "103031.2")[number]
        dataset.FrameReferenceTime = str(60_000 + 180_000 * number + 89_858)
        dataset.ActualFrameDuration = "180000"

    check(pet(each=frame, SeriesTime="154500"), "SUVbw", HALVED)


def test_a_start_that_frames_do_not_bear_out_is_told(pet: Any) -> None:
    def frame(_: int, dataset: FileDataset) -> None:
        # ten minutes of F-18 are 6.5 % by these times
        dataset.AcquisitionTime = "103031.2"
        dataset.FrameReferenceTime, dataset.ActualFrameDuration = "89858", "180000"

    check(pet(each=frame), "SUVbw", HALVED, "SUV may be off by 6 %")


def test_frames_with_several_starts_are_not_converted(pet: Any) -> None:
    def frame(number: int, dataset: FileDataset) -> None:
        dataset.AcquisitionTime = f"10{20 + 5 * number}31.2"
        dataset.FrameReferenceTime, dataset.ActualFrameDuration = "89858", "180000"

    check(pet(each=frame, SeriesTime="154500"), "Bq/ml", 1.0, "FrameReferenceTime gives several")


def test_a_time_of_injection_without_a_date_is_of_the_same_day(pet: Any) -> None:
    check(pet(item={"RadiopharmaceuticalStartDateTime": None}), "SUVbw", HALVED)


def test_a_scan_over_midnight(pet: Any) -> None:
    moment = {"SeriesDate": "20140619", "AcquisitionDate": "20140619"}
    moment |= {"SeriesTime": "003000", "AcquisitionTime": "003000"}
    # 1 h 49 min 46.2 s before
    with_date = {"RadiopharmaceuticalStartDateTime": "20140618224013.8"}
    with_date["RadiopharmaceuticalStartTime"] = "224013.8"
    check(pet(item=with_date, **moment), "SUVbw", HALVED)
    without = {**with_date, "RadiopharmaceuticalStartDateTime": None}
    check(pet(folder="night", item=without, **moment), "SUVbw", HALVED, "of the day before")


def test_an_injection_into_a_running_scan_is_no_day_before(pet: Any) -> None:
    # 109 min 46.2 s after: the dose at the start would be twice as much
    item = {"RadiopharmaceuticalStartTime": "103031.2", "RadiopharmaceuticalStartDateTime": None}
    left = 2.0 ** (600.0 / 6586.2)
    said = "injected 600 s after the scan began"
    check(pet(item=item), "SUVbw", 74.0 * 1000.0 / (370e6 * left), said)


def test_a_long_lived_nuclide_needs_the_day_of_injection(pet: Any) -> None:
    # Zr-89, imaged for days
    item: dict[str, Any] = {"RadionuclideHalfLife": "282240"}
    undated = {**item, "RadiopharmaceuticalStartDateTime": None}
    check(pet(item=undated), "Bq/ml", 1.0, "RadiopharmaceuticalStartDateTime is missing")
    dated = {**item, "RadiopharmaceuticalStartDateTime": "20140615083045.0"}
    waited = 3 * 86400 + 6586.2
    left = 2.0 ** (-waited / 282240)
    check(pet(folder="dated", item=dated), "SUVbw", 74.0 * 1000.0 / (370e6 * left))


def test_two_times_of_injection_are_told(pet: Any) -> None:
    item = {"RadiopharmaceuticalStartTime": "093045.00"}
    check(pet(item=item), "SUVbw", HALVED, "RadiopharmaceuticalStartTime is another")


# --- other units --------------------------------------------------------------------------


def test_grams_per_millilitre_are_suv_already(pet: Any) -> None:
    check(pet(Units="GML", PatientWeight=None), "SUVbw", 1.0)
    check(pet(folder="lean", Units="GML", SUVType="LBM"), "SUVlbm", 1.0)
    check(
        pet(folder="uncorrected", Units="GML", CorrectedImage="DECY"),
        "SUVbw",
        1.0,
        "CorrectedImage lacks ATTN",
    )


def test_counts_of_philips_have_their_own_factor(pet: Any) -> None:
    def suv(_: int, dataset: FileDataset) -> None:
        block = dataset.private_block(0x7053, "Philips PET Private Group", create=True)
        block.add_new(0x00, "DS", "0.000551")

    def activity(_: int, dataset: FileDataset) -> None:
        block = dataset.private_block(0x7053, "Philips PET Private Group", create=True)
        block.add_new(0x00, "DS", "0")
        block.add_new(0x09, "DS", "1.25")

    check(pet(Units="CNTS", PatientWeight=None, each=suv), "SUVbw", 0.000551)
    check(pet(folder="activity", Units="CNTS", each=activity), "SUVbw", 1.25 * HALVED)
    lacking = pet(folder="lacking", Units="CNTS", PatientWeight=None, each=activity)
    check(lacking, "Bq/ml", 1.25, "PatientWeight is missing")


def test_other_units_are_told(pet: Any) -> None:
    check(pet(Units="CNTS"), "counts", 1.0, "PET in counts is not converted to SUV")
    unknown = pet(folder="rate", Units="MLMING")
    assert unknown.unit == ""
    assert "PET in MLMING is not converted to SUV" in unknown.warnings[0]


def test_slices_in_different_units_are_refused(pet: Any) -> None:
    def mixed(number: int, dataset: FileDataset) -> None:
        dataset.Units = "CNTS" if number == 2 else "BQML"

    with pytest.raises(VolumeFormatError, match="different units"):
        pet(each=mixed)


def test_slices_of_different_weights_are_not_converted(pet: Any) -> None:
    def mixed(number: int, dataset: FileDataset) -> None:
        dataset.PatientWeight = "74" if number else "75"

    check(pet(each=mixed), "Bq/ml", 1.0, "differ between its slices")


# --- values -------------------------------------------------------------------------------


def test_numbers_without_a_scale_have_no_unit(pet: Any) -> None:
    table = Dataset()
    table.LUTDescriptor, table.ModalityLUTType = [400, 0, 16], "US"
    table.LUTData = np.arange(0, 800, 2, dtype="<u2").tobytes()
    looked_up = pet(ModalityLUTSequence=[table])
    assert looked_up.unit == ""
    assert any("without a RescaleSlope" in said for said in looked_up.warnings)
    bare = pet(folder="bare", each=lambda _, dataset: _take_scale(dataset))
    assert bare.unit == ""


def _take_scale(dataset: FileDataset) -> None:
    del dataset.RescaleSlope, dataset.RescaleIntercept


def test_each_slice_has_its_own_slope(pet: Any) -> None:
    slopes = np.array([0.31, 2.57, 11.0, 1.125])

    def scale(number: int, dataset: FileDataset) -> None:
        dataset.RescaleSlope = float(slopes[number])

    volume = pet(each=scale)
    expected = HALVED * slopes[:, None, None] * STORED
    # as exact as floats of 32 bits
    np.testing.assert_allclose(volume.values(), expected, rtol=2e-7)
    assert volume.warnings == ()


def test_values_with_a_unit_are_not_turned_around(pet: Any) -> None:
    volume = pet(PhotometricInterpretation="MONOCHROME1")
    check(volume, "SUVbw", HALVED)
    assert "SUVbw are kept as they are" in volume.notes[0]


def test_a_derived_series_says_suv_and_is_read_as_such(pet: Any, tmp_path: Path) -> None:
    volume = pet()
    changed = volume.array.copy()
    changed[0, 0, 0] = changed.max()
    export_scene(Scene(volume.with_values(changed)), tmp_path / "edited")
    files = [dcmread(path) for path in sorted((tmp_path / "edited").rglob("*.dcm"))]
    made = [file for file in files if "DERIVED" in file.get("ImageType", ())]
    assert {(file.Units, file.SUVType) for file in made} == {("GML", "BW")}
    again = palpate.read(tmp_path / "edited", series=made[0].SeriesInstanceUID)
    assert again.unit == "SUVbw"
    expected = values_of(volume.with_values(changed))
    np.testing.assert_allclose(values_of(again), expected, rtol=1e-6)


def test_another_unit_that_is_asked_for_is_told(write_series: Any) -> None:
    series = write_series(Modality="PT", Units="BQML", scale=(2.5, 0.0))
    volume = palpate.read(series, unit="HU")
    assert volume.unit == "HU"
    assert "unit HU replaces the file's own, Bq/ml" in volume.warnings
