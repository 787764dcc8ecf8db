"""What a segment is, in standard codes: SNOMED CT, as DICOM and 3D Slicer use it.

Source: DICOM PS3.3, C.8.20.4 (segment description); PS3.16, CID 7150 and 7151; "Segmentation file
format", 3D Slicer developer guide (``TerminologyEntry``).
"""

from __future__ import annotations

import re
from dataclasses import dataclass

__all__ = ["Code", "Terminology", "terminology_of_name"]

CONTEXT = "Segmentation category and type - DICOM master list"
REGIONS = "Anatomic codes - DICOM master list"
SCHEME = "SCT"


@dataclass(frozen=True)
class Code:
    """A concept of a coding scheme."""

    value: str
    scheme: str
    meaning: str


@dataclass(frozen=True)
class Terminology:
    """Category and type of a segment, and where it lies in the body."""

    category: Code
    kind: Code
    side: Code | None = None
    """Modifier of the type, such as left."""
    region: Code | None = None
    """Region of the body, for types that occur anywhere."""

    @classmethod
    def of_slicer(cls, entry: str) -> Terminology | None:
        """Reads an entry of a ``.seg.nrrd``; None where it has no type."""
        parts = [_code_of(part) for part in entry.rstrip("|").split("~")]
        parts += [None] * (7 - len(parts))
        category, kind = parts[1], parts[2]
        if category is None or kind is None:
            return None
        return cls(category, kind, side=parts[3], region=parts[5])

    def slicer(self) -> str:
        """Returns the entry of a ``.seg.nrrd``."""
        codes = [_text(self.category), _text(self.kind), _text(self.side)]
        return "~".join([CONTEXT, *codes, REGIONS, _text(self.region), "^^|"])


def _code_of(text: str) -> Code | None:
    parts = text.split("^")
    if len(parts) != 3 or not parts[0]:
        return None
    return Code(parts[1], parts[0], parts[2])


def _text(code: Code | None) -> str:
    return "^^" if code is None else f"{code.scheme}^{code.value}^{code.meaning}"


ANATOMY = Code("123037004", SCHEME, "Anatomical Structure")
TISSUE = Code("85756007", SCHEME, "Tissue")
SIDES = (
    (r"(\b|_)left(\b|_)", Code("7771000", SCHEME, "Left")),
    (r"(\b|_)right(\b|_)", Code("24028007", SCHEME, "Right")),
)

BY_NAME: tuple[tuple[str, str, str], ...] = (
    ("adrenal", "23451007", "Adrenal gland"),
    ("gall_?bladder", "28231008", "Gallbladder"),
    ("bladder", "89837001", "Urinary bladder"),
    ("liver", "10200004", "Liver"),
    ("spleen", "78961009", "Spleen"),
    ("kidney", "64033007", "Kidney"),
    ("pancreas", "15776009", "Pancreas"),
    ("stomach", "69695003", "Stomach"),
    ("duodenum", "38848004", "Duodenum"),
    ("colon", "71854001", "Colon"),
    ("esophagus|oesophagus", "32849002", "Esophagus"),
    ("prostate", "41216001", "Prostate"),
    ("trachea", "44567001", "Trachea"),
    ("lung", "39607008", "Lung"),
    ("heart", "80891009", "Heart"),
    ("aorta", "15825003", "Aorta"),
    ("inferior_?.?vena_?.?cava", "64131007", "Inferior vena cava"),
    ("portal_?.?vein", "32764006", "Portal vein"),
    ("brain", "12738006", "Brain"),
    ("spinal_?.?cord", "2748008", "Spinal cord"),
    ("skull|cranium", "89546000", "Skull"),
    ("mandible", "91609006", "Mandible"),
    ("vertebra", "51282000", "Vertebra"),
    ("(\\b|_)rib(\\b|_|s)", "113197003", "Rib"),
    ("sternum", "56873002", "Sternum"),
    ("sacrum", "54735007", "Sacrum"),
    ("femur", "71341001", "Femur"),
    ("humerus", "85050009", "Humerus"),
    ("scapula", "79601000", "Scapula"),
    ("clavic", "51299004", "Clavicle"),
    ("hip(\\b|_)", "29836001", "Hip"),
    ("bone", "272673000", "Bone"),
    ("skin", "39937001", "Skin"),
    ("muscle", "71616004", "Muscle"),
)
"""Patterns of names and the SNOMED CT code of what they match; the first match counts."""


def terminology_of_name(name: str) -> Terminology:
    """Returns what a segment of a name usually is; tissue where the name is not known."""
    plain = name.lower()
    found = next((row for row in BY_NAME if re.search(row[0], plain)), None)
    if found is None:
        return Terminology(TISSUE, TISSUE)
    side = next((code for pattern, code in SIDES if re.search(pattern, plain)), None)
    return Terminology(ANATOMY, Code(found[1], SCHEME, found[2]), side=side)
