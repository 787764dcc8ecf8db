"""Masks of known bodies, changed and grown; and the liver of a real scan from one click."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import SimpleITK
from numpy.typing import NDArray
from palpate.base.errors import EmptySegmentError, OptionError
from palpate.io.reading import read
from palpate.segmentation import mask_shape
from palpate.segmentation.operations import (
    Growing,
    changed_shape,
    grown,
    otsu,
    smoothed_together,
)
from palpate.volumes.volume import Volume, VolumeTraits

Mask = NDArray[np.bool_]

SPACING = (1.0, 1.5, 2.0)
"""x, y, z [mm]: no axis stands for another."""
SHAPE = (40, 52, 70)


def places() -> NDArray[np.float64]:
    """Returns the centre of each voxel, x, y, z [mm]."""
    z, y, x = np.indices(SHAPE)
    return np.stack([x, y, z], axis=-1) * SPACING


def ball(middle: tuple[float, float, float], radius: float) -> Mask:
    inside: Mask = np.linalg.norm(places() - middle, axis=-1) <= radius
    return inside


def volume_of(mask: Mask) -> float:
    return int(np.count_nonzero(mask)) * float(np.prod(SPACING))


def of_radius(radius: float) -> float:
    return 4.0 / 3.0 * np.pi * radius**3


MIDDLE = (35.0, 38.0, 40.0)
BALL = ball(MIDDLE, 20.0)


# --- masks ------------------------------------------------------------------------------


def test_the_distance_is_that_of_centres_whatever_the_spacing() -> None:
    mask = np.zeros(SHAPE, bool)
    mask[20, 25, 30] = True
    distance = mask_shape.distance_to(mask, SPACING)
    exact = np.linalg.norm(places() - (30 * 1.0, 25 * 1.5, 20 * 2.0), axis=-1)
    np.testing.assert_allclose(distance, exact, rtol=1e-5)
    assert np.isinf(mask_shape.distance_to(np.zeros(SHAPE, bool), SPACING)).all()
    assert not mask_shape.distance_to(np.ones(SHAPE, bool), SPACING).any()


@pytest.mark.parametrize("by", [6.0, 3.0, -3.0, -6.0])
def test_a_margin_makes_a_ball_of_another_radius(by: float) -> None:
    changed = mask_shape.margin(BALL, SPACING, by)
    # borders lie between centres, half a voxel at most from where they should be
    assert of_radius(20.0 + by - 1.0) < volume_of(changed) < of_radius(20.0 + by + 1.0)
    assert not (changed & ~ball(MIDDLE, 20.0 + by + 1e-6)).any() or by < 0.0


def test_a_body_that_the_scan_cuts_off_is_not_eaten_from_there() -> None:
    half = ball((35.0, 38.0, -1.0), 20.0)
    shrunk = mask_shape.margin(half, SPACING, -5.0)
    assert shrunk[0].any()
    assert mask_shape.margin(np.ones(SHAPE, bool), SPACING, -5.0).all()


def test_opening_parts_two_balls_at_their_bridge_and_closing_joins_them() -> None:
    two = ball((18.0, 38.0, 40.0), 12.0) | ball((52.0, 38.0, 40.0), 12.0)
    bridge = np.linalg.norm((places() - MIDDLE)[..., 1:], axis=-1) <= 3.0
    joined = two | (bridge & (np.abs(places()[..., 0] - 35.0) < 17.0))
    assert volume_of(mask_shape.keep_largest(joined)) == volume_of(joined)
    opened = mask_shape.opened(joined, SPACING, 4.0)
    assert not opened[:, :, 35].any()
    assert volume_of(opened) == pytest.approx(volume_of(two), rel=0.05)
    near = ball((22.0, 38.0, 40.0), 12.0) | ball((48.0, 38.0, 40.0), 12.0)
    closed = mask_shape.closed(near, SPACING, 6.0)
    assert closed[20, 25, 35]
    assert not (near & ~closed).any()


def test_islands_are_kept_by_size() -> None:
    large, small = ball((20.0, 38.0, 40.0), 14.0), ball((55.0, 38.0, 40.0), 6.0)
    speck = np.zeros(SHAPE, bool)
    speck[2, 2, 2] = True
    # touches the speck at a corner only, so it is an island of its own
    speck[3, 3, 3] = True
    mask = large | small | speck
    np.testing.assert_array_equal(mask_shape.keep_largest(mask), large)
    np.testing.assert_array_equal(mask_shape.keep_largest(mask, 2), large | small)
    np.testing.assert_array_equal(mask_shape.drop_small(mask, 2), large | small)
    count = int(np.count_nonzero(small))
    np.testing.assert_array_equal(mask_shape.drop_small(mask, count), large | small)
    np.testing.assert_array_equal(mask_shape.drop_small(mask, count + 1), large)


def test_holes_are_filled_and_dents_are_not() -> None:
    shell = BALL & ~ball(MIDDLE, 15.0)
    np.testing.assert_array_equal(mask_shape.filled(shell), BALL)
    pierced = shell & ~(np.linalg.norm((places() - MIDDLE)[..., :2], axis=-1) < 2.0)
    np.testing.assert_array_equal(mask_shape.filled(pierced), pierced)


@pytest.mark.parametrize(("thickness", "radii"), [(4.0, (16.0, 20.0)), (-4.0, (20.0, 24.0))])
def test_a_hollow_ball_is_a_shell(thickness: float, radii: tuple[float, float]) -> None:
    shell = mask_shape.hollow(BALL, SPACING, thickness)
    inner, outer = radii
    expected = of_radius(outer) - of_radius(inner)
    assert volume_of(shell) == pytest.approx(expected, rel=0.15)
    assert not (shell & BALL).any() if thickness < 0.0 else not (shell & ~BALL).any()


def test_segments_that_are_smoothed_together_still_meet() -> None:
    z, y, x = np.indices((24, 40, 40))
    off = np.sqrt((x - 20) ** 2 + (y - 20) ** 2 + (2 * (z - 12)) ** 2)
    # three parts of a ball that meet along its axis, with jagged borders
    jagged = np.arctan2(y - 20.5, x - 20.5) + 0.2 * ((z % 4) < 2)
    part = np.floor((jagged + np.pi) / (2.0 * np.pi / 3.0)).astype(int) % 3
    masks = [(off < 15) & (part == number) for number in range(3)]
    volume = Volume(np.zeros(off.shape, np.int16), spacing=(1.0, 1.0, 2.0))
    segments = [volume.segment(mask, name=name) for mask, name in zip(masks, "abc", strict=True)]
    smoothed = smoothed_together(segments, deviation=2.0)
    assert [each.name for each in smoothed] == ["a", "b", "c"]
    together = [each.mask() != 0 for each in smoothed]
    core = off < 11
    np.testing.assert_array_equal(sum(each.astype(int) for each in together)[core], 1)
    # their borders jag less from slice to slice
    jags = [
        sum(np.count_nonzero(np.diff(each.astype(np.int8), axis=0)[core[1:]]) for each in parts)
        for parts in (masks, together)
    ]
    assert jags[1] < 0.6 * jags[0]
    # one by one they leave a gap where they meet
    alone = [mask_shape.smooth(mask, volume.spacing, 2.0) for mask in masks]
    assert not np.logical_or.reduce(alone)[core].all()
    with pytest.raises(OptionError, match="share voxels"):
        smoothed_together([segments[0], segments[0]], deviation=2.0)
    with pytest.raises(OptionError, match="0 mm given"):
        smoothed_together(segments, deviation=0.0)


@pytest.mark.parametrize(("work", "size"), [(mask_shape.smooth, 2.0), (mask_shape.median, 3.0)])
def test_smoothing_takes_specks_and_keeps_the_body(work: Any, size: float) -> None:
    rng = np.random.default_rng(1)
    noisy = BALL ^ (rng.random(SHAPE) < 0.05)
    smooth = work(noisy, SPACING, size)
    assert np.count_nonzero(smooth ^ BALL) < 0.2 * np.count_nonzero(noisy ^ BALL)
    assert volume_of(smooth) == pytest.approx(volume_of(BALL), rel=0.05)


def test_an_empty_mask_stays_empty() -> None:
    nothing = np.zeros(SHAPE, bool)
    for changed in (
        mask_shape.margin(nothing, SPACING, 3.0),
        mask_shape.margin(nothing, SPACING, -3.0),
        mask_shape.filled(nothing),
        mask_shape.keep_largest(nothing),
        mask_shape.closed(nothing, SPACING, 3.0),
        mask_shape.smooth(nothing, SPACING, 3.0),
        mask_shape.hollow(nothing, SPACING, 3.0),
    ):
        assert changed.shape == SHAPE
        assert not changed.any()


# --- segments ---------------------------------------------------------------------------


def scan(
    *, noise: float = 10.0, slope: float = 1.0, origin: tuple[float, ...] = (0, 0, 0)
) -> Volume:
    """A ball of 60 HU, joined by a bridge to a plate of 60 HU, in fat of -90 HU."""
    rng = np.random.default_rng(2)
    solid = ball((25.0, 38.0, 40.0), 18.0)
    plate = places()[..., 0] > 58.0
    bridge = np.linalg.norm((places() - MIDDLE)[..., 1:], axis=-1) <= 5.0
    values = np.where(solid | plate | (bridge & (places()[..., 0] > 25.0)), 60.0, -90.0)
    values += rng.normal(0.0, noise, SHAPE)
    return Volume(
        np.round(values / slope).astype(np.int16),
        spacing=SPACING,
        origin=origin,
        slope=slope,
        traits=VolumeTraits(name="ball and plate", unit="HU"),
    )


def dice(first: Mask, second: Mask) -> float:
    both = np.count_nonzero(first & second)
    return 2.0 * both / (np.count_nonzero(first) + np.count_nonzero(second))


@pytest.mark.parametrize("slope", [1.0, -0.5])
def test_a_region_does_not_leak_over_a_bridge(slope: float) -> None:
    made = grown(scan(slope=slope), [(25.0, 38.0, 40.0)], name="ball")
    mask = made.mask() != 0
    assert not mask[:, :, 60:].any()
    assert dice(mask, ball((25.0, 38.0, 40.0), 18.0)) > 0.93
    # where narrow passages are entered, it does
    wide = Growing(passage=0.0)
    assert grown(scan(), [(25.0, 38.0, 40.0)], growing=wide).mask()[:, :, 65].any()


def test_a_region_that_becomes_too_large_is_held_by_wider_passages() -> None:
    most = 0.0015 * of_radius(18.0)
    held = grown(scan(), [(25.0, 38.0, 40.0)], growing=Growing(passage=0.0, most_ml=most))
    assert held.volume_ml <= most
    assert not held.mask()[:, :, 60:].any()
    with pytest.raises(OptionError, match="becomes larger than 5 ml; allowed"):
        grown(scan(), [(25.0, 38.0, 40.0)], growing=Growing(most_ml=5.0))


def test_seeds_are_points_of_the_patient_and_several_grow_together() -> None:
    moved = scan(origin=(100.0, -200.0, 30.0))
    one = grown(moved, [(125.0, -162.0, 70.0)])
    assert dice(one.mask() != 0, ball((25.0, 38.0, 40.0), 18.0)) > 0.93
    two = grown(moved, [(125.0, -162.0, 70.0), (164.0, -162.0, 70.0)])
    assert two.mask()[20, 25, 25]
    assert two.mask()[20, 25, 64]


def test_what_cannot_grow_is_refused() -> None:
    with pytest.raises(
        OptionError, match=r"seed 500, 0, 0 mm lies outside .* x from -?\d+ to \d+, y from"
    ):
        grown(scan(), [(500.0, 0.0, 0.0)])
    with pytest.raises(OptionError, match="no seed given"):
        grown(scan(), [])
    with pytest.raises(OptionError, match=r"spread 0 given; allowed: 0\.1 to 20"):
        grown(scan(), [(25.0, 38.0, 40.0)], growing=Growing(spread=0.0))


def grown_value(seed: tuple[float, float, float]) -> float:
    """Returns the value of the scan at a seed."""
    x, y, z = (int(c / edge) for c, edge in zip(seed, SPACING, strict=True))
    return float(scan().values()[z, y, x])


@pytest.mark.parametrize("beside", [0.0, 2.0])
def test_a_seed_that_lies_a_little_beside_what_is_in_range_grows_it(beside: float) -> None:
    values = np.full((40, 40, 40), -1000, np.int16)
    z, y, x = np.ogrid[:40, :40, :40]
    values[(z - 20) ** 2 + (y - 20) ** 2 + (x - 20) ** 2 <= 100] = 100
    volume = Volume(values, spacing=(1.0, 1.0, 1.0), traits=VolumeTraits(unit="HU"))
    made = grown(volume, [(20.0, 20.0, 30.0 + beside)], growing=Growing(range=(-400.0, 150.0)))
    assert made.voxel_count == np.count_nonzero(values == 100)


def test_a_seed_outside_of_the_range_is_told_with_its_value_and_the_range() -> None:
    inside, beside = (25.0, 38.0, 40.0), (4.0, 4.0, 4.0)
    value = scan().values()[4, 4, 4]
    wide = r"values around seed 25, 38, 40 mm are about \d+ HU; allowed: values of "
    with pytest.raises(EmptySegmentError, match=wide + "900 to 1000 HU, or another range"):
        grown(scan(), [inside], growing=Growing(range=(900.0, 1000.0)))
    # also where what is in range encloses the seed
    around = (value - 60.0, value + 10.0)
    with pytest.raises(EmptySegmentError, match=wide):
        grown(scan(), [inside], growing=Growing(range=around))
    # and beside one that is inside
    near = grown_value(inside)
    with pytest.raises(EmptySegmentError, match=r"values around seed 4, 4, 4 mm"):
        grown(scan(), [inside, beside], growing=Growing(range=(near - 40.0, near + 40.0)))


def test_work_can_be_stopped_between_its_steps() -> None:
    class StopError(Exception):
        pass

    def stop(what: str, _: float | None, /) -> None:
        if what.startswith("finding"):
            raise StopError

    with pytest.raises(StopError):
        grown(scan(), [(25.0, 38.0, 40.0)], progress=stop)


def test_otsu_parts_three_classes_at_their_valleys() -> None:
    levels = np.array([-1000.0, 50.0, 900.0])
    rng = np.random.default_rng(3)
    classes = rng.integers(0, 3, SHAPE)
    values = levels[classes] + rng.normal(0.0, 30.0, SHAPE)
    for slope in (1.0, -1.0):
        volume = Volume(np.round(slope * values).astype(np.int16), spacing=SPACING, slope=slope)
        found = otsu(volume, classes=3)
        assert [one.voxel_count for one in found] == [
            np.count_nonzero(classes == 1),
            np.count_nonzero(classes == 2),
        ]
        assert all(one.range is not None for one in found)
    (bright,) = otsu(scan(), classes=2)
    assert bright.range is not None
    assert -80.0 < bright.range[0] < 50.0
    with pytest.raises(OptionError, match="5 classes given; allowed: 2, 3, 4"):
        otsu(scan(), classes=5)


def test_shapes_are_changed_by_name_and_combined() -> None:
    volume = scan()
    first = volume.segment(ball((25.0, 38.0, 40.0), 15.0), name="first")
    second = volume.segment(ball((35.0, 38.0, 40.0), 15.0), name="second")
    masks = first.mask() != 0, second.mask() != 0
    for kind, expected in (
        ("unite", masks[0] | masks[1]),
        ("subtract", masks[0] & ~masks[1]),
        ("intersect", masks[0] & masks[1]),
    ):
        changed = changed_shape(first, kind, other=second)  # type: ignore[arg-type]
        np.testing.assert_array_equal(changed.mask() != 0, expected)
        assert changed.name == "first"
    bigger = changed_shape(first, "grow", amount=3.0)
    np.testing.assert_array_equal(bigger.mask() != 0, mask_shape.margin(masks[0], SPACING, 3.0))
    specks = first.mask()
    specks[0, 0, 0] = 1
    cleaned = changed_shape(volume.segment(specks, name="specks"), "drop-small", amount=0.01)
    np.testing.assert_array_equal(cleaned.mask(), first.mask())
    own = changed_shape(first.as_object(), "shrink", amount=3.0)
    assert own.has_own_grid
    with pytest.raises(OptionError, match="no other segment given"):
        changed_shape(first, "unite")
    with pytest.raises(OptionError, match="0 mm given; allowed: more than 0, up to 100 mm"):
        changed_shape(first, "grow", amount=0.0)
    elsewhere = scan(origin=(1.0, 0.0, 0.0)).segment(masks[1], name="other")
    with pytest.raises(OptionError, match="'other' stands on another grid than 'first'"):
        changed_shape(first, "unite", other=elsewhere)


@pytest.mark.data
@pytest.mark.parametrize(
    "click", [(-72.0, 260.0, 1200.0), (-50.0, 250.0, 1210.0), (-100.0, 280.0, 1190.0)]
)
def test_one_click_finds_the_liver(data_folder: Path, click: tuple[float, float, float]) -> None:
    folder = data_folder / "amos_0336"
    volume = read(folder / "amos_0336.mhd")
    labels = SimpleITK.ReadImage(str(folder / "labels_from_meshes.nii.gz"))
    liver = SimpleITK.GetArrayFromImage(labels) == 6
    found = grown(volume, [click])
    assert dice(found.mask() != 0, liver) >= 0.85
