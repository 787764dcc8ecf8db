"""De-identification of DICOM objects that belong together, so that references among them hold.

What is done to each attribute is the table of the basic profile, as dicom-anonymizer keeps it.
Items of sequences are treated as what they are in; whatever refers to people, days or UIDs and is
in no table is treated as the table treats its like. Then words and numbers by which the source
names the patient are looked for in all that is left.

Names of segments are kept, without such words (Clean Descriptors option).

Source: DICOM PS3.15, annex E.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, MutableSequence
from functools import cache
from typing import TYPE_CHECKING, Literal, cast
from uuid import uuid4

from palpate.base.errors import PalpateError
from palpate.base.package_version import package_version
from palpate.export.dicom_object import MAKER, coded, header_told
from palpate.volumes.terminology import Code

if TYPE_CHECKING:
    from pydicom.dataelem import DataElement
    from pydicom.dataset import Dataset

__all__ = ["Deidentifier", "StillIdentifiedError"]

PROFILE = "dicomfields_2026c"
METHODS = (
    Code("113100", "DCM", "Basic Application Confidentiality Profile"),
    Code("113105", "DCM", "Clean Descriptors Option"),
)
STANDARD_UIDS = "1.2.840.10008."
"""UIDs that begin so mean the same everywhere."""
KEPT = ("ROIName", "StructureSetLabel", "ContentLabel")
"""Texts of ours that the table would take away: they are cleaned instead."""
COUNTED = ("SeriesNumber", "AcquisitionNumber")
"""Numbers that the table keeps, and that may be those of the study."""
NAMING = (
    "PatientName", "PatientID", "OtherPatientIDs", "OtherPatientNames", "PatientBirthDate",
    "PatientBirthName", "PatientMotherBirthName", "PatientAddress", "PatientTelephoneNumbers",
    "AccessionNumber", "StudyID", "ReferringPhysicianName", "PerformingPhysicianName",
    "OperatorsName", "InstitutionName", "InstitutionAddress", "StudyDate", "SeriesDate",
    "AcquisitionDate", "ContentDate", "NameOfPhysiciansReadingStudy", "RequestingPhysician",
    "StationName", "DeviceSerialNumber",
)  # fmt: skip
"""By what the source names the patient and the study."""
SHORTEST = 4
"""Letters of a word that names somebody: shorter ones occur by chance."""
TEXTS = ("AE", "LO", "LT", "PN", "SH", "ST", "UC", "UR", "UT")
NUMBERS = ("DS", "FD", "FL", "IS", "SL", "SS", "SV", "UL", "US", "UV")
DUMMIES: dict[str, str] = {
    "AS": "000Y", "DA": "19000101", "DT": "19000101000000", "TM": "000000", "CS": "ANONYMIZED",
    "UR": "http://anonymized.invalid",
    "DS": "0", "IS": "0",
}  # fmt: skip

Action = Literal["remove", "empty", "replace", "map", "follow"]
ACTIONS: dict[str, Action] = {
    "D_TAGS": "replace",
    "Z_TAGS": "empty",
    "X_TAGS": "remove",
    "U_TAGS": "map",
    "Z_D_TAGS": "replace",
    "X_Z_TAGS": "empty",
    "X_D_TAGS": "replace",
    "X_Z_D_TAGS": "replace",
    "X_Z_U_STAR_TAGS": "follow",
}


class StillIdentifiedError(PalpateError):
    """Something by which the source names the patient would be left in a file."""


class Deidentifier:
    """One map of UIDs and one pseudonym for all objects of a patient."""

    def __init__(self, sources: Iterable[Dataset]) -> None:
        """Learns from the source's headers which words name the patient and the study."""
        self._uids: dict[str, str] = {}
        self._pseudonym = f"anonymous-{uuid4().hex[:8]}"
        words = {word for each in sources for word in _words(each)}
        # longer ones first: they may hold shorter ones
        self._words = [_pattern(word) for word in sorted(words, key=len, reverse=True)]

    def uid(self, known: str) -> str:
        """Returns what stands for a UID; the same for the same."""
        from pydicom.uid import generate_uid

        if not known or known.startswith(STANDARD_UIDS):
            return known
        return self._uids.setdefault(known, str(generate_uid()))

    def apply(self, dataset: Dataset) -> Dataset:
        """Returns an object without what names the patient; the given one stays as it is.

        Raises:
            StillIdentifiedError: The patient would still be named in it.
        """
        _check_shown(dataset)
        with header_told("de-identification"):
            made = self._clean(dataset)
        made.file_meta = dataset.file_meta
        made.PatientName = made.PatientID = self._pseudonym
        made.PatientIdentityRemoved = "YES"
        made.LongitudinalTemporalInformationModified = "REMOVED"
        made.DeidentificationMethod = f"{MAKER} {package_version()}, PS3.15 basic profile"[:64]
        made.DeidentificationMethodCodeSequence = [coded(method) for method in METHODS]
        self._check(made)
        return made

    def _clean(self, dataset: Dataset) -> Dataset:
        from pydicom.dataset import Dataset

        made = Dataset()
        for element in dataset:
            match _action(element):
                case "remove":
                    continue
                case "empty":
                    made.add(_with(element, [] if element.VR == "SQ" else None))
                case "replace":
                    made.add(_with(element, _dummy(element.VR)))
                case _:
                    made.add(self._kept(element))
        return made

    def _kept(self, element: DataElement) -> DataElement:
        """Returns an element with its UIDs mapped and its words cleaned."""
        held = element.value
        if element.VR == "SQ":
            return _with(element, [self._clean(item) for item in held])
        if element.VR == "UI":
            several = isinstance(held, MutableSequence)
            mapped = [self.uid(each) for each in held] if several else self.uid(held or "")
            return _with(element, mapped)
        if element.VR in TEXTS:
            return _with(element, self._cleaned(held))
        # some scanners count series by the study's number
        if element.keyword in COUNTED and any(word.search(str(held)) for word in self._words):
            return _with(element, 0)
        return element

    def _cleaned(self, value: object) -> object:
        if value is None:
            return None
        if isinstance(value, MutableSequence):
            return [self._cleaned(each) for each in value]
        text = str(value)
        for word in self._words:
            text = word.sub("ANONYMIZED", text)
        return text

    def _check(self, dataset: Dataset) -> None:
        """Looks once more for words that name the patient, also in what is no text."""
        for element in dataset.iterall():
            if element.VR in {"SQ", "CS", "UI", *NUMBERS} or element.keyword == "PixelData":
                continue
            held = element.value
            text = held.decode("latin-1") if isinstance(held, bytes) else str(held)
            if any(word.search(text) for word in self._words):
                raise StillIdentifiedError(
                    f"{element.name or element.tag} would still name the patient or the study; "
                    "nothing was written; allowed: .seg.nrrd, NIfTI, or `keep_identity=True` "
                    "for an archive that may know the patient"
                )


def _action(element: DataElement) -> Action | Literal["keep"]:
    """Returns what is done to an element."""
    tag = element.tag
    # private ones, lengths of groups, curves and overlays
    if tag.is_private or tag.element == 0 or tag.group & 0xFF00 in (0x5000, 0x6000):
        return "remove"
    if element.keyword in KEPT:
        return "keep"
    listed = _table().get((tag.group, tag.element))
    if listed is not None:
        return listed
    return "empty" if element.VR in {"DA", "DT", "PN", "TM"} else "keep"


@cache
def _table() -> dict[tuple[int, int], Action]:
    """Returns the action for each attribute of the profile."""
    from dicomanonymizer.dicomfields_selector import dicom_anonymization_database_selector

    listed = dicom_anonymization_database_selector(PROFILE)
    return {
        (tag[0], tag[1]): action
        for name, action in ACTIONS.items()
        for tag in listed[name]
        if len(tag) == 2
    }


def _with(element: DataElement, value: object) -> DataElement:
    """Returns an element with another value."""
    from pydicom.dataelem import DataElement
    from pydicom.sequence import Sequence

    held = Sequence(cast("list[Dataset]", value)) if element.VR == "SQ" else value
    return DataElement(element.tag, element.VR, held)


def _dummy(kind: str) -> object:
    """Returns a value of a kind that tells nothing."""
    if kind == "SQ":
        return []
    if kind in DUMMIES:
        return DUMMIES[kind]
    if kind in TEXTS:
        return "ANONYMIZED"
    return 0 if kind in NUMBERS else b"\0\0"


def _words(dataset: Dataset) -> Iterator[str]:
    """Yields the words and numbers by which a source names its patient and study."""
    for element in dataset.iterall():
        if element.keyword not in NAMING or element.VR == "SQ" or element.value is None:
            continue
        several = element.value if element.VM > 1 else [element.value]
        for text in map(str, several):
            parts = re.split(r"[\^=\s,]+", text) if element.VR == "PN" else [text.strip()]
            # names of ours, as those whose data were de-identified before have them
            yield from (
                part
                for part in parts
                if len(part) >= SHORTEST and part.lower() not in "anonymized anonymous"
            )


def _pattern(word: str) -> re.Pattern[str]:
    """Returns what finds a word; digits only where they stand alone."""
    ends = (r"(?<![\d.])", r"(?![\d.])") if word.isdecimal() else ("", "")
    return re.compile(ends[0] + re.escape(word) + ends[1], re.IGNORECASE)


def _check_shown(dataset: Dataset) -> None:
    if str(dataset.get("BurnedInAnnotation") or "") == "YES":
        raise StillIdentifiedError(
            "the scan's images have text in their pixels, which may name the patient; allowed: "
            ".seg.nrrd, or `keep_identity=True` for an archive that may know the patient"
        )
