"""De-identification of DICOM objects that belong together, so that references among them hold.

What is done to each attribute is the table of the basic profile, as dicom-anonymizer keeps it.
Items of sequences are treated as what they are in; whatever refers to people, days or UIDs and is
in no table is treated as the table treats its like. Then words and numbers by which the source
names the patient are looked for in all that is left.

Names of segments are kept, without such words (Clean Descriptors option).

Source: DICOM PS3.15, annex E.
"""

from __future__ import annotations

import csv
from collections import Counter
from collections.abc import Callable, MutableSequence, Sequence
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Literal, cast
from uuid import uuid4

from palpate.base.errors import ConfirmationNeededError, PalpateError
from palpate.base.package_version import package_version
from palpate.export.clean_pixels import cleaned_pixels
from palpate.export.code_strings import is_term
from palpate.export.dicom_object import MAKER, UTF_8, coded, header_told
from palpate.export.identity_words import ANONYMIZED, IdentityWords
from palpate.volumes.terminology import Code

if TYPE_CHECKING:
    from pydicom.dataelem import DataElement
    from pydicom.dataset import Dataset

__all__ = ["Deidentifier", "StillIdentifiedError", "UncheckedPixelsError", "check_shown"]

PROFILE = "dicomfields_2026c"
METHODS = (
    Code("113100", "DCM", "Basic Application Confidentiality Profile"),
    Code("113105", "DCM", "Clean Descriptors Option"),
)
KEPT = ("ROIName", "StructureSetLabel", "ContentLabel")
"""Texts of ours that the table would take away: they are cleaned instead."""
COUNTED = ("SeriesNumber", "AcquisitionNumber")
"""Numbers that the table keeps, and that may be those of the study."""
TECHNICAL = (
    *KEPT, "SegmentLabel", "SegmentDescription", "SegmentAlgorithmName", "CodeValue", "CodeMeaning",
    "CodingSchemeDesignator", "CodingSchemeVersion", "ContextIdentifier", "MappingResource",
    "Manufacturer", "ManufacturerModelName", "SoftwareVersions", "ConvolutionKernel", "FilterType",
    "SequenceName", "PulseSequenceName", "ImagedNucleus", "ResonantNucleus", "ReceiveCoilName",
    "TransmitCoilName", "RescaleType", "ModalityLUTType", "PositionReferenceIndicator", "StackID",
    "DimensionDescriptionLabel", "ReconstructionMethod", "AttenuationCorrectionMethod",
    "ScatterCorrectionMethod", "CollimatorGridName",
)  # fmt: skip
"""Texts that the table keeps and that tell of machines and methods. Others may tell anything."""
BINARY = (
    "PixelData", "FloatPixelData", "DoubleFloatPixelData", "LUTData",
    *(
        f"{colour}PaletteColorLookupTableData"
        for colour in ("Red", "Green", "Blue", "Alpha", "SegmentedRed", "SegmentedGreen")
    ),
    "SegmentedBluePaletteColorLookupTableData", "PointCoordinatesData", "SurfacePointsData",
    "TrackPointIndexList", "VertexPointIndexList",
)  # fmt: skip
"""Bytes that are pixels and shapes."""
SCHEMES = (
    "DCM", "SCT", "SRT", "SNM3", "UCUM", "LN", "FMA", "NCIt", "RADLEX", "UMLS", "MA", "IBSI",
)  # fmt: skip
"""Codes that mean the same everywhere; others are an institution's own."""
WRITTEN_ON = (
    "US", "IVUS", "XA", "RF", "SC", "OT", "ES", "XC", "OP", "GM", "SM", "DG", "HC", "PX", "IO",
    "DOC",
)  # fmt: skip
"""Kinds of images that often have texts in their pixels."""
SECONDARY = "1.2.840.10008.5.1.4.1.1.7"
"""Screens and papers that were captured."""
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
TOLD = {"empty": "emptied", "replace": "replaced"}


class StillIdentifiedError(PalpateError):
    """Something by which the source names the patient would be left in a file."""


class UncheckedPixelsError(StillIdentifiedError, ConfirmationNeededError):
    """There may be text in the pixels, and nobody has looked."""


class Deidentifier:
    """One map of UIDs and one pseudonym for all objects of a patient."""

    def __init__(self, sources: Sequence[Dataset], *, pixels_checked: bool = False) -> None:
        """Learns from the source's headers which words name the patient and the study.

        Args:
            sources: Headers of the scan's files.
            pixels_checked: Whether a person has seen that no text in the pixels names somebody.

        Raises:
            UncheckedPixelsError: There may be text in the pixels, and nobody has looked.
        """
        if not pixels_checked:
            check_shown(sources)
        self._uids: dict[str, str] = {}
        self._pseudonym = f"anonymous-{uuid4().hex[:8]}"
        self._words = IdentityWords(sources)
        self._done: Counter[tuple[int, str, str]] = Counter()

    def uid(self, known: str) -> str:
        """Returns what stands for a UID; the same for the same."""
        from pydicom.uid import UID, generate_uid

        if not known or UID(known).name != known:
            return known
        return self._uids.setdefault(known, str(generate_uid()))

    def cleaned(self, text: str) -> str:
        """Returns a text without words and days that name somebody."""
        return self._words.cleaned(text)

    def apply(self, dataset: Dataset) -> Dataset:
        """Returns an object without what names the patient; the given one stays as it is.

        Raises:
            StillIdentifiedError: The patient would still be named in it.
            HiddenBytesError: Its pixels are compressed in a way that may hide texts.
        """
        with header_told("de-identification"):
            made = self._clean(dataset)
            if "PixelData" in dataset:
                made["PixelData"].value, what = cleaned_pixels(dataset)
                if what is not None:
                    self._note(made["PixelData"], what)
        made.file_meta = dataset.file_meta
        made.SpecificCharacterSet = UTF_8
        made.PatientName = made.PatientID = self._pseudonym
        made.PatientIdentityRemoved = "YES"
        made.LongitudinalTemporalInformationModified = "REMOVED"
        made.DeidentificationMethod = f"{MAKER} {package_version()}, PS3.15 basic profile"[:64]
        made.DeidentificationMethodCodeSequence = [coded(method) for method in METHODS]
        self._check(made)
        return made

    def write_report(self, path: Path) -> None:
        """Writes what was done to each attribute, and how often, as a table; no value is in it."""
        with path.open("w", encoding="utf-8", newline="") as file:
            table = csv.writer(file)
            table.writerow(("attribute", "name", "done", "times"))
            for (tag, name, what), times in sorted(self._done.items()):
                group = f"({tag >> 16:04x},{tag & 0xFFFF:04x})"
                table.writerow((group, name, what, times))

    def _note(self, element: DataElement, what: str) -> None:
        # names of private ones are theirs
        name = "private" if element.tag.is_private else element.keyword or "unknown"
        self._done[int(element.tag), name, what] += 1

    def _clean(self, dataset: Dataset) -> Dataset:
        from pydicom.dataset import Dataset

        made = Dataset()
        own_code = str(dataset.get("CodingSchemeDesignator") or "DCM") not in SCHEMES
        for element in dataset:
            action = _action(element)
            if own_code and element.keyword in {"CodeMeaning", "CodingSchemeDesignator"}:
                action = "replace"
            match action:
                case "remove":
                    self._note(element, "removed")
                    continue
                case "empty":
                    done = _with(element, [] if element.VR == "SQ" else None)
                case "replace":
                    done = _with(element, _dummy(element.VR) if element.value else element.value)
                case _:
                    done = self._kept(element)
            made.add(done)
            if element.VR != "SQ" and done.value != element.value:
                what = "given a new UID" if element.VR == "UI" else TOLD.get(action, "cleaned")
                self._note(element, what)
        return made

    def _kept(self, element: DataElement) -> DataElement:
        """Returns an element with its UIDs mapped and its words cleaned."""
        if element.VR == "SQ":
            return _with(element, [self._clean(item) for item in element.value])
        if element.VR == "UI":
            return _each(element, lambda uid: self.uid(str(uid)))
        if element.VR == "CS":
            return _each(element, lambda term: term if is_term(str(term)) else ANONYMIZED)
        if element.VR in TEXTS:
            return _each(element, lambda text: self.cleaned(str(text)))
        # some scanners count series by the study's number
        if element.keyword in COUNTED and self._words.names_in(str(element.value)):
            return _with(element, 0)
        return element

    def _check(self, dataset: Dataset) -> None:
        """Looks once more for words that name the patient, also in what is no text."""
        for element in dataset.iterall():
            if element.VR in {"SQ", "CS", "UI", *NUMBERS} or element.keyword == "PixelData":
                continue
            held = element.value
            named = (
                self._words.names_in_bytes(held)
                if isinstance(held, bytes)
                else self._words.names_in(str(held))
            )
            if named:
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
    return _action_of_kind(element)


def _action_of_kind(element: DataElement) -> Action | Literal["keep"]:
    """Returns what is done to an element that the table does not name."""
    if element.VR in {"DA", "DT", "PN", "TM"}:
        return "empty"
    if element.VR in TEXTS and element.keyword not in TECHNICAL:
        return "replace"
    if element.VR in {"OB", "OW", "OD", "OF", "OL", "OV", "UN"} and element.keyword not in BINARY:
        return "remove"
    return "keep"


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
        return ANONYMIZED
    return 0 if kind in NUMBERS else b"\0\0"


def _each(element: DataElement, change: Callable[[object], object]) -> DataElement:
    """Returns an element with each of its values changed; empty ones stay."""
    held = element.value
    if isinstance(held, MutableSequence):
        return _with(element, [change(each) for each in held])
    return _with(element, change(held) if held else held)


def check_shown(sources: Sequence[Dataset]) -> None:
    """Refuses images that have text in their pixels, or may have, where nobody has looked.

    Raises:
        UncheckedPixelsError: There are some.
    """
    for source in sources:
        said = str(source.get("BurnedInAnnotation") or "").strip().upper()
        kind = str(source.get("SOPClassUID") or "")
        often = str(source.get("Modality")) in WRITTEN_ON or kind.startswith(SECONDARY)
        if said in {"NO", "N"} or not (said or often):
            continue
        has = "have" if said else "are of a kind that often has"
        raise UncheckedPixelsError(
            f"the scan's images {has} text in their pixels, which may name the patient; allowed: "
            "`pixels_checked=True` once you have looked at all of them, .seg.nrrd, or "
            "`keep_identity=True` for an archive that may know the patient"
        )
