"""What the search for a bent transform is made of: splines that ITK reads, slopes that are true."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import SimpleITK
from numpy.typing import NDArray
from palpate.registration.control_points import ControlPoints
from palpate.registration.options import Metric
from palpate.registration.samples import Alike, Sampled

Array = NDArray[np.float64]

STEP = 1e-5


@pytest.fixture
def image() -> Any:
    """An image that lies askew."""
    values = np.random.default_rng(3).normal(size=(24, 26, 30)).astype(np.float32)
    made = SimpleITK.GetImageFromArray(values)
    made.SetSpacing((2.5, 2.0, 3.0))
    made.SetOrigin((-40.0, 5.0, 7.0))
    made.SetDirection(SimpleITK.Euler3DTransform((0.0, 0.0, 0.0), 0.1, 0.2, 0.3).GetMatrix())
    return made


@pytest.fixture
def grid(image: Any) -> ControlPoints:
    return ControlPoints(image, (3, 2, 4))


def points_in(image: Any, draw: np.random.Generator) -> Array:
    sampled = Sampled(image)
    return sampled.points(draw.random((60, 3)) * (sampled.size - 1))


def test_points_move_as_by_the_transform_that_is_written(image: Any, grid: ControlPoints) -> None:
    draw = np.random.default_rng(1)
    coefficients = draw.normal(size=(grid.count, 3))
    points = points_in(image, draw)
    moved = grid.near(points).moved(coefficients)
    transform = grid.transform(coefficients)
    there = np.array([transform.TransformPoint(point) for point in points.tolist()])
    np.testing.assert_allclose(points + moved, there, atol=1e-9)
    assert np.abs(moved).max() > 0.1


def test_denser_control_points_move_all_points_as_before(image: Any, grid: ControlPoints) -> None:
    draw = np.random.default_rng(2)
    coefficients = draw.normal(size=(grid.count, 3))
    points = points_in(image, draw)
    finer, more = grid.finer(coefficients)
    assert finer.steps == (6, 4, 8)
    np.testing.assert_allclose(
        finer.near(points).moved(more), grid.near(points).moved(coefficients), atol=1e-12
    )


def test_pulls_at_points_are_gathered_as_moves_are_spread(image: Any, grid: ControlPoints) -> None:
    draw = np.random.default_rng(4)
    near = grid.near(points_in(image, draw))
    pulls, coefficients = draw.normal(size=(60, 3)), draw.normal(size=(grid.count, 3))
    spread = float((near.moved(coefficients) * pulls).sum())
    gathered = float((near.gathered(pulls, grid.count) * coefficients).sum())
    assert gathered == pytest.approx(spread)


def test_bending_is_none_of_affine_moves_and_its_slope_is_true(
    grid: ControlPoints,
) -> None:
    draw = np.random.default_rng(5)
    z, y, x = np.indices(grid.shape)
    even = np.stack([x + 2.0 * y, z - x, 3.0 - y], axis=-1).reshape(-1, 3)
    assert grid.bending(even)[0] == pytest.approx(0.0, abs=1e-20)
    coefficients, way = draw.normal(size=(2, grid.count, 3))
    energy, slope = grid.bending(coefficients)
    assert energy > 0.0
    apart = [grid.bending(coefficients + sign * STEP * way)[0] for sign in (1.0, -1.0)]
    assert float((slope * way).sum()) == pytest.approx((apart[0] - apart[1]) / (2 * STEP), rel=1e-5)


def test_values_between_voxels_have_true_slopes(image: Any) -> None:
    draw = np.random.default_rng(6)
    sampled = Sampled(image)
    points = points_in(image, draw)
    values, slopes = sampled.read(sampled.index(points))
    read = [float(image.EvaluateAtPhysicalPoint(point)) for point in points.tolist()]
    np.testing.assert_allclose(values, read, atol=1e-5)
    way = draw.normal(size=points.shape)
    ends = [sampled.read(sampled.index(points + sign * STEP * way))[0] for sign in (1.0, -1.0)]
    np.testing.assert_allclose(
        (slopes * way).sum(axis=1), (ends[0] - ends[1]) / (2 * STEP), atol=1e-6
    )


@pytest.mark.parametrize("metric", ["mutual-information", "correlation", "mean-squares"])
def test_slopes_of_metrics_are_true_and_alike_values_are_best(metric: Metric) -> None:
    draw = np.random.default_rng(7)
    fixed = draw.normal(size=500)
    alike = Alike(metric, 16, (-4.0, 4.0), (-4.0, 4.0))
    values = [
        alike.at(fixed, fixed + noise * draw.normal(size=500))[0] for noise in (0.0, 0.5, 2.0)
    ]
    assert values == sorted(values)
    moving, way = 0.5 * fixed + 0.3 * draw.normal(size=500), draw.normal(size=500)
    slopes = alike.at(fixed, moving)[1]
    ends = [alike.at(fixed, moving + sign * STEP * way)[0] for sign in (1.0, -1.0)]
    assert float(slopes @ way) == pytest.approx((ends[0] - ends[1]) / (2 * STEP), rel=1e-4)
