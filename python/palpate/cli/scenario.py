"""The commands ``palpate scenario``: tools at work without a device, on the phantom or on a scan.

Each prints what happened; with ``--json`` and ``--plot`` it writes what was felt, and a chart.
Heavy modules are imported inside the commands.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from palpate.base.console import Display, quiet_libraries
from palpate.base.harmless_text import terminal
from palpate.cli.written_files import WRITES, keeping_files

if TYPE_CHECKING:
    from rich.table import Table

    from palpate.base.progress import Progress
    from palpate.scenarios.run import ScenarioRun
    from palpate.scenarios.scenarios import Body

__all__ = ["scenario"]

scenario = typer.Typer(help="Drive tools without a device.", no_args_is_help=True)

Scan = Annotated[
    Path | None, typer.Argument(help="Scan; by default the built-in phantom.", metavar="[PATH]")
]
Json = Annotated[
    Path | None,
    typer.Option("--json", help="Write positions, forces and events of the run.", metavar="FILE"),
    WRITES,
]
Plot = Annotated[Path | None, typer.Option(help="Plot the run (.png, .svg, .pdf)."), WRITES]
Speed = Annotated[float, typer.Option(help="Speed of the tool in mm/s.")]
ForceLimit = Annotated[float, typer.Option(help="Force at which the tool stops, in N.")]
BoneFrom = Annotated[float | None, typer.Option(help="Threshold of bone, in the unit of the scan.")]
Labels = Annotated[
    Path | None, typer.Option("--segments", help="Label map of the scan that contains the liver.")
]
Liver = Annotated[int, typer.Option(help="Label of the liver.")]
Depth = Annotated[float, typer.Option(help="Depth of the tool in mm.")]


@scenario.command("needle-skull")
@keeping_files
def needle_skull(
    path: Scan = None,
    *,
    bone: BoneFrom = None,
    speed: Speed = 5.0,
    force_limit: ForceLimit = 6.0,
    json: Json = None,
    plot: Plot = None,
) -> None:
    """Insert a needle through the skin to the bone."""
    _needle("needle-skull", (path, None, 0, bone), push=(speed, force_limit), files=(json, plot))


@scenario.command("needle-liver")
@keeping_files
def needle_liver(
    path: Scan = None,
    *,
    segments: Labels = None,
    liver: Liver = 6,
    bone: BoneFrom = None,
    speed: Speed = 5.0,
    force_limit: ForceLimit = 6.0,
    json: Json = None,
    plot: Plot = None,
) -> None:
    """Insert a needle through the liver to the bone behind it."""
    _needle(
        "needle-liver", (path, segments, liver, bone), push=(speed, force_limit), files=(json, plot)
    )


@scenario.command("drilling")
@keeping_files
def drilling(
    path: Scan = None,
    *,
    bone: BoneFrom = None,
    depth: Depth = 4.0,
    radius: Annotated[float, typer.Option(help="Radius of the burr in mm.")] = 2.0,
    speed: Annotated[
        float | None,
        typer.Option(help="Speed of the tool in mm/s.", show_default="0.1, of particles 1"),
    ] = None,
    force_limit: ForceLimit = 10.0,
    particles: Annotated[
        bool,
        typer.Option(
            "--particles",
            help="Push bone aside as particles that rearrange and stay so, and remove none.",
        ),
    ] = False,
    softening: Annotated[
        float | None,
        typer.Option(
            help="How many times weaker than bone the particles are.", show_default="5000"
        ),
    ] = None,
    json: Json = None,
    plot: Plot = None,
) -> None:
    """Drill into bone, or push it aside."""
    from palpate.base.errors import OptionError
    from palpate.scenarios.scenarios import run_drilling, run_drilling_particles

    _check_files((json, plot))
    if softening is not None and not particles:
        raise OptionError("--softening given without --particles; allowed: both")
    with quiet_libraries(), Display() as display:
        body = _body((path, None, 0, bone), display)
        display("drilling", None)
        if particles:
            run = run_drilling_particles(
                body,
                depth=depth,
                radius=radius,
                speed=1.0 if speed is None else speed,
                force_limit=force_limit,
                softening=5000.0 if softening is None else softening,
            )
        else:
            run = run_drilling(
                body,
                depth=depth,
                radius=radius,
                speed=0.1 if speed is None else speed,
                force_limit=force_limit,
            )
    _tell(run, (json, plot))


@scenario.command("palpation")
@keeping_files
def palpation(  # noqa: PLR0913  # one per option of the command line
    path: Scan = None,
    *,
    segments: Labels = None,
    liver: Liver = 6,
    bone: BoneFrom = None,
    side: Annotated[
        str,
        typer.Option(
            "--from", help="Side of the body to press: anterior, posterior, left, right, any."
        ),
    ] = "anterior",
    voxel: Annotated[
        float, typer.Option(help="Downsample finer voxels to about this size in mm.")
    ] = 2.0,
    map_liver: Annotated[
        bool,
        typer.Option(
            "--map",
            help="Press the front of the liver at the places of a square, and map how stiff it "
            "feels; the phantom's has a tumour that the scan does not show.",
        ),
    ] = False,
    places: Annotated[
        int | None,
        typer.Option(help="Number of places to press, in a row of a map.", show_default="9, 5"),
    ] = None,
    length: Annotated[
        float | None,
        typer.Option(
            help="Distance from the first place to the last in mm.", show_default="40, 36"
        ),
    ] = None,
    depth: Annotated[
        float | None, typer.Option(help="Depth of the tool in mm.", show_default="2.5, 5")
    ] = None,
    radius: Annotated[float | None, typer.Option(help="Radius of the ball in mm.")] = None,
    json: Json = None,
    plot: Plot = None,
) -> None:
    """Press soft tissue along a line that crosses underlying bone, or at the places of a square."""
    from palpate.scenarios.press_lines import SIDES
    from palpate.scenarios.scenarios import run_palpation, run_palpation_map

    _check_files((json, plot))
    with quiet_libraries(), Display() as display:
        body = _body((path, segments, liver, bone), display)
        if map_liver:
            run = run_palpation_map(
                body,
                voxel=voxel,
                places=5 if places is None else places,
                width=36.0 if length is None else length,
                depth=5.0 if depth is None else depth,
                radius=radius,
                progress=display,
            )
        else:
            run = run_palpation(
                body,
                sides=tuple(SIDES) if side == "any" else (side,),
                voxel=voxel,
                places=9 if places is None else places,
                length=40.0 if length is None else length,
                depth=2.5 if depth is None else depth,
                radius=radius,
                progress=display,
            )
    _tell(run, (json, plot))


@scenario.command()
def play(
    run: Annotated[Path, typer.Argument(help="Run written with --json.", metavar="FILE")],
    path: Scan = None,
    *,
    segments: Labels = None,
    liver: Liver = 6,
    bone: BoneFrom = None,
    port: Annotated[int, typer.Option(help="Port on 127.0.0.1; 0 chooses a free one.")] = 0,
    browser: Annotated[
        bool, typer.Option(help="Open the page in the browser if there is a display.")
    ] = True,
) -> None:
    """Play a run on the page, with its scan."""
    from palpate.base.console import warn
    from palpate.cli.show_page import check_page, show
    from palpate.saved.opening import Opening
    from palpate.scenarios.run import read_run
    from palpate.scenarios.scenarios import scene_of_body
    from palpate.server.app import bind

    check_page()
    scan = read_run(run).scan

    def make(progress: Progress) -> Opening:
        body = _body((path, segments, liver, bone), progress)
        if body.volume.name != scan:
            warn(f"the run is of {scan}, and this scan is {body.volume.name}")
        return Opening(scene_of_body(body), None, ())

    with bind(port) as listener, quiet_libraries():
        show(scan, make, listener, rate=1000, browser=browser, run=run)


ScanOptions = tuple[Path | None, Path | None, int, float | None]
"""A scan, its label map, the liver's number in that, where bone begins."""

Push = tuple[float, float]
"""Speed [mm/s], force limit [N]."""

Files = tuple[Path | None, Path | None]
"""For every tick, for the chart."""


def _needle(
    name: Literal["needle-skull", "needle-liver"],
    scan: ScanOptions,
    *,
    push: Push,
    files: Files,
) -> None:
    from palpate.scenarios.scenarios import run_needle

    _check_files(files)
    with quiet_libraries(), Display() as display:
        body = _body(scan, display)
        display(name, None)
        run = run_needle(name, body, speed=push[0], force_limit=push[1])
    _tell(run, files)


def _check_files(files: Files) -> None:
    """Refuses what could not be written, before anything is computed."""
    from palpate.base.errors import OptionError
    from palpate.base.plot_file import check_plot

    check_plot(files[1])
    for path in files:
        if path is not None and not path.parent.is_dir():
            raise OptionError(f"folder {str(path.parent)!r} given; allowed: one that exists")


def _body(scan: ScanOptions, progress: Progress) -> Body:
    from palpate.io.reading import read
    from palpate.scenarios.scenarios import body_of_phantom, body_of_scan

    path, labels, liver, bone = scan
    if path is None:
        return body_of_phantom()
    return body_of_scan(
        read(path, progress=progress),
        labels=None if labels is None else read(labels, progress=progress),
        liver=liver,
        bone=bone,
    )


def _tell(run: ScenarioRun, files: Files) -> None:
    """Prints what happened and what was felt, and writes the files that are asked for."""
    from palpate.scenarios.chart import plot_run
    from palpate.scenarios.run import write_run

    _print_table(run)
    figures = run.figures()
    wall = figures["wall"]
    typer.echo(
        f"largest force {figures['largest_force']:.2f} N, deepest {figures['deepest']:.2f} mm, "
        + ("" if wall is None else f"bone at {wall:.2f} mm, ")
        + f"spikes {figures['spikes']}, violations {run.violations}"
    )
    if run.hole is not None:
        gone = run.samples["volume"][-1]
        come = run.samples["piled"][-1] if "piled" in run.samples else 0.0
        typer.echo(
            f"hole {run.hole.depth:.1f} mm deep, rim {run.hole.rim:.1f} mm high; {gone:.0f} mm³ of "
            f"bone gone from its place, {come:.0f} mm³ elsewhere"
        )
    if run.lump is not None:
        x, y, z = run.lump.place
        aside = run.lump.aside
        typer.echo(
            f"stiffest at ({x:.1f}, {y:.1f}, {z:.1f}) mm, {run.lump.times:.1f} times the median"
            + ("" if aside is None else f"; the tumour is {aside:.1f} mm aside of there")
        )
    json, plot = files
    if json is not None:
        write_run(run, json)
        typer.echo(f"palpate scenario play {json} shows it on the page")
    if plot is not None:
        plot_run(run, plot)


def _print_table(run: ScenarioRun) -> None:
    from rich.table import Table

    table = Table(title=f"{run.scenario}: {run.scan}", title_justify="left")
    if run.lump is not None:
        _add_map(table, run)
    elif run.presses:
        for name in ("along [mm]", "soft over bone [mm]", "depth [mm]", "force [N]"):
            table.add_column(name, justify="right")
        table.add_column("stiffness [N/mm]", justify="right")
        for press in run.presses:
            soft = "–" if press.thickness is None else f"{press.thickness:.1f}"
            numbers = (f"{press.depth:.1f}", f"{press.force:.3f}", f"{press.stiffness:.3f}")
            table.add_row(f"{press.along:.1f}", soft, *numbers)
    else:
        for name in ("event", "segment", "time [s]", "depth [mm]", "force [N]"):
            is_word = name in ("event", "segment")
            table.add_column(name, justify="left" if is_word else "right")
        for event in run.events:
            felt = (f"{event.time:.2f}", f"{event.depth:.1f}", f"{event.force:z.2f}")
            table.add_row(event.kind, event.segment, *felt)
    terminal().print(table)


def _add_map(table: Table, run: ScenarioRun) -> None:
    """Adds the modulus felt at the places of a square: from the top down, as one sees them."""
    columns = sorted({press.along for press in run.presses})
    table.add_column("felt modulus [kPa]", justify="right")
    for along in columns:
        table.add_column(f"{along:.0f} mm", justify="right")
    for across in sorted({press.across or 0.0 for press in run.presses}, reverse=True):
        row = sorted((p for p in run.presses if p.across == across), key=lambda press: press.along)
        table.add_row(f"{across:.0f} mm", *(f"{press.young or 0.0:.1f}" for press in row))
