"""The command ``palpate record``: a session, on the page or by a script, with all its inputs."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from palpate.base.console import Display, quiet_libraries, warn
from palpate.cli.options import (
    AnotherPatient,
    Browser,
    Port,
    Rate,
    Resample,
    Scan,
    Segments,
    Threshold,
)
from palpate.cli.request_options import with_requests
from palpate.cli.written_files import WRITES
from palpate.io.request import ReadRequest

if TYPE_CHECKING:
    from palpate.session.scripted_path import ScriptedPath
    from palpate.volumes.scene import Scene

__all__ = ["record"]

LONGEST = 3600.0
"""A recording keeps an hour at 1 kHz; see ``recording.rs`` of the engine."""


@with_requests
def record(  # noqa: PLR0913  # one per option of the command line
    path: Scan,
    *,
    out: Annotated[
        Path, typer.Option(help="Recording to write (.palpate-session).", metavar="FILE"), WRITES
    ],
    seconds: Annotated[
        float | None,
        typer.Option(help="Duration in s; by default until Ctrl-C, or the length of the script."),
    ] = None,
    script: Annotated[
        Path | None,
        typer.Option(help="Path that the device follows (.csv, .json); runs without the page."),
    ] = None,
    reading: ReadRequest,
    threshold: Threshold = None,
    segments: Segments = None,
    resample: Resample = False,
    another_patient: AnotherPatient = False,
    port: Port = 0,
    browser: Browser = True,
    rate: Rate = 1000,
) -> None:
    """Record a session, with every input of touch, for replay."""
    from palpate.base.typed_numbers import parse_threshold
    from palpate.cli.scenes import scene_of
    from palpate.cli.show_page import check_rate
    from palpate.session.scripted_file import read_path

    check_rate(rate)
    _check_out(out)
    _check_seconds(seconds)
    bounds = parse_threshold(threshold)
    scripted = None if script is None else read_path(script)
    with quiet_libraries(), Display() as display:
        volume = reading.read(path, display)
        scene = scene_of(
            volume,
            bounds=bounds,
            label_map=segments,
            resample=resample,
            another_patient=another_patient,
            progress=display,
        )
    for warning in volume.warnings:
        warn(warning)
    if scripted is not None:
        _record_script(scene, out, path=scripted, seconds=seconds, rate=rate)
    else:
        _record_page(scene, out, port=port, seconds=seconds, rate=rate, browser=browser)


def _check_out(out: Path) -> None:
    """Refuses a file that cannot become a recording, before anything is recorded.

    Raises:
        OptionError: There is no such folder.
    """
    from palpate.base.errors import OptionError

    if not out.parent.is_dir():
        raise OptionError(f"{out.parent} is no folder; allowed: a file in an existing folder")


def _check_seconds(seconds: float | None) -> None:
    """Refuses a length that no recording has.

    Raises:
        OptionError: It is none.
    """
    from palpate.base.errors import OptionError

    if seconds is not None and not (0.0 < seconds <= LONGEST and math.isfinite(seconds)):
        raise OptionError(f"{seconds:g} s given; allowed: more than 0, at most {LONGEST:g} s")


def _record_script(
    scene: Scene, out: Path, *, path: ScriptedPath, seconds: float | None, rate: int
) -> None:
    """Records a device that follows a path, computed at once."""
    from palpate.server.recording import summary
    from palpate.session.session import Session, SessionOptions

    length = path.duration if seconds is None else seconds
    _check_seconds(length)
    options = SessionOptions(rate_hz=rate, real_time=False)
    with Session(scene, device=path, options=options) as session:
        recording = session.run(length)
    recording.save(out)
    typer.echo(f"{out}: {summary(recording)}")


def _record_page(
    scene: Scene, out: Path, *, port: int, seconds: float | None, rate: int, browser: bool
) -> None:
    """Records what a person does on the page."""
    from palpate.cli.show_page import check_page, serve_page
    from palpate.server.app import bind
    from palpate.server.open_scan import OpenScan
    from palpate.server.recording import Recorder
    from palpate.server.workbench import Workbench
    from palpate.session.session import Session, SessionOptions

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
            summary = recorder.stop() if recorder.is_running else "as the page ended it"
            recorder.keep(out)
        finally:
            recorder.close()
    typer.echo(f"{out}: {summary}")
