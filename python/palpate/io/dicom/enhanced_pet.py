"""What enhanced PET says about its values, at its own places: unit, corrections, time of decay.

Its unit is that of a real world value mapping of its frames, and all frames are corrected to one
stated time.

Source: DICOM PS3.3, A.56 (enhanced PET), C.7.6.16.2.11 (real world value mapping), C.8.22.2
(isotope), C.8.22.4 (corrections); PS3.16, CID 84 (units of PET).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from palpate.io.dicom.pet_tags import Corrections, PetTags, moment_of, pet_tags_of
from palpate.io.dicom.rescale import real_world_scale

if TYPE_CHECKING:
    from pydicom.dataset import Dataset

__all__ = ["ENHANCED_PET", "enhanced_pet_tags_of", "pet_mapping"]

ENHANCED_PET = "1.2.840.10008.5.1.4.1.1.130"
"""Its SOP class."""
UNITS = {
    "bq/ml": ("BQML", ""),
    "g/ml{suvbw}": ("GML", "BW"),
    "g/ml{suvlbm}": ("GML", "LBM"),
    "g/ml{suvibw}": ("GML", "IBW"),
    "cm2/ml{suvbsa}": ("CM2ML", "BSA"),
    "{counts}": ("CNTS", ""),
    "{counts}/s": ("CPS", ""),
    "%": ("PCNT", ""),
}
"""Units and SUV type of single slices for units of UCUM, in small letters; the first is preferred,
of which SUV is worked out as of single slices."""


def pet_mapping(holders: Sequence[Dataset]) -> Dataset | None:
    """Returns the mapping of stored numbers that gives a frame its values; None without any.

    Args:
        holders: Its own functional groups, the shared ones, the file.
    """
    for holder in holders:
        linear = [
            mapping
            for mapping in holder.get("RealWorldValueMappingSequence") or []
            if real_world_scale(mapping) is not None
        ]
        if linear:
            chosen: Dataset = min(linear, key=_rank)
            return chosen
    return None


def enhanced_pet_tags_of(dataset: Dataset, mappings: Sequence[Dataset | None]) -> PetTags:
    """Returns what a file says about its values, given the mappings of its frames."""
    found = {"" if mapping is None else _unit(mapping) for mapping in mappings}
    unit = found.pop() if len(found) == 1 else ""
    units, suv_type = UNITS.get(unit.lower(), (unit, ""))
    corrected_to = moment_of(str(dataset.get("DecayCorrectionDateTime") or "").strip())
    wanted = ("AttenuationCorrected", "DecayCorrected")
    lacking = [
        f"{name} is {dataset.get(name) or 'missing'}"
        for name in wanted
        if dataset.get(name) != "YES"
    ]
    if corrected_to is None and dataset.get("DecayCorrected") == "YES":
        lacking.append("DecayCorrectionDateTime is missing")
    return replace(
        pet_tags_of(dataset),
        units=units,
        suv_type=suv_type,
        decay="START",
        corrections=Corrections(corrected_to, ", ".join(lacking)),
    )


def _rank(mapping: Dataset) -> int:
    known = [*UNITS]
    unit = _unit(mapping).lower()
    return known.index(unit) if unit in UNITS else len(known)


def _unit(mapping: Dataset) -> str:
    """Returns the unit of a mapping as UCUM has it; "" where it tells none."""
    codes = mapping.get("MeasurementUnitsCodeSequence") or []
    return str(codes[0].get("CodeValue") or "").strip() if codes else ""
