"""What a person should know of a change of shape: what the grid cannot express of it.

Distances are between centres of voxels, so a length that is less than a voxel along an axis does
nothing there; a shell is a voxel thick there all the same, since it must enclose.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from palpate.segmentation.lengths_in_voxels import nearest_voxels, shorter_than_voxel
from palpate.segmentation.mask_shape import Mask, touches_border

__all__ = ["told_of_shape"]

BY_A_BALL = ("grow", "shrink", "open", "close")
"""What does nothing along an axis where its length is less than a voxel."""


def told_of_shape(
    kind: str, length: float, spacing: Sequence[float], *, masks: tuple[Mask, Mask]
) -> tuple[str, ...]:
    """Returns sentences on a change of shape.

    Args:
        kind: The change; see ``operations.ShapeKind``.
        length: Its length [mm].
        spacing: Sides of the voxels along x, y, z [mm].
        masks: Before and after, [z, y, x].
    """
    if kind in BY_A_BALL:
        short = shorter_than_voxel(length, spacing)
        return _nothing_along(kind, length, short)
    if kind == "median":
        sides = zip("xyz", spacing, strict=True)
        short = {axis: side for axis, side in sides if nearest_voxels(length, side) < 1}
        return _nothing_along(kind, length, short)
    if kind in ("hollow-inside", "hollow-outside"):
        return tuple(_told_of_shell(kind, length, spacing, masks=masks))
    return ()


def _nothing_along(kind: str, length: float, short: dict[str, float]) -> tuple[str, ...]:
    if not short:
        return ()
    return (f"{kind} by {length:g} mm changes nothing along {_along(short)}",)


def _told_of_shell(
    kind: str, length: float, spacing: Sequence[float], *, masks: tuple[Mask, Mask]
) -> Iterator[str]:
    before, after = masks
    short = shorter_than_voxel(length, spacing)
    if short:
        yield (
            f"a shell of {length:g} mm is one voxel thick, so that it encloses, along "
            f"{_along(short)}"
        )
    if touches_border(before):
        yield "the segment reaches the border of its grid: its shell is open there"
    elif touches_border(after):
        yield "the shell reaches the border of its grid: it is thinner there"
    if kind == "hollow-inside" and np.array_equal(before, after):
        yield f"nothing is hollow: the segment is nowhere thicker than two walls of {length:g} mm"


def _along(axes: dict[str, float]) -> str:
    """Names axes with their voxels' sides."""
    if len(axes) == 3:
        return f"any axis (voxels of {' x '.join(f'{side:g}' for side in axes.values())} mm)"
    return " and ".join(f"{axis} (voxels of {side:g} mm)" for axis, side in axes.items())
