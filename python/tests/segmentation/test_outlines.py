"""Outlines in slices: the live wire along edges, levels, and what they enclose."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import SimpleITK
from contourpy import contour_generator
from numpy.typing import NDArray
from palpate.base.errors import OptionError
from palpate.io.reading import read
from palpate.segmentation.level_tracing import traced_level
from palpate.segmentation.live_wire import live_wire
from palpate.session.painted_stroke import PaintedStroke
from palpate.session.session import Session, SessionOptions
from palpate.volumes.polygon_fill import fill_polygons
from palpate.volumes.scan_slice import ScanSlice
from palpate.volumes.scene import Scene
from palpate.volumes.volume import Volume

SPACING = (0.8, 0.8, 2.0)
"""x, y, z [mm]."""
SHAPE = (20, 90, 100)
MIDDLE = np.array([40.0, 36.0, 20.0])
"""Of the ball [patient mm]; the origin is the corner of the first voxel."""
RADIUS = 17.0
NORMALS = {"axial": (0.0, 0.0, -1.0), "coronal": (0.0, -1.0, 0.0), "sagittal": (1.0, 0.0, 0.0)}


def scan(*, noise: float = 0.0, blur: float = 0.8, bright: bool = False) -> Volume:
    """A ball of 150 in 50, its border as blurred as a scanner's [mm]; a brighter body beside it."""
    z, y, x = (
        (np.arange(n) + 0.5) * edge for n, edge in zip(SHAPE, reversed(SPACING), strict=True)
    )
    places = np.stack(np.meshgrid(x, y, z, indexing="ij")[::-1], axis=0)
    z3, y3, x3 = (np.transpose(c, (2, 1, 0)) for c in places)
    distance = np.sqrt((x3 - MIDDLE[0]) ** 2 + (y3 - MIDDLE[1]) ** 2 + (z3 - MIDDLE[2]) ** 2)
    values = 50.0 + 100.0 / (1.0 + np.exp((distance - RADIUS) / (0.5 * blur)))
    if bright:
        values[x3 > MIDDLE[0] + RADIUS + 4.0] = 1200.0
    values += np.random.default_rng(3).normal(0.0, noise, values.shape) if noise else 0.0
    return Volume(
        np.round(values).astype(np.int16),
        spacing=SPACING,
        origin=tuple(0.5 * edge for edge in SPACING),
    )


def on_circle(slice_name: str, degrees: float, *, radius: float = RADIUS) -> NDArray[np.float64]:
    """A point of the ball's outline in a slice through its middle."""
    turned = np.radians(degrees)
    a, b = radius * np.cos(turned), radius * np.sin(turned)
    offset = {"axial": (a, b, 0.0), "coronal": (a, 0.0, b), "sagittal": (0.0, a, b)}[slice_name]
    point: NDArray[np.float64] = MIDDLE + offset
    return point


def away(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """How far points are from the ball's surface [mm]."""
    distances: NDArray[np.float64] = np.abs(np.linalg.norm(points - MIDDLE, axis=1) - RADIUS)
    return distances


@pytest.mark.parametrize("noise", [0.0, 15.0])
def test_the_wire_runs_along_the_edge_between_a_few_clicks(noise: float) -> None:
    volume = scan(noise=noise)
    clicks = [on_circle("axial", degrees, radius=RADIUS + 0.8) for degrees in (10, 130, 250)]
    path = live_wire(volume, clicks, normal=NORMALS["axial"], smoothing=1.2)
    # chords between the clicks are up to half the radius away
    assert away(path).mean() < 0.6
    assert away(path).max() < 2.5
    steps = np.abs(np.diff(path / SPACING, axis=0)).max(axis=1)
    np.testing.assert_allclose(steps, 1.0)
    np.testing.assert_allclose(path[0], path[-1])
    assert np.ptp(path[:, 2]) == 0.0


def test_a_brighter_edge_nearby_does_not_draw_the_wire_away() -> None:
    volume = scan(bright=True)
    clicks = [on_circle("axial", degrees) for degrees in (-50, 50)]
    path = live_wire(volume, clicks, normal=NORMALS["axial"], closed=False)
    assert away(path).max() < 1.3


@pytest.mark.parametrize("name", ["coronal", "sagittal"])
def test_voxels_need_not_be_square(name: str) -> None:
    clicks = [on_circle(name, degrees) for degrees in (-60, 60)]
    path = live_wire(scan(), clicks, normal=NORMALS[name], closed=False)
    # a voxel of 2 mm has its middle up to 1 mm beside the edge
    assert away(path).mean() < 0.9
    assert len(path) > 15


@pytest.mark.parametrize("name", list(NORMALS))
def test_a_level_is_traced_through_the_point(name: str) -> None:
    volume = scan()
    outline = traced_level(volume, list(on_circle(name, 40.0)), normal=NORMALS[name])
    assert away(outline).max() < 0.5
    assert len(outline) > 30


@pytest.mark.data
def test_the_wire_finds_more_of_the_liver_than_straight_lines_do(data_folder: Path) -> None:
    folder = data_folder / "amos_0336"
    volume = read(folder / "amos_0336.mhd")
    labels = SimpleITK.GetArrayFromImage(
        SimpleITK.ReadImage(str(folder / "labels_from_meshes.nii.gz"))
    )
    found: list[float] = []
    straight: list[float] = []
    for number in (78, 90, 102):
        where = ScanSlice(volume, 2, number)
        liver = np.pad((labels[number] == 6).astype(float), 1)
        lines = [np.asarray(line) for line in contour_generator(z=liver).lines(0.5)]
        corners = max(lines, key=len)[:-1] - 1.0
        clicks = corners[np.linspace(0, len(corners), 6, endpoint=False).astype(int)]
        true = fill_polygons([corners], where.shape) != 0
        path = live_wire(volume, list(where.points(clicks)), normal=(0.0, 0.0, 1.0))
        for scores, polygon in ((found, where.places(path)), (straight, clicks)):
            mask = fill_polygons([polygon], where.shape) != 0
            scores.append(2.0 * (mask & true).sum() / (mask.sum() + true.sum()))
    # six clicks at even distances along the outline, none of them chosen by a person
    assert np.mean(found) > 0.9
    assert np.mean(found) > np.mean(straight) + 0.03


def test_levels_that_the_border_cuts_are_closed_along_it() -> None:
    values = np.zeros((4, 20, 30), np.int16)
    values[:, :, 10:] = 100
    volume = Volume(values, spacing=(1.0, 1.0, 1.0), origin=(0.5, 0.5, 0.5))
    outline = traced_level(volume, [10.0, 10.0, 1.5], normal=(0.0, 0.0, 1.0))
    np.testing.assert_allclose(outline.min(axis=0)[:2], [10.0, 0.0], atol=0.51)
    np.testing.assert_allclose(outline.max(axis=0)[:2], [30.0, 20.0], atol=0.51)
    flat = Volume(np.zeros((4, 5, 6), np.int16), spacing=(1.0, 1.0, 1.0))
    with pytest.raises(OptionError, match="no outline"):
        traced_level(flat, [2.0, 2.0, 2.0], normal=(0.0, 0.0, 1.0))


@pytest.mark.parametrize("name", list(NORMALS))
def test_places_and_points_of_a_slice_are_each_others(name: str) -> None:
    volume = scan()
    where = ScanSlice.through(volume, list(MIDDLE), normal=NORMALS[name])
    places = np.array([[3.0, 4.0], [7.5, 2.0]])
    np.testing.assert_allclose(where.places(where.points(places)), places)
    column, row = (int(c) for c in places[0])
    point = where.points(places[:1])[0]
    index = [int(c) for c in np.floor(point / SPACING)]
    stored = volume.array[index[2], index[1], index[0]]
    assert where.values[row, column] == stored == volume.array[where.box].squeeze()[row, column]


@pytest.mark.parametrize(
    ("points", "normal", "told"),
    [
        ([[40.0, 36.0, 20.0]], (0, 0, 1), "1 points given"),
        ([[40.0, 36.0, 20.0], [41.0, 36.0, 20.0]], (0, 1, 1), "along the scan's own axes"),
        ([[40.0, 36.0, 20.0], [41.0, 36.0, 20.0]], (0, 0, 0), "along the scan's own axes"),
        ([[-1.0, 36.0, 20.0], [41.0, 36.0, 20.0]], (0, 0, 1), "a point in the scan"),
        ([[40.0, 36.0, 20.0], [41.0, 136.0, 20.0]], (0, 0, 1), "a point in the scan"),
    ],
)
def test_wires_that_cannot_be_are_refused(points: Any, normal: Any, told: str) -> None:
    with pytest.raises(OptionError, match=told):
        live_wire(scan(), points, normal=normal)


def test_what_an_outline_encloses_is_painted_and_is_one_step() -> None:
    volume = scan(bright=True)
    scene = Scene(volume, [volume.segment(np.zeros(SHAPE, np.uint8), name="painted")])
    clicks = [on_circle("axial", degrees) for degrees in (0, 90, 180, 270)]
    path = live_wire(volume, clicks, normal=NORMALS["axial"])
    with Session(scene, options=SessionOptions(real_time=False)) as session:
        stroke = PaintedStroke(session, 1)
        stroke.inside(list(path), normal=NORMALS["axial"])
        stroke.finish()
        mask = session.segment(1).mask().astype(bool)
        layers = np.flatnonzero(mask.any(axis=(1, 2)))
        assert layers.tolist() == [10]
        true = np.pi * RADIUS**2 / (SPACING[0] * SPACING[1])
        assert mask.sum() == pytest.approx(true, rel=0.06)

        erased = PaintedStroke(session, 1, erases=True)
        erased.inside(list(path), normal=NORMALS["axial"], values=(140.0, 200.0))
        erased.finish()
        left = session.segment(1).mask().astype(bool)
        assert 0 < left.sum() < mask.sum() / 4
        values = volume.array[left]
        assert values.max() < 140
        for expected in (mask.sum(), 0):
            assert session.undo()
            assert session.segment(1).mask().sum() == expected
        with pytest.raises(OptionError, match="three or more"):
            stroke.inside(list(path[:2]), normal=NORMALS["axial"])
