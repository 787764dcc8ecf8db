"""``palpate surface export`` says what it wrote, of how many, and what was lost."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from palpate.cli.commands import run
from palpate.io.reading import read
from palpate.saved.scene_file import save_scene
from palpate.session.session import Session, SessionOptions
from palpate.volumes.mesh_read import read_mesh
from palpate.volumes.scene import Scene


@pytest.fixture
def scan(write_image: Any) -> Path:
    """Two blocks of 1000 joined by a bridge of one voxel."""
    values = np.zeros((18, 18, 28), np.int16)
    values[4:14, 4:14, 4:12] = values[4:14, 4:14, 16:24] = values[7, 7, 12:16] = 1000
    path: Path = write_image(values, "scan.mha", spacing=(1.0, 1.0, 1.0))
    return path


def export(*arguments: str | Path) -> int:
    return run(["surface", "export", *map(str, arguments)])


def test_what_was_written_is_said(scan: Path, tmp_path: Path, capsys: Any) -> None:
    mesh, report = tmp_path / "a.ply", tmp_path / "a.json"
    assert export(scan, mesh, "--threshold", "500", "--smoothing", "0", "--json", report) == 0
    told = capsys.readouterr()
    assert "segment 'threshold'" in told.out
    assert "1.60 ml in 1 body (voxels: 1.60 ml in 1 body)" in told.out
    assert told.err == ""
    known = json.loads(report.read_text())
    assert known["triangles"] == len(read_mesh(mesh).mesh.triangles)
    assert (known["segments"], known["voxel_volume"], known["warnings"]) == (1, 1604.0, [])


def test_what_a_step_takes_away_is_said(scan: Path, tmp_path: Path, capsys: Any) -> None:
    assert export(scan, tmp_path / "a.stl", "--threshold", "500", "--step", "2") == 0
    told = capsys.readouterr()
    assert "has 2 bodies, its voxels 1 body" in told.err
    assert "in 2 bodies (voxels: 1.60 ml in 1 body)" in told.out


def test_scenes_are_read_and_their_segments_chosen(scan: Path, tmp_path: Path, capsys: Any) -> None:
    volume, path = read(scan), tmp_path / "work.palpate"
    scene = Scene(volume, [volume.threshold(low) for low in (400, 500)])
    with Session(scene, options=SessionOptions(real_time=False)) as session:
        session.run(0.01)
        save_scene(path, session)
    mesh = tmp_path / "a.stl"
    assert export(path, mesh, "--segment", "2") == 0
    assert "segment 'segment 2' of 2, " in capsys.readouterr().out
    mesh.unlink()
    assert export(path, mesh) != 0
    told = capsys.readouterr().err
    assert "allowed: a name or a number of 1 segment 1, 2 segment 2" in told
    assert export(path, mesh, "--threshold", "500") != 0
    assert "options of scans are allowed with scans only" in capsys.readouterr().err
