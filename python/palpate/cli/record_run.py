"""What ``palpate record`` and ``palpate replay`` do once their options are understood."""

from __future__ import annotations

import json
import math
from dataclasses import asdict
from pathlib import Path
from typing import Any

import typer

from palpate.base.console import warn
from palpate.base.errors import OptionError
from palpate.cli.show_page import check_page, serve_page
from palpate.server.app import bind
from palpate.server.open_scan import OpenScan
from palpate.server.recording import Recorder, summary
from palpate.server.workbench import Workbench
from palpate.session.recording import Recording, Replay
from palpate.session.scripted_path import ScriptedPath
from palpate.session.session import Session, SessionOptions
from palpate.volumes.scene import Scene

__all__ = ["check_out", "check_seconds", "record_page", "record_script", "replay_file"]

LONGEST = 3600.0
"""A recording keeps an hour at 1 kHz; see ``recording.rs`` of the engine."""

DIFFERENT = 1
"""Exit code where a replay gives other bits."""


def check_out(out: Path) -> None:
    """Refuses a file that cannot become a recording, before anything is recorded.

    Raises:
        OptionError: There is no such folder, or there is such a file already.
    """
    if not out.parent.is_dir():
        raise OptionError(f"{out.parent} is no folder; allowed: a file in an existing folder")
    if out.exists():
        raise OptionError(f"{out} exists already; allowed: a new file")


def check_seconds(seconds: float | None) -> None:
    """Refuses a length that no recording has.

    Raises:
        OptionError: It is none.
    """
    if seconds is not None and not (0.0 < seconds <= LONGEST and math.isfinite(seconds)):
        raise OptionError(f"{seconds:g} s given; allowed: more than 0, at most {LONGEST:g} s")


def record_script(
    scene: Scene, out: Path, *, path: ScriptedPath, seconds: float | None, rate: int
) -> None:
    """Records a device that follows a path, computed at once."""
    length = path.duration if seconds is None else seconds
    check_seconds(length)
    options = SessionOptions(rate_hz=rate, real_time=False)
    with Session(scene, device=path, options=options) as session:
        recording = session.run(length)
    recording.save(out)
    typer.echo(f"{out}: {summary(recording)}")


def record_page(
    scene: Scene, out: Path, *, port: int, seconds: float | None, rate: int, browser: bool
) -> None:
    """Records what a person does on the page."""
    check_page()
    with (
        bind(port) as listener,
        Session(scene, options=SessionOptions(rate_hz=rate)) as session,
    ):
        recorder = Recorder(session)
        try:
            recorder.start()
            workbench = Workbench(OpenScan(session, recorder=recorder), fixed=True)
            serve_page(workbench, listener, browser=browser, seconds=seconds)
            # a page may have ended it before
            said = recorder.stop() if recorder.is_running else "as the page ended it"
            recorder.keep(out)
        finally:
            recorder.close()
    typer.echo(f"{out}: {said}")


def replay_file(file: Path, *, csv: Path | None, npz: Path | None, as_json: bool) -> int:
    """Replays a recording and writes its tables; returns the exit code."""
    recording = Recording.load(file)
    if csv is not None:
        recording.to_csv(csv)
    if npz is not None:
        recording.to_npz(npz)
    # the tables of a recording that cannot be replayed are there all the same
    replayed = recording.replay()
    if not replayed.same_build:
        by = recording.about.palpate if recording.about else "unknown"
        warn(
            f"another build recorded this (Palpate {by}): its bits may differ, and nothing is "
            "wrong if they do"
        )
    if replayed.stopped:
        warn(f"the replay is not complete: {replayed.stopped}")
    figures = _figures(recording, replayed)
    if as_json:
        typer.echo(json.dumps(figures, indent=2))
    else:
        _print(figures)
    # another build is another program: there is nothing to fail
    return DIFFERENT if replayed.same_build and not replayed.is_equal else 0


def _figures(recording: Recording, replayed: Replay) -> dict[str, Any]:
    figures = asdict(replayed)
    del figures["positions"], figures["forces"]
    about = recording.about
    return {
        "scan": about.scan.name if about else "",
        "recorded": about.recorded if about else "",
        "recorded_ticks": len(recording),
        "lost_ticks": recording.lost,
        "contact_share": recording.contact_share,
        "largest_force": recording.largest_force,
        "equal": replayed.is_equal,
        **figures,
    }


def _print(figures: dict[str, Any]) -> None:
    lines = [
        ("scan", figures["scan"]),
        ("recorded", figures["recorded"]),
        ("ticks", f"{figures['ticks']} of {figures['recorded_ticks']} replayed"),
        ("duration", f"{figures['seconds']:.3f} s"),
        ("in contact", f"{figures['contact_share']:.1%}"),
        ("largest force", f"{figures['largest_force']:.3f} N"),
        ("hash recorded", figures["recorded_hash"]),
        ("hash replayed", figures["replayed_hash"]),
    ]
    first = figures["first_difference"]
    if first is not None:
        apart = f"probe {first['probe']:g} mm, force {first['force']:g} N apart"
        lines += [
            ("ticks that differ", str(figures["different"])),
            ("the first", f"tick {first['tick']} at {first['time']:.3f} s: {apart}"),
        ]
    for name, value in lines:
        typer.echo(f"{name:18}{value}")
    typer.echo("EQUAL" if figures["equal"] else "DIFFERENT")
