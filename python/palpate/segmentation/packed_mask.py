"""A mask of cells, a bit each, 64 in a word along x: layers are added and taken 64 at a time.

Arrays are [z, y, x]; words [z, y, word], the lowest bit first. Bits behind the last cell are 0.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from palpate.segmentation.mask_shape import Mask

__all__ = ["PackedMask"]

WORD = 64
"""Bits of a word."""
LAST = np.uint64(WORD - 1)
ONE = np.uint64(1)


@dataclass(frozen=True)
class PackedMask:
    """A mask; all of it stays as it is."""

    words: NDArray[np.uint64]
    width: int
    """Cells along x."""

    @staticmethod
    def of(mask: Mask) -> PackedMask:
        """Packs a mask."""
        *lengths, width = mask.shape
        count = -(-width // WORD)
        packed = np.zeros((*lengths, 8 * count), np.uint8)
        found = np.packbits(mask, axis=2, bitorder="little")
        packed[:, :, : found.shape[2]] = found
        return PackedMask(packed.view(np.dtype("<u8")).astype(np.uint64, copy=False), width)

    def mask(self) -> Mask:
        """Returns the mask, a byte each."""
        packed = self.words.astype(np.dtype("<u8"), copy=False).view(np.uint8)
        found = np.unpackbits(packed, axis=2, count=self.width, bitorder="little")
        return found.view(bool)

    def __and__(self, other: PackedMask) -> PackedMask:
        """Returns what both have."""
        return PackedMask(self.words & other.words, self.width)

    def __invert__(self) -> PackedMask:
        """Returns what it does not have."""
        return PackedMask(~self.words & self._cells(), self.width)

    @property
    def count(self) -> int:
        """How many cells it has."""
        return int(np.bitwise_count(self.words).sum())

    def grown(self, step: int) -> PackedMask:
        """Adds a layer of cells: over faces at even steps, over corners too at odd ones."""
        source = self.words
        along_x = source.copy()
        along_x |= source << ONE
        along_x |= source >> ONE
        along_x[:, :, 1:] |= source[:, :, :-1] >> LAST
        along_x[:, :, :-1] |= source[:, :, 1:] << LAST
        along_x &= self._cells()
        result = along_x
        for axis in (1, 0):
            beside = source if step % 2 == 0 else result.copy()
            lower = (slice(None),) * axis + (slice(1, None),)
            upper = (slice(None),) * axis + (slice(None, -1),)
            result[lower] |= beside[upper]
            result[upper] |= beside[lower]
        return PackedMask(result, self.width)

    def eroded(self, step: int) -> PackedMask:
        """Takes a layer of cells away, as ``grown`` adds one.

        Beyond the grid lies what lies at its border.
        """
        return ~(~self).grown(step)

    def _cells(self) -> NDArray[np.uint64]:
        """Returns words with a bit for each cell along x."""
        bits = np.full(self.words.shape[2], ~np.uint64(0))
        rest = self.width % WORD
        if rest:
            bits[-1] = (ONE << np.uint64(rest)) - ONE
        return bits
