"""Values of PET as standardized uptake values (SUV) by body weight, where the tags tell enough.

SUVbw [g/ml] is the activity concentration [Bq/ml] times the weight [g], by the injected dose [Bq]
that is left at the time to which the scanner has corrected the decay. Where a tag is missing or
impossible, values stay in the unit of the file, and a sentence says which tag it is.

Source: QIBA, "SUV vendor-neutral pseudo-code" (2012, robust version), with its times of scan start;
DICOM PS3.3, C.8.9.1 (PET series), C.8.9.2 (isotope), C.8.9.4 (PET image).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from datetime import datetime, timedelta
from statistics import median
from typing import TYPE_CHECKING

from palpate.base.errors import VolumeFormatError

if TYPE_CHECKING:
    from palpate.io.dicom.header import Header, Series
    from palpate.io.dicom.pet_tags import PetTags

__all__ = ["quantified", "unit_tags"]

SUV_BY_TYPE = {
    "": "SUVbw",
    "BW": "SUVbw",
    "LBM": "SUVlbm",
    "LBMJAMES128": "SUVlbm",
    "LBMJANMA": "SUVlbm",
    "IBW": "SUVibw",
}
"""Units of values in g/ml by their SUV type; without one they are by body weight."""
PLAIN_UNITS = {"BQML": "Bq/ml", "CNTS": "counts", "CPS": "counts/s", "CM2ML": "SUVbsa", "PCNT": "%"}
"""Units of DICOM as people write them."""

NO_UNIT = (
    "PET that tells no unit of its values (RealWorldValueMappingSequence) is not converted to SUV"
)

WEIGHTS = 0.005, 650.0
"""Of a mouse to the heaviest patients [kg]: beyond, it is in another unit or a typing error."""
DOSES = 1e4, 1e11
"""[Bq]: less are MBq, which some scanners have written."""
MOST_HALF_LIVES = 6.0
"""From injection to scan: beyond, 1.6 % are left, and a date or time is wrong."""
LONGEST_OF_A_DAY = 6.0 * 3600
"""Half-life [s] up to which a scan follows the injection within a day: a time without date is one
of that day."""
INJECTED_DURING_SCAN = timedelta(hours=1)
"""By how much an injection follows the start of a dynamic scan at most."""
SAME_TIME = timedelta(minutes=1)
"""By how much times differ that are one."""
UNSURE_SHARE = 0.02
"""Relative difference of SUV by two times of the scan's start that is told."""


class _LackingError(Exception):
    """What is missing or impossible, in words."""


@dataclass(frozen=True)
class _Quantity:
    """What rescaled values of the files mean."""

    unit: str
    factor: float = 1.0
    """Value of a rescaled 1 [unit]."""
    told: tuple[str, ...] = ()


def quantified(what: str, series: Series) -> tuple[Series, list[str]]:
    """Returns a series whose slices scale to SUV where tags allow, and what is to be told.

    Raises:
        VolumeFormatError: Its slices are in different units.
    """
    tags = [header.pet for header in series.headers if header.pet is not None]
    if len(tags) < len(series.headers):
        return series, []
    if len({(one.units, one.suv_type) for one in tags}) > 1:
        units = ", ".join(sorted({one.units for one in tags}))
        raise VolumeFormatError(
            f"{what} has slices of PET in different units ({units}); allowed: one unit for all"
        )
    quantity = _quantity(tags, alone=not series.part)
    if not all(map(_has_scale, series.headers)):
        quantity = _Quantity("", told=("PET without a RescaleSlope of its own: no unit is known",))
    headers = tuple(_scaled(header, quantity) for header in series.headers)
    return replace(series, headers=headers), list(quantity.told)


def unit_tags(unit: str) -> tuple[str, str] | None:
    """Returns Units and SUV type of DICOM for a unit of PET; None for other units."""
    for suv_type, named in SUV_BY_TYPE.items():
        if suv_type and named == unit:
            return "GML", suv_type
    found = [units for units, named in PLAIN_UNITS.items() if named == unit]
    return (found[0], "BSA" if found[0] == "CM2ML" else "") if found else None


def _has_scale(header: Header) -> bool:
    return header.table is None and all(frame.scale is not None for frame in header.frames)


def _scaled(header: Header, quantity: _Quantity) -> Header:
    frames = tuple(
        frame if frame.scale is None else replace(frame, scale=_times(quantity.factor, frame.scale))
        for frame in header.frames
    )
    return replace(header, frames=frames, unit=quantity.unit)


def _times(factor: float, scale: tuple[float, float]) -> tuple[float, float]:
    slope, intercept = scale
    return factor * slope, factor * intercept


# --- what values mean ---------------------------------------------------------------------


def _quantity(tags: Sequence[PetTags], *, alone: bool) -> _Quantity:
    """Finds what rescaled values mean, from all slices; ``alone`` if they are the whole series."""
    first = tags[0]
    if first.units == "GML":
        return _as_the_file_says(first)
    if first.units == "CNTS" and first.philips_suv is not None and not _uncorrected(first):
        if len({one.philips_suv for one in tags}) == 1:
            return _Quantity("SUVbw", first.philips_suv)
        return _Quantity("counts", told=("PET stays in counts: SUV factors differ by slice",))
    becquerels = 1.0 if first.units == "BQML" else first.philips_activity
    if first.units not in ("BQML", "CNTS") or becquerels is None:
        unit = PLAIN_UNITS.get(first.units, "")
        said = f"PET in {unit or first.units} is not converted to SUV" if first.units else NO_UNIT
        return _Quantity(unit, told=(said,))
    try:
        if len({one.shared for one in tags}) > 1:
            raise _LackingError("weight, dose or times differ between its slices")
        dose, told = _dose_in_scan(tags, alone=alone)
    except _LackingError as error:
        return _Quantity("Bq/ml", becquerels, (f"PET stays in Bq/ml, not SUV: {error}",))
    assert first.weight is not None  # noqa: S101  # else the dose lacks it
    return _Quantity("SUVbw", becquerels * first.weight * 1000.0 / dose, tuple(told))


def _as_the_file_says(tags: PetTags) -> _Quantity:
    unit = SUV_BY_TYPE.get(tags.suv_type, f"SUV {tags.suv_type}")
    wrong = _uncorrected(tags)
    return _Quantity(unit, told=(f"SUV as the files say, but {wrong}",) if wrong else ())


def _uncorrected(tags: PetTags) -> str:
    """Says which corrections that SUV needs are missing; "" for none."""
    if tags.corrections is not None:
        return tags.corrections.lacking
    # DECAY: as the pseudo-code has it
    decayed = {"DECY", "DECAY"} & set(tags.corrected)
    missing = [*(() if "ATTN" in tags.corrected else ("ATTN",)), *(() if decayed else ("DECY",))]
    return f"CorrectedImage lacks {' and '.join(missing)}" if missing else ""


def _dose_in_scan(tags: Sequence[PetTags], *, alone: bool) -> tuple[float, list[str]]:
    """Returns the dose at the time to which decay was corrected [Bq], and what is to be told.

    Raises:
        _LackingError: The tags do not tell it.
    """
    first = tags[0]
    lacking = _lacking(first)
    if lacking:
        raise _LackingError(", ".join(lacking))
    assert first.dose is not None and first.half_life is not None  # noqa: S101, PT018
    if first.decay == "ADMIN":
        return first.dose, []
    start = _scan_start(tags, alone=alone)
    injected, told = _injection(first, start, first.half_life)
    told += _doubts(tags, start, first.half_life)
    return first.dose * _left(start - injected, first.half_life), told


def _lacking(tags: PetTags) -> list[str]:
    """Lists tags without which there is no SUV, beside those of times."""
    found = [_uncorrected(tags)]
    if tags.decay not in ("START", "ADMIN"):
        found.append(f"DecayCorrection is {tags.decay or 'missing'}, allowed: START or ADMIN")
    found.append(_outside("PatientWeight", tags.weight, WEIGHTS, unit="kg"))
    if tags.pharmaceuticals != 1:
        sequence = "RadiopharmaceuticalInformationSequence"
        kind = f"has {tags.pharmaceuticals} items" if tags.pharmaceuticals else "is missing"
        found.append(f"{sequence} {kind}")
    else:
        found.append(_outside("RadionuclideTotalDose", tags.dose, DOSES, unit="Bq"))
        if tags.decay == "START":
            ends = (1.0, math.inf)
            found.append(_outside("RadionuclideHalfLife", tags.half_life, ends, unit="s"))
    return [one for one in found if one]


def _outside(name: str, value: float | None, ends: tuple[float, float], *, unit: str) -> str:
    if value is None:
        return f"{name} is missing"
    low, high = ends
    allowed = f"{low:g} to {high:g}" if math.isfinite(high) else f"{low:g} or more"
    return "" if low <= value <= high else f"{name} is {value:g}, allowed: {allowed} {unit}"


# --- times --------------------------------------------------------------------------------


def _scan_start(tags: Sequence[PetTags], *, alone: bool) -> datetime:
    """Returns the time to which decay was corrected: the start of the scan, not of its processing.

    Raises:
        _LackingError: The tags do not tell it.
    """
    first = tags[0]
    if first.corrections is not None and first.corrections.decayed_to is not None:
        return first.corrections.decayed_to
    acquired = [one.acquired for one in tags if one.acquired is not None]
    if len(acquired) < len(tags):
        raise _LackingError("AcquisitionDate or AcquisitionTime is missing")
    if first.series_start is not None and first.series_start <= min(acquired):
        return first.series_start
    # a series that was made later, or has a time of its own
    if first.ge_start is not None and first.ge_start <= min(acquired):
        return first.ge_start
    worked_out = _starts_by_reference(tags)
    if worked_out:
        if max(worked_out) - min(worked_out) > SAME_TIME:
            raise _LackingError("FrameReferenceTime gives several starts of the scan")
        return _median(worked_out)
    if not alone:
        raise _LackingError("SeriesDate and SeriesTime lie after the acquisition of its slices")
    return min(acquired)


def _starts_by_reference(tags: Sequence[PetTags]) -> list[datetime]:
    """Works the start of the scan out from each slice; none where a slice does not tell."""
    starts = []
    for one in tags:
        if not (one.acquired and one.reference and one.duration and one.half_life):
            return []
        constant = math.log(2.0) / one.half_life
        decay = constant * one.duration
        average = math.log(decay / -math.expm1(-decay)) / constant
        starts.append(one.acquired + timedelta(seconds=average - one.reference))
    return starts


def _median(moments: Sequence[datetime]) -> datetime:
    away = median((moment - moments[0]).total_seconds() for moment in moments)
    return moments[0] + timedelta(seconds=away)


def _injection(tags: PetTags, start: datetime, half_life: float) -> tuple[datetime, list[str]]:
    """Returns the time of injection, and what was assumed about it.

    Raises:
        _LackingError: It is missing, or does not fit the scan.
    """
    told = []
    if tags.injected is None:
        injected = _injection_of_a_day(tags, start, half_life)
        if injected.date() != start.date():
            told.append("the injection has a time without a date: taken as of the day before")
    else:
        injected = tags.injected
        clock = tags.injected_time
        if clock and abs(datetime.combine(injected.date(), clock) - injected) > SAME_TIME:
            told.append(
                "SUV may be off: RadiopharmaceuticalStartDateTime is used, and "
                "RadiopharmaceuticalStartTime is another"
            )
    waited = start - injected
    if not -INJECTED_DURING_SCAN <= waited <= timedelta(seconds=MOST_HALF_LIVES * half_life):
        raise _LackingError(
            f"injection at {injected:%Y-%m-%d %H:%M:%S} does not fit the scan at "
            f"{start:%Y-%m-%d %H:%M:%S}"
        )
    if waited < timedelta():
        told.append(
            f"injected {-waited.total_seconds():.0f} s after the scan began: values and dose are "
            "those at its beginning, by the half-life"
        )
    return injected, told


def _injection_of_a_day(tags: PetTags, start: datetime, half_life: float) -> datetime:
    """Returns the time of an injection that has no date: within a day before the scan.

    Raises:
        _LackingError: There is no time either, or the injection may have been days before.
    """
    if tags.injected_time is None:
        raise _LackingError(
            "RadiopharmaceuticalStartDateTime and RadiopharmaceuticalStartTime are missing"
        )
    if half_life > LONGEST_OF_A_DAY:
        raise _LackingError("RadiopharmaceuticalStartDateTime is missing, and so is the day")
    injected = datetime.combine(start.date(), tags.injected_time)
    after = injected - start > INJECTED_DURING_SCAN
    return injected - timedelta(days=1) if after else injected


def _doubts(tags: Sequence[PetTags], start: datetime, half_life: float) -> list[str]:
    """Tells of a start of the scan that its slices' own times do not bear out."""
    others = _starts_by_reference(tags)
    if not others:
        return []
    other = _median(others)
    share = abs(_left(other - start, half_life) - 1.0)
    if share <= UNSURE_SHARE:
        return []
    said = f"FrameReferenceTime tells a start of the scan at {other:%H:%M:%S}, not {start:%H:%M:%S}"
    return [f"SUV may be off by {100.0 * share:.0f} %: {said}"]


def _left(waited: timedelta, half_life: float) -> float:
    """Returns the share of a dose that is left after some time."""
    return float(2.0 ** (-waited.total_seconds() / half_life))
