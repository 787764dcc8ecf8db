"""Votes of regions around a seed: which of them most are like, and what these agree on.

Regions of wrong ranges and passages are wrong in many ways, those of right ones alike.
"""

from __future__ import annotations

import numpy as np

from palpate.segmentation.growing.cells import Cells, connected
from palpate.segmentation.growing.choice import Found, Region, in_box, measured, slopes_of

__all__ = ["ALIKE", "agreed", "best_of"]

VOTES = 6
"""Power of a region's score that it counts with."""
ALIKE = 1.4
"""Volume by that of the best region of one that is about as large."""


def best_of(found: list[Region]) -> tuple[Region, float] | None:
    """Returns the region that most of the good ones are like, and their share of all."""
    if not found:
        return None
    weights = [one.score**VOTES for one in found]
    shares = [
        sum(weight for other, weight in zip(found, weights, strict=True) if _alike(one, other))
        for one in found
    ]

    def rank(number: int) -> tuple[float, int]:
        return round(shares[number] * found[number].score, 3), found[number].count

    best = max(range(len(found)), key=rank)
    return found[best], shares[best] / sum(weights)


def agreed(cells: Cells, best: Region, found: list[Region]) -> Region:
    """Returns what most of the regions like the best one have, and hangs together with the seeds.

    Majority voting, as where several people have marked the same (Rohlfing et al., "Evaluation of
    atlas selection strategies", 2004).
    """
    alike = [one for one in found if _alike(best, one)]
    votes = np.zeros(cells.values.shape, np.float32)
    for one in alike:
        votes[one.box] += one.score * one.mask
    most = connected(votes > 0.5 * sum(one.score for one in alike), list(cells.seeds))
    first, second, third = (slice(0, length) for length in most.shape)
    mask, box = in_box(most, (first, second, third))
    most_agreed = Found(mask, box, max(one.half for one in alike))
    return measured(most_agreed, slopes_of(cells.values, [box]))


def _alike(one: Region, other: Region) -> bool:
    """Returns whether two regions are about as large, and in about the same place."""
    # the border of a small body is a large part of it
    most = max(ALIKE, (1.0 + 1.0 / one.depth) ** 3)
    if not 1.0 / most < other.count / one.count < most:
        return False
    both, either = 1, 1
    for own, its in zip(one.box, other.box, strict=True):
        both *= max(0, min(own.stop, its.stop) - max(own.start, its.start))
        either *= max(own.stop, its.stop) - min(own.start, its.start)
    return both * most * most > either
