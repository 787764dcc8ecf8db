"""When pages need the label of each voxel anew.

A voxel has one label, that of the last segment that has it. Pages get the labels of hidden segments
too, below those of visible ones: where segments lie apart, hiding one changes no label, and nothing
has to be fetched for it. Which of them overlap is learned whenever labels are made.
"""

from __future__ import annotations

from collections.abc import Sequence

__all__ = ["LabelsVersion"]

Order = tuple[int, ...]
"""Numbers of segments; the label of a voxel is the last one's that has it."""


class LabelsVersion:
    """The version of the labels that pages need, as segments and their voxels change."""

    def __init__(self) -> None:
        """Begins with segments of which nothing is known."""
        self.number = 0
        self._voxels_version = 0
        # pages have labels by the first; changes since then came by the others
        self._orders: list[Order] = []
        self._edit = 0
        self._learned: tuple[int, frozenset[int]] | None = None
        self._overlapping: frozenset[int] = frozenset()

    @property
    def order(self) -> Order:
        """Numbers of the segments that labels are made of now."""
        return self._orders[-1] if self._orders else ()

    @property
    def is_unsure(self) -> bool:
        """Whether pages may need other labels; ``learn`` settles that."""
        return len(self._orders) > 1

    def follow(self, order: Sequence[int], *, voxels_version: int, edit: int) -> bool:
        """Takes the order of segments as it is now; returns whether it is another.

        Args:
            order: Numbers of the segments.
            voxels_version: Rises where voxels change that pages are not told of.
            edit: Number of the newest edit of voxels.
        """
        new = tuple(order)
        changed = new != self.order
        voxels = voxels_version if new else 0
        self._edit = edit
        if set(new) != set(self.order) or voxels != self._voxels_version or not self._orders:
            self._voxels_version = voxels
            self._renew(new)
        elif changed:
            self._orders.append(new)
        self._settle()
        return changed

    def learn(self, overlapping: frozenset[int], *, order: Order, edit: int) -> None:
        """Takes which of the segments of an order share voxels, as it was after an edit."""
        self._learned = edit, frozenset(order)
        self._overlapping = overlapping
        self._settle()

    @property
    def edit(self) -> int:
        """Number of the newest edit of voxels that this has followed."""
        return self._edit

    def _settle(self) -> None:
        """Finds out whether an order gives other labels than those before, where that is known."""
        if not self.is_unsure or self._learned != (self._edit, frozenset(self.order)):
            return
        among = {
            tuple(each for each in order if each in self._overlapping) for order in self._orders
        }
        if len(among) == 1:
            self._orders = [self.order]
        else:
            self._renew(self.order)

    def _renew(self, order: Order) -> None:
        self._orders = [order]
        self.number += 1
