"""A region that grows from seeds with no range of values and no passage given.

It is looked for among cells first (``choice.py``), finer ones where it is small; then its
border is found at the scan's voxels (``border.py``). Where no region ends at an edge of
values it would leak; then a tube is looked for (``tube.py``). Where there is none either,
the click is refused.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import numpy as np
from numpy.typing import NDArray

from palpate.base.errors import OptionError
from palpate.base.progress import Progress
from palpate.base.simpleitk import simpleitk
from palpate.segmentation.growing.basins import basins_of
from palpate.segmentation.growing.border import at_voxels
from palpate.segmentation.growing.cells import Box, Cells, cells_around, connected
from palpate.segmentation.growing.choice import Region, regions, seed_value
from palpate.segmentation.growing.levels import USUAL, Levels, levels_of
from palpate.segmentation.growing.tube import is_tube, tubes
from palpate.segmentation.growing.vote import ALIKE, agreed, best_of
from palpate.segmentation.lengths_in_voxels import most_voxels
from palpate.segmentation.mask_shape import Mask, opened
from palpate.volumes.volume import Volume

__all__ = ["grown_by_choice"]

SIDE = 2.5
"""Of the first cells [mm]."""
REACH = 88
"""How many cells the region may reach from the seeds."""
TUBE_REACH = 180
"""The same of a tube: an aorta that is clicked at its upper end."""
FINER_REACH = 60
"""The same of finer cells: what is looked for in them is small."""
FINER_TUBE_REACH = 100
"""The same of a tube."""
FEW = 600
"""Regions of fewer cells are looked for again, in finer ones."""
LEAST_DEPTH = 3
"""Tubes less deep are looked for again, in finer ones [cells]."""
FINER = 0.5
"""Side of the next finer cells."""
FINEST = 0.75
"""Side of the finest cells, by that of a voxel."""
LEAST_FINER = 0.9
"""Cells that are less finer than this, by their side, are not looked at."""
NECK = 0.6
"""Depth in a neck by that of the less deep side, below which it is one."""
LEAST_SIDE = 0.7
"""Share of the region that the seed's side of its necks has."""
GOOD = 0.93
"""Score by the best one of a region that is nearly as good."""
LEAST_SHARE = 0.5
"""Of all regions, so weighted, that are like the chosen one."""
UNANIMOUS = 0.95
"""Share of votes from which edges within, such as that of a core, are less of a doubt."""
LEAST_AGREED_EDGE = 0.6
"""Share of a border at an edge, of a region that is unanimous."""
SLIGHTLY = 21
"""Levels that are a slightly narrower range: by 16 %."""
LEAST_HELD = 0.5
"""Share of a region that such a range holds."""
AT_SEED = 2
"""How far from the seed it may be deeper [cells]."""
THIN = 0.3
"""Depth around the seed by that of the region, below which the seed may lie in another body."""
MOST_RAGGED = 1.05
"""The most that a body is; see ``Region.ragged``."""
MOST_OFF = 3.0
"""How far the seed's value may be from most of the region's, in standard deviations of those."""
LEAST_DEVIATION = 0.05
"""Standard deviation that counts at least, by half of the range: bodies without noise have none."""
MANY = 20_000
"""Of larger regions every second cell is enough to see necks."""
LEAST_EDGE = 0.8
"""Share of a region's border at an edge of values, below which it would leak."""


def grown_by_choice(
    volume: Volume,
    places: list[NDArray[np.int64]],
    *,
    most_ml: float,
    fill: bool,
    progress: Progress,
) -> Levels:
    """Returns the best region at seeds [z, y, x], with narrower and wider ones.

    Raises:
        OptionError: Every region would leak, or none is small enough.
    """
    cells, found, why = _body(volume, places, most_ml=most_ml, progress=progress)
    if found is not None and why is None:
        progress("finding the border", None)
        box, mask = at_voxels(volume, cells, found, seeds=places, fill=fill)
        levels = _levels(volume, (cells, found), (box, mask), seeds=places, most_ml=most_ml)
        if not (_is_narrowly_held(levels) and _is_thin_at(found, cells.seeds[0])):
            return levels
        why = _would_leak("a slightly narrower range of values holds little of it")
    cells, tube = _tube(volume, places, cells, most_ml=most_ml, progress=progress)
    if tube is None:
        raise OptionError(why)
    progress("finding the border", None)
    box, mask = at_voxels(volume, cells, tube, seeds=places, fill=fill, within_range=True)
    starts = [tuple(int(c) for c in place - [side.start for side in box]) for place in places]
    mask = _without_films(mask, starts, spacing=volume.spacing, radius=cells.side)
    return _levels(volume, (cells, tube), (box, mask), seeds=places, most_ml=most_ml)


def _levels(
    volume: Volume,
    chosen: tuple[Cells, Region],
    found: tuple[Box, Mask],
    *,
    seeds: list[NDArray[np.int64]],
    most_ml: float,
) -> Levels:
    """Returns the levels of narrower and wider ranges around a region that was found as voxels."""
    edges = np.array(volume.spacing[::-1])
    most = most_voxels(most_ml, volume.voxel_volume)
    return levels_of(*chosen, found, seeds=seeds, edges=edges, most=most)


def _is_narrowly_held(levels: Levels) -> bool:
    """Returns whether a slightly narrower range reaches little of a region."""
    narrower = levels.mask(USUAL - SLIGHTLY)
    held = np.count_nonzero(narrower) / np.count_nonzero(levels.mask(USUAL))
    return bool(held < LEAST_HELD)


def _is_thin_at(region: Region, seed: tuple[int, ...]) -> bool:
    """Returns whether a region is much less deep around a seed than elsewhere."""
    sitk = simpleitk()
    image = sitk.GetImageFromArray(np.pad(region.mask, 1).view(np.uint8))
    depth = sitk.GetArrayFromImage(
        sitk.SignedMaurerDistanceMap(image, insideIsPositive=True, squaredDistance=False)
    )
    place = [c - side.start + 1 for c, side in zip(seed, region.box, strict=True)]
    near = depth[tuple(slice(max(0, c - AT_SEED), c + AT_SEED + 1) for c in place)]
    return bool(near.max() < THIN * depth.max())


def _would_leak(why: str) -> str:
    return (
        f"the region would leak: {why}; allowed: another place, or a spread and a passage "
        "that suit it"
    )


def _body(
    volume: Volume, places: list[NDArray[np.int64]], *, most_ml: float, progress: Progress
) -> tuple[Cells, Region | None, str | None]:
    """Returns cells, the best region among them, and why it would leak, if it would."""
    side = SIDE
    while True:
        told = partial(progress, "reading values")
        reach = side * (REACH if side == SIDE else FINER_REACH)
        cells = cells_around(volume, places, side=side, reach=reach, told=told)
        told = partial(progress, "trying ranges of values and passages")
        found = regions(cells, most=_most(most_ml, side), told=told)
        chosen = best_of(found)
        finer = _finer(side, volume)
        if finer is None or (chosen is not None and chosen[0].count >= FEW):
            break
        side = finer
    if chosen is None:
        why = (
            f"the region becomes larger than {most_ml:g} ml; allowed: another place, a smaller "
            "spread, wider passages that are not entered, or a larger volume"
        )
        return cells, None, why
    return cells, chosen[0], _leak(*chosen, found=found, cells=cells)


def _leak(best: Region, share: float, *, found: list[Region], cells: Cells) -> str | None:
    """Returns why a region would leak, if it would."""
    if best.edge < (LEAST_EDGE if share < UNANIMOUS else LEAST_AGREED_EDGE):
        why = "no edge of values holds it"
    elif share < LEAST_SHARE or _goes_on(best, found):
        why = "nearly the same range of values gives a region of another size"
    elif _has_neck(best, cells.seeds[0]):
        why = "it goes on through a neck"
    elif best.ragged > MOST_RAGGED:
        why = "its border is ragged"
    elif _is_off(cells, best):
        why = "most of it has other values than the point"
    else:
        return None
    return _would_leak(why)


def _tube(
    volume: Volume,
    places: list[NDArray[np.int64]],
    before: Cells,
    *,
    most_ml: float,
    progress: Progress,
) -> tuple[Cells, Region | None]:
    """Returns cells, and the tube that most ranges and necks agree on, if they do.

    Cells that were made before are not made again where they are those of the whole scan.
    """
    side = SIDE
    told = partial(progress, "looking for a tube")
    while True:
        cells = before
        if before.side != side or before.cut_off(_all_of(before), volume.shape):
            reach = side * (TUBE_REACH if side == SIDE else FINER_TUBE_REACH)
            cells = cells_around(volume, places, side=side, reach=reach, told=told)
        found = tubes(cells, most=_most(most_ml, side), told=told)
        chosen = best_of(found)
        finer = _finer(side, volume)
        thin = chosen is not None and is_tube(chosen[0]) and chosen[0].depth < LEAST_DEPTH
        if finer is None or not thin:
            break
        side = finer
    if chosen is None:
        return cells, None
    best, share = chosen
    good = (
        share >= LEAST_SHARE
        and best.edge >= LEAST_EDGE
        and is_tube(best)
        and not cells.cut_off(best.box, volume.shape)
    )
    return cells, agreed(cells, best, found) if good else None


def _without_films(
    region: Mask, starts: list[tuple[int, ...]], *, spacing: Sequence[float], radius: float
) -> Mask:
    """Returns what hangs together with the seeds where a ball fits, such as no rim of a vein."""
    thick = opened(region, spacing, radius)
    return connected(thick, starts) if all(thick[start] for start in starts) else region


def _finer(side: float, volume: Volume) -> float | None:
    """Returns the side of the next finer cells; None where these are no finer to speak of."""
    finer = max(FINER * side, FINEST * min(volume.spacing))
    return finer if finer < LEAST_FINER * side else None


def _most(most_ml: float, side: float) -> int:
    """Returns how many cells a region may have."""
    return int(most_ml * 1000.0 / side**3) + 1


def _all_of(cells: Cells) -> Box:
    first, second, third = (slice(0, length) for length in cells.values.shape)
    return first, second, third


def _is_off(cells: Cells, region: Region) -> bool:
    """Returns whether the seed's value is not one of those that a region mostly has."""
    values = cells.values[region.box][region.mask]
    middle = float(np.median(values))
    deviation = 1.4826 * float(np.median(np.abs(values - middle)))
    least = LEAST_DEVIATION * region.half
    return abs(seed_value(cells) - middle) > MOST_OFF * max(deviation, least)


def _goes_on(best: Region, found: list[Region]) -> bool:
    """Returns whether a region as good goes on where this one ends in a passage half as wide."""
    wider = [
        other
        for other in found
        if (other.half, other.open_above) == (best.half, best.open_above)
        and other.steps < best.steps
    ]
    return (
        bool(wider)
        and 2 * best.steps >= best.depth
        and wider[-1].count > ALIKE * best.count
        and wider[-1].score > GOOD * best.score
    )


def _has_neck(region: Region, seed: tuple[int, ...]) -> bool:
    """Returns whether the seed's side of a neck is much less than the region.

    Sides are the basins of a watershed of depths (Beucher and Meyer 1993), that are one where the
    depth between them is nearly that of the less deep one.
    """
    sitk = simpleitk()
    every = 1 if region.count < MANY else 2
    begin = [place - side.start for place, side in zip(seed, region.box, strict=True)]
    mask = np.pad(region.mask[tuple(slice(place % every, None, every) for place in begin)], 1)
    image = sitk.GetImageFromArray(mask.view(np.uint8))
    depth = sitk.GetArrayFromImage(
        sitk.SignedMaurerDistanceMap(image, True, False, False)  # noqa: FBT003
    )
    depths = np.maximum(depth + np.float32(0.5), np.float32(1.0))
    basins = basins_of(depths, mask, same=NECK).numbers
    own = (basins == basins[tuple(place // every + 1 for place in begin)]) & mask
    return bool(np.count_nonzero(own) < LEAST_SIDE * np.count_nonzero(mask))
