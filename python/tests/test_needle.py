"""Needles from Python: driving one into layers, and the scenarios of the command line."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from palpate.cli import run
from palpate.errors import OptionError
from palpate.needle import TISSUES, NeedleRun, Tissue, drive_needle, line_through
from palpate.scene import Scene
from palpate.session import Session
from palpate.volume import Volume

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


def driven(**options: float) -> NeedleRun:
    scan = volume()
    layers = [(scan.segment(mask(name), name=name), TISSUES.get(name)) for name in BORDERS]
    start, target = line_through(scan, mask("liver"), mask("bone"))
    return drive_needle(scan, layers, start=start, target=target, **options)


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


@pytest.mark.parametrize("name", ["needle-skull", "needle-liver"])
def test_a_scenario_on_the_phantom_writes_its_ticks_and_its_chart(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    table, chart = tmp_path / "run.json", tmp_path / "run.png"
    assert run(["scenario", name, "--json", str(table), "--plot", str(chart)]) == 0
    told = json.loads(table.read_text())
    assert told["scenario"] == name
    figures = told["figures"]
    assert figures["violations"] == 0
    assert figures["spikes"] == 0
    assert figures["deepest"] <= figures["wall"]
    assert figures["deepest_probe"] <= figures["wall"]
    punctured = [event["segment"] for event in told["events"] if event["kind"] == "punctured"]
    assert punctured[0] == "skin"
    assert ("liver" in punctured) == (name == "needle-liver")
    assert told["events"][-1]["kind"] == "withdrawn"
    assert any(event["kind"] == "stopped" for event in told["events"])
    assert len(told["samples"]["force"]) == len(told["phase"])
    assert chart.stat().st_size > 10_000
    assert "spikes 0" in capsys.readouterr().out


def test_a_scenario_without_its_labels_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(["scenario", "needle-skull", "--plot", str(tmp_path / "run.txt")]) == 2
    assert "allowed" in capsys.readouterr().err
