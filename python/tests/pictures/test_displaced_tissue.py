"""Soft tissue that is pressed, in pictures of a session: it is seen where it stands."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from made_gel import GEL, TOP, gel_scene
from numpy.typing import NDArray
from palpate.pictures.appearance import Appearance
from palpate.pictures.camera import Camera
from palpate.pictures.session_pictures import Fineness, SessionPictures
from palpate.session.edited_values import EditedValues
from palpate.session.needle import TISSUES
from palpate.session.scripted_path import ScriptedPath
from palpate.session.session import Session, SessionOptions
from palpate.volumes.material import Material

ISO = -475.0
MIDDLE = (24.3, 24.4)
WIDE = 15
"""Pixels of a millimetre."""
AWAY = 100.0
"""From the plane of the picture to the block's upper face [mm]."""
Array = NDArray[np.float64]


def depths(pictures: SessionPictures) -> Array:
    """Returns how deep the surface lies under the picture's plane, seen from above [mm]."""
    look = Appearance(
        mode="iso",
        transfer=((0.0, (0.0, 0.0, 0.0), 0.0), (1.0, (1.0, 1.0, 1.0), 1.0)),
        edge_gradient=1.0,
        window=(400.0, 40.0),
        iso_value=ISO,
        iso_colour=(1.0, 1.0, 1.0),
        tissue_from=-300.0,
    )
    camera = Camera(
        target=(*MIDDLE, float(TOP)),
        distance=float(WIDE),
        right=(1.0, 0.0, 0.0),
        up=(0.0, 1.0, 0.0),
        back=(0.0, 0.0, 1.0),
        field=2 * math.atan(0.5),
        parallel=AWAY,
    )
    fineness = Fineness(steps_per_voxel=4.0, haste=True)
    drawn = pictures.draw(look, camera, (WIDE, WIDE), fineness=fineness, number=None)
    assert drawn is not None
    return drawn.depths.astype(float)


def trilinear(values: Array, places: Array) -> Array:
    """Returns what lies at places (x, y, z) between the middles of voxels, or of nodes."""
    last = np.array(values.shape[2::-1]) - 1
    inside = np.clip(places, 0, last)
    low = np.minimum(inside.astype(int), np.maximum(last - 1, 0))
    share = inside - low
    total: Array = np.zeros((len(places), *values.shape[3:]))
    for corner in np.ndindex(2, 2, 2):
        x, y, z = np.minimum(low + corner, last).T
        weight = np.prod(np.where(corner, share, 1 - share), axis=1)
        total += values[z, y, x] * weight.reshape(-1, *[1] * (values.ndim - 3))
    return total


def expected(values: NDArray[np.int16], displaced: Any) -> Array:
    """Returns the same depths by the formula of docs/understand/optics.md."""
    columns = np.arange(WIDE) + 0.5 - WIDE / 2
    # the middle of the first voxel is the patient's origin
    x, y = np.meshgrid(MIDDLE[0] + columns, MIDDLE[1] - columns)
    surface = np.full(x.shape, np.nan)
    for z in np.arange(TOP - 6.0, TOP + 3.0, 0.01):
        places = np.stack([x.ravel(), y.ravel(), np.full(x.size, z)], axis=1)
        if displaced is not None:
            count = displaced["size"]
            packed = np.frombuffer(displaced["moved"], "<f2").astype(float)
            moved = packed.reshape(*count[::-1], 4)[..., :3]
            nodes = (places + 0.5 - displaced["origin"]) / displaced["step"]
            inside = np.all((nodes > -0.5) & (nodes < np.array(count) - 0.5), axis=1)
            first = places - trilinear(moved, nodes)
            nodes = (first + 0.5 - displaced["origin"]) / displaced["step"]
            places = np.where(inside[:, None], places - trilinear(moved, nodes), places)
        solid = trilinear(values.astype(float), places).reshape(x.shape) >= ISO
        surface[solid] = z
    return AWAY + TOP - surface


def edited(session: Session) -> NDArray[np.int16]:
    """Returns the stored values with the changes since the first that were asked for."""
    edited = EditedValues(session.scene.volume.array)
    for change in session.picture_changes():
        for box in change["voxels"]:
            if box["stored"] is not None:
                edited.write(box["low"], box["high"], box["stored"])
    return edited.values


def test_a_pressed_block_is_drawn_where_it_stands() -> None:
    path = ScriptedPath((*MIDDLE, 30.0)).move((*MIDDLE, TOP - 1.6), seconds=1.0)
    path = path.move((*MIDDLE, TOP - 1.6), seconds=0.5)
    with Session(gel_scene(), device=path, options=SessionOptions(real_time=False)) as session:
        pictures = SessionPictures(session)
        untouched = depths(pictures)
        np.testing.assert_allclose(untouched, AWAY + 0.5, atol=0.02)
        session.picture_changes()
        session.set_material(1, GEL)
        session.set_deformation("lattice")
        session.run(1.4)
        boxes: Any = session.whole_surfaces()["displaced"]
        values = edited(session)
        seen = depths(pictures)
        # as a renderer sees it that has followed nothing
        np.testing.assert_array_equal(depths(SessionPictures(session)), seen)
        session.set_deformation(None)
        session.run(0.05)
        still = depths(pictures)
    by_formula = expected(values, boxes[0])
    by_voxels = expected(values, None)
    np.testing.assert_allclose(seen, by_formula, atol=0.04)
    # voxels alone show it elsewhere, and a dent it is
    assert np.abs(by_formula - by_voxels).max() > 0.1
    assert seen.max() - seen.min() > 0.8
    # without a model tissue is at rest
    np.testing.assert_allclose(still, untouched, atol=0.02)


def test_tissue_dimples_under_a_needle_and_comes_back_at_the_puncture() -> None:
    liver = TISSUES["liver"]
    path = ScriptedPath((*MIDDLE, 30.0)).move((*MIDDLE, TOP - 5.0), seconds=1.0)
    path = path.move((*MIDDLE, TOP - 5.0), seconds=0.5).move((*MIDDLE, TOP - 8.0), seconds=0.5)
    with Session(gel_scene(), device=path, options=SessionOptions(real_time=False)) as session:
        session.set_material(1, Material(young=5.5e3, poisson=0.45, friction=0.0))
        session.set_deformation("lattice")
        session.set_tool("needle", radius=0.5, segment_ids=[1], tissues=[liver])
        session.stroke(on=True)
        pictures = SessionPictures(session)
        untouched = depths(pictures)
        force = session.run(1.4).forces[-1][2]
        pressed = depths(pictures) - untouched
        assert not session.needle_events()
        last = pressed
        while not session.needle_events():
            last = depths(pictures) - untouched
            session.run(0.02)
        session.run(0.02)
        punctured = depths(pictures) - untouched
    # l x + q x² = force
    linear, quadratic = liver.linear, liver.quadratic
    deflection = (math.sqrt(linear**2 + 4.0 * quadratic * force) - linear) / (2.0 * quadratic)
    assert deflection > 2.0
    tip = pressed[WIDE // 2, WIDE // 2]
    assert abs(tip / deflection - 1.0) < 0.15
    # a funnel around the tip
    assert tip == pressed.max()
    assert np.all(np.diff(pressed[WIDE // 2, WIDE // 2 :]) < 0.05)
    assert pressed[0, 0] < 0.5 * tip
    # from the force of the puncture to that of cutting
    assert punctured.max() < 0.8 * last.max()
