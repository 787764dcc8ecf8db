"""Recordings of 0.1 are replayed bit for bit, by whatever build and on whatever machine."""

from __future__ import annotations

import json
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from palpate import Recording

from .kept import FIXTURES, command

FOLDER = FIXTURES / "recordings"
EXPECTED: dict[str, Any] = json.loads((FIXTURES / "expected.json").read_text("utf-8"))["recordings"]


def path_of(name: str) -> Path:
    return FOLDER / f"{name}.palpate-session"


def test_each_recording_has_what_is_expected_of_it() -> None:
    assert sorted(path.stem for path in FOLDER.iterdir()) == sorted(EXPECTED)


@pytest.mark.parametrize("name", sorted(EXPECTED))
def test_a_recording_is_replayed_to_the_bit(name: str) -> None:
    expected = EXPECTED[name]
    recording = Recording.load(path_of(name))
    replay = recording.replay()
    assert replay.first_difference is None
    assert replay.is_equal
    assert (replay.first_tick, replay.ticks) == (expected["first_tick"], expected["ticks"])
    assert replay.stopped == expected["stopped"] == ""
    assert replay.recorded_hash == replay.replayed_hash == expected["hash"]

    # the recording says so, and what was noted beside it
    first = int(np.searchsorted(recording.ticks, replay.first_tick))
    assert replay.forces.tobytes() == recording.forces[first:].tobytes()
    assert replay.positions.tobytes() == recording.positions[first:].tobytes()
    assert sha256(replay.forces.tobytes()).hexdigest() == expected["forces"]
    assert sha256(replay.positions.tobytes()).hexdigest() == expected["positions"]
    assert recording.largest_force > 0.05


@pytest.mark.parametrize("name", sorted(EXPECTED))
def test_the_events_of_a_recording_keep_their_names(name: str) -> None:
    events = {word for each in Recording.load(path_of(name)).events for word in each.split(" + ")}
    assert sorted(events - {""}) == EXPECTED[name]["events"]


def test_the_command_line_says_equal_though_another_build_recorded_it(capsys: Any) -> None:
    assert command(["replay", str(path_of("exact-ball-intensities")), "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["equal"] is True
    assert told["recorded_hash"] == EXPECTED["exact-ball-intensities"]["hash"]
