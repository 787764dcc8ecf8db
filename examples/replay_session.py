"""Record a session with an edit under the probe, and compute it again bit for bit.

    python examples/replay_session.py [FILE]      # keeps the recording where FILE is given

The probe is pressed on the phantom's bone; then the bone is opened beneath it, and it goes deeper.
"""

from __future__ import annotations

import sys
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import palpate


def main(arguments: list[str]) -> None:
    """Records, keeps, loads and replays."""
    recording = record()
    with TemporaryDirectory() as folder:
        file = Path(arguments[0] if arguments else f"{folder}/bone.palpate-session")
        recording.save(file)
        print(f"{recording} in {file.stat().st_size / 1e3:.0f} kB")
        loaded = palpate.Recording.load(file)

    replay = loaded.replay()
    print(f"recorded {replay.recorded_hash}, replayed {replay.replayed_hash}")
    check(loaded, replay)
    print("every bit is the same, and the edit is in it")


def record() -> palpate.Recording:
    """Presses on the back of the spine for a second, opens it, and presses on."""
    volume = palpate.phantom().volume
    bone = volume.threshold(250, name="bone")
    behind, inside = np.array([0.0, 110.0, 140.0]), np.array([0.0, 92.0, 140.0])
    path = palpate.ScriptedPath(behind).move(inside, seconds=1.0).hold(1.0)
    options = palpate.SessionOptions(real_time=False)
    with palpate.Session(palpate.Scene(volume, [bone]), device=path, options=options) as session:
        session.start_recording()
        session.let_pass(1.5)
        probe = np.append(session.frame()["proxy"], 1.0)
        voxel = np.floor(np.linalg.inv(volume.patient_from_grid) @ probe)[:3].astype(int)
        low, high = tuple(voxel - 4), tuple(voxel + 5)
        session.fill_box(1, low=low, high=high, solid=False)
        session.let_pass(0.5)
        return session.stop_recording()


def check(recording: palpate.Recording, replay: palpate.Replay) -> None:
    """Fails unless the replay is equal and shows the edit."""
    assert replay.is_equal
    assert replay.stopped == ""
    edited = next(row for row, event in enumerate(recording.events) if "edit" in event)
    assert recording.contacts[edited - 1]
    # the probe followed the device into the hole
    assert recording.depths[-1] < recording.depths[edited - 1] - 1.0


if __name__ == "__main__":
    main(sys.argv[1:])
