"""What a DICOMweb service answers to a search: lists of datasets in DICOM's JSON.

Nothing of it is taken at its word: a UID is one by its form, a number is one by its digits.

Source: DICOM PS3.18, annex F (the JSON model), 10.6.3 (answers to a search).
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

from palpate.io.dicomweb.address import UID

__all__ = ["Found", "bytes_of", "list_of", "text_of", "uid_of", "whole_of"]

TAGS = {
    "StudyInstanceUID": "0020000D",
    "SeriesInstanceUID": "0020000E",
    "SOPInstanceUID": "00080018",
    "PatientName": "00100010",
    "PatientID": "00100020",
    "StudyDate": "00080020",
    "StudyDescription": "00081030",
    "SeriesDescription": "0008103E",
    "SeriesNumber": "00200011",
    "Modality": "00080060",
    "NumberOfSeriesRelatedInstances": "00201209",
    "Rows": "00280010",
    "Columns": "00280011",
    "BitsAllocated": "00280100",
    "SamplesPerPixel": "00280002",
    "NumberOfFrames": "00280008",
}
"""Elements that are asked for, by their keywords."""

Found = Mapping[str, Any]
"""A dataset in DICOM's JSON."""


def list_of(answer: object) -> list[Found]:
    """Returns an answer as the list that it has to be.

    Raises:
        ValueError: It is none.
    """
    if not isinstance(answer, list) or not all(isinstance(each, dict) for each in answer):
        raise ValueError("no list of datasets")
    return answer


def text_of(found: Found, name: str) -> str:
    """Returns the first value of an element as text; "" where there is none."""
    element = found.get(TAGS[name]) or {}
    value = (element.get("Value") or [""])[0]
    if isinstance(value, dict):
        # a person's name
        value = value.get("Alphabetic") or value.get("Ideographic") or ""
    return "" if value is None else str(value).strip()


def whole_of(found: Found, name: str) -> int | None:
    """Returns the first value of an element as a whole number; None where it is none."""
    text = text_of(found, name)
    return int(text) if re.fullmatch(r"[0-9]{1,9}", text) else None


def uid_of(text: str) -> str:
    """Returns a text that is a UID.

    Raises:
        ValueError: It is none.
    """
    if not re.fullmatch(UID, text):
        raise ValueError("no UID")
    return text


def bytes_of(found: Found) -> int | None:
    """Returns the size of a file's pixels before compression; None where it is not told."""
    rows, columns = whole_of(found, "Rows"), whole_of(found, "Columns")
    if not rows or not columns:
        return None
    samples = whole_of(found, "SamplesPerPixel") or 1
    frames = whole_of(found, "NumberOfFrames") or 1
    return rows * columns * samples * frames * (whole_of(found, "BitsAllocated") or 16) // 8
