"""The command ``palpate replay``: a recorded session computed again and compared."""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from palpate.base.console import warn
from palpate.cli.written_files import WRITES

if TYPE_CHECKING:
    from palpate.session.recording import Recording, Replay

__all__ = ["replay"]

DIFFERENT = 1
"""Exit code where a replay gives other bits."""


def replay(
    file: Annotated[
        Path, typer.Argument(help="Recording to replay (.palpate-session).", metavar="FILE")
    ],
    *,
    csv: Annotated[
        Path | None, typer.Option(help="Write positions, forces and events as CSV."), WRITES
    ] = None,
    npz: Annotated[
        Path | None,
        typer.Option(help="Write positions, forces and events as NumPy arrays."),
        WRITES,
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print a JSON object.")] = False,
) -> int:
    """Replay a recorded session and compare the forces bit for bit."""
    from palpate.session.recording import Recording

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
