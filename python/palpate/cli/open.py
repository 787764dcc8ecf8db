"""The commands ``palpate open`` and ``palpate demo``."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Annotated

import typer

from palpate.base.console import quiet_libraries
from palpate.base.early_imports import importing
from palpate.cli.options import (
    AnotherPatient,
    Browser,
    Mesh,
    MeshFrame,
    MeshSpacing,
    MeshUnit,
    Port,
    Rate,
    Resample,
    ScanOrNone,
    Segments,
    Threshold,
    Transform,
    With,
    WithFrame,
    WithSeries,
)
from palpate.cli.read_ahead import ReadAhead
from palpate.cli.request_options import with_requests
from palpate.io.request import ReadRequest

if TYPE_CHECKING:
    from palpate.base.progress import Progress

__all__ = ["demo", "open_scan"]


@with_requests
def open_scan(  # noqa: PLR0913  # one per option of the command line
    path: ScanOrNone = None,
    *,
    reading: ReadRequest,
    threshold: Threshold = None,
    segments: Segments = None,
    resample: Resample = False,
    another_patient: AnotherPatient = False,
    second: With = None,
    second_series: WithSeries = None,
    second_frame: WithFrame = None,
    transform: Transform = None,
    mesh: Mesh = None,
    mesh_frame: MeshFrame = None,
    mesh_unit: MeshUnit = None,
    mesh_spacing: MeshSpacing = None,
    port: Port = 0,
    browser: Browser = True,
    rate: Rate = 1000,
    recover: Annotated[
        bool | None,
        typer.Option(
            "--recover/--no-recover",
            help="Restore unsaved changes of an earlier session, or set them aside; by "
            "default the page asks.",
        ),
    ] = None,
    journal: Annotated[
        bool,
        typer.Option(
            "--journal/--no-journal",
            help="Write changes to disk as they are made, to survive a crash.",
        ),
    ] = True,
) -> None:
    """Open a scan or a saved scene in the browser."""
    from palpate.base.errors import OptionError
    from palpate.base.typed_numbers import parse_threshold
    from palpate.saved.ending import is_scene

    ahead = None if path is None or is_scene(path) else ReadAhead(partial(reading.read, path))
    with importing():
        from palpate.cli.scenes import add_mesh, add_second, saved_scene, scene_of
        from palpate.cli.show_page import check_start, choose_on_page, show
        from palpate.saved.opening import Opening
        from palpate.server.app import bind_again
        from palpate.server.resume import note_port

    check_start(rate)
    bounds = parse_threshold(threshold)
    if path is None or is_scene(path):
        of_scans = (bounds, segments, mesh, second, second_series, second_frame, transform)
        if reading != ReadRequest() or any(option is not None for option in of_scans):
            what = "no scan is given" if path is None else f"{path} is a scene"
            raise OptionError(f"{what}: options of scans are allowed with scans only")
    if path is None:
        with bind_again("", port) as listener, quiet_libraries():
            note_port("", listener.getsockname()[1])
            choose_on_page(listener, rate=rate, browser=browser, journalled=journal)
        return
    given = path

    def make(progress: Progress) -> Opening:
        if ahead is None:
            return saved_scene(given, progress)
        volume = ahead.result(progress)
        scene = scene_of(
            volume,
            bounds=bounds,
            label_map=segments,
            resample=resample,
            another_patient=another_patient,
            progress=progress,
        )
        add_second(
            scene,
            second,
            transform,
            series=second_series,
            frame=second_frame,
            progress=progress,
        )
        if mesh is not None:
            add_mesh(scene, mesh, frame=mesh_frame, unit=mesh_unit, spacing=mesh_spacing)
        return Opening(scene, None, tuple(volume.warnings))

    place = str(given.resolve())
    with bind_again(place, port) as listener, quiet_libraries():
        note_port(place, listener.getsockname()[1])
        show(
            path.name,
            make,
            listener,
            rate=rate,
            browser=browser,
            journalled=journal,
            recover=recover,
        )


def demo(*, port: Port = 0, browser: Browser = True, rate: Rate = 1000) -> None:
    """Open the built-in phantom in the browser."""
    from palpate.cli.show_page import check_start, show
    from palpate.saved.demonstration import demonstration
    from palpate.server.app import bind

    check_start(rate)
    with bind(port) as listener:
        show("the phantom", demonstration, listener, rate=rate, browser=browser)
