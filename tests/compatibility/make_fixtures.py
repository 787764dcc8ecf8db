"""Makes the files of Palpate 0.1 that later versions are to open, as they lie in ``fixtures``.

To be run by the Python of 0.1 (``git checkout 0.1`` or commit cad3e3c, ``make setup``) in the root
of a checkout that holds this folder, with a browser and the Node packages of the viewer::

    PATH_OF_0_1/.venv/bin/python -m tests.compatibility.make_fixtures
    PATH_OF_0_1/.venv/bin/python -m tests.compatibility.make_fixtures --check

With ``--check`` nothing is written: sessions are run once more, by whatever build runs this, and
those that give other bits are named. The same build gives the same bits on the same machine, but
for ``live``, which goes by the clock; particles add in another order where vectors are wider.

What else differs from one making to the next: dates, and the hash of the build. The recordings are
of sessions in ``sessions.py``; what the other files hold is told in ``kept.py``. Nothing here is
of a patient: the scan is a ball over a slab, of whole numbers.
"""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import sys
import time
from hashlib import sha256
from importlib.metadata import version
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from palpate import Recording, Scene, Session, SessionOptions

from . import kept
from .kept import FILES, FIXTURES, LOOKS, MADE_IN, STANDING
from .names import names_of_files, names_of_recordings
from .sessions import SESSIONS, Place, bone

ROOT = Path(__file__).parents[2]
SIZE = {"width": 1000, "height": 700}
PROGRAM = Path(sys.executable).parent / "palpate"


def main() -> None:
    """Makes all of it, or checks the recordings."""
    if "--check" in sys.argv[1:]:
        sys.exit(check())
    expected: dict[str, Any] = {"palpate": version("palpate"), "recordings": recordings()}
    folder = Path(MADE_IN)
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()
    os.environ["PALPATE_STATE"] = str(folder / "state")
    for recipe in FILES.glob("*.yaml"):
        shutil.copy(recipe, folder)
    kept.write_scans(folder)
    expected["journal"] = crash(folder)
    expected["scene"] = scenes(folder)
    kept.write_notes(folder, kept.open_scene(folder / "linked.palpate"))
    kept.write_scenario(folder / "needle.json")
    expected["scenario"] = kept.told_of_run(folder / "needle.json")
    collect(folder)
    expected["recipe"] = kept.made_by_recipe(folder)
    write(FIXTURES / "expected.json", expected)
    write(FIXTURES / "names.json", {**names_of_recordings(FIXTURES), **names_of_files(FILES)})


def write(path: Path, value: Any) -> None:
    """Writes JSON that a person can read."""
    path.write_text(json.dumps(value, indent=1, sort_keys=True, ensure_ascii=False) + "\n", "utf-8")


# --- recordings -------------------------------------------------------------------------


def recordings() -> dict[str, Any]:
    """Records all sessions; returns what their replays give."""
    folder = FIXTURES / "recordings"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    expected = {}
    for name, make in SESSIONS.items():
        recording = make()
        recording.save(folder / f"{name}.palpate-session")
        expected[name] = told_of_replay(recording)
        assert expected[name]["different"] == 0, name
    return expected


def told_of_replay(recording: Recording) -> dict[str, Any]:
    """Returns what a replay gives, its columns by their hash."""
    replay = recording.replay()
    return {
        "first_tick": replay.first_tick,
        "ticks": replay.ticks,
        "different": replay.different,
        "stopped": replay.stopped,
        "hash": replay.replayed_hash,
        "forces": sha256(replay.forces.tobytes()).hexdigest(),
        "positions": sha256(replay.positions.tobytes()).hexdigest(),
        "events": sorted({name for each in recording.events if each for name in each.split(" + ")}),
    }


def check() -> int:
    """Runs the sessions again; returns how many give other bits than the recordings have."""
    other = 0
    for name, make in SESSIONS.items():
        if name == "live":
            continue
        before = Recording.load(FIXTURES / "recordings" / f"{name}.palpate-session")
        now = make()
        columns = [
            column
            for column, values in dict[str, Any](before.columns).items()
            if values.tobytes() != dict[str, Any](now.columns)[column].tobytes()
        ]
        other += bool(columns)
        sys.stdout.write(f"{name}: {'other ' + ', '.join(columns) if columns else 'same'}\n")
    return other


# --- a session that is killed -----------------------------------------------------------


def crash(folder: Path) -> dict[str, Any]:
    """Kills a session in the middle of a stroke; returns what its journal is to bring back."""
    child = [sys.executable, "-m", "tests.compatibility.make_fixtures", "--until-killed"]
    with subprocess.Popen(child, cwd=ROOT, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        before = json.loads(process.stdout.readline())
        ends = time.monotonic() + 60.0
        while recovered(folder)["segments"] != before["segments"]:
            assert time.monotonic() < ends, "the journal never holds all of it"
        os.kill(process.pid, signal.SIGKILL)
    after = recovered(folder)
    assert {name: after[name] for name in before} == before
    return after


def until_killed() -> None:
    """Does what is to be lost, tells what is there then, and waits."""
    folder = Path(MADE_IN)
    volume = kept.open_scan(folder)
    start = Place(volume)(20.0, 20.0, 24.0)
    options = SessionOptions(real_time=False, start=start)
    with Session(Scene(volume, [bone(volume)]), options=options) as session:
        journal = kept.Journal(session)
        journal.start()
        journal.note(b"[]")
        kept.done_before_the_crash(session)
        journal.note(json.dumps(LOOKS).encode())
        journal.note_second(kept.second_scan(folder))
        told = {"segments": kept.told(session), "values": kept.told_of_values(session)}
        sys.stdout.write(json.dumps(told) + "\n")
        sys.stdout.flush()
        sys.stdin.read()
        time.sleep(600.0)


def recovered(folder: Path) -> dict[str, Any]:
    """Returns what the journal has by now, and each step back; the folder stays as it is."""
    with TemporaryDirectory() as copy:
        shutil.copytree(folder, copy, dirs_exist_ok=True)
        return kept.told_of_journal(Path(copy))


# --- scenes -----------------------------------------------------------------------------


def scenes(folder: Path) -> dict[str, Any]:
    """Saves a scene beside its scan, then one with it, by the page; returns what is in them."""
    volume = kept.open_scan(folder)
    scene = Scene(volume, [bone(volume)])
    scene.second = kept.second_scan(folder)
    with Session(scene, options=STANDING) as session:
        kept.edited_for_a_scene(session)
        session.let_pass(0.1)
        view: dict[str, Any] = {"camera": None, "crosshair": [1.0, 2.0, 3.0], "remembered": {}}
        looks = json.dumps(LOOKS).encode()
        kept.save_scene(folder / "linked.palpate", session, looks=looks, view=view)
    page = save_on_page(folder)
    linked = kept.told_of_scene(folder / "linked.palpate")
    whole = kept.told_of_scene(folder / "whole.palpate")
    return {"linked": linked, "whole": whole, "page": page}


def save_on_page(folder: Path) -> dict[str, Any]:
    """Opens the scene on the page of 0.1, looks at it otherwise, and saves it with its scan."""
    sys.path.insert(0, str(ROOT / "tests" / "support"))
    from browser import browser
    from browser import palpate as program

    with (
        program("open", folder / "linked.palpate", tool=[PROGRAM]) as running,
        browser() as page,
    ):
        page.do("open", url=running.url, **SIZE)
        page.all_done()
        page.do("click", testid="layout-four")
        page.wait("window.palpate.slices.length === 3")
        page.read("window.palpate.setView('R')")
        page.do("wheel", y=-300)
        page.do("drag", x=60, y=20)
        page.do("press", key="b")
        page.do("clickAt", testid="canvas", x=0.5, y=0.5)
        page.do("press", key="m")
        for x in (0.4, 0.6):
            page.do("clickAt", testid="slice-axial", x=x, y=0.5)
        page.read("window.palpate.cross([9, 18, 20])")
        page.do("click", testid="clip-box")
        page.do("slide", testid="clip-A", value=5)
        page.frames()
        seen = page_view(page)
        assert len(seen["marks"]) == 2, seen
        page.do("click", testid="scene-with-scan")
        page.do("download", testid="save-scene", path=str(folder / "whole.palpate"))
        assert page.complaints == []
        return seen


def page_view(page: Any) -> dict[str, Any]:
    """Returns what a page shows of a scene's view, whose clip box is on."""
    names = ("camera", "marks", "crosshair")
    seen = {name: page.read(f"window.palpate.{name}") for name in names}
    slices = page.read("window.palpate.slices.map(({ name }) => name)")
    return {**seen, "slices": sorted(slices), "clip-A": page.text("clip-A-value")}


def collect(folder: Path) -> None:
    """Takes what was made."""
    for recipe in FILES.glob("*.yaml"):
        assert recipe.exists()
    state = FILES / "state"
    shutil.rmtree(state, ignore_errors=True)
    shutil.copytree(folder / "state", state, ignore=shutil.ignore_patterns("doors"))
    for name in (
        "scan.nrrd",
        "second.nrrd",
        "second.raw",
        "linked.palpate",
        "whole.palpate",
        "needle.json",
    ):
        shutil.copy(folder / name, FILES / name)


if __name__ == "__main__":
    if "--until-killed" in sys.argv[1:]:
        until_killed()
    else:
        main()
