"""Statistics of segments: the same as by NumPy, SimpleITK and a comparison of all pairs."""

from __future__ import annotations

from itertools import product
from typing import Any

import numpy as np
import palpate
import pytest
import SimpleITK
from numpy.typing import NDArray
from palpate.base.errors import OptionError
from palpate.base.simpleitk import image_on
from palpate.segmentation.measures import diameters
from palpate.segmentation.measures.diameters import largest_diameters
from palpate.segmentation.measures.segment_statistics import SegmentStatistics, statistics
from palpate.volumes.scene import Scene
from palpate.volumes.volume import Volume, VolumeTraits

SHAPE = (14, 17, 23)
GRIDS = {
    "axial": np.eye(3),
    "oblique": np.array([[0.36, 0.48, -0.8], [-0.8, 0.6, 0.0], [0.48, 0.64, 0.6]]),
    "left-handed": np.diag([1.0, -1.0, 1.0]),
    "sagittal": np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, -1.0, 0.0]]),
}
"""Axes of the grid as columns, LPS."""


def scan(values: NDArray[Any] | None = None, grid: str = "axial", unit: str = "HU") -> Volume:
    if values is None:
        values = np.random.default_rng(5).integers(-1000, 2000, SHAPE).astype(np.int16)
    return Volume(
        values,
        spacing=(0.7, 1.1, 2.3),
        origin=(-30.0, 12.0, 400.0),
        direction=GRIDS[grid],
        traits=VolumeTraits(unit=unit),
    )


def blob(seed: int = 7) -> NDArray[np.bool_]:
    """A mask that is not convex, away from the border, with a speck."""
    z, y, x = np.indices(SHAPE)
    mask = ((x - 10) / 7) ** 2 + ((y - 8) / 5) ** 2 + ((z - 6) / 4) ** 2 <= 1.0
    mask &= np.random.default_rng(seed).random(SHAPE) < 0.8
    mask[12, 15, 21] = True
    return np.asarray(mask, bool)


def measured(volume: Volume, mask: NDArray[Any]) -> SegmentStatistics:
    (one,) = statistics(Scene(volume, [volume.segment(mask, name="one")]))
    return one


@pytest.mark.parametrize(
    "values",
    [
        np.random.default_rng(1).integers(-1000, 2000, SHAPE).astype(np.int16),
        np.random.default_rng(2).normal(0.2, 3.0, SHAPE).astype(np.float32),
        np.random.default_rng(3).integers(0, 2**31, SHAPE, dtype=np.uint32),
    ],
    ids=["int16", "float32", "uint32"],
)
def test_values_are_those_of_numpy(values: NDArray[Any]) -> None:
    mask = blob()
    found = measured(scan(values), mask).values
    assert found is not None
    inside = values[mask].astype(np.float64)
    low, quarter, median, three_quarters, high = np.percentile(inside, [5, 25, 50, 75, 95])
    assert found.count == inside.size
    assert found.mean == pytest.approx(inside.mean())
    assert found.standard_deviation == pytest.approx(inside.std())
    assert (found.minimum, found.maximum) == (inside.min(), inside.max())
    assert (found.percentile_5, found.percentile_25) == pytest.approx((low, quarter))
    assert found.median == pytest.approx(median)
    assert (found.percentile_75, found.percentile_95) == pytest.approx((three_quarters, high))


@pytest.mark.parametrize("grid", GRIDS)
def test_place_and_size_are_those_of_simpleitk(grid: str) -> None:
    volume, mask = scan(grid=grid), blob()
    found = measured(volume, mask)
    shape = SimpleITK.LabelShapeStatisticsImageFilter()
    shape.ComputeFeretDiameterOn()
    shape.Execute(image_on(volume, mask.astype(np.uint8)))
    assert found.voxels == shape.GetNumberOfPixels(1)
    assert found.volume == pytest.approx(shape.GetPhysicalSize(1))
    assert found.centroid == pytest.approx(shape.GetCentroid(1))
    # ITK measures between centres: at least that long, and at most by a voxel's diagonal more
    between_centres, diagonal = shape.GetFeretDiameter(1), np.linalg.norm(volume.spacing)
    assert found.diameter is not None
    assert between_centres < found.diameter <= between_centres + diagonal


def test_values_are_those_of_simpleitk() -> None:
    volume, mask = scan(), blob()
    found = measured(volume, mask).values
    assert found is not None
    intensity = SimpleITK.LabelIntensityStatisticsImageFilter()
    intensity.Execute(image_on(volume, mask.astype(np.uint8)), image_on(volume, volume.array))
    assert found.mean == pytest.approx(intensity.GetMean(1))
    assert (found.minimum, found.maximum) == (intensity.GetMinimum(1), intensity.GetMaximum(1))
    # ITK's is that of a sample, ours that of these voxels
    of_sample = found.standard_deviation * np.sqrt(found.count / (found.count - 1))
    assert of_sample == pytest.approx(intensity.GetStandardDeviation(1))


def longest_by_pairs(voxels: NDArray[Any], edges: NDArray[np.float64]) -> float:
    """The largest distance between all corners of voxels, pair by pair."""
    corners = [voxels + np.array(corner) for corner in product((0, 1), repeat=voxels.shape[1])]
    places = np.unique(np.concatenate(corners), axis=0) * edges
    return max(float(np.linalg.norm(places - place, axis=1).max()) for place in places)


@pytest.mark.parametrize("seed", range(20))
def test_diameters_are_the_longest_of_all_pairs(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    # all planes are looked at and many cells made, however few voxels there are
    monkeypatch.setattr(diameters, "FEW", 0)
    monkeypatch.setattr(diameters, "CELLS", 3)
    rng = np.random.default_rng(seed)
    mask = rng.random(rng.integers(1, 9, 3)) < rng.choice([0.05, 0.5])
    mask.flat[rng.integers(mask.size)] = True
    edges = rng.uniform(0.3, 3.0, 3)
    axial = int(rng.integers(3))
    in_slices = max(
        longest_by_pairs(np.argwhere(each), np.delete(edges, axial))
        for each in np.moveaxis(mask, axial, 0)
        if each.any()
    )
    expected = longest_by_pairs(np.argwhere(mask), edges), in_slices
    assert largest_diameters(mask, edges[::-1].tolist(), axial=axial) == pytest.approx(expected)


@pytest.mark.parametrize("turn", [0.1, 0.5, 0.9, 1.3])
def test_diameters_of_round_bodies_are_exact(turn: float) -> None:
    # many vertices of the hull where its sides turn by little
    y, x = np.indices((90, 110)) - np.array([44, 54])[:, None, None]
    along, across = np.cos(turn) * x + np.sin(turn) * y, np.cos(turn) * y - np.sin(turn) * x
    disc = (along / 41.3) ** 2 + (across / 40.2) ** 2 <= 1.0
    edges = np.array([2.0, 1.0, 0.9 + 0.1 * turn])
    in_slice = longest_by_pairs(
        np.argwhere(disc ^ (disc & (along**2 + across**2 < 38**2))), edges[1:]
    )
    mask = np.stack([disc, disc])
    found = largest_diameters(mask, edges[::-1].tolist(), axial=0)
    assert found == pytest.approx((np.hypot(in_slice, 4.0), in_slice), abs=1e-9)


def test_the_axial_diameter_lies_in_axial_slices_however_the_scan_was_taken() -> None:
    mask = np.zeros(SHAPE, bool)
    # in a sagittal scan, the second axis of the grid runs along the body
    mask[3, 2:12, 5] = True
    along, across = measured(scan(grid="sagittal"), mask), measured(scan(), mask)
    assert along.diameter == across.diameter
    assert along.axial_diameter == pytest.approx(np.hypot(0.7, 2.3))
    assert across.axial_diameter == pytest.approx(np.hypot(0.7, 11.0))


def test_a_ball_has_the_area_of_a_ball() -> None:
    z, y, x = np.indices((40, 40, 40))
    ball = (x - 20) ** 2 + (y - 20) ** 2 + (z - 20) ** 2 <= 15.0**2
    volume = Volume(np.zeros(ball.shape, np.int16), spacing=(0.5, 0.5, 0.5))
    # smoothed faces of voxels approach the ball, within some percent at 15 voxels
    assert measured(volume, ball).surface_area == pytest.approx(4.0 * np.pi * 7.5**2, rel=0.03)


def test_one_voxel_has_its_own_size() -> None:
    mask = np.zeros(SHAPE, bool)
    mask[1, 2, 3] = True
    found = measured(scan(), mask)
    assert found.volume == pytest.approx(0.7 * 1.1 * 2.3)
    assert found.diameter == pytest.approx(np.linalg.norm([0.7, 1.1, 2.3]))
    assert found.axial_diameter == pytest.approx(np.hypot(0.7, 1.1))
    assert found.centroid == pytest.approx((-30.0 + 2.1, 12.0 + 2.2, 400.0 + 2.3))
    assert found.values is not None
    assert found.values.standard_deviation == 0.0


def test_voxels_without_a_value_are_left_out_and_counted() -> None:
    values = np.full(SHAPE, 2.5, np.float32)
    mask = blob()
    values[tuple(np.argwhere(mask)[0])] = np.nan
    values[tuple(np.argwhere(mask)[1])] = np.inf
    found = measured(scan(values), mask)
    assert found.without_value == 2
    assert found.voxels == np.count_nonzero(mask)
    assert found.values is not None
    assert (found.values.count, found.values.mean) == (found.voxels - 2, 2.5)
    nothing = measured(scan(np.where(mask, np.nan, 1.0)), mask)
    assert (nothing.values, nothing.note) == (None, "no values")


def test_an_empty_segment_has_a_row_that_says_so() -> None:
    found = measured(scan(), np.zeros(SHAPE, bool))
    assert (found.voxels, found.volume, found.note) == (0, 0.0, "empty")
    assert (found.values, found.diameter, found.centroid) == (None, None, None)


def test_an_object_has_a_size_and_no_values() -> None:
    volume = scan()
    scene = Scene(volume, [volume.segment(blob(), name="plate").as_object()])
    (found,) = statistics(scene)
    assert found.diameter == measured(volume, blob()).diameter
    assert (found.values, found.note) == (None, "own grid: no values")


def test_values_are_those_of_the_scene_after_edits() -> None:
    volume, mask = scan(), blob()
    with palpate.Session(
        Scene(volume, [volume.segment(mask, name="one")]),
        options=palpate.SessionOptions(real_time=False),
    ) as session:
        edited = volume.array.copy()
        edited[mask] = 77
        (found,) = palpate.statistics(session.scene_now(edited))
    assert found.values is not None
    assert (found.values.minimum, found.values.maximum) == (77.0, 77.0)


def test_what_is_no_scene_is_refused() -> None:
    with pytest.raises(OptionError, match="scene of type Volume given; allowed: a Scene"):
        statistics(scan())  # type: ignore[arg-type]


def test_work_that_is_no_longer_wanted_ends() -> None:
    volume = scan()
    one = volume.segment(blob(), name="one")

    class UnwantedError(Exception):
        pass

    def progress(what: str, share: float | None, /) -> None:
        if share == 0.5:
            raise UnwantedError(what)

    with pytest.raises(UnwantedError, match="measuring one"):
        statistics(Scene(volume, [one, one]), progress=progress)
