"""Voxels of a grid in little memory: packed bits of their box, compressed.

Arrays are bool, [z, y, x]; low and size of a box are in the same order [voxels].
"""

from __future__ import annotations

import zlib
from hashlib import blake2b
from math import prod

import msgspec
import numpy as np

from palpate.base.errors import OptionError
from palpate.segmentation.mask_shape import Mask

__all__ = ["VoxelSet", "digest_of"]

FAST = 1
"""Level of zlib: boxes of segments are mostly runs of equal bits, which any level packs well."""

Place = tuple[int, int, int]


class VoxelSet(msgspec.Struct, frozen=True):
    """Some voxels of a grid, as files keep them too."""

    shape: Place
    """Of the whole grid."""
    low: Place
    size: Place
    bits: bytes

    @classmethod
    def of(cls, mask: Mask) -> VoxelSet:
        """Returns the voxels of a mask."""
        low, part = _box(mask)
        z, y, x = mask.shape
        bits = zlib.compress(np.packbits(part).data, FAST)
        depth, height, width = part.shape
        return cls((z, y, x), low, (depth, height, width), bits)

    @property
    def is_empty(self) -> bool:
        """Whether there are none."""
        return prod(self.size) == 0

    def mask(self, *, on: Place | None = None) -> Mask:
        """Returns their mask, of the shape of the grid.

        Args:
            on: Shape of the grid that they must be on; None takes any.

        Raises:
            OptionError: They are on another grid, or come from a damaged file.
        """
        if on is not None and on != self.shape:
            raise OptionError(f"voxels of a grid of {list(self.shape)} given; allowed: {list(on)}")
        ends = np.add(self.low, self.size)
        count = prod(self.size)
        within = min(*self.low, *self.size) >= 0 and bool((ends <= self.shape).all())
        try:
            unpacker = zlib.decompressobj()
            packed = unpacker.decompress(self.bits, (count + 7) // 8 + 1) if within else b""
        except zlib.error:
            packed = b""
        if len(packed) != (count + 7) // 8 or not within:
            raise OptionError("the voxels of a step are damaged; allowed: those that were saved")
        mask = np.zeros(self.shape, bool)
        box = tuple(slice(low, end) for low, end in zip(self.low, ends, strict=True))
        solid = np.unpackbits(np.frombuffer(packed, np.uint8), count=count)
        mask[box] = solid.reshape(self.size)
        return mask


def digest_of(mask: Mask) -> bytes:
    """Returns 16 bytes that only equal masks share."""
    low, part = _box(mask)
    hasher = blake2b(digest_size=16)
    hasher.update(np.asarray([mask.shape, low, part.shape], "<i8").tobytes())
    hasher.update(np.packbits(part).data)
    return hasher.digest()


def _box(mask: Mask) -> tuple[Place, Mask]:
    """Returns the lowest voxel of the box of a mask, and the mask in it."""
    spans = []
    for axis in range(3):
        others = tuple(other for other in range(3) if other != axis)
        solid = np.flatnonzero(mask.any(axis=others))
        spans.append((int(solid[0]), int(solid[-1]) + 1) if solid.size else (0, 0))
    (z, z_end), (y, y_end), (x, x_end) = spans
    return (z, y, x), mask[z:z_end, y:y_end, x:x_end]
