"""What files of PET say about their values: units, corrections, dose, weight and times.

Source: DICOM PS3.3, C.8.9.1 (PET series), C.8.9.2 (isotope), C.8.9.4 (PET image); conformance
statements of GE (0009,xx0D) and Philips (7053,xx00 and 7053,xx09).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from datetime import date, datetime, time
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pydicom.dataset import Dataset

__all__ = ["Corrections", "PetTags", "moment_of", "pet_tags_of"]

GE_SCAN = 0x0009, "GEMS_PETD_01"
PHILIPS = 0x7053, "Philips PET Private Group"


@dataclass(frozen=True)
class Corrections:
    """What an enhanced image says of its corrections."""

    decayed_to: datetime | None
    """Time to which decay is corrected in all frames."""
    lacking: str
    """What SUV needs and is not there, in words; "" for nothing."""


@dataclass(frozen=True)
class PetTags:
    """What one file of PET says about its values; None and "" where it says nothing."""

    units: str
    suv_type: str
    corrected: tuple[str, ...]
    decay: str
    weight: float | None
    """[kg]."""
    pharmaceuticals: int
    dose: float | None
    """At the time of injection [Bq]."""
    half_life: float | None
    """[s]."""
    injected: datetime | None
    injected_time: time | None
    series_start: datetime | None
    ge_start: datetime | None
    philips_suv: float | None
    """SUV of a rescaled value."""
    philips_activity: float | None
    """Activity concentration of a rescaled value [Bq/ml]."""
    acquired: datetime | None = None
    """Start of the slice's own bed position or time frame."""
    reference: float | None = None
    """When its average count rate occurred, after the start of the scan [s]."""
    duration: float | None = None
    """Of its frame [s]."""
    corrections: Corrections | None = None
    """Of an enhanced image; None of single slices."""

    @property
    def shared(self) -> PetTags:
        """What is the same for all slices of a scan."""
        return replace(self, acquired=None, reference=None, duration=None)


def pet_tags_of(dataset: Dataset) -> PetTags:
    """Returns what a file of PET says about its values, as single slices have it."""
    from pydicom.dataset import Dataset

    items = dataset.get("RadiopharmaceuticalInformationSequence") or []
    pharmaceutical = items[0] if items else Dataset()
    corrected = dataset.get("CorrectedImage") or ()
    return PetTags(
        units=_text(dataset, "Units"),
        suv_type=_text(dataset, "SUVType"),
        corrected=(corrected,) if isinstance(corrected, str) else tuple(map(str, corrected)),
        decay=_text(dataset, "DecayCorrection"),
        weight=_number(dataset, "PatientWeight"),
        pharmaceuticals=len(items),
        dose=_number(pharmaceutical, "RadionuclideTotalDose"),
        half_life=_number(pharmaceutical, "RadionuclideHalfLife"),
        injected=moment_of(_text(pharmaceutical, "RadiopharmaceuticalStartDateTime")),
        injected_time=_clock(_text(pharmaceutical, "RadiopharmaceuticalStartTime")),
        series_start=_date_and_time(dataset, "Series"),
        ge_start=moment_of(str(_private(dataset, GE_SCAN, 0x0D) or "")),
        philips_suv=_positive(_private(dataset, PHILIPS, 0x00)),
        philips_activity=_positive(_private(dataset, PHILIPS, 0x09)),
        acquired=_date_and_time(dataset, "Acquisition")
        or moment_of(_text(dataset, "AcquisitionDateTime")),
        reference=_seconds(_number(dataset, "FrameReferenceTime")),
        duration=_seconds(_number(dataset, "ActualFrameDuration")),
    )


def _text(holder: Dataset, name: str) -> str:
    return str(holder.get(name) or "").strip()


def _number(holder: Dataset, name: str) -> float | None:
    try:
        value = holder.get(name)
    except (TypeError, ValueError):
        return None
    return _finite(value)


def _finite(value: object) -> float | None:
    if isinstance(value, bytes):
        # private elements without a known type
        value = value.decode("ascii", "replace").strip("\0 ")
    try:
        number = float(str(value))
    except ValueError:
        return None
    return number if math.isfinite(number) else None


def _positive(value: object) -> float | None:
    number = _finite(value)
    return number if number is not None and number > 0.0 else None


def _seconds(milliseconds: float | None) -> float | None:
    return milliseconds / 1000.0 if milliseconds is not None and milliseconds > 0.0 else None


def _private(dataset: Dataset, block: tuple[int, str], element: int) -> object:
    try:
        value: object = dataset.private_block(*block)[element].value
    except (KeyError, TypeError, ValueError):
        return None
    return value


def _date_and_time(dataset: Dataset, of: str) -> datetime | None:
    day, clock = _day(_text(dataset, f"{of}Date")), _clock(_text(dataset, f"{of}Time"))
    return None if day is None or clock is None else datetime.combine(day, clock)


def _day(text: str) -> date | None:
    from pydicom.valuerep import DA

    try:
        return DA(text) if text else None
    except ValueError:
        return None


def _clock(text: str) -> time | None:
    from pydicom.valuerep import TM

    try:
        return TM(text) if text else None
    except ValueError:
        return None


def moment_of(text: str) -> datetime | None:
    """Returns date and time in the scanner's own zone, as all others are."""
    from pydicom.valuerep import DT

    try:
        moment = DT(text) if len(text) > len("YYYYMMDD") else None
    except ValueError:
        return None
    return None if moment is None else datetime.combine(moment.date(), moment.time())
