"""Needles from Python: driving one into layers, and one in the hand of a session."""

from __future__ import annotations

from typing import get_args

import numpy as np
import pytest
from palpate import protocol
from palpate.base.errors import OptionError
from palpate.scenarios.drive import Drive
from palpate.scenarios.lines import line_through
from palpate.scenarios.needle import drive_needle
from palpate.scenarios.run import ScenarioRun
from palpate.session.needle import TISSUES, Tissue
from palpate.session.session import Session, SessionOptions
from palpate.volumes.scene import Scene
from palpate.volumes.volume import Volume

SHAPE = (24, 60, 24)
"""Layers across y: air, skin, liver, bone."""
BORDERS = {"skin": (10, 14), "liver": (14, 40), "bone": (40, 60)}


def volume() -> Volume:
    return Volume(np.zeros(SHAPE, dtype=np.int16), spacing=(1.0, 1.0, 1.0))


def mask(name: str) -> np.ndarray[tuple[int, ...], np.dtype[np.bool_]]:
    solid = np.zeros(SHAPE, dtype=bool)
    low, high = BORDERS[name]
    solid[:, low:high, :] = True
    return solid


def driven(**options: float) -> ScenarioRun:
    scan = volume()
    layers = [(scan.segment(mask(name), name=name), TISSUES.get(name)) for name in BORDERS]
    start, target = line_through(scan, mask("liver"), mask("bone"))
    return drive_needle(scan, layers, Drive(start=start, target=target, **options))


def test_a_needle_punctures_layer_after_layer_and_stops_at_bone() -> None:
    run = driven()
    kinds = [(event.kind, event.segment) for event in run.events]
    assert kinds == [
        ("punctured", "skin"),
        ("punctured", "liver"),
        ("stopped", "bone"),
        ("withdrawn", ""),
    ]
    assert run.wall_at is not None
    assert run.tip.max() <= run.wall_at
    assert run.probe.max() <= run.wall_at
    # it stops in the tick after the one that comes to the limit; 0.005 mm at 1 N/mm
    assert 6.0 <= run.force.max() < 6.01
    assert run.spikes() == 0
    assert run.violations == 0


def test_a_spike_is_counted_and_an_event_excuses_one() -> None:
    run = driven(rest_secs=0.1)
    middle = int(np.searchsorted(run.travel, 30.0))
    run.force[middle] *= 2.0
    assert run.spikes() == 1
    run.force[middle] /= 2.0
    at = int(np.searchsorted(run.time, run.events[0].time))
    run.force[at] *= 2.0
    assert run.spikes() == 0


def test_what_is_no_drive_or_no_line_is_refused() -> None:
    with pytest.raises(OptionError, match="speed"):
        driven(speed=0.0)
    with pytest.raises(OptionError, match="no line"):
        line_through(volume(), mask("bone"), mask("skin"))


def test_the_needle_of_a_session_needs_a_tissue_for_each_segment() -> None:
    scan = volume()
    scene = Scene(scan)
    scene.add(scan.segment(mask("liver"), name="liver"))
    with Session(scene) as session:
        session.set_tool("needle", segment_ids=[1], tissues=[TISSUES["liver"]])
        session.stroke(on=True)
        session.stroke(on=False)
        with pytest.raises(OptionError, match="0 tissues for 1 segments"):
            session.set_tool("needle", segment_ids=[1])
        soft = Tissue(**{**vars(TISSUES["fat"]), "puncture": -1.0})
        with pytest.raises(OptionError, match="puncture"):
            session.set_tool("needle", segment_ids=[1], tissues=[soft])


def test_a_thicker_needle_meets_more_and_a_foundation_that_is_as_stiff() -> None:
    liver = TISSUES["liver"]
    thick = liver.met_by(2.0)
    assert thick.puncture == pytest.approx(2.0 * liver.puncture)
    assert thick.friction == pytest.approx(2.0 * liver.friction)
    assert thick.lateral == liver.lateral
    assert liver.met_by(1.0) == liver


def test_pages_know_the_tissues_that_there_are() -> None:
    assert set(get_args(protocol.TissueName)) == set(TISSUES)


def test_a_needle_in_the_hand_is_told_of_and_withdrawn() -> None:
    scan = volume()
    scene = Scene(scan)
    for name in BORDERS:
        scene.add(scan.segment(mask(name), name=name), touchable=True)
    x, y, z = line_through(scan, mask("liver"), mask("bone"))[0].tolist()
    start = (x, y, z)
    tissues = [TISSUES["skin"], TISSUES["liver"]]
    with Session(scene, options=SessionOptions(real_time=False, start=start)) as session:
        session.set_tool("needle", radius=0.5, segment_ids=[1, 2], tissues=tissues)
        session.stroke(on=True)
        assert not session.withdraw_needle()
        for step in range(60):
            session.hand((start[0], start[1] + 0.6 * step, start[2]))
            session.run(0.05)
        needle = session.frame()["needle"]
        assert needle["inside"]
        assert needle["depth"] > 5.0
        # in tissue the tip stays on the line that it went in along, but for what the hand pulls
        assert needle["direction"] == pytest.approx((0.0, 1.0, 0.0), abs=0.05)
        tip = np.add(needle["entry"], np.multiply(needle["depth"], needle["direction"]))
        assert session.frame()["proxy"] == pytest.approx(tip.tolist(), abs=0.2)
        kinds = [(event.kind, event.segment) for event in session.needle_events()]
        assert kinds[:2] == [("punctured", 1), ("punctured", 2)]
        assert needle["events"] == len(kinds)
        assert session.withdraw_needle()
        session.run(0.1)
        assert not session.frame()["needle"]["inside"]
        assert session.needle_events()[-1].kind == "withdrawn"


def test_a_needle_goes_in_along_the_direction_that_is_set() -> None:
    scan = volume()
    scene = Scene(scan)
    for name in BORDERS:
        scene.add(scan.segment(mask(name), name=name), touchable=True)
    x, y, z = line_through(scan, mask("liver"), mask("bone"))[0].tolist()
    tissues = [TISSUES["skin"], TISSUES["liver"]]
    with Session(scene, options=SessionOptions(real_time=False, start=(x, y, z))) as session:
        session.set_tool("needle", radius=0.5, segment_ids=[1, 2], tissues=tissues)
        assert session.frame()["needle"]["set_direction"] is None
        session.set_needle_direction((0.3, 2.0, 0.0))
        session.run(0.05)
        along = np.array((0.3, 2.0, 0.0)) / np.hypot(0.3, 2.0)
        assert session.frame()["needle"]["set_direction"] == pytest.approx(along.tolist())
        session.stroke(on=True)
        for step in range(40):
            session.hand((x, y + 0.6 * step, z))
            session.run(0.05)
        needle = session.frame()["needle"]
        assert needle["inside"]
        assert needle["direction"] == pytest.approx(along.tolist())
        session.set_needle_direction(None)
        session.run(0.05)
        assert session.frame()["needle"]["set_direction"] is None


@pytest.mark.parametrize("nonsense", [(0.0, 0.0, 0.0), (float("nan"), 0.0, 1.0), (1.0, 2.0)])
def test_what_is_no_direction_is_refused(nonsense: tuple[float, ...]) -> None:
    options = SessionOptions(real_time=False)
    with (
        Session(Scene(volume()), options=options) as session,
        pytest.raises(OptionError, match="direction"),
    ):
        session.set_needle_direction(nonsense)
