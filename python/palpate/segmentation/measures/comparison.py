"""How well segments agree with those of a reference: Dice and distances of their borders."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from palpate.base.errors import OptionError
from palpate.labels.grid import Labels
from palpate.segmentation.measures.surface_distances import surface_distances
from palpate.volumes.scene import Scene, choose_segment, require_scene
from palpate.volumes.segment import Segment

__all__ = ["Comparison", "SegmentComparison", "compare"]

FURTHEST = 95.0
"""Share of the distances that is counted [%]; the rest may be few voxels that stick out."""


@dataclass(frozen=True, kw_only=True)
class SegmentComparison:
    """A segment beside one of the reference; what cannot be said is None."""

    name: str
    reference: str
    """Name in the reference; "" where it has none for this segment."""
    volume: float
    """Volume of the segment [mm³]."""
    reference_volume: float | None
    """Volume of that of the reference [mm³]."""
    dice: float | None
    """Twice the shared volume by the sum of both, 0 to 1; None where both are empty."""
    hausdorff_95: float | None
    """95th percentile of distances between borders, the larger one of both ways [mm]."""
    mean_surface_distance: float | None
    """Mean of distances between borders, of both ways together [mm]."""
    note: str
    """Why numbers are missing; "" where all are there."""


@dataclass(frozen=True)
class Comparison:
    """All segments of a scan beside those of a reference."""

    segments: tuple[SegmentComparison, ...]
    warnings: tuple[str, ...] = ()
    """Sentences on what was left out."""


def compare(
    scene: Scene, reference: Labels, *, segment: str | None = None, against: str | None = None
) -> Comparison:
    """Compares segments with those of a reference that have the same names.

    Where both have a single one, these are compared whatever they are called. What is compared must
    lie on one grid: ``palpate.read_labels`` lays a file on that of the scan, or refuses it.

    Args:
        scene: The scan and its segments.
        reference: Segments of a file, read for this scan.
        segment: Name or number of the segment to compare; by default all.
        against: Name or number of its counterpart in the reference.

    Raises:
        OptionError: There is nothing to compare, or the reference lies on another grid.
    """
    require_scene(scene)
    truth = Scene(scene.volume)
    for label in reference.labels:
        if label.segment.has_own_grid:
            raise OptionError(
                f"reference {label.segment.name!r} has a grid of its own; allowed: one that "
                "`palpate.read_labels` has read for this scan"
            )
        truth.add(label.segment)
    pairs, alone = _pairs(scene, truth, segment=segment, against=against)
    made = tuple(_compared(name, one, other) for name, one, other in pairs)
    warnings = list(reference.warnings)
    if alone:
        warnings.append(f"only in the reference, not compared: {', '.join(alone)}")
    warnings += [f"{one.name}: {one.note}" for one in made if one.note]
    return Comparison(made, tuple(warnings))


Pair = tuple[str, Segment, Segment | None]


def _pairs(
    scene: Scene, truth: Scene, *, segment: str | None, against: str | None
) -> tuple[list[Pair], list[str]]:
    """Returns what is compared, and names of the reference that are left."""
    if not len(scene):
        raise OptionError("no segments given; allowed: one or more to compare")
    if not len(truth):
        nothing = scene.volume.segment(np.zeros(scene.volume.shape, np.uint8), name="")
        every = [each.segment for each in scene]
        chosen = every if segment is None else [choose_segment(scene, segment)]
        return [(each.name, each, nothing) for each in chosen], []
    if segment is not None or against is not None:
        one = choose_segment(scene, segment)
        return [(one.name, one, _counterpart(truth, one.name, against=against))], []
    shown, known = list(scene), list(truth)
    if len(shown) == 1 and len(known) == 1:
        return [(shown[0].name, shown[0].segment, known[0].segment)], []
    names = [each.name for each in known]
    _refuse_twice([each.name for each in shown], "segments")
    _refuse_twice(names, "segments of the reference")
    by_name = {each.name: each.segment for each in known}
    if not any(each.name in by_name for each in shown):
        raise OptionError(
            f"segments {', '.join(each.name for each in shown)} and reference {', '.join(names)} "
            "given; allowed: names that both have, or `segment=NAME` with `against=NAME`"
        )
    pairs = [(each.name, each.segment, by_name.get(each.name)) for each in shown]
    seen = {each.name for each in shown}
    return pairs, [name for name in names if name not in seen]


def _counterpart(truth: Scene, name: str, *, against: str | None) -> Segment:
    """Returns a segment of the reference.

    Raises:
        OptionError: It has none of this name.
    """
    try:
        return choose_segment(truth, against or (None if len(truth) == 1 else name))
    except OptionError as error:
        raise OptionError(f"reference: {error}") from None


def _refuse_twice(names: Sequence[str], what: str) -> None:
    for name in names:
        if names.count(name) > 1:
            raise OptionError(
                f"{names.count(name)} {what} are called {name!r}; allowed: a name for each, or "
                "`segment=NUMBER` with `against=NUMBER`"
            )


def _compared(name: str, one: Segment, other: Segment | None) -> SegmentComparison:
    dice = furthest = mean = known = None
    note = "own grid: not compared" if one.has_own_grid else "not in the reference, or empty there"
    if other is not None and not one.has_own_grid:
        counts = one.voxel_count, other.voxel_count
        masks = one.mask().view(np.bool_), other.mask().view(np.bool_)
        if any(counts):
            dice = 2.0 * int(np.count_nonzero(masks[0] & masks[1])) / sum(counts)
        if all(counts):
            ways = surface_distances(*masks, one.volume.spacing)
            furthest = max(float(np.percentile(way, FURTHEST)) for way in ways)
            mean = float(sum(way.sum() for way in ways) / sum(map(len, ways)))
        known, note = counts[1] * other.volume.voxel_volume, _note(*counts)
    return SegmentComparison(
        name=name,
        reference="" if other is None else other.name,
        volume=one.voxel_count * one.volume.voxel_volume,
        reference_volume=known,
        dice=dice,
        hausdorff_95=furthest,
        mean_surface_distance=mean,
        note=note,
    )


def _note(voxels: int, of_reference: int) -> str:
    if voxels and of_reference:
        return ""
    if of_reference:
        return "the segment is empty: no distances"
    return "the reference is empty: no distances" if voxels else "both are empty"
