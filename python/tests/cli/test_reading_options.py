"""The options of reading, which every command that reads a scan has."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from palpate.base.request import options_of
from palpate.cli.commands import app, run
from palpate.io.request import ReadRequest
from typer.main import get_command

COMMANDS = ("open", "info", "record", "export", "import", "segment", "surface export")
BARE = ("--raw", "14x13x12,int16,big", "--voxel-size", "1,1,2")


@pytest.fixture
def bare(tmp_path: Path) -> Path:
    """Voxels without a header, which only --raw can read."""
    values = np.full((12, 13, 14), -1000, ">i2")
    values[4:8, 4:8, 4:8] = 400
    path = tmp_path / "scan.raw"
    path.write_bytes(values.tobytes())
    return path


def options(command: str) -> dict[str, tuple[str, str, object]]:
    """Returns what each option of a command is called, says and is by default."""
    found = get_command(app)
    for name in command.split():
        found = found.commands[name]  # type: ignore[attr-defined]
    return {
        each.name: (each.opts[0], getattr(each, "help", ""), each.default)
        for each in found.params
        if each.name is not None
    }


@pytest.mark.parametrize("command", COMMANDS)
def test_commands_that_read_a_scan_have_the_same_options(command: str) -> None:
    one, usual = options(command), options("info")
    for option in options_of(ReadRequest):
        if (command, option.field) == ("segment", "fill"):
            # holes are filled there
            continue
        assert one[option.field] == usual[option.field]
        assert usual[option.field][0] == f"--{option.field.replace('_', '-')}"


def test_each_command_that_reads_a_scan_reads_bare_voxels(
    bare: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    made = [
        tmp_path / name
        for name in ("a.stl", "a.seg.nrrd", "a.palpate-session", "a.mha", "b.nii.gz")
    ]
    (tmp_path / "path.csv").write_text("t,x,y,z\n0,0,0,60\n0.01,0,0,60\n")
    touched = ("--threshold", "0,1000")
    assert run(["surface", "export", str(bare), str(made[0]), *BARE, *touched]) == 0
    assert run(["export", str(bare), "-o", str(made[1]), *BARE, *touched]) == 0
    script = ("--script", str(tmp_path / "path.csv"))
    assert run(["record", str(bare), "--out", str(made[2]), *BARE, *touched, *script]) == 0
    assert run(["import", str(bare), "-o", str(made[3]), *BARE]) == 0
    bone = ("--unit", "HU", "--threshold", "bone")
    assert run(["segment", str(bare), "-o", str(made[4]), *BARE, *bone]) == 0
    assert all(path.stat().st_size > 0 for path in made)
    assert run(["info", str(bare), *BARE]) == 0
    assert "14 x 13 x 12" in capsys.readouterr().out


@pytest.mark.parametrize("command", COMMANDS)
def test_a_voxel_size_that_is_none_is_refused_before_anything_is_read(
    command: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = {
        "surface export": [str(tmp_path / "a.stl")],
        "record": ["--out", str(tmp_path / "a.palpate-session")],
    }.get(command, [] if command in {"info", "open"} else ["-o", str(tmp_path / "a.nrrd")])
    given = [*command.split(), str(tmp_path / "missing.raw"), *out, "--voxel-size", "1,2"]
    assert run(given) == 2
    assert "voxel-size '1,2' given; allowed: 3 numbers, X,Y,Z" in capsys.readouterr().err


@pytest.mark.parametrize("option", [("--max-voxels", "5"), ("--fill", "0"), ("--series", "2")])
def test_options_of_reading_are_refused_where_no_scan_is_read(
    option: tuple[str, str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    scene = tmp_path / "work.palpate"
    scene.touch()
    assert run(["open", *option]) == 2
    assert "no scan is given: options of scans" in capsys.readouterr().err
    assert run(["export", str(scene), "-o", str(tmp_path / "a.seg.nrrd"), *option]) == 2
    assert "is a scene: options of scans" in capsys.readouterr().err
