"""Journals, scenes, notes, scenarios and recipes of 0.1 bring back what was in them."""

from __future__ import annotations

import json
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from palpate import read
from palpate.recipes.recipe import read_recipe

from . import kept
from .kept import FILES, FIXTURES, MADE_IN

EXPECTED: dict[str, Any] = json.loads((FIXTURES / "expected.json").read_text("utf-8"))


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """All files of 0.1, where they can be changed, as if they had been made there."""
    place = tmp_path / "files"
    shutil.copytree(FILES, place)
    for note in (place / "state").rglob("*"):
        if note.suffix in {".json", ".second"}:
            note.write_text(note.read_text("utf-8").replace(MADE_IN, str(place)), "utf-8")
    monkeypatch.setenv("PALPATE_STATE", str(place / "state"))
    return place


def kept_constants(segments: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Returns segments with what they are made of as 0.1 knew it.

    The fourth constant was the strain at which bonds break, and is the energy that a tear takes.
    The sixth is new: by it tissue stiffens with strain, and what 0.1 made does not.
    """
    told = []
    for segment in segments:
        material = segment["material"]
        if material is not None:
            ends = {}
            for end in ("low", "high"):
                *constants, friction = material[end][:5]
                assert all(stiffening == 0.0 for stiffening in material[end][5:])
                ends[end] = [*constants[:3], friction]
            material = {**material, **ends}
        told.append({**segment, "material": material})
    return told


def compare(found: dict[str, Any], expected: dict[str, Any]) -> None:
    """Compares item by item, so that a failure names the first one."""
    assert sorted(found) == sorted(expected)
    for name, value in expected.items():
        # NaN, as of a constant that is none, is equal to itself here
        assert plain(found[name]) == plain(value), name


def plain(value: Any) -> str:
    """Returns a value as text, the same for equal ones."""
    return json.dumps(value, sort_keys=True)


# --- the journal of a session that was killed -------------------------------------------


def test_the_journal_is_where_the_scan_is_looked_for(folder: Path) -> None:
    of_scan = kept.scan_hash(kept.open_scan(folder))
    assert kept.journal_place(of_scan).exists()
    assert of_scan.hex() == EXPECTED["scene"]["linked"]["hash"]


def test_the_journal_of_a_killed_session_brings_everything_back(folder: Path) -> None:
    found = kept.told_of_journal(folder)
    expected = dict(EXPECTED["journal"])
    # each step back, too
    for row, (now, then) in enumerate(zip(found["before"], expected["before"], strict=True)):
        assert now == then, f"after {row + 1} steps back"
    compare(found, expected)
    assert found["steps"] > 10
    assert len(found["segments"]) == 5


def test_a_journal_that_was_cut_off_brings_back_what_is_whole(folder: Path) -> None:
    (path,) = (folder / "state").rglob("*.journal")
    whole = path.read_bytes()
    path.write_bytes(whole[:-7])
    found = kept.told_of_journal(folder)
    # the last note was cut: looks are those before it, voxels are all there
    assert found["lost_bytes"] > 0
    assert found["looks"] == []
    for name in ("steps", "segments", "values"):
        assert found[name] == EXPECTED["journal"][name], name


# --- scenes -----------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["linked", "whole"])
def test_a_scene_brings_everything_back(folder: Path, name: str) -> None:
    if name == "whole":
        for scan in folder.glob("*.nrrd"):
            scan.unlink()
    found, expected = kept.told_of_scene(folder / f"{name}.palpate"), EXPECTED["scene"][name]
    found, expected = (
        {**told, "segments": kept_constants(told["segments"])} for told in (found, expected)
    )
    # an option that came later is off
    assert found["model"]["options"].pop("whole_segment") is False
    compare(found, expected)
    assert len(found["segments"]) == 4
    assert found["segments"][1]["locked"]
    assert found["model"]["model"] == "lattice"
    assert [one["look"] for one in found["looks"]] == [one["look"] for one in kept.LOOKS]
    assert found["second"]["second_from_first"] == kept.SECOND_PLACE.tolist()


def test_the_view_of_the_page_is_in_its_scene(folder: Path) -> None:
    view, seen = (EXPECTED["scene"][name] for name in ("whole", "page"))
    saved = kept.open_scene(folder / "whole.palpate")
    assert saved.view is not None
    assert saved.view == view["view"]
    assert saved.view["camera"] == seen["camera"]
    assert saved.view["crosshair"] == seen["crosshair"]
    assert saved.view["remembered"]["marks"]["list"] == seen["marks"]


# --- notes in the state folder ----------------------------------------------------------


def test_scans_that_were_open_are_offered_again_raw_voxels_with_their_layout(folder: Path) -> None:
    scene, scan, raw = kept.recent_scans()
    assert Path(scene.path) == folder / "linked.palpate"
    assert (Path(scan.path).name, scan.name, scan.raw) == ("scan.nrrd", "scan", None)
    assert (raw.raw, raw.voxel_size) == ("4x5x10,int16,big", (2.0, 2.5, 3.0))
    volume = read(raw.path, raw=raw.raw, voxel_size=raw.voxel_size)
    second = read(folder / "second.nrrd")
    np.testing.assert_array_equal(volume.array, second.array)
    assert volume.spacing == second.spacing


def test_a_scan_comes_back_to_its_port(folder: Path) -> None:
    assert (folder / "state" / "ports.json").exists()
    assert kept.kept_port("scan") == 20123


@pytest.mark.parametrize("name", ["linked.palpate", "passing.palpate", "passing (1).palpate"])
def test_the_autosave_of_a_damaged_scene_is_found(folder: Path, name: str) -> None:
    damaged = folder / name
    damaged.write_bytes((FILES / "linked.palpate").read_bytes()[:100])
    found = kept.autosave_of(damaged)
    assert found is not None
    assert found.place == folder / "scan.nrrd"
    assert found.command is not None
    assert found.command.endswith("--unit HU --recover")


# --- scenarios, recipes -----------------------------------------------------------------


def test_a_run_of_a_scenario_is_read(folder: Path) -> None:
    compare(kept.told_of_run(folder / "needle.json"), EXPECTED["scenario"])


def test_a_recipe_gives_the_same_files(folder: Path) -> None:
    compare(kept.made_by_recipe(folder), EXPECTED["recipe"])


@pytest.mark.parametrize("name", ["every-key.yaml", "every-key-reconstruct.yaml"])
def test_every_key_of_a_recipe_is_still_taken(folder: Path, name: str) -> None:
    # the check refuses what does not go together, such as a series of a NRRD file
    recipe, _ = read_recipe(folder / name)
    assert recipe.segment
