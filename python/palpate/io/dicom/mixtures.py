"""Series that hold slices of several scans: parted by modality and frame of reference.

A series has one of each (DICOM PS3.3, C.7.3.1.1.1 and C.7.4.1), but files are sent and renamed by
many hands.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from palpate.io.dicom.phases import parted

if TYPE_CHECKING:
    from palpate.io.dicom.header import Header, Series

__all__ = ["mixture_told", "scans_of"]

LEAST = 3
"""Slices of one kind that are a scan of their own."""


def scans_of(series: Series) -> list[Series]:
    """Returns the scans of a series by modality and frame of reference: itself, where it is one."""
    kinds: dict[tuple[str, str], list[Header]] = {}
    # slices without a frame of reference may be in that of any other
    all_told = all(header.frame for header in series.headers)
    for header in series.headers:
        kinds.setdefault((header.modality, header.frame if all_told else ""), []).append(header)
    counts = [sum(len(header.frames) for header in some) for some in kinds.values()]
    # badly de-identified slices may have a frame of reference each
    if len(kinds) == 1 or min(counts) < LEAST:
        return [series]
    return [
        parted(
            replace(series, modality=some[0].modality),
            _words(list(kinds), number),
            [(header, index) for header in some for index in range(len(header.frames))],
        )
        for number, some in enumerate(kinds.values())
    ]


def _words(kinds: list[tuple[str, str]], number: int) -> str:
    """Says what tells one kind from the others."""
    modality = kinds[number][0]
    alike = [index for index, kind in enumerate(kinds) if kind[0] == modality]
    words = [modality or "unknown modality"] if len(alike) < len(kinds) else []
    if len(alike) > 1:
        words.append(f"frame of reference {alike.index(number) + 1}")
    return ", ".join(words)


def mixture_told(series: Series) -> tuple[str, ...]:
    """Says of what kinds the slices of a scan are that were not parted."""
    kinds = {
        "modalities": {header.modality for header in series.headers},
        "frames of reference": {header.frame for header in series.headers} - {""},
    }
    return tuple(
        f"slices tell {len(found)} different {name}: taken as one scan"
        for name, found in kinds.items()
        if len(found) > 1
    )
