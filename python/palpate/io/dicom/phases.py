"""Several volumes in one series, such as times and echoes: each becomes a series of its own.

Slices at one place are told apart by the first element, or the first two, whose values part them
into stacks without doubles. Where none does the series stays whole, and reading refuses it.

Source: DICOM PS3.3, C.7.6.16.2.2 (frame content), C.8.3.1 and C.8.13 (MR images).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pydicom.dataset import Dataset

    from palpate.io.dicom.header import Header, Series

__all__ = ["parted", "phase_of", "phases_of"]

DIGITS = 2
"""After the point, to which places [mm] are the same."""
MOST_ELEMENTS = 2
"""That part a series together, such as times and echoes."""


@dataclass(frozen=True)
class Element:
    """What may tell volumes apart: by its name in files of one slice, or per frame in a group."""

    words: str
    """With the value in the place of {}."""
    keyword: str
    group: str
    in_group: str
    """Through sequences within the group, with dots between."""


ELEMENTS = (
    Element(
        "time {}", "TemporalPositionIdentifier", "FrameContentSequence", "TemporalPositionIndex"
    ),
    Element("echo of {} ms", "EchoTime", "MREchoSequence", "EffectiveEchoTime"),
    Element("echo {}", "EchoNumbers", "", ""),
    Element("b = {} s/mm²", "DiffusionBValue", "MRDiffusionSequence", "DiffusionBValue"),
    Element(
        "direction {}",
        "DiffusionGradientOrientation",
        "MRDiffusionSequence",
        "DiffusionGradientDirectionSequence.DiffusionGradientOrientation",
    ),
    Element(
        "{} % of the cycle",
        "NominalPercentageOfCardiacPhase",
        "CardiacSynchronizationSequence",
        "NominalPercentageOfCardiacPhase",
    ),
    Element(
        "{} ms after the trigger",
        "TriggerTime",
        "CardiacSynchronizationSequence",
        "NominalCardiacTriggerDelayTime",
    ),
    Element("inversion time {} ms", "InversionTime", "MRModifierSequence", "InversionTimes"),
    Element("{}", "ImageType", "MRImageFrameTypeSequence", "FrameType"),
    Element(
        "acquisition {}", "AcquisitionNumber", "FrameContentSequence", "FrameAcquisitionNumber"
    ),
    Element("phase {}", "PhaseVector", "", ""),
    Element("time slot {}", "TimeSlotVector", "", ""),
    Element("R-R interval {}", "RRIntervalVector", "", ""),
    Element("energy window {}", "EnergyWindowVector", "", ""),
    Element("at {}", "AcquisitionTime", "", ""),
)
RANKED = {"TriggerTime": "phase {} of {} after the trigger", "AcquisitionTime": "time {} of {}"}
"""Elements whose order at each place parts a series, where their values differ from place to place:
other heartbeats, other breath-holds."""
OF_TIME = (*RANKED, "TemporalPositionIdentifier", "NominalPercentageOfCardiacPhase")
"""Elements that say no more than when a slice was taken."""


def phase_of(dataset: Dataset, groups: Sequence[Dataset], index: int) -> tuple[str, ...]:
    """Returns what a frame says for each of the elements; "" where it says nothing.

    Args:
        dataset: Of the whole file.
        groups: The frame's own functional groups and the shared ones.
        index: Which frame of the file it is.
    """
    return tuple(_value(dataset, groups, index, element=element) for element in ELEMENTS)


def _value(dataset: Dataset, groups: Sequence[Dataset], index: int, *, element: Element) -> str:
    for group in groups:
        if element.group and group.get(element.group):
            return _told(_within(group[element.group][0], element.in_group))
    value = dataset.get(element.keyword)
    if element.keyword.endswith("Vector") and isinstance(value, Sequence):
        # of nuclear medicine: one number for each frame
        value = value[index] if index < len(value) else None
    return _told(value)


def _within(group: Dataset, way: str) -> object:
    *sequences, keyword = way.split(".")
    for name in sequences:
        if not group.get(name):
            return None
        group = group[name][0]
    return group.get(keyword)


def _told(value: object) -> str:
    if value is None:
        return ""
    if isinstance(value, float):
        return f"{value:g}"
    if isinstance(value, str | bytes) or not isinstance(value, Sequence):
        return str(value)
    return " ".join(map(_told, value))


def phases_of(series: Series) -> list[Series]:
    """Returns the volumes that a series holds: itself, where it holds one, or cannot be parted."""
    slices = [(header, index) for header in series.headers for index in range(len(header.frames))]
    if not _has_doubles(slices):
        return [series]
    for chosen in _choices():
        parts: dict[tuple[str, ...], list[tuple[Header, int]]] = {}
        for header, index in slices:
            phase = header.frames[index].phase
            parts.setdefault(tuple(phase[i] for i in chosen), []).append((header, index))
        if len(parts) > 1 and all(len(p) > 1 and not _has_doubles(p) for p in parts.values()):
            return [
                parted(series, _words(chosen, values), parts[values]) for values in _sorted(parts)
            ]
    return _ranked(series, slices) or [series]


def _ranked(series: Series, slices: Sequence[tuple[Header, int]]) -> list[Series]:
    """Returns the phases of a series by the order of times at each place; none where it has none.

    Nothing but times may differ, so that what comes first is the first phase.
    """
    phases = [header.frames[index].phase for header, index in slices]
    keywords = [element.keyword for element in ELEMENTS]
    kept = [at for at, keyword in enumerate(keywords) if keyword not in OF_TIME]
    if len({tuple(phase[at] for at in kept) for phase in phases}) > 1:
        return []
    places: dict[tuple[float, ...], list[int]] = {}
    for number, (header, index) in enumerate(slices):
        places.setdefault(_place(header.frames[index].position or ()), []).append(number)
    counts = {len(numbers) for numbers in places.values()}
    if len(counts) != 1 or len(places) == 1:
        return []
    count = counts.pop()
    for keyword, words in RANKED.items():
        times = [phase[keywords.index(keyword)] for phase in phases]
        if any(len({times[number] for number in here} - {""}) < count for here in places.values()):
            continue
        ordered = [
            sorted(here, key=lambda number: _number(times[number])) for here in places.values()
        ]
        return [
            parted(series, words.format(rank + 1, count), [slices[here[rank]] for here in ordered])
            for rank in range(count)
        ]
    return []


def _place(position: Sequence[float]) -> tuple[float, ...]:
    return tuple(round(number, DIGITS) + 0.0 for number in position)


def _choices() -> Iterator[tuple[int, ...]]:
    for count in range(1, MOST_ELEMENTS + 1):
        yield from combinations(range(len(ELEMENTS)), count)


def _has_doubles(slices: Sequence[tuple[Header, int]]) -> bool:
    """Says whether two slices are at one place; copies of a file count once."""
    places: dict[tuple[float, ...], tuple[object, ...]] = {}
    for header, index in slices:
        position = header.frames[index].position
        if position is None:
            return False
        place = _place(position)
        # all slices may have one UID, where it was badly taken away
        which = (header.instance or header.path, header.number, index, header.frames[index].phase)
        if places.setdefault(place, which) != which:
            return True
    return False


def _sorted(parts: dict[tuple[str, ...], list[tuple[Header, int]]]) -> list[tuple[str, ...]]:
    def order(values: tuple[str, ...]) -> list[tuple[float, str]]:
        return [(_number(value), value) for value in values]

    return sorted(parts, key=order)


def _number(value: str) -> float:
    try:
        return float(value)
    except ValueError:
        return 0.0


def _words(chosen: tuple[int, ...], values: tuple[str, ...]) -> str:
    pairs = zip(chosen, values, strict=True)
    # such as the one without a direction
    return ", ".join(ELEMENTS[i].words.format(value) for i, value in pairs if value) or "others"


def parted(series: Series, words: str, slices: Sequence[tuple[Header, int]]) -> Series:
    """Returns some slices of a series as one of its own, named by words."""
    of_files: dict[int, tuple[Header, list[int]]] = {}
    for header, index in slices:
        of_files.setdefault(id(header), (header, []))[1].append(index)
    headers = tuple(_frames_of(header, indices) for header, indices in of_files.values())
    part = f"{series.part}, {words}".removeprefix(", ")
    description = f"{series.whole}, {part}".removeprefix(", ")
    return replace(series, description=description, headers=headers, part=part)


def _frames_of(header: Header, indices: list[int]) -> Header:
    if len(indices) == len(header.frames):
        return header
    frames = tuple(header.frames[index] for index in indices)
    before = header.taken or range(len(header.frames))
    return replace(header, frames=frames, taken=tuple(before[index] for index in indices))
