"""A volume renderer on the CPU, in NumPy: what pictures of the page are held against.

It follows ``docs/understand/picture.md``: the formulas of light are the shaders' too, code and
sampling are its own. Where they take the mean of the transfer function between two samples, leap,
quarter steps and end early, this one takes samples eight times as dense as the voxels, the transfer
function of each, and goes on to the end. Where one place of a ray decides, which may lie between
samples, they are 32 times as dense.
Lengths are in mm, colours linear RGB 0..1. There is no light volume: occlusion and shadow are 0.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

STEPS_PER_VOXEL = 8
STEPS_TO_A_PLACE = 32
"""For the modes that show one place of a ray."""
CHUNK = 200
"""Rays that are followed at once: what they need fits into some 200 MB."""
MOST_OPACITY = 0.995
"""More of 1 mm is not told from opaque."""

KEY_COLOUR = np.array([1.06, 1.0, 0.92])
SKY_COLOUR = np.array([0.36, 0.38, 0.42])
GROUND_COLOUR = np.array([0.14, 0.11, 0.10])


@dataclass(frozen=True)
class Look:
    """What of the page's look its modes need; values in the scan's unit."""

    opacities: Sequence[tuple[float, float]]
    """Value, and opacity of 1 mm of tissue."""
    colours: Sequence[tuple[float, str]]
    """Value, and "#rrggbb"."""
    densities: dict[str, float]
    """Factor on the extinction, by mode."""
    windows: dict[str, tuple[float, float]]
    """Window and level, by mode of grey."""
    slabs: dict[str, float]
    """Thickness of what is looked at around the middle of the view, by mode of grey; 0: all."""
    iso_value: float
    tissue_from: float
    """From which value on a ray has tissue, where there is no slab."""
    edge_gradient: float
    """Of a full boundary [value per mm]."""
    flat_share: float
    """Of its extinction that flat tissue keeps."""


@dataclass(frozen=True)
class View:
    """A camera of the page, and the rays of some of its pixels [ray, axis] in the scene."""

    origins: Array
    directions: Array
    up: Array
    right: Array
    back: Array
    distance: float

    @property
    def key(self) -> Array:
        """Toward the lamp: over the viewer's left shoulder."""
        return unit(-0.45 * self.right + 0.65 * self.up + 0.75 * self.back)


@dataclass(frozen=True)
class Samples:
    """Places along some rays [ray, sample], and what is there."""

    lengths: Array
    grid: Array
    inside: NDArray[np.bool_]
    values: Array
    step: float


class Reference:
    """Renders one scan, whose voxels stand along the axes of the scene."""

    def __init__(self, values: NDArray[Any], spacing: Array, origin: Array, look: Look) -> None:
        """Takes values [z, y, x] and the middle of the first voxel."""
        self.values = np.ascontiguousarray(values, np.float64)
        self.size = np.array(values.shape)[::-1]
        self.spacing, self.origin, self.look = spacing, origin, look

    def picture(self, mode: str, view: View) -> Array:
        """Returns the picture of a mode [ray, RGBA], linear and multiplied by its opacity."""
        rays = np.arange(len(view.origins))
        parts = np.array_split(rays, max(1, len(rays) // CHUNK))
        return np.concatenate([self._chunk(mode, part_of(view, part)) for part in parts])

    def _chunk(self, mode: str, view: View) -> Array:
        one_place = mode in {"mip", "minip", "iso"}
        samples = self._samples(view, STEPS_TO_A_PLACE if one_place else STEPS_PER_VOXEL)
        if mode in {"mip", "minip", "average"}:
            return self._projection(mode, samples, view)
        if mode == "iso":
            return self._iso_surface(samples, view)
        return self._tissue(mode, samples, view)

    # --- the scan as a field

    def at(self, grid: Array) -> Array:
        """Returns trilinear values at places [voxels from the first one]; the outermost go on."""
        place = np.clip(grid, 0, self.size - 1.000001)
        low = place.astype(np.int64)
        x, y, z = np.moveaxis(place - low, -1, 0)
        row, layer = self.size[0], self.size[0] * self.size[1]
        first = low[..., 0] + row * low[..., 1] + layer * low[..., 2]
        flat = self.values.ravel()

        def along_x(start: NDArray[np.int64]) -> Array:
            return np.asarray(flat[start] * (1 - x) + flat[start + 1] * x)

        def along_y(start: NDArray[np.int64]) -> Array:
            return np.asarray(along_x(start) * (1 - y) + along_x(start + row) * y)

        return np.asarray(along_y(first) * (1 - z) + along_y(first + layer) * z)

    def gradient(self, grid: Array) -> Array:
        """Returns central differences over a voxel to each side [value per mm]."""
        each = [
            (self.at(grid + step) - self.at(grid - step)) / (2 * size)
            for step, size in zip(np.eye(3), self.spacing, strict=True)
        ]
        return np.stack(each, axis=-1)

    def _samples(self, view: View, steps_per_voxel: int) -> Samples:
        """Returns places in the middle of equal steps from where rays enter the scan."""
        origins = (view.origins - self.origin) / self.spacing
        directions = view.directions / self.spacing
        with np.errstate(divide="ignore"):
            faces = np.stack([-0.5 - origins, self.size - 0.5 - origins]) / directions
        enter = np.maximum(faces.min(axis=0).max(axis=1), 0)
        leave = faces.max(axis=0).min(axis=1)
        step = float(self.spacing.min()) / steps_per_voxel
        count = int(np.ceil(max(0.0, float((leave - enter).max())) / step)) + 1
        lengths = enter[:, None] + step * (np.arange(count) + 0.5)
        grid = origins[:, None] + directions[:, None] * lengths[..., None]
        inside = lengths < leave[:, None]
        return Samples(lengths, grid, inside, self.at(grid), step)

    # --- tissue

    def _tissue(self, mode: str, samples: Samples, view: View) -> Array:
        look = self.look
        values = samples.values
        opacity = np.interp(values, *np.transpose(look.opacities))
        extinction = -np.log(1 - np.minimum(opacity, MOST_OPACITY)) * look.densities[mode]
        extinction = np.where(samples.inside, extinction, 0.0)
        if mode == "absorption":
            absorbed = 1 - np.exp(-samples.step * extinction.sum(axis=1))
            return np.repeat(absorbed[:, None], 4, axis=1)
        colours = self._colours(values)
        if mode == "emission":
            light = samples.step * (extinction[..., None] * colours).sum(axis=1)
            return with_opacity(light, np.minimum(light.max(axis=1), 1))

        ray, place = np.nonzero(extinction)
        gradient = self.gradient(samples.grid[ray, place])
        boundary = smoothstep(np.linalg.norm(gradient, axis=1) / look.edge_gradient)
        extinction[ray, place] *= look.flat_share + (1 - look.flat_share) * boundary
        if mode == "shaded":
            lit = lit_tissue(colours[ray, place], gradient, boundary, view, view.directions[ray])
            colours[ray, place] = lit
        thickness = samples.step * extinction
        before = np.cumsum(thickness, axis=1) - thickness
        weight = np.exp(-before) * (1 - np.exp(-thickness))
        light = (weight[..., None] * colours).sum(axis=1)
        return with_opacity(light, 1 - np.exp(-thickness.sum(axis=1)))

    def _colours(self, values: Array) -> Array:
        at, names = zip(*self.look.colours, strict=True)
        stops = np.array([linear_of_hex(name) for name in names])
        return np.stack([np.interp(values, at, stops[:, c]) for c in range(3)], axis=-1)

    # --- one value of a ray

    def _projection(self, mode: str, samples: Samples, view: View) -> Array:
        look = self.look
        counted, tissue_from = samples.inside, look.tissue_from
        if look.slabs[mode] > 0:
            depth = samples.lengths * (-view.directions @ view.back)[:, None]
            counted = counted & (np.abs(depth - view.distance) <= look.slabs[mode] / 2)
            tissue_from = -np.inf
        if mode != "mip":
            tissue = counted & (samples.values >= tissue_from)
            begun = np.logical_or.accumulate(tissue, axis=1)
            goes_on = np.logical_or.accumulate(tissue[:, ::-1], axis=1)[:, ::-1]
            counted = counted & begun & goes_on
        most = np.where(counted, samples.values, -np.inf).max(axis=1)
        least = np.where(counted, samples.values, np.inf).min(axis=1)
        number = counted.sum(axis=1)
        mean = (samples.values * counted).sum(axis=1) / np.maximum(number, 1)
        value = {"mip": most, "minip": least, "average": mean}[mode]
        window, level = look.windows[mode]
        grey = np.clip((value - level) / window + 0.5, 0, 1)
        grey[number == 0] = 0
        return with_opacity(np.repeat(linear_of_srgb(grey)[:, None], 3, axis=1), grey)

    # --- the iso-surface

    def _iso_surface(self, samples: Samples, view: View) -> Array:
        reached = samples.inside & (samples.values >= self.look.iso_value)
        ray = np.flatnonzero(reached.any(axis=1))
        first = reached[ray].argmax(axis=1)
        along = view.directions[ray] / self.spacing
        place = samples.grid[ray, first]
        # the crossing lies in the step before, but for rays that begin inside
        before = place - np.where(first > 0, samples.step, 0.0)[:, None] * along
        for _ in range(8):
            middle = (before + place) / 2
            enclosed = (self.at(middle) >= self.look.iso_value)[:, None]
            place = np.where(enclosed, middle, place)
            before = np.where(enclosed, before, middle)
        normal = facing(self.gradient(place), view.directions[ray])
        colour = self._colours(np.array(self.look.iso_value))
        light = lit_surface(
            colour, normal, self.openness(place, normal), view, view.directions[ray]
        )
        picture = np.zeros((len(view.origins), 4))
        picture[ray] = with_opacity(light, np.ones(len(ray)))
        return picture

    def openness(self, grid: Array, normal: Array) -> Array:
        """Returns the share of the sky over a surface: five directions, four places along each."""
        aside = np.where(np.abs(normal[:, 2:]) < 0.9, [0.0, 0.0, 1.0], [1.0, 0.0, 0.0])
        side = unit(np.cross(normal, aside))
        other = np.cross(normal, side)
        covered = np.zeros(len(grid))
        for right, up in ((0, 0), (1, 0), (-1, 0), (0, 1), (0, -1)):
            direction = unit(normal + 1.1 * (right * side + up * other)) / self.spacing
            hit = np.zeros(len(grid))
            for i in range(4):
                place = grid + direction * 2.2 * 1.9**i
                within = ((place > -0.5) & (place < self.size - 0.5)).all(axis=1)
                enclosed = within & (self.at(place) >= self.look.iso_value)
                hit = np.maximum(hit, np.where(enclosed, 1 - 0.2 * i, 0))
            covered += hit
        return np.asarray(1 - 0.17 * covered)


# --- light


def lit_tissue(colour: Array, gradient: Array, boundary: Array, view: View, ways: Array) -> Array:
    """Returns translucent tissue as it is lit; ``boundary`` is how much of a surface it is."""
    normal = facing(gradient, ways)
    wrapped = np.maximum((normal @ view.key + 0.35) / 1.35, 0)[:, None]
    rim = ((1 - np.maximum(-(normal * ways).sum(axis=1), 0)) ** 3)[:, None]
    shine = 0.22 * highlight(normal, view, ways) ** 36
    surface = colour * (sky(normal, view) + 0.18 * rim + 0.85 * KEY_COLOUR * wrapped) + shine
    return np.asarray(0.55 * colour + boundary[:, None] * (surface - 0.55 * colour))


def lit_surface(colour: Array, normal: Array, open_share: Array, view: View, ways: Array) -> Array:
    """Returns a solid surface as it is lit, with the share of the sky that it sees."""
    seen = open_share[:, None]
    key = np.maximum(normal @ view.key, 0)[:, None]
    toward = np.maximum(-(normal * ways).sum(axis=1), 0)[:, None]
    direct = 0.82 * KEY_COLOUR * key * (0.45 + 0.55 * seen)
    scattered = np.array([0.10, 0.055, 0.04]) * (1 - seen) + 0.04 * (1 - toward)
    shine = 0.16 * highlight(normal, view, ways) ** 28
    return np.asarray(colour * (sky(normal, view) * seen + direct + scattered) + shine * seen)


def sky(normal: Array, view: View) -> Array:
    """Returns the light of sky and ground, mixed by how far a surface looks up."""
    share = (0.5 + 0.5 * (normal @ view.up))[:, None]
    return np.asarray(GROUND_COLOUR * (1 - share) + SKY_COLOUR * share)


def highlight(normal: Array, view: View, ways: Array) -> Array:
    """Returns Blinn's cosine: of the normal and the middle between lamp and eye."""
    cosine = (normal * unit(view.key - ways)).sum(axis=1)
    return np.asarray(np.maximum(cosine, 0)[:, None])


def facing(vectors: Array, ways: Array) -> Array:
    """Returns unit vectors turned to who looks along the ways; toward them where there is none."""
    size = np.linalg.norm(vectors, axis=1, keepdims=True)
    units = np.where(size > 1e-9, vectors / np.maximum(size, 1e-9), -ways)
    return np.where((units * ways).sum(axis=1, keepdims=True) > 0, -units, units)


# --- colours


def ground_at(across: Array, upward: Array) -> Array:
    """Returns the page's ground (linear) at shares of the picture from its lower left corner."""
    away = np.hypot((across - 0.5) * 1.1, (upward - 0.52) * 1.25)
    share = smoothstep(away / 0.85)[:, None]
    return linear_of_hex("#1b222b") * (1 - share) + linear_of_hex("#0b0e12") * share


def on_screen(picture: Array, ground: Array, *, bent: bool) -> Array:
    """Returns a picture over a ground as sRGB; highlights are bent where it is no grey."""
    light, opacity = picture[:, :3], picture[:, 3:]
    if bent:
        light = np.minimum(light, 0.7) + 0.3 * (1 - np.exp(-np.maximum(light - 0.7, 0) / 0.3))
    return srgb_of_linear(light + (1 - opacity) * ground)


def linear_of_srgb(colour: Array) -> Array:
    """Returns linear light (IEC 61966-2-1)."""
    return np.where(colour <= 0.04045, colour / 12.92, ((colour + 0.055) / 1.055) ** 2.4)


def srgb_of_linear(light: Array) -> Array:
    """Returns what the screen is told."""
    c = np.clip(light, 0, 1)
    return np.where(c <= 0.0031308, 12.92 * c, 1.055 * c ** (1 / 2.4) - 0.055)


def linear_of_hex(colour: str) -> Array:
    """Returns linear light of "#rrggbb"."""
    return linear_of_srgb(np.array([int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5)]))


# --- small things


def part_of(view: View, rays: NDArray[np.int64]) -> View:
    """Returns some of the rays."""
    one, other = view.origins[rays], view.directions[rays]
    return View(one, other, view.up, view.right, view.back, view.distance)


def with_opacity(light: Array, opacity: Array) -> Array:
    """Returns RGBA."""
    return np.concatenate([light, opacity[:, None]], axis=1)


def smoothstep(share: Array) -> Array:
    """Returns 0 below 0 and 1 above 1, with no kink between."""
    x = np.clip(share, 0, 1)
    return np.asarray(x * x * (3 - 2 * x))


def unit(vectors: Array) -> Array:
    """Returns vectors of length 1."""
    return np.asarray(vectors / np.linalg.norm(vectors, axis=-1, keepdims=True))
