"""Regions that grow with default settings: crisp balls, leaks that are told, and laws."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from file_cases import bright_middle, case_input
from numpy.typing import NDArray
from palpate.base.errors import OptionError
from palpate.bench.growing import crisp_ball
from palpate.io.reading import read
from palpate.segmentation import mask_shape
from palpate.segmentation.growing.levels import USUAL
from palpate.segmentation.operations import Growing, grow_levels, grown
from palpate.volumes.volume import Volume


def middle_of(volume: Volume) -> tuple[float, float, float]:
    grid = 0.5 * np.array(volume.dimensions)
    x, y, z = volume.patient_from_grid[:3, :3] @ grid + volume.patient_from_grid[:3, 3]
    return float(x), float(y), float(z)


def dice(first: NDArray[np.bool_], second: NDArray[np.bool_]) -> float:
    both = np.count_nonzero(first & second)
    return 2.0 * both / (np.count_nonzero(first) + np.count_nonzero(second))


@pytest.mark.parametrize("noise", [0.0, 5.0])
@pytest.mark.parametrize("spacing", [(1.0, 1.0, 1.0), (1.0, 1.0, 1.5), (0.7, 0.7, 2.5)])
@pytest.mark.parametrize("radius", [3.0, 5.0, 9.0])
def test_crisp_balls_keep_their_volume(
    radius: float, spacing: tuple[float, float, float], noise: float
) -> None:
    volume, ball = crisp_ball(radius, spacing, noise=noise)
    found = grown(volume, [middle_of(volume)]).mask() != 0
    assert np.count_nonzero(found) == pytest.approx(np.count_nonzero(ball), rel=0.05)
    assert dice(found, ball) > 0.95


def test_a_large_crisp_ball_keeps_its_volume_from_any_seed() -> None:
    volume, ball = crisp_ball(20.0, (1.0, 1.0, 1.5), noise=5.0)
    x, y, z = middle_of(volume)
    for seed in ((x, y, z), (x + 12.0, y - 6.0, z + 3.0)):
        found = grown(volume, [seed]).voxel_count
        assert found == pytest.approx(np.count_nonzero(ball), rel=0.05)


@pytest.mark.data
@pytest.mark.parametrize("noise", [0, 5])
@pytest.mark.parametrize(("radius", "right"), [(10, 2766), (16, 11370)])
def test_case_16_keeps_the_border(data_folder: Path, radius: int, right: int, noise: int) -> None:
    case = case_input(data_folder, 16)
    volume = read(case / f"ball{radius}_noise{noise}.nii.gz")
    seed = bright_middle(volume)
    found = grown(volume, [seed.tolist()]).voxel_count
    assert found == pytest.approx(right, rel=0.05)


def two_balls(neck: float) -> Volume:
    """Two balls of 14 mm whose middles are 44 mm apart, joined by a tube of this radius."""
    z, y, x = np.indices((44, 44, 92)).astype(float)
    off = np.minimum(abs(x - 24.0), abs(x - 68.0)) ** 2 + (y - 22.0) ** 2 + (z - 22.0) ** 2
    tube = ((y - 22.0) ** 2 + (z - 22.0) ** 2 <= neck**2) & (abs(x - 46.0) < 22.0)
    noise = np.random.default_rng(3).normal(0.0, 4.0, x.shape)
    return Volume(
        np.rint(100.0 * ((off <= 14.0**2) | tube) + noise).astype(np.int16), spacing=(1.0, 1.0, 1.0)
    )


def test_a_leak_through_a_wide_neck_is_told_and_through_a_narrow_one_closed() -> None:
    seed = (24.5, 22.5, 22.5)
    with pytest.raises(OptionError, match=r"would leak: .*; allowed: "):
        grown(two_balls(7.0), [seed])
    alone = grown(two_balls(2.5), [seed]).mask() != 0
    assert not alone[:, :, 50:].any()
    assert np.count_nonzero(alone) == pytest.approx(4.0 / 3.0 * np.pi * 14.0**3, rel=0.08)


def test_noise_alone_is_told() -> None:
    noise = np.random.default_rng(4).normal(0.0, 20.0, (40, 40, 40))
    with pytest.raises(OptionError, match="allowed"):
        grown(Volume(noise.astype(np.int16), spacing=(1.0, 1.0, 1.0)), [(20.0, 20.0, 20.0)])


def test_regions_hold_their_seed_hang_together_and_are_the_same_again_and_elsewhere() -> None:
    volume, _ = crisp_ball(8.0, (0.9, 1.1, 1.7), noise=8.0)
    x, y, z = middle_of(volume)
    seed = (x + 2.0, y - 3.0, z)
    found = grown(volume, [seed]).mask() != 0
    grid = np.floor(np.linalg.inv(volume.patient_from_grid) @ [*seed, 1.0]).astype(int)
    assert found[grid[2], grid[1], grid[0]]
    np.testing.assert_array_equal(found, mask_shape.keep_largest(found))
    np.testing.assert_array_equal(found, grown(volume, [seed]).mask() != 0)
    # voxels around the seed that were farther along all axes
    moved = Volume(np.pad(volume.array, ((3, 0), (2, 0), (5, 0)), "wrap"), spacing=volume.spacing)
    offset = np.array([5 * 0.9, 2 * 1.1, 3 * 1.7])
    again = grown(moved, [tuple(np.array(seed) + offset)]).mask() != 0
    np.testing.assert_array_equal(again[3:, 2:, 5:], found)


def test_a_spread_or_a_passage_that_is_given_counts() -> None:
    volume = two_balls(7.0)
    seed = (24.5, 22.5, 22.5)
    both = grown(volume, [seed], growing=Growing(spread=8.0, passage=4.0)).mask() != 0
    assert both[22, 22, 68]
    one = grown(volume, [seed], growing=Growing(spread=8.0, passage=20.0)).mask() != 0
    assert not one[22, 22, 68]


def test_a_body_with_a_bright_core_is_found_from_around_the_core() -> None:
    volume, ball = crisp_ball(14.0, (1.0, 1.0, 1.0))
    _, core = crisp_ball(5.0, (1.0, 1.0, 1.0))
    values = 3 * volume.array
    values[tuple(slice(9, -9) for _ in range(3))][core] = 900
    x, y, z = middle_of(volume)
    both = Volume(values, spacing=volume.spacing)
    found = grown(both, [(x + 9.0, y, z)]).voxel_count
    assert found == pytest.approx(np.count_nonzero(ball), rel=0.05)


def vessel_between_chambers() -> tuple[Volume, NDArray[np.bool_], NDArray[np.bool_]]:
    """A bent vessel of 8 mm radius that opens into chambers of 20 mm, and both as voxels."""
    z, y, x = np.indices((200, 50, 60)) * 1.2 + 0.6
    bend = 36.0 + 8.0 * np.sin(z / 30.0)
    ends = [(z - end) ** 2 + (y - 30.0) ** 2 + (x - bend) ** 2 <= 20.0**2 for end in (25.0, 215.0)]
    chambers = ends[0] | ends[1]
    vessel = (np.hypot(y - 30.0, x - bend) <= 8.0) & (abs(z - 120.0) <= 95.0) & ~chambers
    noise = np.random.default_rng(5).normal(0.0, 6.0, x.shape)
    values = 50.0 + 200.0 * (vessel | chambers) + noise
    return Volume(np.rint(values).astype(np.int16), spacing=(1.2, 1.2, 1.2)), vessel, chambers


def test_a_vessel_is_found_up_to_the_chambers_that_it_opens_into() -> None:
    volume, vessel, chambers = vessel_between_chambers()
    for z in (90.0, 140.0):
        grid = np.array([36.0 + 8.0 * np.sin(z / 30.0), 30.0, z]) / 1.2
        x, y, height, _ = volume.patient_from_grid @ [*grid, 1.0]
        found = grown(volume, [(float(x), float(y), float(height))]).mask() != 0
        assert dice(found, vessel) > 0.85
        assert np.count_nonzero(found & chambers) < 0.1 * np.count_nonzero(chambers)


def test_a_click_into_a_chamber_gives_the_chamber_without_its_vessel() -> None:
    volume, vessel, chambers = vessel_between_chambers()
    grid = np.array([36.0 + 8.0 * np.sin(25.0 / 30.0), 30.0, 25.0]) / 1.2
    x, y, z, _ = volume.patient_from_grid @ [*grid, 1.0]
    found = grown(volume, [(float(x), float(y), float(z))]).mask() != 0
    chambers[100:] = False
    assert dice(found, chambers) > 0.9
    assert np.count_nonzero(found & vessel) < 0.1 * np.count_nonzero(vessel)


def test_wider_ranges_hold_narrower_ones_and_the_seed_and_the_usual_one_is_what_is_grown() -> None:
    volume, _ = crisp_ball(10.0, (1.0, 1.1, 1.6), noise=8.0)
    seed = middle_of(volume)
    levels = grow_levels(volume, seed)
    least, most = levels.ends
    assert least < USUAL <= most
    masks = [levels.mask(level) for level in (least, (least + USUAL) // 2, USUAL, most)]
    assert all(not np.any(narrow & ~wide) for narrow, wide in pairwise(masks))
    assert np.count_nonzero(masks[0]) < np.count_nonzero(masks[2])
    assert all(mask[levels.seeds[0]] for mask in masks)
    usual = np.zeros(volume.shape, bool)
    usual[levels.box] = masks[2]
    np.testing.assert_array_equal(usual, grown(volume, [seed]).mask() != 0)


def test_a_vessel_beside_a_body_of_nearly_its_values_does_not_give_the_body() -> None:
    z, y, x = np.indices((60, 60, 70)).astype(float)
    body = (z - 30.0) ** 2 + (y - 30.0) ** 2 + (x - 30.0) ** 2 <= 24.0**2
    vessel = (np.hypot(y - 30.0, x - 52.0) <= 5.0) & (abs(z - 30.0) < 22.0) & ~body
    noise = np.random.default_rng(6).normal(0.0, 3.0, x.shape)
    values = 100.0 * body + 130.0 * vessel + noise
    volume = Volume(np.rint(values).astype(np.int16), spacing=(2.0, 2.0, 2.0))
    place = volume.patient_from_grid @ [54.5, 30.5, 40.5, 1.0]
    found = grown(volume, [tuple(float(c) for c in place[:3])]).mask() != 0
    assert np.count_nonzero(found & vessel) > np.count_nonzero(found & body)
    assert np.count_nonzero(found & body) < 0.05 * np.count_nonzero(body)


def test_work_tells_how_far_it_is_and_ends_where_a_person_stops_it() -> None:
    volume, _ = crisp_ball(10.0, (1.0, 1.0, 1.0), noise=5.0)
    shares: list[float] = []

    def stop(_: str, share: float | None) -> None:
        if share is not None:
            shares.append(share)
        if len(shares) == 3:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        grown(volume, [middle_of(volume)], progress=stop)
    assert len(shares) == 3
    assert all(0.0 <= share < 1.0 for share in shares)
