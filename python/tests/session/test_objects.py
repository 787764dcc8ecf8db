"""Segments as objects: moved, in the hand, parted, and the gap between them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from palpate import (
    OptionError,
    Scene,
    ScriptedPath,
    Segment,
    Session,
    SessionOptions,
    TouchSettings,
    Volume,
)

SPACING = (1.0, 1.0, 1.5)
SHAPE = (40, 48, 48)
OFFLINE = SessionOptions(real_time=False)


def balls() -> Scene:
    """Returns two balls of radius 6 and 9 mm at (14, 24, 30) and (34, 24, 30)."""
    z, y, x = np.indices(SHAPE)
    points = np.stack([x * SPACING[0], y * SPACING[1], z * SPACING[2]], axis=-1)
    values = np.zeros(SHAPE, np.int16)
    for value, radius, middle in [(100, 6.0, (14, 24, 30)), (200, 9.0, (34, 24, 30))]:
        values[np.linalg.norm(points - middle, axis=-1) <= radius] = value
    volume = Volume(values, spacing=SPACING)
    return Scene(volume, [volume.threshold(50, 150, name="a"), volume.threshold(150, name="b")])


def shifted(x: float, y: float, z: float) -> NDArray[np.float64]:
    pose = np.eye(4)
    pose[:3, 3] = x, y, z
    return pose


def test_the_gap_follows_a_segment_to_where_it_stands() -> None:
    with Session(balls(), options=OFFLINE) as session:
        gap = session.gap(1, 2)
        # half a voxel
        assert gap.minimum == pytest.approx(5.0, abs=0.75)
        assert gap.overlap == 0.0
        session.move_segment(1, shifted(-4.0, 0.0, 0.0))
        session.let_pass(0.2)
        moved = session.gap(1, 2)
        # the same stairs, four voxels farther
        assert moved.minimum == pytest.approx(gap.minimum + 4.0, abs=0.1)
        session.move_segment(1, shifted(20.0, 0.0, 0.0))
        session.let_pass(0.2)
        inside = session.gap(1, 2)
        assert inside.minimum == 0.0
        volume = session.segment(1).volume_ml * 1000.0
        assert inside.overlap == pytest.approx(volume, rel=0.02)


def test_a_gap_from_nothing_is_refused() -> None:
    with Session(balls(), options=OFFLINE) as session:
        with pytest.raises(OptionError, match="9"):
            session.gap(1, 9)
        session.fill_box(1, low=(0, 0, 0), high=(48, 48, 40), solid=False)
        with pytest.raises(OptionError, match="empty"):
            session.gap(1, 2)


def test_a_session_with_a_grabbed_segment_is_replayed_bit_for_bit() -> None:
    start, above = np.array([14.0, 24.0, 55.0]), np.array([14.0, 24.0, 38.0])
    path = (
        ScriptedPath(start)
        .move(above, seconds=0.3)
        .move(above + np.array([6.0, 0.0, 0.0]), seconds=0.3)
        .move(above + np.array([14.0, 2.0, -8.0]), seconds=0.5)
        .hold(0.3)
    )
    with Session(balls(), device=path, options=OFFLINE) as session:
        session.start_recording()
        session.let_pass(0.32)
        session.grab(1, collides=True)
        session.let_pass(0.4)
        session.turn_grabbed([0.0, 0.3, 0.0])
        session.let_pass(0.2)
        frame = session.frame()
        assert frame["grabbed"] == 1
        [moved] = frame["poses"]
        assert moved["id"] == 1
        session.grab(None)
        session.let_pass(0.4)
        recording = session.stop_recording()
    turned = np.reshape(moved["pose"], (4, 4))
    assert not np.allclose(turned, np.eye(4), atol=0.1)
    again = recording.replay()
    assert again.is_equal
    assert again.stopped == ""


def test_a_cut_makes_two_of_one_and_undo_one_of_two() -> None:
    with Session(balls(), options=OFFLINE) as session:
        whole = session.segment(2).mask()
        part = session.cut(2, (34.0, 24.0, 30.0), (0.0, 0.0, 1.0))
        below, above = session.segment(2).mask(), session.segment(part).mask()
        np.testing.assert_array_equal(below | above, whole)
        assert not (below & above).any()
        assert not below[21:].any()
        assert not above[:20].any()
        session.undo()
        np.testing.assert_array_equal(session.segment(2).mask(), whole)
        assert len(session.segments()) == 2
        with pytest.raises(OptionError, match="one side"):
            session.cut(2, (0.0, 0.0, 0.0), (0.0, 0.0, 1.0))
        with pytest.raises(OptionError, match="normal"):
            session.cut(2, (34.0, 24.0, 30.0), (0.0, 0.0, 0.0))


def test_what_cannot_be_grabbed_is_refused() -> None:
    with Session(balls(), options=OFFLINE) as session:
        with pytest.raises(OptionError, match="7"):
            session.grab(7)
        with pytest.raises(OptionError, match="turn"):
            session.turn_grabbed((float("nan"), 0.0, 0.0))


def test_a_session_with_gain_and_clutch_is_replayed_bit_for_bit() -> None:
    start = np.array([14.0, 24.0, 45.0])
    path = ScriptedPath(start).move(start - np.array([0.0, 0.0, 8.0]), seconds=0.6).hold(0.4)
    with Session(balls(), device=path, options=OFFLINE) as session:
        session.start_recording()
        session.let_pass(0.1)
        held = session.settings(TouchSettings(gain=0.5))
        assert held["gain"] == 0.5
        session.let_pass(0.2)
        session.clutch(on=True)
        session.let_pass(0.2)
        assert session.frame()["clutched"]
        session.clutch(on=False)
        session.let_pass(0.5)
        recording = session.stop_recording()
    # 8 mm of the device, half of them from 0.1 s on, none from 0.3 s to 0.5 s
    expected = 45.0 - 8.0 / 6.0 - 0.5 * 8.0 / 3.0 - 0.5 * 8.0 / 6.0
    assert recording.positions[-1][2] == pytest.approx(expected, abs=0.3)
    assert recording.replay().is_equal
    with Session(balls(), options=OFFLINE) as session:
        for gain in (0.0, 11.0, float("nan")):
            with pytest.raises(OptionError, match="gain"):
                session.settings(TouchSettings(gain=gain))


def plate() -> Segment:
    """Returns a plate of 10 x 10 x 1.5 mm from (30, 30, 40.3) on, in voxels of its own."""
    values = np.zeros((10, 44, 44), np.int16)
    values[2:8, 2:42, 2:42] = 1
    corner = np.array([30.0, 30.0, 40.3]) - 2 * 0.25
    fine = Volume(values, spacing=[0.25] * 3, origin=(corner + 0.125).tolist())
    return fine.threshold(1, name="plate").as_object()


def test_a_plate_is_felt_as_thick_as_it_is_in_a_scan_of_thick_slices() -> None:
    volume = Volume(np.zeros((40, 60, 60), np.int16), spacing=(1.0, 1.0, 2.0))
    scene = Scene(volume)
    assert scene.add(plate()).shown_as == "surface"
    path = (
        ScriptedPath((35.0, 35.0, 50.0))
        .move((35.0, 35.0, 38.0), seconds=0.5)
        .hold(0.3)
        .move((35.0, 35.0, 50.0), seconds=0.2)
        .move((20.0, 35.0, 50.0), seconds=0.2)
        .move((20.0, 35.0, 32.0), seconds=0.2)
        .move((35.0, 35.0, 32.0), seconds=0.2)
        .move((35.0, 35.0, 44.0), seconds=0.4)
        .hold(0.3)
    )
    with Session(scene, device=path, options=OFFLINE) as session:
        recording = session.run(2.3)
        above, below = recording.positions[750, 2], recording.positions[-1, 2]
        # the probe keeps 1e-8 of a voxel from a face
        assert above == pytest.approx(41.8, abs=1e-4)
        assert below == pytest.approx(40.3, abs=1e-4)
        assert recording.replay().is_equal
        again = session.segment(1)
        assert again.has_own_grid
        assert again.volume_ml == pytest.approx(0.15)
        np.testing.assert_array_equal(again.mask(), plate().mask())
        assert again.contains([[35.0, 35.0, 41.0], [35.0, 35.0, 42.0]]).tolist() == [True, False]


def test_an_object_with_voxels_of_its_own_comes_back_after_a_crash(tmp_path: Path) -> None:
    file, scan = tmp_path / "a.journal", bytes(32)
    with Session(balls(), options=OFFLINE) as session:
        session.begin_journal(file, scan)
        number = session.add_segment(plate())
        session.move_segment(number, shifted(0.0, 2.0, 1.0))
        session.set_feel(number, stiffness=0.25)
        session.let_pass(0.2)
        expected = session.segments()
    with Session(balls(), options=OFFLINE) as session:
        session.recover_journal(file, scan)
        session.let_pass(0.2)
        assert session.segments() == expected
        session.undo()
        assert session.segments()[2]["pose"] == np.eye(4).ravel().tolist()
        session.undo()
        assert len(session.segments()) == 2
