"""Scenes and recordings for others: no seed of the scan, no path, no name of a person."""

from __future__ import annotations

import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from msgspec.structs import replace
from palpate.cli.commands import run
from palpate.export.deidentify import UncheckedPixelsError
from palpate.io.reading import read
from palpate.saved.autosave import note_scene
from palpate.saved.kept_with_scan import KEPT_IN_VIEW
from palpate.saved.scene_file import open_scene, save_scene
from palpate.saved.shared_recording import share_recording
from palpate.saved.shared_scene import share_scene
from palpate.segmentation.segment_steps import ShapeStep
from palpate.session.appearance import appearances_of, keep_appearances, restore_appearances
from palpate.session.recording import Recording
from palpate.session.session import Session, SessionOptions
from palpate.volumes.scan_hash import scan_identity
from palpate.volumes.scene import Scene
from palpate.volumes.second_scan import SecondScan
from seeds import seeded_series, spellings

# seeds break rules on values
pytestmark = pytest.mark.filterwarnings("ignore::UserWarning")

WriteSeries = Callable[..., Path]
NAMED = ("liver", "Lesion Alvarez", "tumour of Li", "seen 8.10.04")
PERSON = ("Alvarez", "Ñusta", "8.10.04", "778899")
"""In any case of letters."""


@pytest.fixture
def seeds() -> set[str]:
    return {"19730623", *PERSON}


@pytest.fixture
def folder(write_series: WriteSeries, seeds: set[str]) -> Path:
    """A scan with seeds, in folders that name the patient."""
    place = seeded_series(write_series, seeds)
    named = place.parent / "home-of-SEEDUSER" / "SEEDPATIENT"
    named.parent.mkdir()
    seeds |= {"SEEDUSER", "SEEDPATIENT"}
    return place.rename(named)


def work(folder: Path, *, second: Path | None = None) -> Session:
    """A session with segments that people named, one of them with a step that names another."""
    volume = read(folder)
    segments = [volume.threshold(k - 1023.0, name=name) for k, name in enumerate(NAMED)]
    scene = Scene(volume, segments)
    if second is not None:
        scene.second = SecondScan(read(second), np.eye(4))
    session = Session(scene, options=SessionOptions(real_time=False))
    first, other = session.ids[:2]
    step = ShapeStep.with_other("subtract", session.segment(other))
    session.change_shape(first, replace(step, other_name="SEEDSTEP Alvarez"))
    return session


def save(session: Session, path: Path, **options: Any) -> None:
    looks = appearances_of(session)
    mark = {"kind": "point", "name": "Alvarez tip", "points": [[1, 2, 3]]}
    parts: dict[str, Any] = {"mark.1": mark, "window": {"low": -100, "high": 300}}
    if (second := session.scene.second) is not None:
        parts[f"second.{scan_identity(second.volume)}"] = {"opacity": 0.5}
    view = {"camera": None, "remembered": {"SEEDLAYOUT": 1}, KEPT_IN_VIEW: parts}
    kept = keep_appearances(session, lambda number: looks[number])
    save_scene(path, session, looks=kept, view=view, **options)


def held(path: Path) -> dict[str, bytes]:
    """Returns all bytes of a file, packed and unpacked, with the names of its members."""
    with zipfile.ZipFile(path) as archive:
        members = {name: archive.read(name) for name in archive.namelist()}
    return {**members, "names": repr(members.keys()).encode(), "whole": path.read_bytes()}


def found(path: Path, seeds: set[str]) -> set[str]:
    looked_for = {each.upper(): seed for seed in seeds for each in spellings(seed)}
    content = [each.upper() for each in held(path).values()]
    return {seed for each, seed in looked_for.items() if any(each in one for one in content)}


@pytest.mark.parametrize("copy", [True, False])
def test_no_seed_is_in_a_scene_that_is_shared(
    folder: Path, seeds: set[str], tmp_path: Path, *, copy: bool
) -> None:
    path, out = tmp_path / "work.palpate", tmp_path / "shared.palpate"
    with work(folder, second=folder) as session:
        save(session, path, copy=copy)
    # the test sees what there is
    assert {"Alvarez", "8.10.04", *(() if copy else ("SEEDUSER", "SEEDPATIENT"))} <= found(
        path, seeds
    )
    names = share_scene(path, out)
    # without a path to the scan nothing tells which words are names
    liver, lesion, mark = (
        ("segment 1", "segment 2", "mark 1")
        if copy
        else ("liver", "Lesion ANONYMIZED", "ANONYMIZED tip")
    )
    assert found(out, {*seeds, "SEEDLAYOUT", str(tmp_path), tmp_path.name}) == set()
    assert names.kept[:2] == ([] if copy else [liver, lesion])
    before, shared = open_scene(path), open_scene(out)
    np.testing.assert_array_equal(shared.volume.array, before.volume.array)
    with Session(shared.scene(), options=SessionOptions(real_time=False)) as session:
        shared.restore(session)
        looks = restore_appearances(session, shared.looks)
        assert [looks[1].name, looks[2].name] == [liver, lesion]
        assert len(session.segments()) == len(NAMED)
        steps = session.kept_steps()
        assert steps is not None
        assert b"SEEDSTEP" not in steps or not copy
    assert shared.view is not None
    parts = shared.view[KEPT_IN_VIEW]
    assert parts["mark.1"]["name"] == mark
    assert shared.second is not None
    assert f"second.{scan_identity(shared.second.volume)}" in parts


def test_a_scene_with_its_scan_goes_by_the_headers_of_the_scan_that_is_open(
    write_series: WriteSeries, tmp_path: Path
) -> None:
    volume = read(write_series(PatientName="Alvarez^Ana", BurnedInAnnotation="YES"))
    path, out = tmp_path / "work.palpate", tmp_path / "shared.palpate"
    with Session(Scene(volume, [volume.threshold(-1000.0, name="Alvarez tip")])) as session:
        save(session, path, copy=True)
    # the file alone knows neither of text in pixels nor of names
    assert share_scene(path, out).replaced == 2
    with pytest.raises(UncheckedPixelsError):
        share_scene(path, out, scan=volume)
    names = share_scene(path, out, scan=volume, pixels_checked=True)
    assert (names.replaced, names.kept) == (0, ["ANONYMIZED tip"])
    assert found(out, {"Alvarez"}) == set()


def test_a_scene_with_its_scan_has_no_path_and_this_machine_still_knows_it(
    folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from palpate.saved.autosave import _noted

    monkeypatch.setenv("PALPATE_STATE", str(tmp_path / "state"))
    path = tmp_path / "work.palpate"
    with work(folder) as session:
        scan = save_scene(path, session, copy=True)
    assert found(path, {"SEEDUSER", str(tmp_path)}) == set()
    note_scene(scan, path)
    # opened again, it does not say
    note_scene(open_scene(path).scan, path)
    assert [one.scan.path for one in _noted()] == [str(folder)]


def test_names_that_nothing_tells_of_become_numbers(
    ball_scene: Scene, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path, out = tmp_path / "work.palpate", tmp_path / "shared.palpate"
    with Session(ball_scene, options=SessionOptions(real_time=False)) as session:
        save(session, path)
    assert run(["share", str(path), "-o", str(out)]) == 0
    told = capsys.readouterr()
    assert "2 names became numbers" in told.err
    assert "names in it: none" in told.out
    assert found(out, {"Alvarez"}) == set()
    assert run(["share", str(path), "-o", str(out), "--names-checked", "--force"]) == 0
    assert "Alvarez tip" in capsys.readouterr().out
    assert found(out, {"Alvarez"}) == {"Alvarez"}


@pytest.mark.parametrize("copy", [True, False])
def test_text_in_pixels_is_asked_about(
    write_series: WriteSeries, tmp_path: Path, *, copy: bool
) -> None:
    folder = write_series(Modality="US")
    path, out = tmp_path / "work.palpate", tmp_path / "shared.palpate"
    with Session(Scene(read(folder)), options=SessionOptions(real_time=False)) as session:
        save_scene(path, session, copy=copy)
    with pytest.raises(UncheckedPixelsError):
        share_scene(path, out)
    share_scene(path, out, pixels_checked=True)
    assert out.is_file()


def test_no_seed_is_in_a_recording_that_is_shared(
    folder: Path, seeds: set[str], tmp_path: Path
) -> None:
    path, out = tmp_path / "mine.palpate-session", tmp_path / "shared.palpate-session"
    with work(folder) as session:
        session.run(0.02).save(path)
    recording = Recording.load(path)
    assert recording.about is not None
    # the test sees what there is
    assert "Alvarez" in found(path, seeds)
    share_recording(path, out)
    assert found(out, {*seeds, str(tmp_path), recording.about.recorded}) == set()
    shared = Recording.load(out)
    assert shared.about is not None
    assert [one.name for one in shared.about.segments] == [f"segment {k}" for k in range(1, 5)]
    np.testing.assert_array_equal(shared.forces, recording.forces)
    assert shared.replay().is_equal


@pytest.mark.parametrize(
    ("name", "out", "told"),
    [
        ("scan.nii.gz", "x.palpate", "allowed: .palpate or .palpate-session files"),
        ("a.palpate", "x.palpate-session", "allowed: a .palpate file"),
        ("a.palpate", "none/x.palpate", "allowed: one that exists"),
    ],
)
def test_what_cannot_be_shared_is_told(
    name: str, out: str, told: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / name).write_bytes(b"no scene")
    assert run(["share", str(tmp_path / name), "-o", str(tmp_path / out)]) == 2
    assert told in capsys.readouterr().err
