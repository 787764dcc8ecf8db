"""Examples run and check themselves."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

EXAMPLES = Path(__file__).parents[3] / "examples"


def run(name: str, *arguments: str) -> str:
    done = subprocess.run(
        [sys.executable, str(EXAMPLES / name), *arguments],
        capture_output=True,
        text=True,
        timeout=600,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_bone_of_the_phantom_is_felt() -> None:
    assert "the probe stayed outside the bone" in run("feel_bone.py")


def test_a_session_is_recorded_kept_and_replayed() -> None:
    assert "every bit is the same" in run("replay_session.py")


def test_a_plate_is_placed_on_the_spine_of_the_phantom() -> None:
    assert "the plate lies on the bone" in run("place_plate.py")


@pytest.mark.data
def test_a_plate_is_placed_on_a_real_skull(data_folder: Path) -> None:
    scan = str(data_folder / "cthead_stanford/CThead.mha")
    assert "the plate lies on the bone" in run("place_plate.py", scan, "1350")


@pytest.mark.data
@pytest.mark.parametrize(
    ("name", "threshold"),
    [("cthead_stanford/CThead.mha", "1300"), ("amos_0336/amos_0336.mhd", "250")],
)
def test_bone_of_real_scans_is_felt(data_folder: Path, name: str, threshold: str) -> None:
    assert "the probe stayed outside the bone" in run(
        "feel_bone.py", str(data_folder / name), threshold
    )
