"""A scan in the 3-D view of a page, and the same file's values along the rays of its camera."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
import SimpleITK
from browser import Browser
from numpy.typing import NDArray

Array = NDArray[np.float64]


class Page(Protocol):
    """A page in any browser."""

    def read(self, expression: str) -> Any:
        """Returns the value of an expression in the page."""


@dataclass(frozen=True)
class Seen:
    """A scan in the 3-D view of a page in any browser."""

    page: Page
    image: Any

    def points_along(self, pixels: Array, lengths: Array) -> Array:
        """Returns points of the scene [ray, sample, axis]; lengths [mm] begin at the target."""
        camera = self.page.read("window.palpate.camera")
        box = self.page.read(
            "document.querySelector('[data-testid=canvas]').getBoundingClientRect().toJSON()"
        )
        right, up, back, target = (np.array(camera[k]) for k in ("right", "up", "back", "target"))
        half = np.tan(camera["field"] / 2)
        place = (pixels + 0.5) / (box["width"], box["height"]) * 2 - 1
        sideways = half * (place[:, :1] * box["width"] / box["height"] * right - place[:, 1:] * up)
        if camera["parallel"] is None:
            toward = sideways - back
            toward /= np.linalg.norm(toward, axis=1, keepdims=True)
            eye = target + camera["distance"] * back
        else:
            toward = np.broadcast_to(-back, sideways.shape)
            eye = (target + camera["distance"] * (back + sideways))[:, None]
        ways = (lengths + float(camera["distance"]))[None, :, None]
        return np.asarray(eye + toward[:, None] * ways, np.float64)

    def values_along(self, pixels: Array, lengths: Array) -> Array:
        """Returns the file's values [ray, sample] along the rays of pixels; NaN outside of it."""
        points = self.points_along(pixels, lengths)
        axes = np.array(self.image.GetDirection()).reshape(3, 3) * self.image.GetSpacing()
        index = (points - self.image.GetOrigin()) @ np.linalg.inv(axes).T
        return trilinear(SimpleITK.GetArrayFromImage(self.image), index)


@dataclass(frozen=True)
class Opened(Seen):
    """The same in the browser of all tests."""

    page: Browser


def trilinear(values: NDArray[Any], index: Array) -> Array:
    """Returns values [z, y, x] between voxels at indices (x, y, z); NaN outside."""
    size = np.array(values.shape)[::-1]
    outside = ((index < -0.5) | (index > size - 0.5)).any(axis=-1)
    inside = np.clip(index, 0, size - 1.000001)
    low = np.floor(inside).astype(int)
    share = inside - low
    total = np.zeros(index.shape[:-1])
    for corner in np.ndindex(2, 2, 2):
        weight = np.prod(np.where(np.array(corner) == 1, share, 1 - share), axis=-1)
        x, y, z = np.moveaxis(low + corner, -1, 0)
        total += weight * values[z, y, x]
    total[outside] = np.nan
    return total
