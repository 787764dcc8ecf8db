"""Contours enclose what writers mean, with the volume of area times distance."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import palpate
import pytest
from dicom_cases import case
from numpy.typing import NDArray
from palpate.labels.contour_fill import fill_contours
from palpate.labels.contours import filled
from palpate.volumes.volume import Volume

Corners = NDArray[np.float64]
SHAPE = (40, 40)


@pytest.mark.data
@pytest.mark.parametrize(
    ("number", "name", "count"),
    [
        (13, "middle_twice", 231),
        (13, "all_twice", 231),
        (13, "overlap", 180),
        (14, "plain", 231),
        (14, "half", 231),
        (14, "second", 462),
    ],
)
def test_contours_that_were_reported(data_folder: Path, number: int, name: str, count: int) -> None:
    folder = case(data_folder, number)
    found = palpate.read_labels(folder / f"{name}.dcm", palpate.read(folder / "ct"))
    assert [int(label.segment.mask().sum()) for label in found.labels] == [count]
    assert found.warnings == ()


# --- one plane ----------------------------------------------------------------------------


def box(low: float, high: float, *, right: float = 0.0, back: bool = False) -> Corners:
    corners = np.array([(low, low), (high, low), (high, high), (low, high)])
    corners[:, 0] += right
    return corners[::-1] if back else corners


def count(*polygons: Corners, exclusive: bool = False) -> int:
    return int(fill_contours(polygons, SHAPE, exclusive=exclusive).sum())


@pytest.mark.parametrize("back", [False, True])
def test_a_contour_inside_another_is_a_hole_whichever_way_it_runs(*, back: bool) -> None:
    assert count(box(2.5, 30.5), box(10.5, 20.5, back=back)) == 28**2 - 10**2
    # an island in the hole, and a hole in it
    nest = (box(2.5, 30.5), box(6.5, 26.5, back=back), box(10.5, 20.5), box(12.5, 14.5, back=back))
    assert count(*nest) == 28**2 - 20**2 + 10**2 - 2**2
    assert count(*nest[::-1]) == count(*nest)


def test_a_keyhole_is_a_hole() -> None:
    inner = box(10.5, 20.5, back=True)
    way = np.concatenate([box(2.5, 30.5), box(2.5, 30.5)[:1], inner, inner[:1]])
    assert count(way) == 28**2 - 10**2
    # what lies in the hole is an island, and a contour around all of it changes nothing twice
    assert count(way, box(12.5, 14.5)) == 28**2 - 10**2 + 2**2


def test_overlapping_contours_are_joined_and_share_their_holes() -> None:
    assert count(box(2.5, 12.5), box(2.5, 12.5, right=5.0)) == 150
    assert count(box(2.5, 12.5), box(2.5, 12.5, right=5.0), box(8.5, 10.5)) == 150 - 4


@pytest.mark.parametrize("off", [0.0, 0.01, -0.05])
def test_a_contour_that_comes_again_counts_once(off: float) -> None:
    again = box(2.5 + off, 20.5 - off)[[2, 3, 0, 1]]
    assert count(box(2.5, 20.5), again) == pytest.approx(18**2, abs=1)
    assert count(box(2.5, 20.5), box(6.5, 10.5), again, box(6.5, 10.5)) == pytest.approx(
        18**2 - 16, abs=1
    )


def test_a_hole_may_touch_the_edge() -> None:
    assert count(box(2.5, 20.5), np.array([(2.5, 5.5), (8.5, 5.5), (8.5, 9.5), (2.5, 9.5)])) == (
        18**2 - 24
    )


def test_even_numbers_of_contours_are_outside_where_the_file_says_so() -> None:
    assert count(box(2.5, 12.5), box(2.5, 12.5, right=5.0), exclusive=True) == 100
    assert count(box(2.5, 12.5), box(2.5, 12.5), exclusive=True) == 0


# --- volumes ------------------------------------------------------------------------------

CENTRE = np.array([30.3, 29.8, 30.1])
TURNED = np.linalg.qr(np.array([[0.9, 0.2, 0.4], [-0.1, 1.0, 0.3], [-0.4, -0.2, 0.9]]))[0]


def circles(
    radii: NDArray[np.float64], heights: NDArray[np.float64], axes: NDArray[np.float64]
) -> list[Corners]:
    """Contours of a body of revolution around the third of the axes, at heights off its centre."""
    angles = np.linspace(0.0, 2.0 * np.pi, 180, endpoint=False)
    ring = np.column_stack([np.cos(angles), np.sin(angles), np.zeros(180)])
    made = zip(heights, radii, strict=True)
    return [(radius * ring + (0, 0, height)) @ axes.T + CENTRE for height, radius in made]


def volume_of(polygons: list[Corners], slice_step: float, *, free: bool = False) -> float:
    scan = Volume(
        np.zeros((int(60 / slice_step), 60, 60), np.int16), spacing=(1.0, 1.0, slice_step)
    )
    return float(filled("a", polygons, scan, free=free).mask.sum()) * slice_step


@pytest.mark.parametrize("offset", [0.0, 0.13, 0.5, 0.77])
@pytest.mark.parametrize("step", [1.0, 2.5, 4.0])
@pytest.mark.parametrize("slice_step", [0.8, 1.0, 3.0])
def test_balls_and_ellipsoids_have_their_volume(
    offset: float, step: float, slice_step: float
) -> None:
    for length in (20.0, 26.0):
        heights = np.arange(-length + (offset + 0.01) * step, length, step)
        polygons = circles(18.0 * np.sqrt(1.0 - (heights / length) ** 2), heights, np.eye(3))
        true = 4 / 3 * np.pi * 18.0**2 * length
        assert volume_of(polygons, slice_step) == pytest.approx(true, rel=0.03)


@pytest.mark.parametrize("offset", [0.0, 0.4])
@pytest.mark.parametrize("step", [1.0, 2.5, 4.0])
def test_bodies_drawn_aslant_have_their_volume(offset: float, step: float) -> None:
    heights = np.arange(-20.0 + (offset + 0.01) * step, 20.0, step)
    polygons = circles(18.0 * np.sqrt(1.0 - (heights / 20.0) ** 2), heights, TURNED)
    true = 4 / 3 * np.pi * 18.0**2 * 20.0
    assert volume_of(polygons, 2.0, free=True) == pytest.approx(true, rel=0.03)


@pytest.mark.parametrize("shift", [1.0, 6.0, 12.0])
def test_a_vessel_that_runs_sideways_keeps_its_volume(shift: float) -> None:
    # at 12 mm neighbouring contours of 10 mm do not overlap
    heights = np.arange(-8.0, 9.0, 4.0)
    polygons = [
        corners + np.array([shift * number - 2 * shift, 0.0, 0.0])
        for number, corners in enumerate(circles(np.full(len(heights), 5.0), heights, np.eye(3)))
    ]
    assert volume_of(polygons, 1.0) == pytest.approx(np.pi * 25.0 * 20.0, rel=0.03)


def test_a_gap_between_parts_is_not_filled() -> None:
    heights = np.array([-12.0, -11.0, -10.0, 5.0, 6.0, 7.0])
    polygons = circles(np.full(len(heights), 5.0), heights, np.eye(3))
    assert volume_of(polygons, 1.0) == pytest.approx(np.pi * 25.0 * 6.0, rel=0.03)


@pytest.mark.parametrize("heights", [(-20.0, 0.0), (-20.0, -12.0, 0.0), (-9.0, 0.0, 1.0)])
@pytest.mark.parametrize("axes", [np.eye(3), TURNED])
def test_lesions_of_one_slice_far_apart_are_no_tube(
    heights: tuple[float, ...], axes: NDArray[np.float64]
) -> None:
    polygons = circles(np.full(len(heights), 5.0), np.array(heights), axes)
    volume = volume_of(polygons, 1.0, free=axes is TURNED)
    assert volume == pytest.approx(np.pi * 25.0 * len(heights), rel=0.15)


def test_contours_that_are_regular_belong_together_however_thin_slices_are() -> None:
    # one of them is missing
    heights = np.array([-12.0, -8.0, -4.0, 0.0, 8.0, 12.0])
    polygons = circles(np.full(len(heights), 5.0), heights, np.eye(3))
    assert volume_of(polygons, 0.8) == pytest.approx(np.pi * 25.0 * 24.0, rel=0.03)


def test_what_is_thinner_than_a_slice_is_not_lost() -> None:
    polygons = circles(np.array([5.0]), np.array([1.5]), np.eye(3))
    polygons += circles(np.array([5.0]), np.array([2.0]), np.eye(3))
    assert volume_of(polygons, 5.0) == pytest.approx(np.pi * 25.0 * 5.0, rel=0.03)


def test_contours_far_beyond_the_scan_are_cut_off() -> None:
    far = [np.array([(-1e9, -1e9, z), (1e9, -1e9, z), (1e9, 1e9, z), (-1e9, 1e9, z)]) + 0.0 for z in
           (4.0, 5.0)]  # fmt: skip
    assert volume_of(far, 1.0) == 2 * 60 * 60
