"""The engine's module: what the package builds on."""

from __future__ import annotations

import subprocess
import sys
import time
from collections.abc import Callable
from typing import Any, Literal

import msgspec
import numpy as np
import pytest
from palpate import _core, protocol  # noqa: TID251  # the thin module itself is tested

BLOCK = (slice(10, 30), slice(20, 45), slice(10, 50))
"""Solid voxels [z, y, x]; its front face is the plane y = 19.5 mm."""

PRESSED = 4.0
"""How deep the path goes into the block [mm]."""


def volume() -> _core.Volume:
    """A scan of 60 x 50 x 40 voxels of 1 mm, the centre of the first at the scene's zero."""
    values = np.zeros((40, 50, 60), dtype=np.int16)
    values[BLOCK] = 1000
    identity = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)
    return _core.Volume(values, (1.0, 1.0, 1.0), (0.0, 0.0, 0.0), identity, 1.0, 0.0)


def path() -> np.ndarray[Any, np.dtype[np.float64]]:
    """Goes into the block in half a second, rests, and comes back."""
    deep = 19.5 + PRESSED
    return np.array(
        [
            [0.0, 30.0, 10.0, 20.0],
            [0.5, 30.0, deep, 20.0],
            [1.0, 30.0, deep, 20.0],
            [1.5, 30.0, 10.0, 20.0],
        ]
    )


def pressing(**options: Any) -> _core.Session:
    """An offline session that presses the block along the path."""
    scan = volume()
    bone = scan.threshold(500.0, 2000.0)
    return _core.Session(
        scan,
        device="scripted",
        path=path(),
        real_time=False,
        segments=[(bone, True, (500.0, 2000.0))],
        **options,
    )


def test_arrays_keep_their_order_and_are_read_only() -> None:
    rng = np.random.default_rng(3)
    values = rng.integers(-2000, 3000, size=(5, 7, 11), dtype=np.int16)
    direction = (0.0, 1.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 1.0)
    scan = _core.Volume(values, (0.5, 0.6, 2.5), (1.0, 2.0, 3.0), direction, 2.0, -7.0)
    assert scan.dimensions == (11, 7, 5)
    assert np.array_equal(scan.values(), values)
    with pytest.raises(ValueError, match="read-only"):
        scan.values()[0, 0, 0] = 1
    # the centre of voxel (2, 1, 0): origin + direction · (spacing · index)
    centre = scan.patient_from_grid @ [2.5, 1.5, 0.5, 1.0]
    assert np.allclose(centre, [1.0 + 0.6, 2.0 - 1.0, 3.0, 1.0], atol=1e-12)

    low, high = -500.0, 2200.0
    physical = 2.0 * values - 7.0
    wanted = (physical >= low) & (physical <= high)
    segment = scan.threshold(low, high)
    assert np.array_equal(segment.mask(), wanted)
    assert segment.voxel_count == wanted.sum()
    assert np.array_equal(_core.Segment.from_mask(wanted.astype(np.uint8)).mask(), wanted)
    z, y, x = np.argwhere(wanted)[0]
    points = np.array([[x + 0.5, y + 0.5, z + 0.5], [-0.5, 0.0, 0.0], [np.nan, 0.0, 0.0]])
    assert segment.contains(points).tolist() == [True, False, False]


def test_views_of_the_values_outlive_the_volume() -> None:
    view = volume().values()
    assert view[BLOCK].min() == view.max() == 1000


def test_histogram_counts_every_voxel() -> None:
    low, high, counts = volume().histogram(64)
    assert counts.sum() == 40 * 50 * 60
    assert low <= 0.0
    assert high >= 1000.0


def test_pressing_gives_stiffness_times_depth() -> None:
    session = pressing(settings={"stiffness": 0.8})
    session.start_recording()
    session.run(0.8)
    frame = session.frame()
    assert frame["contact"]
    assert frame["touched"] == 1
    # the probe stays 1e-8 voxels before the face
    assert frame["depth"] == pytest.approx(PRESSED, abs=1e-6)
    assert frame["force"] == pytest.approx((0.0, -0.8 * PRESSED, 0.0), abs=1e-6)
    columns, _ = session.stop_recording()
    assert columns["force"].shape == (800, 3)
    assert np.array_equal(columns["tick"], np.arange(800))
    assert not columns["contact"][:100].any()
    assert columns["contact"][-100:].all()
    session.run(0.8)
    assert session.frame()["force"] == (0.0, 0.0, 0.0)


def test_a_frame_is_what_the_protocol_says() -> None:
    session = pressing()
    session.run(0.8)
    frame = session.frame()
    assert frame["notices"] == []
    assert frame["segments_version"] == 0
    assert frame["voxels_version"] == 0
    beside = {"notices", "segments_version", "voxels_version"}
    fields = {name: value for name, value in frame.items() if name not in beside}
    state = msgspec.convert(fields, protocol.State)
    assert state.contact
    assert len(state.samples) == 200
    assert state.rates.servo.hz == pytest.approx(1000.0)


def test_thresholds_follow_undo() -> None:
    session = pressing()
    (state,) = session.segments_state()
    assert state["bounds"] is not None
    low, high = state["bounds"]
    assert (np.subtract(high, low).prod()) == 20_000
    assert set(state["feel"]) == {"stiffness", "friction_static", "friction_kinetic"}
    assert state == {
        "bounds": state["bounds"],
        "feel": state["feel"],
        "id": 1,
        "voxels": 20_000,
        "volume": 20_000.0,
        "grid": None,
        "touchable": True,
        "locked": False,
        "pending": False,
        "range": (500.0, 2000.0),
        "made_by": (500.0, 2000.0),
        "material": None,
        "pose": None,
    }
    session.fill_box(1, (0, 0, 0), (5, 5, 5), solid=True)
    assert session.segments_state()[0]["range"] is None
    assert session.segments_state()[0]["made_by"] == (500.0, 2000.0)
    assert session.segments_state()[0]["voxels"] == 20_125
    assert session.undo()
    assert session.segments_state()[0]["range"] == (500.0, 2000.0)
    assert session.redo()
    assert session.segment(1).voxel_count == 20_125
    other = session.threshold(-10.0, 10.0)
    assert other == 2
    assert session.segments_state()[1]["voxels"] == 40 * 50 * 60 - 20_000


def test_a_live_session_answers_and_stops() -> None:
    scan = volume()
    bone = scan.threshold(500.0, 2000.0)
    session = _core.Session(scan, device="simulated")
    session.add_segment(bone, touchable=True)
    assert session.place(30.0, 10.0, 20.0) == (30.0, 10.0, 20.0)
    session.hand(30.0, 40.0, 20.0)
    deadline = time.monotonic() + 60.0
    while not session.frame()["contact"]:
        assert time.monotonic() < deadline
        time.sleep(0.01)
    session.stop()
    assert not session.is_running
    assert session.frame()["force"] == (0.0, 0.0, 0.0)
    with pytest.raises(RuntimeError, match="stopped"):
        session.hand(0.0, 0.0, 0.0)


def test_a_program_that_forgets_its_session_still_ends() -> None:
    program = """
import numpy as np
from palpate import _core
identity = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)
scan = _core.Volume(np.zeros((8, 8, 8), np.int16), (1.0,) * 3, (0.0,) * 3, identity, 1.0, 0.0)
forgotten = [_core.Session(scan), _core.Session(scan, real_time=False)]
"""
    done = subprocess.run([sys.executable, "-c", program], timeout=300, check=False)
    assert done.returncode == 0


REFUSED: list[tuple[str, Callable[[], object]]] = [
    ("rate", lambda: pressing(rate_hz=7)),
    ("stiffness", lambda: pressing(settings={"stiffness": -1.0})),
    ("force limit", lambda: pressing(settings={"force_limit": float("nan")})),
    ("start", lambda: pressing(start=(float("inf"), 0.0, 0.0))),
    ("path", lambda: _core.Session(volume(), device="scripted", path=np.zeros((3, 3)))),
    ("path", lambda: _core.Session(volume(), device="scripted", path=np.zeros((3, 4)))),
    ("without a path", lambda: _core.Session(volume(), device="scripted")),
    ("with a path", lambda: _core.Session(volume(), device="simulated", path=path())),
    ("allowed: 'simulated'", lambda: _core.Session(volume(), device="mouse")),  # type: ignore[arg-type]
    ("hand", lambda: pressing().hand(float("nan"), 0.0, 0.0)),
    ("place", lambda: pressing().place(0.0, 1e300, 0.0)),
    ("view axes", lambda: pressing().view((1.0, 0.0, 0.0), (2.0, 0.0, 0.0))),
    ("threshold", lambda: volume().threshold(2.0, 1.0)),
    ("bins", lambda: volume().histogram(0)),
    ("segment 9", lambda: pressing().remove_segment(9)),
    ("box", lambda: pressing().fill_box(1, (3, 3, 3), (3, 9, 9), solid=True)),
    ("given; allowed: 0 to 3600 s", lambda: pressing().run(-1.0)),
    ("contiguous", lambda: _core.Segment.from_mask(np.zeros((4, 4, 4), np.uint8)[::2])),
    ("those of the scan", lambda: pressing().add_segment(_small_segment(), touchable=True)),
]


def _small_segment() -> _core.Segment:
    return _core.Segment.from_mask(np.ones((2, 2, 2), dtype=np.uint8))


@pytest.mark.parametrize(("message", "call"), REFUSED)
def test_what_is_not_allowed_is_a_value_error(message: str, call: Callable[[], object]) -> None:
    with pytest.raises(ValueError, match=message.replace("(", r"\(")):
        call()


def test_only_offline_sessions_can_be_stepped() -> None:
    session = _core.Session(volume())
    with pytest.raises(RuntimeError, match="real time"):
        session.run(0.1)
    session.stop()


def test_the_phantom_is_the_same_for_the_same_seed() -> None:
    first, labels, names = _core.phantom((32, 28, 40), 5)
    second, _, _ = _core.phantom((32, 28, 40), 5)
    assert first.dimensions == (32, 28, 40)
    assert labels.shape == (40, 28, 32)
    assert np.array_equal(first.values(), second.values())
    assert {"liver", "skin"} <= set(names)
    with pytest.raises(ValueError, match="allowed"):
        _core.phantom((0, 4, 4), 1)
    with pytest.raises(ValueError, match="allowed"):
        _core.phantom((60_000, 60_000, 60_000), 1)


@pytest.mark.parametrize("work", ["detection, 4 voxels", "proxy", "tick"])
def test_the_benchmark_reports_what_it_timed(work: str) -> None:
    scan = volume()
    bone = scan.threshold(500.0, 2000.0)
    report = _core.TouchBench(_core.Ground(scan, [bone]), 0.0, 5000, 1).run(work)
    assert report["per_second"] > 0.0
    assert report["median_ns"] <= report["p999_ns"] <= report["max_ns"]
    if "detection" not in work:
        assert report["contact_share"] >= 0.95
        assert report["mean_step"] == pytest.approx(0.2)
    empty = scan.threshold(5000.0, 6000.0)
    with pytest.raises(ValueError, match="surface"):
        _core.TouchBench(_core.Ground(scan, [empty]), 0.0, 10, 1)
    with pytest.raises(ValueError, match="allowed: 1 to 255"):
        _core.Ground(scan, [])


@pytest.mark.parametrize("work", ["proxy", "tick"])
def test_the_benchmark_times_each_contact_model_on_the_same_path(
    work: Literal["proxy", "tick"],
) -> None:
    scan = volume()
    bone = scan.threshold(500.0, 2000.0)
    bench = _core.TouchBench(_core.Ground(scan, [bone]), 0.0, 2000, 1)
    exact = bench.run(work)
    original = bench.run(work, "thesis-original")
    improved = bench.run(work, "thesis-improved")
    assert exact["mean_step"] == original["mean_step"] == improved["mean_step"]
    assert len({report["mean_visits"] for report in (exact, original, improved)}) == 3
    with pytest.raises(ValueError, match='contact model "thesis" given; allowed'):
        bench.run(work, "thesis")  # type: ignore[arg-type]
