"""What scissors take, against the projection of every voxel by itself."""

from __future__ import annotations

import numpy as np
import pytest
from matplotlib.path import Path as Polygon
from numpy.typing import NDArray
from palpate.base.errors import OptionError
from palpate.segmentation.scissors import Loop, in_loop, near_surface
from palpate.volumes.volume import Volume

SPACING = (1.0, 1.5, 2.5)
SHAPE = (18, 26, 34)
TARGET = np.array([20.0, 12.0, -3.0])
BACK = np.array([0.36, -0.48, 0.8])
RIGHT = np.array([0.8, 0.6, 0.0])


def turned() -> Volume:
    """A grid whose axes lie askew in the scene."""
    x = np.array([0.0, 0.6, 0.8])
    y = np.array([1.0, 0.0, 0.0])
    axes = np.stack([x, y, np.cross(x, y)], axis=1)
    values = np.zeros(SHAPE, np.int16)
    return Volume(values, spacing=SPACING, origin=tuple(TARGET - [10, 14, 18]), direction=axes)


def star(distance: float, *, size: float = 12.0) -> Loop:
    """A loop that is not convex, in the plane of the target, seen from so far away."""
    angles = np.linspace(0.0, 2.0 * np.pi, 80, endpoint=False)
    radii = size * (1.0 + 0.45 * np.cos(5.0 * angles))
    up = np.cross(BACK, RIGHT)
    line = TARGET + radii[:, None] * (
        np.cos(angles)[:, None] * RIGHT + np.sin(angles)[:, None] * up
    )
    eye = TARGET + distance * BACK
    return Loop(line=line, eye=(eye[0], eye[1], eye[2]), view=(-BACK[0], -BACK[1], -BACK[2]))


def centres(volume: Volume) -> NDArray[np.float64]:
    z, y, x = np.indices(volume.shape)
    grid = np.stack([x, y, z], axis=-1) + 0.5
    matrix = volume.patient_from_grid
    return np.asarray(grid @ matrix[:3, :3].T + matrix[:3, 3])


def seen_at(points: NDArray[np.float64], loop: Loop) -> NDArray[np.float64]:
    """Where lines of sight meet the plane of the target [mm]."""
    offset = points - np.array(loop.eye)
    distance = np.linalg.norm(TARGET - np.array(loop.eye))
    onto = offset * (distance / (offset @ -BACK))[..., None] + np.array(loop.eye) - TARGET
    return np.stack([onto @ RIGHT, onto @ np.cross(BACK, RIGHT)], axis=-1)


@pytest.mark.parametrize("distance", [60.0, 250.0, 1e4 * 250.0])
def test_voxels_are_taken_whose_centres_project_into_the_loop(distance: float) -> None:
    volume, loop = turned(), star(distance)
    places, corners = seen_at(centres(volume), loop), seen_at(loop.line, loop)
    flat = places.reshape(-1, 2)
    inside = Polygon(corners).contains_points(flat).reshape(volume.shape)
    # half a cell, the smallest side of a voxel by 4, where it seems largest: at the nearest voxel
    near_edge = 0.25 * 1.8 / 2.0 + 1e-6
    ends = np.roll(corners, -1, axis=0)
    along = ends - corners
    share = np.clip(((flat[:, None] - corners) * along).sum(-1) / (along * along).sum(-1), 0.0, 1.0)
    away = np.linalg.norm(flat[:, None] - corners - share[..., None] * along, axis=-1).min(axis=1)
    sure = (away > near_edge).reshape(volume.shape)
    found = in_loop(volume, loop)
    assert sure.mean() > 0.9
    assert 200 < inside.sum() < inside.size - 200
    np.testing.assert_array_equal(found[sure], inside[sure])


@pytest.mark.parametrize("distance", [120.0, 1e6])
def test_near_the_surface_a_flat_face_gives_way_to_the_depth(distance: float) -> None:
    values = np.zeros((40, 40, 40), np.int16)
    volume = Volume(values, spacing=(1.0, 1.0, 1.0))
    matter = np.zeros(values.shape, bool)
    matter[:, 10:] = True
    # seen from before, along y; what hides behind is not reached
    eye = (19.5, -distance, 19.5)
    corners = [(5.0, 10.0, 5.0), (34.0, 10.0, 5.0), (34.0, 10.0, 34.0), (5.0, 10.0, 34.0)]
    loop = Loop(line=np.array(corners), eye=eye, view=(0.0, 1.0, 0.0))
    taken = in_loop(volume, loop) & near_surface(volume, loop, matter, depth=5.0) & matter
    column = taken[20, :, 20]
    assert column[10:15].all()
    assert not column[16:].any()
    through = in_loop(volume, loop) & matter
    assert taken.sum() < 0.25 * through.sum()


def test_voxels_behind_the_eye_are_never_taken() -> None:
    volume = Volume(np.zeros((20, 20, 20), np.int16), spacing=(1.0, 1.0, 1.0))
    corners = [(4.0, 12.0, 4.0), (16.0, 12.0, 4.0), (16.0, 12.0, 16.0), (4.0, 12.0, 16.0)]
    loop = Loop(line=np.array(corners), eye=(10.0, 8.0, 10.0), view=(0.0, 1.0, 0.0))
    found = in_loop(volume, loop)
    assert not found[:, :8].any()
    assert found[10, 12:, 10].all()


def test_what_is_no_loop_is_refused() -> None:
    behind = Loop(line=-star(60.0).line, eye=(0.0, 0.0, 0.0), view=(1.0, 0.0, 0.0))
    with pytest.raises(OptionError, match="before the eye"):
        in_loop(turned(), behind)
