"""The commands ``palpate record`` and ``palpate replay``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from palpate.base.console import Display, quiet_libraries, warn
from palpate.cli.options import Browser, Port, Rate, Scan, Segments, Threshold
from palpate.cli.reading_options import Reading, with_reading

__all__ = ["record", "replay"]


@with_reading
def record(
    path: Scan,
    *,
    out: Annotated[
        Path, typer.Option(help="Recording to write (.palpate-session).", metavar="FILE")
    ],
    seconds: Annotated[
        float | None,
        typer.Option(help="Duration in s; by default until Ctrl-C, or the length of the script."),
    ] = None,
    script: Annotated[
        Path | None,
        typer.Option(help="Path that the device follows (.csv, .json); runs without the page."),
    ] = None,
    reading: Reading,
    threshold: Threshold = None,
    segments: Segments = None,
    port: Port = 0,
    browser: Browser = True,
    rate: Rate = 1000,
) -> None:
    """Record a session, with every input of touch, for replay."""
    from palpate.base.typed_numbers import parse_threshold
    from palpate.cli.record_run import check_out, check_seconds, record_page, record_script
    from palpate.cli.scenes import scene_of
    from palpate.cli.show_page import check_rate
    from palpate.session.scripted_file import read_path

    check_rate(rate)
    check_out(out)
    check_seconds(seconds)
    bounds = parse_threshold(threshold)
    scripted = None if script is None else read_path(script)
    with quiet_libraries(), Display() as display:
        volume = reading.read(path, display)
        scene = scene_of(volume, bounds=bounds, label_map=segments, progress=display)
    for warning in volume.warnings:
        warn(warning)
    if scripted is not None:
        record_script(scene, out, path=scripted, seconds=seconds, rate=rate)
    else:
        record_page(scene, out, port=port, seconds=seconds, rate=rate, browser=browser)


def replay(
    file: Annotated[
        Path, typer.Argument(help="Recording to replay (.palpate-session).", metavar="FILE")
    ],
    *,
    csv: Annotated[
        Path | None, typer.Option(help="Write positions, forces and events as CSV.")
    ] = None,
    npz: Annotated[
        Path | None, typer.Option(help="Write positions, forces and events as NumPy arrays.")
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print a JSON object.")] = False,
) -> int:
    """Replay a recorded session and compare the forces bit for bit."""
    from palpate.cli.record_run import replay_file

    return replay_file(file, csv=csv, npz=npz, as_json=as_json)
