"""Names in files are those of 0.1: in what is kept here, and in what this build writes."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any, cast

import pytest
from palpate import Scene, Session

from . import kept, names
from .kept import FILES, FIXTURES
from .sessions import PARTICLES, SESSIONS, bone

NAMES: dict[str, list[str]] = json.loads((FIXTURES / "names.json").read_text("utf-8"))


def of(kind: str) -> dict[str, list[str]]:
    """Returns the names of a kind of file."""
    return {name: some for name, some in NAMES.items() if name.startswith(kind)}


ADDED = {
    "recording commands": ("GiveWay.stays",),
    "recording start": (
        "state.giving_way.stays",
        "state.needle.direction",
        "state.soft.answer.stays",
    ),
    "state recent.json": ("[].frame",),
    "scene keys": ("labels", "materials[].stiffening", "save_id", "tears_by"),
    "scene members": ("steps.msgpack",),
    "scenario": ("figures.hole_depth", "figures.hole_rim", "figures.lump_aside", "hole", "lump"),
}
"""Names of newer versions, which readers of 0.1 pass over."""

ADDED_LOOKS = {"touched_while_hidden"}
"""The same of how segments look."""


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What this build writes: the same kinds of files."""
    folder = tmp_path_factory.mktemp("written")
    (folder / "recordings").mkdir()
    for name in SESSIONS.keys() - {"live", *PARTICLES}:
        SESSIONS[name]().save(folder / "recordings" / f"{name}.palpate-session")
    files = folder / "files"
    files.mkdir()
    kept.write_scans(files)
    kept.write_scenario(files / "needle.json")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("PALPATE_STATE", str(files / "state"))
        for name in ("linked", "whole"):
            _write_scene(files, name)
        kept.write_notes(files, kept.open_scene(files / "linked.palpate"))
    return folder


def _write_scene(files: Path, name: str) -> None:
    volume = kept.open_scan(files)
    scene = Scene(volume, [bone(volume)])
    scene.second = kept.second_scan(files)
    looks = json.dumps(kept.LOOKS).encode()
    view: dict[str, Any] = {"camera": None, "crosshair": None, "remembered": {}}
    path = files / f"{name}.palpate"
    with Session(scene, options=kept.STANDING) as session:
        journal = kept.Journal(session)
        journal.start(recover=False)
        journal.note_second(scene.second)
        kept.edited_for_a_scene(session)
        session.let_pass(0.1)
        kept.save_scene(path, session, looks=looks, view=view, copy=name == "whole")


def test_the_names_in_recordings_of_0_1_are_listed() -> None:
    assert names.names_of_recordings(FIXTURES) == of("recording")


def test_the_names_in_other_files_of_0_1_are_listed() -> None:
    found = names.names_of_files(FILES)
    assert found == {name: some for name, some in NAMES.items() if name not in of("recording")}


@pytest.mark.parametrize("kind", sorted(of("recording")))
def test_recordings_of_this_build_have_the_same_names(written: Path, kind: str) -> None:
    found = names.names_of_recordings(written)[kind]
    assert [name for name in found if name not in ADDED.get(kind, ())] == NAMES[kind]


@pytest.mark.parametrize("kind", sorted(NAMES.keys() - of("recording")))
def test_other_files_of_this_build_have_the_same_names(written: Path, kind: str) -> None:
    found = names.names_of_files(written / "files")[kind]
    assert [name for name in found if name not in ADDED.get(kind, ())] == NAMES[kind]


def test_looks_of_a_page_have_the_same_names() -> None:
    """What this build keeps of what was restored is what it was given."""
    volume = kept.open_scan(FILES)
    with Session(Scene(volume, [bone(volume)]), options=kept.STANDING) as session:
        (again,) = kept.looks_again(session, kept.LOOKS[:1])
    look, before = (cast("dict[str, object]", each["look"]) for each in (again, kept.LOOKS[0]))
    added = look.keys() - before.keys()
    assert added == ADDED_LOOKS
    again["look"] = {name: some for name, some in look.items() if name not in added}
    assert again == kept.LOOKS[0]
