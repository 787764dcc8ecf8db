"""Values in an ellipse or a rectangle of a slice, against brute force in NumPy."""

from __future__ import annotations

import tracemalloc
from typing import Any, Literal

import numpy as np
import pytest
from numpy.typing import NDArray
from palpate import Volume
from palpate.base.errors import OptionError
from palpate.volumes import area_values
from palpate.volumes.area_values import Area, values_in_area

SPACING = (0.7, 1.1, 4.0)
SHAPE = (11, 40, 50)


def turned() -> NDArray[np.float64]:
    """Returns a rotation about no axis of the body; columns are the axes of the grid."""
    a, b = 0.35, -0.5
    first = np.array([[np.cos(a), -np.sin(a), 0], [np.sin(a), np.cos(a), 0], [0, 0, 1]])
    second = np.array([[1, 0, 0], [0, np.cos(b), -np.sin(b)], [0, np.sin(b), np.cos(b)]])
    return np.asarray(second @ first)


def scan(direction: NDArray[np.float64], values: Any = None) -> Volume:
    random = np.random.default_rng(3)
    made = random.integers(-1000, 2000, SHAPE).astype(np.int16) if values is None else values
    return Volume(made, spacing=SPACING, origin=(-30.0, 12.0, 400.0), direction=direction)


def area(
    kind: Literal["ellipse", "rectangle"],
    middle: NDArray[np.float64],
    first: NDArray[np.float64],
    second: NDArray[np.float64],
) -> Area:
    return Area(kind, middle.tolist(), first.tolist(), second.tolist())


def at(
    kind: Literal["ellipse", "rectangle"], middle: NDArray[np.float64], half: tuple[float, float]
) -> Area:
    """Returns an axial area by its half axes along the body [mm]."""
    return area(
        kind, middle, middle + np.array([half[0], 0, 0]), middle + np.array([0, half[1], 0])
    )


def centres(volume: Volume) -> NDArray[np.float64]:
    """Returns the centres of all voxels, shape [z, y, x, 3]."""
    z, y, x = np.indices(volume.shape)
    matrix = volume.patient_from_grid
    index = np.stack([x, y, z], axis=-1) + 0.5
    return np.asarray(index @ matrix[:3, :3].T + matrix[:3, 3])


@pytest.mark.parametrize("kind", ["ellipse", "rectangle"])
@pytest.mark.parametrize("axis", [0, 1, 2])
@pytest.mark.parametrize("direction", [np.eye(3), turned()], ids=["upright", "turned"])
def test_values_are_those_of_the_voxels_whose_centres_lie_inside(
    kind: Literal["ellipse", "rectangle"], axis: int, direction: NDArray[np.float64]
) -> None:
    volume = scan(direction)
    u, v = (direction[:, other] for other in range(3) if other != axis)
    # in the slice, and not turned as its rows are
    u, v = 0.8 * u + 0.6 * v, -0.6 * u + 0.8 * v
    matrix = volume.patient_from_grid
    middle = matrix[:3, :3] @ [24.3, 19.1, 5.4] + matrix[:3, 3]
    half = (9.0, 5.5)
    found = values_in_area(volume, area(kind, middle, middle + half[0] * u, middle + half[1] * v))

    offset = centres(volume) - middle
    a, b = offset @ u / half[0], offset @ v / half[1]
    inside = (a**2 + b**2 <= 1) if kind == "ellipse" else (np.maximum(abs(a), abs(b)) <= 1)
    layer = np.moveaxis(np.zeros(volume.shape, bool), 2 - axis, 0)
    layer[(24, 19, 5)[axis]] = True
    voxels = volume.array[inside & np.moveaxis(layer, 0, 2 - axis)].astype(float)
    assert len(voxels) > 20
    assert found.count == len(voxels)
    assert found.mean == pytest.approx(voxels.mean())
    assert found.standard_deviation == pytest.approx(voxels.std())
    assert (found.minimum, found.maximum) == (voxels.min(), voxels.max())
    assert found.area == pytest.approx((np.pi if kind == "ellipse" else 4) * 9.0 * 5.5)
    assert not found.cut


def test_in_an_oblique_plane_values_are_interpolated() -> None:
    direction = turned()
    upright = scan(direction)
    slope = np.array([3.0, -2.0, 5.0])
    # a plane through space has its own value in the middle of whatever lies evenly around it
    values = (centres(upright) @ slope).astype(np.float32)
    volume = scan(direction, values)
    matrix = volume.patient_from_grid
    middle = matrix[:3, :3] @ [25.0, 20.0, 5.5] + matrix[:3, 3]
    u = direction @ [0.6, 0.64, 0.48]
    v = np.cross(u, direction @ [0.0, 0.6, -0.8])
    v /= np.linalg.norm(v)
    found = values_in_area(volume, area("ellipse", middle, middle + 8 * u, middle + 6 * v))
    # of numbers of 32 bits
    assert found.mean == pytest.approx(middle @ slope, abs=0.05)
    # samples stand for even parts: as many as the area has squares of the smallest edge
    assert found.count == pytest.approx(np.pi * 48 / 0.7**2, rel=0.05)
    # of an even slope over an ellipse: half of the slope along each half axis
    spread = np.hypot(8 * u @ slope, 6 * v @ slope) / 2
    assert found.standard_deviation == pytest.approx(spread, rel=0.02)
    assert found.maximum == pytest.approx(middle @ slope + 2 * spread, rel=0.02)


def test_fractions_stay_and_edits_count() -> None:
    random = np.random.default_rng(5)
    volume = scan(np.eye(3), random.random(SHAPE).astype(np.float32) * 1e-3)
    matrix = volume.patient_from_grid
    middle = matrix[:3, :3] @ [20.5, 20.5, 3.5] + matrix[:3, 3]
    area = at("rectangle", middle, (1.0, 1.5))
    voxels = volume.values((3, slice(19, 22), slice(19, 22))).astype(float)
    found = values_in_area(volume, area)
    assert found.count == 9
    assert found.mean == pytest.approx(voxels.mean(), rel=1e-6)
    stored = volume.array.copy()
    stored[3, 20, 20] = -32000
    edited = values_in_area(volume, area, stored=stored)
    voxels[1, 1] = -32000 * volume.slope + volume.intercept
    assert edited.mean == pytest.approx(voxels.mean(), rel=1e-6)


def test_what_has_no_value_is_left_out() -> None:
    values = np.ones(SHAPE, np.float32)
    values[3, 20, 20] = np.nan
    volume = scan(np.eye(3), values)
    matrix = volume.patient_from_grid
    middle = matrix[:3, :3] @ [20.5, 20.5, 3.5] + matrix[:3, 3]
    found = values_in_area(volume, at("rectangle", middle, (1.0, 1.5)))
    assert (found.count, found.mean) == (8, 1.0)


def test_outside_of_the_scan_and_between_voxels_there_are_no_values() -> None:
    volume = scan(np.eye(3))
    matrix = volume.patient_from_grid
    corner = matrix[:3, 3]
    beyond = values_in_area(volume, at("ellipse", corner, (5, 5)))
    assert beyond.cut
    assert 0 < beyond.count < np.pi * 25 / (0.7 * 1.1) / 2
    far = corner - 100
    none = values_in_area(volume, at("ellipse", far, (5, 5)))
    assert (none.count, none.mean, none.cut) == (0, None, True)
    between = matrix[:3, :3] @ [20.0, 20.0, 3.5] + matrix[:3, 3]
    small = at("ellipse", between, (0.1, 0.1))
    assert values_in_area(volume, small).count == 0


@pytest.mark.parametrize(
    "second", [(0.0, 0.0, 0.0), (5.0, 1.0, 0.0), (float("nan"), 0.0, 0.0)], ids=str
)
def test_what_is_no_area_is_refused(second: tuple[float, float, float]) -> None:
    with pytest.raises(OptionError, match="half axes"):
        values_in_area(scan(np.eye(3)), Area("ellipse", (0, 0, 0), (5, 0, 0), second))


def oblique(half: float) -> tuple[Volume, Area]:
    """Returns a scan and an area through its middle that lies along none of its axes."""
    volume, direction = scan(np.eye(3)), turned()
    matrix = volume.patient_from_grid
    middle = matrix[:3, :3] @ [25.0, 20.0, 5.5] + matrix[:3, 3]
    ends = (middle + half * direction[:, axis] for axis in (0, 1))
    return volume, area("ellipse", middle, *ends)


def test_samples_are_the_same_in_blocks_of_any_size(monkeypatch: pytest.MonkeyPatch) -> None:
    volume, wanted = oblique(9.0)
    at_once = values_in_area(volume, wanted)
    assert at_once.count > 300
    monkeypatch.setattr(area_values, "BLOCK", 7)
    assert values_in_area(volume, wanted) == at_once


def test_a_large_oblique_area_takes_little_memory() -> None:
    volume, wanted = oblique(350.0)  # a million samples: 24 MB for their points alone
    tracemalloc.start()
    try:
        found = values_in_area(volume, wanted)
        _, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert found.cut
    assert found.count > 1000
    assert peak < 30e6


def test_an_area_of_too_many_samples_is_refused() -> None:
    volume, wanted = oblique(5000.0)
    with pytest.raises(OptionError, match="an area of 78539816 mm² given; allowed: a smaller one"):
        values_in_area(volume, wanted)
