"""Lengths and volumes that are equal to whole numbers of voxels but for rounding are equal."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from palpate.base.errors import OptionError
from palpate.segmentation import mask_shape
from palpate.segmentation.lengths_in_voxels import (
    least_voxels,
    most_voxels,
    nearest_voxels,
    whole_voxels,
    within,
)
from palpate.segmentation.operations import changed_shape
from palpate.segmentation.slice_interpolation import between_slices
from palpate.volumes.volume import Volume
from scipy import ndimage

Mask = NDArray[np.bool_]

SIDES = [0.2, 0.3, 0.35, 0.4, 0.6, 0.7, 0.8, 1.0, 1.1, float(np.float32(0.8)), 2.5, 3.0]

few = settings(max_examples=60, deadline=None)
spacings = st.tuples(*[st.sampled_from(SIDES)] * 3)


def cube(edge: int, around: int) -> Mask:
    mask = np.zeros((edge + 2 * around,) * 3, bool)
    mask[(slice(around, around + edge),) * 3] = True
    return mask


def ends_of(mask: Mask) -> list[tuple[int, int]]:
    return [(int(axis.min()), int(axis.max())) for axis in np.nonzero(mask)]


@st.composite
def blobs(draw: st.DrawFn) -> Mask:
    """Bodies of several boxes, some of which the grid cuts off."""
    mask = np.zeros((9, 11, 13), bool)
    for _ in range(draw(st.integers(1, 4))):
        low = [draw(st.integers(0, edge - 1)) for edge in mask.shape]
        mask[tuple(slice(at, at + draw(st.integers(1, 6))) for at in low)] = True
    return mask


# --- at equality ------------------------------------------------------------------------


def test_a_margin_of_whole_voxels_is_so_many_on_each_side() -> None:
    body = cube(7, 4)
    assert ends_of(mask_shape.margin(body, (0.8,) * 3, 1.6)) == [(2, 12)] * 3
    assert ends_of(mask_shape.margin(body, (0.8,) * 3, -0.8)) == [(5, 9)] * 3


def test_four_hundred_spacings_and_margins_grow_to_both_sides() -> None:
    for hundredths in range(5, 105, 5):
        for steps in range(1, 21):
            side, by = hundredths / 100, hundredths * steps / 100
            body = np.zeros((1, 1, 2 * steps + 9), bool)
            body[..., steps + 1 : -steps - 1] = True
            grown_ = mask_shape.margin(body, (side, side, side), by)
            assert ends_of(grown_)[2] == (1, 2 * steps + 7), (side, by)
            assert np.array_equal(mask_shape.margin(grown_, (side,) * 3, -by), body), (side, by)


def test_a_cube_is_its_own_closing_and_an_opening_adds_nothing() -> None:
    body = cube(11, 4)
    np.testing.assert_array_equal(mask_shape.closed(body, (0.4,) * 3, 0.4), body)
    opened = mask_shape.opened(cube(9, 4), (0.8,) * 3, 0.8)
    assert np.count_nonzero(opened) == 637


@few
@given(blobs(), st.sampled_from(SIDES), st.integers(1, 4))
def test_on_equal_sides_balls_are_those_of_scipy(body: Mask, side: float, steps: int) -> None:
    reach = np.arange(-steps, steps + 1)
    ball = sum(axis**2 for axis in np.meshgrid(reach, reach, reach)) <= steps**2
    spacing, by = (side,) * 3, round(side * steps, 6)
    expected = ndimage.binary_dilation(body, ball)
    np.testing.assert_array_equal(mask_shape.margin(body, spacing, by), expected)
    # what lies beyond the border counts as what lies at it
    eroded = ndimage.binary_erosion(body, ball, border_value=1)
    np.testing.assert_array_equal(mask_shape.margin(body, spacing, -by), eroded)
    opened = ndimage.binary_dilation(eroded, ball)
    np.testing.assert_array_equal(mask_shape.opened(body, spacing, by), opened)
    closed = ndimage.binary_erosion(expected, ball, border_value=1)
    np.testing.assert_array_equal(mask_shape.closed(body, spacing, by), closed)


@few
@given(spacings, st.floats(0.2, 7.0), st.integers(0, 2), st.integers(1, 4))
def test_dilation_is_symmetric(
    spacing: tuple[float, ...], by: float, axis: int, whole: int
) -> None:
    for length in (by, spacing[axis] * whole):
        point = np.zeros((15, 17, 19), bool)
        point[7, 8, 9] = True
        ball = mask_shape.margin(point, spacing, length)
        for flipped in range(3):
            np.testing.assert_array_equal(ball, np.flip(ball, flipped))


@few
@given(blobs(), spacings, st.floats(0.2, 6.0), st.integers(0, 2), st.integers(0, 3))
def test_opening_lies_in_the_body_and_that_in_closing_and_both_are_idempotent(
    body: Mask, spacing: tuple[float, ...], by: float, axis: int, whole: int
) -> None:
    radius = spacing[axis] * whole or by
    opened = mask_shape.opened(body, spacing, radius)
    closed = mask_shape.closed(body, spacing, radius)
    assert not (opened & ~body).any()
    assert not (body & ~closed).any()
    np.testing.assert_array_equal(mask_shape.opened(opened, spacing, radius), opened)
    np.testing.assert_array_equal(mask_shape.closed(closed, spacing, radius), closed)


@few
@given(spacings, st.floats(0.2, 5.0))
def test_borders_are_within_half_a_voxel_of_the_true_offset(
    spacing: tuple[float, ...], by: float
) -> None:
    body = np.zeros((24, 26, 28), bool)
    body[8:16, 9:17, 10:18] = True
    sides = np.array(spacing[::-1])
    centre, half = np.array([12.0, 13.0, 14.0]) * sides, 4.0 * sides
    away = np.abs((np.moveaxis(np.indices(body.shape), 0, -1) + 0.5) * sides - centre) - half
    outside = np.linalg.norm(np.maximum(away, 0.0), axis=-1)
    diagonal = 0.5 * float(np.linalg.norm(sides))
    grown_ = mask_shape.margin(body, spacing, by)
    assert grown_[outside <= by - diagonal].all()
    assert not grown_[outside > by * (1 + 1e-6)].any()
    # to a face it is half of the side there
    depth = -away / sides
    kept = mask_shape.margin(body, spacing, -by)
    assert kept[(depth > by / sides + 0.5 + 1e-5).all(axis=-1)].all()
    assert not kept[(depth < by / sides - 0.5 - 1e-5).any(axis=-1)].any()


@pytest.mark.parametrize("spacing", [(0.7, 0.7, 2.5), (0.3, 0.3, 0.3)])
def test_squared_distances_are_the_same_far_from_the_origin(spacing: tuple[float, ...]) -> None:
    mask = np.zeros((3, 3, 900), bool)
    mask[1, 1, ::9] = True
    squared = mask_shape.squared_distance_to(mask, spacing)
    np.testing.assert_array_equal(squared[..., :9], squared[..., 882:891])


@pytest.mark.parametrize("by", [0.4, 2.0, 13.0, 60.0])
def test_margins_are_the_same_however_many_layers_are_worked_on_at_once(by: float) -> None:
    body = np.random.default_rng(1).random((150, 9, 11)) < 0.002
    spacing = (0.8, 1.1, 0.4)
    whole = within(mask_shape.squared_distance_to(body, spacing), by)
    np.testing.assert_array_equal(mask_shape.margin(body, spacing, by), whole)
    np.testing.assert_array_equal(mask_shape.margin(~body, spacing, -by), ~whole)


def test_islands_of_just_the_least_volume_stay() -> None:
    volume = Volume(np.zeros((14, 14, 14), np.int16), spacing=(0.7, 0.7, 0.7))
    thousand = np.zeros(volume.shape, bool)
    thousand[2:12, 2:12, 2:12] = True
    island = volume.segment(thousand, name="island")
    assert changed_shape(island, "drop-small", amount=0.343).voxel_count == 1000
    assert changed_shape(island, "drop-small", amount=0.3434).voxel_count == 0


def test_voxels_are_counted_without_the_rounding_of_their_sides() -> None:
    for side in SIDES:
        for count in range(1, 200):
            length, ml = round(count * side, 6), round(count * side**3, 9) / 1000
            assert whole_voxels(length, side) == count
            assert nearest_voxels(length + side / 2, side) == count + 1
            assert least_voxels(ml, side**3) == most_voxels(ml, side**3) == count


def test_a_median_counts_half_a_voxel_as_one() -> None:
    # 1.2 / 0.8 is a little less than a half more than 1
    speck = cube(3, 6)
    assert not mask_shape.median(speck, (0.8,) * 3, 1.2).any()


# --- ties -------------------------------------------------------------------------------


def test_slices_between_are_mirrored_with_those_that_were_painted() -> None:
    rng = np.random.default_rng(4)
    for spacing in [(0.7, 0.7, 3.0), (0.3, 0.9, 1.0)]:
        painted = np.zeros((7, 20, 24), bool)
        painted[0] = ndimage.binary_dilation(rng.random((20, 24)) < 0.02, iterations=3)
        painted[6] = ndimage.binary_dilation(rng.random((20, 24)) < 0.02, iterations=3)
        filled = between_slices(painted, spacing)
        for axis in range(3):
            mirrored = between_slices(np.flip(painted, axis), spacing)
            np.testing.assert_array_equal(np.flip(mirrored, axis), filled)


# --- what a grid cannot express ---------------------------------------------------------


def segment_of(mask: Mask, spacing: tuple[float, ...] = (1.0, 1.0, 3.0)) -> Any:
    return Volume(np.zeros(mask.shape, np.int16), spacing=spacing).segment(mask, name="body")


@pytest.mark.parametrize("kind", ["grow", "shrink", "open", "close"])
def test_a_length_of_less_than_a_voxel_along_an_axis_is_told(kind: Any) -> None:
    changed = changed_shape(segment_of(cube(9, 4)), kind, amount=2.0)
    assert changed.warnings == (f"{kind} by 2 mm changes nothing along z (voxels of 3 mm)",)
    assert changed_shape(segment_of(cube(9, 4)), kind, amount=3.0).warnings == ()
    # and stays told after a next change
    again = changed_shape(changed, "fill-holes")
    assert again.warnings == changed.warnings


def test_a_median_that_changes_nothing_along_an_axis_is_told() -> None:
    (told,) = changed_shape(segment_of(cube(9, 4)), "median", amount=1.4).warnings
    assert told == "median by 1.4 mm changes nothing along z (voxels of 3 mm)"
    assert changed_shape(segment_of(cube(9, 4)), "median", amount=1.5).warnings == ()


@few
@given(blobs(), spacings, st.floats(0.2, 4.0), st.sampled_from(["inside", "outside"]))
def test_a_shell_encloses(
    body: Mask, spacing: tuple[float, ...], thickness: float, side: str
) -> None:
    body = np.pad(body, 4)
    thickness = max(thickness, min(spacing))
    kind: Any = f"hollow-{side}"
    shell = changed_shape(segment_of(body, spacing), kind, amount=thickness).mask() != 0
    within = body & ~shell
    # no way over faces leads out
    parts, _ = ndimage.label(~shell)
    assert parts[0, 0, 0] not in np.unique(parts[within])
    assert side == "inside" or within.sum() == body.sum()


def test_a_shell_is_told_where_it_is_another_than_was_asked_for() -> None:
    thin = changed_shape(segment_of(cube(9, 4)), "hollow-inside", amount=2.0)
    assert thin.warnings == (
        "a shell of 2 mm is one voxel thick, so that it encloses, along z (voxels of 3 mm)",
    )
    cut = np.zeros((9, 9, 9), bool)
    cut[:7, 2:7, 2:7] = True
    (told,) = changed_shape(segment_of(cut, (1.0,) * 3), "hollow-inside", amount=1.0).warnings
    assert told == "the segment reaches the border of its grid: its shell is open there"
    (told,) = changed_shape(segment_of(cube(5, 1)), "hollow-outside", amount=3.0).warnings
    assert told == "the shell reaches the border of its grid: it is thinner there"
    (told,) = changed_shape(segment_of(cube(5, 4), (1.0,) * 3), "hollow-inside", amount=3).warnings
    assert told.startswith("nothing is hollow: the segment is nowhere thicker than two walls")
    with pytest.raises(OptionError, match=r"shell of 0\.5 mm given; allowed: .* at least, 1 mm"):
        changed_shape(segment_of(cube(5, 4)), "hollow-inside", amount=0.5)
