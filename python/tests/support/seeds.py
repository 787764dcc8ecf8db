"""Marked strings in all of a DICOM file, and the ways in which another file may hold them."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Callable
from pathlib import Path

import numpy as np
from palpate.export.deidentify import TECHNICAL
from pydicom.datadict import DicomDictionary  # type: ignore[attr-defined]
from pydicom.dataset import Dataset, FileDataset
from pydicom.tag import Tag

READ = (
    "PatientSex", "SpecificCharacterSet", "Modality", "PhotometricInterpretation", "SOPClassUID",
    "SOPInstanceUID", "SeriesInstanceUID", "BurnedInAnnotation", "PixelPresentation", "RescaleType",
    "LossyImageCompression", "TransferSyntaxUID", "VolumetricProperties", "PresentationLUTShape",
)  # fmt: skip
"""What is needed to read the scan: no seeds there."""
TEXTS = ("AE", "CS", "LO", "LT", "PN", "SH", "ST", "UC", "UR", "UT")
NAME = "Álvarez-Ñusta^Li Bo=山田^太郎"
ENCODINGS = ("utf-8", "latin-1", "utf-16-le", "utf-16-be", "iso2022_jp", "gb18030", "euc_kr")


def seed_of(tag: int) -> str:
    return f"SEED{tag:08X}"


def fill(dataset: Dataset, seeds: set[str], *, depth: int) -> None:
    """Puts a seed into each text, UID, day and sequence that the dictionary knows."""
    for number, (kind, _, _, retired, keyword) in DicomDictionary.items():
        tag = Tag(number)
        if not keyword or keyword in READ or tag.group in (0x0000, 0x0002, 0xFFFE, 0x7FE0):
            continue
        if (
            retired
            or "FunctionalGroup" in keyword
            or "CenterPoint" in keyword
            or tag.group in (0x0004, 0x0028)
            or tag in dataset
        ):
            continue
        seed, value = _seeded(number, kind, keyword)
        if kind == "SQ" and depth and tag.group in (0x0008, 0x0010, 0x0018, 0x0040, 0x3006):
            item = Dataset()
            _some(item, seed)
            if keyword == "RequestAttributesSequence":
                fill(item, seeds, depth=depth - 1)
            value = [item]
        if value is not None:
            dataset.add_new(number, kind, value)
            seeds.add(seed)


def _seeded(number: int, kind: str, keyword: str) -> tuple[str, object]:
    """Returns what is looked for, and the value that it stands in."""
    seed = seed_of(number)
    if kind in TEXTS:
        # what tells of methods is kept, without what names somebody
        return seed, f"ALVAREZ {number % 997}" if keyword in TECHNICAL else seed
    if kind in {"OB", "UN"}:
        return seed, seed.encode()
    if kind in {"DA", "DT"}:
        return "19730623", "19730623"
    uid = f"1.2.826.77.{number}"
    return (uid, uid) if kind == "UI" else (seed, None)


def _some(item: Dataset, seed: str) -> None:
    item.PatientComments = item.CodeMeaning = seed
    item.CodingSchemeDesignator = "99SEED"
    item.ReferringPhysicianName = f"{seed}^{seed}"
    item.private_block(0x0011, seed, create=True).add_new(1, "LT", seed)


def spellings(seed: str) -> set[bytes]:
    """Returns the bytes that a string may be in a file."""
    plain = set()
    for encoding in ENCODINGS:
        try:
            plain.add(seed.encode(encoding))
        except UnicodeEncodeError:
            continue
    inner = seed.encode()
    # in base64 a string has three forms, by where it begins; their ends depend on what is beside
    coded = {b64encode(b"\0" * pad + inner)[4 if pad else 0 : -4] for pad in range(3)}
    return {each for each in plain | coded if len(each) >= 6}


def seeded_series(write_series: Callable[..., Path], seeds: set[str]) -> Path:
    """Writes a scan of two slices with seeds, and adds them to ``seeds``; returns its folder."""

    def each(number: int, dataset: FileDataset) -> None:
        dataset.SpecificCharacterSet = "ISO_IR 192"
        dataset.PatientName = NAME
        dataset.OtherPatientNames = ["Müller^Jürgen"]
        dataset.PatientID = "MRN/778899-X"
        dataset.StudyDate = "20041008"
        dataset.ImageType = ["ORIGINAL", "PRIMARY", "AXIAL", "SEEDTYPE"]
        dataset.FrameOfReferenceUID, dataset.StudyInstanceUID = "1.2.826.5", "1.2.826.6"
        dataset.InstanceNumber = number
        dataset.BitsStored, dataset.HighBit = 12, 11
        values = np.frombuffer(dataset.PixelData, "<u2") | np.uint16(0xA000)
        dataset.PixelData = values.tobytes() + b"SEEDPIXEL!"
        dataset.private_block(0x0009, "SEEDPRIVATE", create=True).add_new(1, "LO", "SEEDPRIVATE")
        fill(dataset, seeds, depth=2)
        dataset.file_meta.SourceApplicationEntityTitle = "SEEDMETA"
        dataset.file_meta.ImplementationVersionName = "SEEDMETA"
        dataset.preamble = b"SEEDMETA" * 16

    seeds |= {"SEEDTYPE", "SEEDPIXEL", "SEEDPRIVATE", "SEEDMETA"}
    return write_series("seeded", each=each, positions=[(0.0, 0.0, 2.0 * k) for k in range(2)])
