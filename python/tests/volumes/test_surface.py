"""Surfaces tell what they keep of their voxels: volume and bodies."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from palpate.base.errors import EmptySegmentError, OptionError
from palpate.base.volume_text import volume_text
from palpate.volumes.scene import Scene, choose_segment
from palpate.volumes.segment import Segment
from palpate.volumes.surface import Surface
from palpate.volumes.volume import Volume
from scipy import ndimage

SIZE = (20, 20, 30)
ONE = np.s_[10, 9, 9]
LINE = np.s_[10, 9, 4:22]
SHEET = np.s_[10, 4:16, 4:24]
SPACING = (0.7, 0.8, 2.5)


def segment_of(
    mask: NDArray[np.uint8], spacing: tuple[float, float, float] = (1.0, 1.0, 1.0)
) -> Segment:
    return Volume(mask.astype(np.int16), spacing=spacing).segment(mask, name="thin")


def filled(*parts: Any, spacing: tuple[float, float, float] = (1.0, 1.0, 1.0)) -> Segment:
    mask = np.zeros(SIZE, np.uint8)
    for part in parts:
        mask[part] = 1
    return segment_of(mask, spacing)


def blocks() -> Segment:
    """Two blocks joined by a bridge of one voxel."""
    return filled(np.s_[4:14, 4:14, 4:12], np.s_[4:14, 4:14, 16:24], np.s_[7, 7, 12:16])


@pytest.mark.parametrize("part", [ONE, LINE, SHEET], ids=["voxel", "line", "sheet"])
@pytest.mark.parametrize("spacing", [(1.0, 1.0, 1.0), SPACING])
def test_without_smoothing_a_surface_is_the_voxels(part: Any, spacing: Any) -> None:
    report = Surface(filled(part, spacing=spacing), smoothing=0).report()
    assert report.volume == pytest.approx(report.voxel_volume, rel=1e-5)
    assert (report.bodies, report.voxel_bodies, report.warnings) == (1, 1, ())


@pytest.mark.parametrize("part", [ONE, LINE, SHEET], ids=["voxel", "line", "sheet"])
@pytest.mark.parametrize("spacing", [(1.0, 1.0, 1.0), SPACING])
def test_what_is_thin_keeps_its_volume(part: Any, spacing: Any) -> None:
    thin = filled(part, spacing=spacing)
    for segment in (thin, thin.volume.threshold(0.5), thin.volume.threshold(1)):
        report = Surface(segment).report()
        assert report.volume == pytest.approx(report.voxel_volume, rel=0.01)
        assert (report.bodies, report.voxel_bodies, report.warnings) == (1, 1, ())
        assert report.thin.volume == pytest.approx(report.volume, rel=1e-3)


@pytest.mark.parametrize("off", [(0.0, 0.0), (0.25, 0.0), (0.3, 0.4), (0.5, 0.5)])
def test_a_vessel_with_partial_volume_has_its_volume(off: tuple[float, float]) -> None:
    """1.6 mm across and 18 mm long, on voxels of 1 mm: 36.2 mm³."""
    fine = (np.arange(11 * 20) + 0.5) / 20 - 5.5
    inside = (fine - off[0]) ** 2 + (fine[:, None] - off[1]) ** 2 <= 0.8**2
    values = np.zeros((24, 11, 11), np.int16)
    values[3:21] = np.round(1000.0 * inside.reshape(11, 20, 11, 20).mean((1, 3)))
    report = Surface(Volume(values, spacing=(1.0, 1.0, 1.0)).threshold(500)).report()
    assert report.volume == pytest.approx(np.pi * 0.8**2 * 18.0, rel=0.05)
    assert report.expected_volume == pytest.approx(np.pi * 0.8**2 * 18.0, rel=0.02)
    # whole voxels say 18, 36 or 72 mm³
    differs = abs(report.voxel_volume / report.volume - 1.0) > 0.05
    assert differs == bool(report.warnings)
    assert not differs or "by the scan's values they stand for 36." in report.warnings[0]


def test_a_thin_part_that_a_step_leaves_out_is_told_with_its_place() -> None:
    mask = np.zeros(SIZE, np.uint8)
    mask[4:14, 4:14, 4:14] = mask[7, 7, 14:24] = 1
    volume = Volume(mask.astype(np.int16), spacing=(1.0, 1.0, 1.0), origin=(-50.0, 20.0, 0.0))
    segment = volume.segment(mask, name="rod")
    assert Surface(segment).report().warnings == ()
    report = Surface(segment, step=2).report()
    assert (report.bodies, report.voxel_bodies) == (1, 1)
    x, y, z = report.thin.changed_most_at or (0.0, 0.0, 0.0)
    assert (y, z) == (27.0, 7.0)
    assert -36.0 < x < -26.0
    told = " ".join(report.warnings)
    assert "1 of 1 thin parts of 'rod' changes by more than 5%, most by -9 mm³ at (" in told


def test_bodies_are_those_that_scipy_finds() -> None:
    random = np.random.default_rng(5)
    eighteen = ndimage.generate_binary_structure(3, 2)
    for share in (0.03, 0.1, 0.4):
        mask = (random.random(SIZE) < share).astype(np.uint8)
        expected = ndimage.label(mask, eighteen)[1]
        for smoothing in (0, 3):
            report = Surface(segment_of(mask), smoothing=smoothing).report()
            assert (report.bodies, report.voxel_bodies) == (expected, expected)


def test_edges_where_voxels_touch_are_told() -> None:
    report = Surface(filled(np.s_[4, 4, 4], np.s_[4, 5, 5]), smoothing=0).report()
    assert (report.bodies, report.touching_edges) == (1, 1)
    assert "touch at 1 edge " in report.warnings[0]


def test_a_step_that_parts_a_body_is_told() -> None:
    fine, coarse = (Surface(blocks(), step=step).report() for step in (1, 2))
    assert (fine.voxel_bodies, fine.bodies, fine.warnings) == (1, 1, ())
    assert (coarse.voxel_bodies, coarse.bodies) == (1, 2)
    assert "has 2 bodies, its voxels 1 body" in coarse.warnings[-1]


def test_a_line_that_a_step_leaves_nothing_of_is_called_too_thin() -> None:
    with pytest.raises(EmptySegmentError, match="too thin for this step: none of its 18 voxels"):
        Surface(filled(LINE), step=2).mesh()


def test_volumes_are_said_in_three_digits() -> None:
    told = [volume_text(volume) for volume in (0.1234, 36.19, 999.0, 1028.0, 25_000.0, 1_234_567.0)]
    assert told == ["0.123 mm³", "36.2 mm³", "999 mm³", "1.03 ml", "25.0 ml", "1235 ml"]


def test_segments_are_chosen_by_name_or_number() -> None:
    scene = Scene(blocks().volume)
    made = [blocks(), filled(LINE), filled(ONE)]
    for segment, name in zip(made, ("a", "b", "b"), strict=True):
        scene.add(segment.part_of(scene.volume, name=name))
    counts = [choose_segment(scene, name).voxel_count for name in ("a", "1", "2", "3")]
    assert counts == [made[0].voxel_count, made[0].voxel_count, 18, 1]
    with pytest.raises(OptionError, match="2 segments are called 'b'; allowed: a number, 2 or 3"):
        choose_segment(scene, "b")
    for wrong in (None, "c", "0", "4"):
        with pytest.raises(OptionError, match="allowed: a name or a number of 1 a, 2 b, 3 b"):
            choose_segment(scene, wrong)
