"""Which files of a series make its volume: each slice once, without the few that cannot be used.

Two files at one place are the same slice where their values are; SOP Instance UIDs do not decide,
since de-identification may give all slices one, and a copy one of its own.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from palpate.base.counted import counted, listed
from palpate.base.errors import VolumeFormatError
from palpate.io.dicom.header import Header, Series
from palpate.io.dicom.pixels import file_values

__all__ = ["left_out", "tolerable", "usable"]

DIGITS = 2
"""After the point, to which places [mm] are the same."""
LEAST_LEFT = 3
"""Slices that have to be left."""
TOLERATED = 10
"""One bad slice in so many is left out, and one in any series."""


def usable(what: str, series: Series) -> tuple[Series, list[str]]:
    """Returns a series with what makes its volume, and what to say about the rest.

    Raises:
        VolumeFormatError: Too many files are unusable, or two lie at one place and differ.
    """
    series, bad = _without_bad(what, series)
    series, doubles = _without_doubles(what, series)
    return series, bad + doubles


def tolerable(bad: int, among: int) -> bool:
    """Says whether so few slices are bad that the others are a scan."""
    return 0 < bad <= max(1, among // TOLERATED) and among - bad >= LEAST_LEFT


def left_out(bad: Sequence[tuple[Header, str]], among: int) -> str:
    """Says which slices are left out, and why."""
    named = listed([f"{header.path.name} ({why})" for header, why in bad])
    some = counted(len(bad), "slices is bad and was", "slices are bad and were", of=among)
    return f"{some} left out: {named}"


# --- bad slices -----------------------------------------------------------------------------

CUT = "shorter than its image"
UNPLACED = "without a position"


def _without_bad(what: str, series: Series) -> tuple[Series, list[str]]:
    bad = _unusable(series.headers)
    single = all(len(header.frames) == 1 for header in series.headers)
    if single and tolerable(len(bad), len(series.headers)):
        chosen = {id(header) for header, _ in bad}
        kept = tuple(header for header in series.headers if id(header) not in chosen)
        return replace(series, headers=kept), [left_out(bad, len(series.headers))]
    short = [header.path.name for header, why in bad if why == CUT]
    if short:
        some = counted(len(short), "file is shorter than its", "files are shorter than their")
        raise VolumeFormatError(
            f"{what} is truncated: {some} image, such as {short[0]}; allowed: complete files"
        )
    return series, []


def _unusable(headers: Sequence[Header]) -> list[tuple[Header, str]]:
    """Lists files that are cut off, or do not lie where nearly all others do."""
    placed = [header for header in headers if _is_placed(header)]
    spacings = Counter(header.frames[0].pixel_spacing for header in placed)
    usual = spacings.most_common(1)[0][0] if spacings else None
    bad = []
    for header in headers:
        spacing = header.frames[0].pixel_spacing
        if header.truncated:
            bad.append((header, CUT))
        elif placed and not _is_placed(header):
            bad.append((header, UNPLACED))
        elif usual is not None and (spacing is None or not np.allclose(spacing, usual, rtol=1e-3)):
            # 1e-3: writers round the same spacing in different ways
            bad.append((header, "other pixel spacing"))
    return bad


def _is_placed(header: Header) -> bool:
    return all(frame.position and frame.orientation for frame in header.frames)


# --- doubles ----------------------------------------------------------------------------------


def _without_doubles(what: str, series: Series) -> tuple[Series, list[str]]:
    kept: dict[object, Header] = {}
    doubles: list[Header] = []
    count = len(series.headers) - len(set(map(_place, series.headers)))
    for header in series.headers:
        first = kept.setdefault(_place(header), header)
        if first is header:
            continue
        if not _is_same(first, header):
            raise VolumeFormatError(
                f"{what} has {count} slices at the place of another (several phases or times?), "
                f"such as {first.path.name} and {header.path.name}, whose pixels differ; allowed: "
                "one slice per place"
            )
        doubles.append(header)
    said = []
    if doubles:
        some = counted(
            len(doubles), "file is a copy of another and was", "files are copies of others and were"
        )
        said.append(f"{some} left out, such as {doubles[0].path.name}")
    uids = Counter(header.instance for header in kept.values() if header.instance)
    shared = sum(count for count in uids.values() if count > 1)
    if shared:
        said.append(f"{shared} different slices share their SOP Instance UIDs with others")
    return replace(series, headers=tuple(kept.values())), said


def _place(header: Header) -> object:
    """Returns what is the same for files of one slice only."""
    positions = [frame.position for frame in header.frames]
    if None not in positions:
        return tuple(
            tuple(round(number, DIGITS) + 0.0 for number in position or ())
            for position in positions
        )
    # without a place only copies of a file are known
    return (header.instance, header.number) if header.instance else header.path


def _is_same(one: Header, other: Header) -> bool:
    try:
        return bool(np.array_equal(file_values(one), file_values(other)))
    except VolumeFormatError:
        return False
