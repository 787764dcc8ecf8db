"""Every mode of the engine's pictures of a small real CT against a renderer in NumPy."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
import SimpleITK
from numpy.typing import NDArray
from palpate import _core
from palpate.pictures.appearance import Appearance, Lighting, Mode
from palpate.pictures.camera import Camera
from reference_head import GREY, LOOK, MODES, small_head
from reference_renderer import Reference, View, ground_at, linear_of_hex, on_screen, unit

SIZE = (640, 500)
APART = 6
"""Every so many pixels, along both edges, one is held against the reference."""
STEPS = 5.0
"""Steps per voxel, as of a still image of the page."""
DISTANCE = 620.0
Array = NDArray[np.float64]


def camera() -> Camera:
    """Looks from before, from the patient's left and from above."""
    back = unit(np.array([0.4, -0.85, 0.3]))
    right = unit(np.cross([0.0, 0.0, 1.0], back))
    up = np.cross(back, right)
    return Camera(
        target=(0.0, 0.0, 0.0),
        distance=DISTANCE,
        right=tuple(right),
        up=tuple(up),
        back=tuple(back),
        field=math.radians(24),
    )


def places() -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Returns the rows and columns of the pixels that are held against the reference."""
    rows, columns = np.mgrid[0 : SIZE[1] : APART, 0 : SIZE[0] : APART]
    return rows.ravel(), columns.ravel()


def view_of(seen: Camera) -> View:
    """Returns the rays of the pixels that are held against the reference."""
    right, up, back = (np.array(axis) for axis in (seen.right, seen.up, seen.back))
    rows, columns = places()
    half = math.tan(seen.field / 2)
    across = (2 * (columns + 0.5) / SIZE[0] - 1) * half * SIZE[0] / SIZE[1]
    upward = (1 - 2 * (rows + 0.5) / SIZE[1]) * half
    directions = unit(across[:, None] * right + upward[:, None] * up - back)
    eyes = np.broadcast_to(np.array(seen.target) + seen.distance * back, directions.shape)
    return View(eyes, directions, up, right, back, seen.distance)


def transfer() -> tuple[tuple[float, tuple[float, float, float], float], ...]:
    """Returns the look's function as points so close that it is straight between them."""
    values, opacities = np.array(LOOK.opacities).T
    places = np.linspace(values[0], values[-1], 1421)
    extinctions = -np.log1p(-np.interp(places, values, opacities))
    stops = np.array([value for value, _ in LOOK.colours])
    colours = np.array([linear_of_hex(colour) for _, colour in LOOK.colours])
    channels = [np.interp(places, stops, colours[:, i]) for i in range(3)]
    return tuple(
        (float(value), (float(red), float(green), float(blue)), float(extinction))
        for value, red, green, blue, extinction in zip(places, *channels, extinctions, strict=True)
    )


def appearance(mode: Mode) -> Appearance:
    """Returns how a mode shows the head, without the light volume, which the reference lacks."""
    slab = LOOK.slabs.get(mode, 0)
    points = transfer()
    iso = min(points, key=lambda point: abs(point[0] - LOOK.iso_value))
    return Appearance(
        mode=mode,
        density=LOOK.densities.get(mode, 1),
        transfer=points,
        edge_gradient=LOOK.edge_gradient,
        window=LOOK.windows.get(mode, LOOK.windows["average"]),
        iso_value=LOOK.iso_value,
        iso_colour=iso[1],
        tissue_from=-1e9 if slab > 0 else LOOK.tissue_from,
        slab=slab or None,
        lighting=Lighting(edges=1 - LOOK.flat_share, occlusion=0.0, shadow=0.0),
    )


@pytest.mark.data
def test_each_mode_is_the_picture_of_a_renderer_in_numpy(data_folder: Path) -> None:
    image = small_head(data_folder / "cthead_stanford" / "CThead.mha")
    spacing, origin = np.array(image.GetSpacing()), np.array(image.GetOrigin())
    values = SimpleITK.GetArrayFromImage(image)
    identity = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)
    volume = _core.Volume(values, tuple(spacing), tuple(origin), identity, 1.0, 0.0)
    renderer = _core.Renderer(volume)
    seen = camera()
    view = view_of(seen)
    rows, columns = places()
    ground = ground_at((columns + 0.5) / SIZE[0], 1 - (rows + 0.5) / SIZE[1])
    reference = Reference(values, spacing, origin, LOOK)
    for mode in MODES:
        renderer.set_appearance(appearance(mode))
        picture = renderer.draw(seen, SIZE, steps_per_voxel=STEPS)
        assert picture is not None
        colours = picture.colours()[rows, columns].astype(float)
        shown = on_screen(colours, ground, bent=mode not in GREY)
        expected = on_screen(reference.picture(mode, view), ground, bent=mode not in GREY)
        off = np.abs(shown - expected)
        mean, within = float(off.mean()) * 255, float(np.mean(off.max(axis=1) <= 8 / 255))
        assert mean < 1, (mode, mean)
        assert within >= 0.999, (mode, within)
        assert np.ptp(expected) > 0.5, mode
