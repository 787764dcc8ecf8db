"""A region that grows from seeds with no range of values and no passage given.

It is looked for among cells first (``growing_choice.py``), finer ones where it is small; then its
border is found at the scan's voxels (``growing_border.py``). Where no region ends at an edge of
values it would leak; then a tube is looked for (``growing_tube.py``). Where there is none either,
the click is refused.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from palpate.base.errors import OptionError
from palpate.base.progress import Progress
from palpate.base.simpleitk import simpleitk
from palpate.segmentation.growing_basins import basins_of
from palpate.segmentation.growing_border import at_voxels
from palpate.segmentation.growing_cells import Box, Cells, cells_around, connected
from palpate.segmentation.growing_choice import Region, regions
from palpate.segmentation.growing_levels import Levels, levels_of
from palpate.segmentation.growing_tube import is_tube, tubes
from palpate.segmentation.growing_vote import ALIKE, agreed, best_of
from palpate.segmentation.lengths_in_voxels import most_voxels
from palpate.segmentation.mask_shape import Mask, opened
from palpate.volumes.volume import Volume

__all__ = ["Chosen", "grown_by_choice"]

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
MANY = 20_000
"""Of larger regions every second cell is enough to see necks."""
LEAST_EDGE = 0.8
"""Share of a region's border at an edge of values, below which it would leak."""


@dataclass(frozen=True)
class Chosen:
    """A region of cells, and the same at the voxels in a box of the scan."""

    cells: Cells
    region: Region
    box: Box
    mask: Mask

    def levels(self, volume: Volume, seed: NDArray[np.int64], *, most_ml: float) -> Levels:
        """Returns the levels of narrower and wider ranges, which hold a seed [z, y, x]."""
        return levels_of(
            self.cells,
            self.region,
            (self.box, self.mask),
            seed=seed,
            edges=np.array(volume.spacing[::-1]),
            most=most_voxels(most_ml, volume.voxel_volume),
        )


def grown_by_choice(
    volume: Volume,
    places: list[NDArray[np.int64]],
    *,
    most_ml: float,
    fill: bool,
    progress: Progress,
) -> Chosen:
    """Returns the best region at seeds [z, y, x].

    Raises:
        OptionError: Every region would leak, or none is small enough.
    """
    cells, found, why = _body(volume, places, most_ml=most_ml, progress=progress)
    if why is not None:
        cells, found = _tube(volume, places, cells, most_ml=most_ml, progress=progress)
    if found is None:
        raise OptionError(why)
    progress("finding the border", None)
    is_tube = why is not None
    box, mask = at_voxels(volume, cells, found, seeds=places, fill=fill, within_range=is_tube)
    if is_tube:
        starts = [tuple(int(c) for c in place - [side.start for side in box]) for place in places]
        mask = _without_films(mask, starts, spacing=volume.spacing, radius=cells.side)
    return Chosen(cells, found, box, mask)


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
        finest = side <= FINEST * min(volume.spacing)
        if finest or (chosen is not None and chosen[0].count >= FEW):
            break
        side = max(FINER * side, FINEST * min(volume.spacing))
    if chosen is None:
        why = (
            f"the region becomes larger than {most_ml:g} ml; allowed: another place, a smaller "
            "spread, wider passages that are not entered, or a larger volume"
        )
        return cells, None, why
    return cells, chosen[0], _leak(*chosen, found=found, seed=cells.seeds[0])


def _leak(best: Region, share: float, *, found: list[Region], seed: tuple[int, ...]) -> str | None:
    """Returns why a region would leak, if it would."""
    if best.edge < (LEAST_EDGE if share < UNANIMOUS else LEAST_AGREED_EDGE):
        why = "no edge of values holds it"
    elif share < LEAST_SHARE or _goes_on(best, found):
        why = "nearly the same range of values gives a region of another size"
    elif _has_neck(best, seed):
        why = "it goes on through a neck"
    else:
        return None
    return (
        f"the region would leak: {why}; allowed: another place, or a spread and a passage "
        "that suit it"
    )


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
        finest = side <= FINEST * min(volume.spacing)
        thin = chosen is not None and is_tube(chosen[0]) and chosen[0].depth < LEAST_DEPTH
        if finest or not thin:
            break
        side = max(FINER * side, FINEST * min(volume.spacing))
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


def _most(most_ml: float, side: float) -> int:
    """Returns how many cells a region may have."""
    return int(most_ml * 1000.0 / side**3) + 1


def _all_of(cells: Cells) -> Box:
    first, second, third = (slice(0, length) for length in cells.values.shape)
    return first, second, third


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
