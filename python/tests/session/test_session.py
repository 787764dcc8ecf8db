"""Touch against an oracle in NumPy: where the probe may be, and how strong the force is."""

from __future__ import annotations

import time
from pathlib import Path

import numpy as np
import palpate
import pytest
from palpate import (
    OptionError,
    Recording,
    Scene,
    ScriptedPath,
    Session,
    SessionOptions,
    TouchSettings,
    Volume,
)

OFFLINE = SessionOptions(
    real_time=False,
    # without smoothing the spring is that from device to probe, which the oracle knows
    touch=TouchSettings(stiffness=0.8, damping=0.0, smoothing="off", force_limit=10.0),
)


def press(scene: Scene, point: np.ndarray, inward: np.ndarray) -> Recording:
    """Comes from 10 mm outside a point of the surface, presses 5 mm deep, and goes back."""
    path = (
        ScriptedPath(point - 10.0 * inward)
        .move(point + 5.0 * inward, seconds=0.6)
        .hold(0.3)
        .move(point - 10.0 * inward, seconds=0.6)
        .hold(0.1)
    )
    with Session(scene, device=path, options=OFFLINE) as session:
        return session.run(path.duration)


def check_touch(recording: Recording, volume: Volume, solid: np.ndarray) -> None:
    """Checks a press against the mask itself: free probe, spring force, zero after retreat."""
    # the probe is never in a solid voxel
    grid_from_patient = np.linalg.inv(volume.patient_from_grid)
    in_grid = recording.positions @ grid_from_patient[:3, :3].T + grid_from_patient[:3, 3]
    voxels = np.floor(in_grid).astype(int)
    inside = ((voxels >= 0) & (voxels < volume.dimensions)).all(axis=1)
    x, y, z = voxels[inside].T
    assert not solid[z, y, x].any()

    # force = stiffness x depth, from the device toward the probe
    touching = recording.contacts
    assert touching.sum() > 300
    expected = 0.8 * (recording.positions - recording.devices)
    # 1e-9 N: rounding
    np.testing.assert_allclose(recording.forces[touching], expected[touching], atol=1e-9)
    assert not recording.forces[~touching].any()
    assert recording.depths.max() > 1.5

    # zero again after retreat, also at the device, which is sent forces two ticks later
    assert not recording.contacts[-50:].any()
    assert not recording.sent_forces[-50:].any()
    np.testing.assert_allclose(recording.positions[-1], recording.devices[-1], atol=1e-9)


def first_solid_along(volume: Volume, solid: np.ndarray, voxel: tuple[int, int]) -> np.ndarray:
    """Where a line along y from the front meets a solid voxel first, at (x, z) [patient]."""
    x, z = voxel
    y = int(np.flatnonzero(solid[z, :, x])[0])
    return (volume.patient_from_grid @ (x + 0.5, y, z + 0.5, 1.0))[:3]


def test_a_ball_stops_the_probe(ball_scene: Scene) -> None:
    volume = ball_scene.volume
    solid = volume.array > 0
    point = first_solid_along(volume, solid, (20, 20))
    check_touch(press(ball_scene, point, np.array([0.0, 1.0, 0.0])), volume, solid)


def test_the_bone_of_the_phantom_stops_the_probe() -> None:
    made = palpate.phantom((100, 70, 135), seed=3)
    volume = made.volume
    solid = volume.array > 250
    # the middle of the body, from its back, where the spine is
    x, z = 50, 67
    y = int(np.flatnonzero(solid[z, :, x])[-1])
    point = (volume.patient_from_grid @ (x + 0.5, y + 1.0, z + 0.5, 1.0))[:3]
    recording = press(Scene(volume, [volume.offered_bone()]), point, np.array([0.0, -1.0, 0.0]))
    check_touch(recording, volume, volume.array >= 250)


@pytest.mark.data
@pytest.mark.parametrize(
    ("name", "voxel", "threshold"),
    [
        # forehead
        ("cthead_stanford/CThead.mha", (128, 85), 1300),
        # right iliac bone
        ("amos_0336/amos_0336.mhd", (95, 42), 250),
    ],
)
def test_bone_of_real_scans_stops_the_probe(
    data_folder: Path, name: str, voxel: tuple[int, int], threshold: int
) -> None:
    volume = palpate.read(data_folder / name)
    solid = volume.array >= threshold
    point = first_solid_along(volume, solid, voxel)
    scene = Scene(volume, [volume.threshold(threshold)])
    check_touch(press(scene, point, np.array([0.0, 1.0, 0.0])), volume, solid)


def test_the_same_session_gives_the_same_numbers(ball_scene: Scene) -> None:
    point = np.array([19.3, 12.0, 22.1])
    first, second = (press(ball_scene, point, np.array([0.0, 1.0, 0.0])) for _ in range(2))
    np.testing.assert_array_equal(first.positions, second.positions)
    np.testing.assert_array_equal(first.forces, second.forces)


def test_a_recording_has_a_row_for_every_tick(ball_scene: Scene) -> None:
    options = SessionOptions(real_time=False, rate_hz=4000)
    with Session(ball_scene, options=options) as session:
        session.run(0.25)
        recording = session.run(0.5)
    assert len(recording) == 2000
    np.testing.assert_array_equal(np.diff(recording.ticks), 1)
    np.testing.assert_allclose(np.diff(recording.times), 1 / 4000, atol=1e-12)
    assert recording.positions.shape == (2000, 3)


def test_a_device_may_be_read_faster_than_the_servo_runs(ball_scene: Scene) -> None:
    options = SessionOptions(real_time=False, rate_hz=1000, device_rate_hz=4000)
    with Session(ball_scene, options=options) as session:
        recording = session.run(0.5)
        rates = session.frame()["rates"]
    assert len(recording) == 500
    assert rates["device"]["asked_hz"] == 4000.0
    # four readings for each tick of the servo, the first together
    assert rates["device"]["ticks"] == 4 * rates["servo"]["ticks"] - 3


def test_the_simulated_device_follows_its_hand(ball_scene: Scene) -> None:
    options = SessionOptions(real_time=False, start=(20.0, 20.0, 36.0))
    with Session(ball_scene, options=options) as session:
        session.hand((24.0, 18.0, 34.0))
        recording = session.run(2.0)
    # what is left of the way after 2 s, some 100 time constants of the hand, is rounding
    np.testing.assert_allclose(recording.devices[-1], (24.0, 18.0, 34.0), atol=1e-6)


def test_what_is_not_touchable_stops_nothing(ball_scene: Scene) -> None:
    path = ScriptedPath((20.0, 20.0, 40.0)).move((20.0, 20.0, 20.0), seconds=0.5)
    with Session(ball_scene, device=path, options=OFFLINE) as session:
        session.set_touchable(1, touchable=False)
        recording = session.run(0.6)
    assert not recording.contacts.any()
    np.testing.assert_allclose(recording.positions[-1], (20.0, 20.0, 20.0))


def test_an_edit_opens_a_segment_and_undo_closes_it(ball_scene: Scene) -> None:
    with Session(ball_scene, options=SessionOptions(real_time=False)) as session:
        before = session.segment(1).mask()
        session.fill_box(1, low=(15, 15, 15), high=(26, 26, 26), solid=False)
        opened = session.segment(1).mask()
        assert opened[20, 20, 20] == 0
        assert session.undo()
        np.testing.assert_array_equal(session.segment(1).mask(), before)
        assert session.redo()
        np.testing.assert_array_equal(session.segment(1).mask(), opened)
        assert not session.redo()


def test_a_session_that_stopped_does_nothing_more(ball_scene: Scene) -> None:
    with Session(ball_scene) as session:
        session.run(0.2)
    assert not session.is_running
    session.stop()
    with pytest.raises(RuntimeError, match="stopped"):
        session.hand((0.0, 0.0, 0.0))


def test_real_time_is_that_of_the_clock(ball_scene: Scene) -> None:
    with Session(ball_scene) as session:
        started = time.monotonic()
        session.start_recording()
        session.let_pass(0.5)
        while not session.frame()["recording"]:
            session.let_pass(0.01)
        recording = session.stop_recording()
        passed = time.monotonic() - started
    assert passed >= 0.5
    # a busy machine lets ticks fall out; none comes before its time, at 1 kHz
    assert 0.0 < recording.times[-1] - recording.times[0] <= passed
    assert len(recording) <= 1000.0 * passed + 1.0


@pytest.mark.parametrize(
    "options",
    [
        SessionOptions(touch=TouchSettings(stiffness=-1.0)),
        SessionOptions(touch=TouchSettings(stiffness=float("nan"))),
        SessionOptions(touch=TouchSettings(force_limit=100.0)),
        SessionOptions(touch=TouchSettings(damping=1.0)),
        SessionOptions(rate_hz=1),
    ],
)
def test_options_out_of_range_are_refused(ball_scene: Scene, options: SessionOptions) -> None:
    with pytest.raises(OptionError, match="allowed"):
        Session(ball_scene, options=options)


def test_points_that_are_none_are_refused(ball_scene: Scene) -> None:
    with Session(ball_scene) as session:
        for point in ((float("nan"), 0.0, 0.0), (0.0, float("inf"), 0.0)):
            with pytest.raises(OptionError, match="allowed"):
                session.hand(point)
            with pytest.raises(OptionError, match="allowed"):
                session.place(point)
