"""The command line: `open`, `demo`, `info`, `export`, `record`, `replay`, `surface`, and others.

Whatever is wrong with what was given becomes one line on stderr and exit code 2. Heavy
modules are imported inside the commands, so that ``palpate --help`` is quick.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated

import typer
from typer.exceptions import TyperException

from palpate.cli_bench import (
    bench_deform,
    bench_open,
    bench_register,
    bench_render,
    bench_segment,
    bench_session,
    bench_truth_cube,
    stress_in_matter,
)
from palpate.cli_export import export
from palpate.cli_fuzz import bench_fuzz_import
from palpate.cli_import import EXAMPLES as IMPORT_EXAMPLES
from palpate.cli_import import import_scan
from palpate.cli_recipe import EXAMPLES as RECIPE_EXAMPLES
from palpate.cli_recipe import run_file
from palpate.cli_reconstruct import EXAMPLES as RECONSTRUCT_EXAMPLES
from palpate.cli_reconstruct import reconstruct
from palpate.cli_register import EXAMPLES as REGISTER_EXAMPLES
from palpate.cli_register import register
from palpate.cli_scenario import scenario
from palpate.cli_segment import EXAMPLES, segment
from palpate.cli_series import series
from palpate.console import WRONG_INPUT, Display, fail, quiet_libraries, warn
from palpate.errors import PalpateError

__all__ = ["app", "main"]

app = typer.Typer(
    name="palpate",
    help="Examine medical scans by touch. For research and teaching, not for clinical use.",
    add_completion=False,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)

STOPPED_BY_PERSON = 130
"""Exit code after Ctrl-C, as shells expect it."""


def main() -> None:
    """Runs the command line and ends the process."""
    sys.exit(run(sys.argv[1:]))


def run(arguments: list[str]) -> int:
    """Runs the command line with these arguments; returns the exit code."""
    try:
        result = app(args=arguments, prog_name="palpate", standalone_mode=False)
    except TyperException as error:
        # without a command the help was printed instead
        return fail(_usage(error, arguments)) if error.format_message() else WRONG_INPUT
    except (PalpateError, OSError) as error:
        return fail(_system(error) if isinstance(error, OSError) else str(error))
    except MemoryError:
        return fail("not enough memory for this; allowed: a smaller scan, or a bigger machine")
    except KeyboardInterrupt:
        return STOPPED_BY_PERSON
    return result if isinstance(result, int) else 0


def _usage(error: TyperException, arguments: list[str]) -> str:
    """Says what of a command line is wrong, and what is allowed."""
    said = error.format_message().rstrip(".")
    context = getattr(error, "ctx", None)
    if context is None:
        return said
    help_at = f"see {context.command_path} --help"
    given = _given(getattr(error, "param", None), arguments)
    if given is not None:
        return f"{said} (given: {given!r}; {help_at})"
    options = [
        name
        for parameter in context.command.params
        for name in (*parameter.opts, *parameter.secondary_opts)
    ]
    names = [
        *getattr(context.command, "commands", {}),
        *sorted(name for name in options if name.startswith("--")),
    ]
    return f"{said}; allowed: {', '.join(names)} ({help_at})"


def _given(parameter: object, arguments: list[str]) -> str | None:
    """Returns the value that was given for an option, if it was."""
    for option in getattr(parameter, "opts", ()):
        for argument, after in zip(arguments, [*arguments[1:], None], strict=True):
            if argument == option:
                return after
            if argument.startswith(f"{option}="):
                return argument.removeprefix(f"{option}=")
    return None


def _system(error: OSError) -> str:
    """Says what the system refused, and for which file."""
    if error.strerror is None:
        return str(error)
    return f"{error.filename or 'the system'}: {error.strerror}; allowed: files that can be read"


def _print_version(*, asked: bool) -> None:
    if asked:
        from palpate.package_version import package_version

        typer.echo(f"palpate {package_version()}")
        raise typer.Exit


@app.callback()
def root(
    *,
    version: Annotated[
        bool,
        typer.Option(
            "--version", is_eager=True, help="Print the version.", callback=_print_version
        ),
    ] = False,
) -> None:
    """Takes the options that stand before a command."""


# --- options of several commands --------------------------------------------------------

Scan = Annotated[
    Path,
    typer.Argument(
        help="DICOM folder, file or zip archive; NIfTI, NRRD, MetaImage or MINC file; pictures.",
        metavar="PATH",
    ),
]
ScanOrNone = Annotated[
    Path | None,
    typer.Argument(
        help="DICOM folder, file or zip archive; NIfTI, NRRD, MetaImage or MINC file; pictures; a "
        "scene. Without it the page asks for a scan.",
        metavar="[PATH]",
    ),
]
Series = Annotated[
    str | None, typer.Option(help="DICOM series: its UID, description or number in the list.")
]
Orientation = Annotated[
    str | None, typer.Option(help="Sides toward which x, y, z run, such as LPS or RAS.")
]
Unit = Annotated[str | None, typer.Option(help="HU, where the values are known to be.")]
Raw = Annotated[
    str | None,
    typer.Option(
        help="Layout of raw voxels, such as 256x256x113,int16,big.",
        metavar="SIZE,TYPE[,ORDER[,SKIP]]",
    ),
]
VoxelSize = Annotated[
    str | None, typer.Option(help="Of raw voxels and pictures [mm].", metavar="X,Y,Z")
]
Fill = Annotated[float | None, typer.Option(help="Value in the place of NaN and infinity.")]
MaxVoxels = Annotated[int, typer.Option(help="Largest scan that is read.")]
Threshold = Annotated[
    str | None, typer.Option(help="Values of the segment to touch.", metavar="LOW[,HIGH]")
]
Segments = Annotated[
    Path | None,
    typer.Option(help="Label map, .seg.nrrd, DICOM SEG or RTSTRUCT, or a folder of masks."),
]
With = Annotated[
    Path | None, typer.Option("--with", help="Second scan, shown with the first: CT and MR.")
]
Transform = Annotated[
    Path | None,
    typer.Option(help="Of --with: .tfm that maps points of the first scan to the second's."),
]
Mesh = Annotated[
    Path | None,
    typer.Option(help="Closed .stl, .ply, .obj or .glb: becomes a segment that can be moved."),
]
MeshFrame = Annotated[str | None, typer.Option(help="LPS or RAS, where the mesh does not say.")]
MeshUnit = Annotated[str | None, typer.Option(help="mm or m, where the mesh does not say.")]
MeshSpacing = Annotated[
    float | None,
    typer.Option(
        "--mesh-spacing",
        "--spacing",
        help="Edge of the mesh's voxels [mm]; else fine enough for its thickness.",
    ),
]
Port = Annotated[int, typer.Option(help="Port of 127.0.0.1; 0 takes a free one.")]
Browser = Annotated[bool, typer.Option(help="Open the page, where there is a display.")]
Plot = Annotated[Path | None, typer.Option(help="Draw the figures: .png, .svg or .pdf.")]
Rate = Annotated[int, typer.Option(help="Servo ticks a second: 1000 or 4000.")]


@app.command("open")
def open_scan(  # noqa: PLR0913  # one per option of the command line
    path: ScanOrNone = None,
    *,
    series: Series = None,
    orientation: Orientation = None,
    unit: Unit = None,
    fill: Fill = None,
    raw: Raw = None,
    voxel_size: VoxelSize = None,
    max_voxels: MaxVoxels = 1024**3,
    threshold: Threshold = None,
    segments: Segments = None,
    second: With = None,
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
            help="Bring back changes that an earlier session left, or keep them aside; by default "
            "the page asks.",
        ),
    ] = None,
    journal: Annotated[
        bool, typer.Option("--journal/--no-journal", help="Keep changes on disk as they are made.")
    ] = True,
) -> None:
    """Show a scan, or a scene that was saved, and feel it."""
    from palpate.cli_open import (
        add_second,
        check_start,
        choose_on_page,
        is_scene,
        parse_threshold,
        parse_voxel_size,
        scene_of,
        show,
        show_saved,
    )
    from palpate.cli_surface import add_mesh
    from palpate.errors import OptionError
    from palpate.io import read
    from palpate.server import bind

    check_start(rate)
    bounds, size = parse_threshold(threshold), parse_voxel_size(voxel_size)
    if path is None or is_scene(path):
        of_scans = (
            *(series, orientation, unit, fill, raw, size, bounds, segments, mesh),
            *(second, transform),
        )
        if any(option is not None for option in of_scans):
            what = "no scan is given" if path is None else f"{path} is a scene"
            raise OptionError(f"{what}: options of scans are allowed with scans only")
    if path is None:
        with bind(port) as listener, quiet_libraries():
            choose_on_page(listener, rate=rate, browser=browser, journalled=journal)
        return
    if is_scene(path):
        with bind(port) as listener, quiet_libraries():
            show_saved(
                path, listener, rate=rate, browser=browser, journalled=journal, recover=recover
            )
        return
    with bind(port) as listener, quiet_libraries():
        with Display() as display:
            volume = read(
                path,
                series=series,
                orientation=orientation,
                unit=unit,
                fill=fill,
                raw=raw,
                voxel_size=size,
                max_voxels=max_voxels,
                progress=display,
            )
            scene = scene_of(volume, bounds=bounds, label_map=segments, progress=display)
            add_second(scene, second, transform, progress=display)
            if mesh is not None:
                add_mesh(scene, mesh, frame=mesh_frame, unit=mesh_unit, spacing=mesh_spacing)
        for warning in volume.warnings:
            warn(warning)
        show(scene, listener, rate=rate, browser=browser, journalled=journal, recover=recover)


@app.command()
def demo(*, port: Port = 0, browser: Browser = True, rate: Rate = 1000) -> None:
    """Show the built-in phantom and feel it."""
    from palpate.cli_open import check_start, scene_of, show
    from palpate.phantom_scan import phantom
    from palpate.server import bind

    check_start(rate)
    with bind(port) as listener:
        with Display() as display:
            display("making the phantom", None)
            made = phantom()
            scene = scene_of(made.volume, bounds=None, label_map=None, progress=display)
            # something to make soft
            scene.add(made.part("liver"), shown_as="surface")
        show(scene, listener, rate=rate, browser=browser)


@app.command()
def info(  # one per option of the command line
    path: Scan,
    *,
    series: Series = None,
    orientation: Orientation = None,
    unit: Unit = None,
    fill: Fill = None,
    raw: Raw = None,
    voxel_size: VoxelSize = None,
    max_voxels: MaxVoxels = 1024**3,
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object.")] = False,
) -> None:
    """Tell what a scan is."""
    from palpate.cli_open import parse_voxel_size
    from palpate.info import describe, print_table
    from palpate.io import read

    size = parse_voxel_size(voxel_size)
    with quiet_libraries(), Display() as display:
        volume = read(
            path,
            series=series,
            orientation=orientation,
            unit=unit,
            fill=fill,
            raw=raw,
            voxel_size=size,
            max_voxels=max_voxels,
            progress=display,
        )
    if as_json:
        import json

        typer.echo(json.dumps(describe(volume), indent=2))
    else:
        print_table(volume)


@app.command()
def record(  # noqa: PLR0913  # one per option of the command line
    path: Scan,
    *,
    out: Annotated[
        Path, typer.Option(help="New .palpate-session file for the recording.", metavar="FILE")
    ],
    seconds: Annotated[
        float | None,
        typer.Option(help="How long; by default until Ctrl-C, or as long as the script is."),
    ] = None,
    script: Annotated[
        Path | None,
        typer.Option(help="Path for the device, .csv or .json; then nothing is shown."),
    ] = None,
    series: Series = None,
    orientation: Orientation = None,
    unit: Unit = None,
    fill: Fill = None,
    max_voxels: MaxVoxels = 1024**3,
    threshold: Threshold = None,
    segments: Segments = None,
    port: Port = 0,
    browser: Browser = True,
    rate: Rate = 1000,
) -> None:
    """Record a session, with every input of touch, so that it can be replayed."""
    from palpate.cli_open import check_rate, parse_threshold, scene_of
    from palpate.cli_record import check_out, check_seconds, record_page, record_script
    from palpate.io import read
    from palpate.scripted_file import read_path

    check_rate(rate)
    check_out(out)
    check_seconds(seconds)
    bounds = parse_threshold(threshold)
    scripted = None if script is None else read_path(script)
    with quiet_libraries(), Display() as display:
        volume = read(
            path,
            series=series,
            orientation=orientation,
            unit=unit,
            fill=fill,
            max_voxels=max_voxels,
            progress=display,
        )
        scene = scene_of(volume, bounds=bounds, label_map=segments, progress=display)
    for warning in volume.warnings:
        warn(warning)
    if scripted is not None:
        record_script(scene, out, path=scripted, seconds=seconds, rate=rate)
    else:
        record_page(scene, out, port=port, seconds=seconds, rate=rate, browser=browser)


@app.command()
def replay(
    file: Annotated[Path, typer.Argument(help="A .palpate-session file.", metavar="FILE")],
    *,
    csv: Annotated[
        Path | None, typer.Option(help="Write poses, forces and events as a table of text.")
    ] = None,
    npz: Annotated[Path | None, typer.Option(help="Write them as NumPy arrays.")] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object.")] = False,
) -> int:
    """Compute a recorded session again, and compare it bit for bit."""
    from palpate.cli_record import replay_file

    return replay_file(file, csv=csv, npz=npz, as_json=as_json)


app.command("export")(export)
app.command("import", epilog=IMPORT_EXAMPLES)(import_scan)
app.command("reconstruct", epilog=RECONSTRUCT_EXAMPLES)(reconstruct)
app.command("register", epilog=REGISTER_EXAMPLES)(register)
app.command("series")(series)
app.command("segment", epilog=EXAMPLES)(segment)
app.command("run", epilog=RECIPE_EXAMPLES)(run_file)


surface = typer.Typer(help="Meshes of segments, and voxels of meshes.", no_args_is_help=True)
app.add_typer(surface, name="surface")


@surface.command("export")
def surface_export(  # noqa: PLR0913  # one per option of the command line
    path: Scan,
    file: Annotated[Path, typer.Argument(help="New .stl, .ply, .obj or .glb.", metavar="FILE")],
    *,
    segment: Annotated[str | None, typer.Option(help="Its name, where there are several.")] = None,
    smoothing: Annotated[
        int | None, typer.Option(help="Degree, 0 to 12; 0 shows the voxels as they are.")
    ] = None,
    step: Annotated[int | None, typer.Option(help="Edge of a cell: 1, 2 or 4 voxels.")] = None,
    source: Annotated[
        str,
        typer.Option("--from", help="intensities (of a threshold) or bits, which have stairs."),
    ] = "intensities",
    series: Series = None,
    orientation: Orientation = None,
    unit: Unit = None,
    fill: Fill = None,
    max_voxels: MaxVoxels = 1024**3,
    threshold: Threshold = None,
    segments: Segments = None,
) -> None:
    """Write the surface of a segment to a file, in the patient (LPS)."""
    from palpate.cli_open import parse_threshold, scene_of
    from palpate.cli_surface import check_target, choose_segment, export_surface
    from palpate.io import read

    check_target(file)
    bounds = parse_threshold(threshold)
    with quiet_libraries(), Display() as display:
        volume = read(
            path,
            series=series,
            orientation=orientation,
            unit=unit,
            fill=fill,
            max_voxels=max_voxels,
            progress=display,
        )
        scene = scene_of(volume, bounds=bounds, label_map=segments, progress=display)
    chosen = choose_segment(scene, segment)
    export_surface(chosen, file, step=step, smoothing=smoothing, source=source)


@surface.command("voxels")
def surface_voxels(
    mesh: Annotated[Path, typer.Argument(help=".stl, .ply, .obj or .glb.", metavar="MESH")],
    file: Annotated[Path, typer.Argument(help="New .nrrd, .nii.gz or .mha.", metavar="FILE")],
    *,
    spacing: Annotated[float | None, typer.Option(help="Edge of a voxel [mm].")] = None,
    like: Annotated[Path | None, typer.Option(help="Scan whose grid is taken.")] = None,
    frame: Annotated[str | None, typer.Option(help="Of the mesh: LPS or RAS.")] = None,
    unit: Annotated[str | None, typer.Option(help="Of the mesh: mm or m.")] = None,
    close: Annotated[bool, typer.Option("--close", help="Close its holes.")] = False,
    shell: Annotated[bool, typer.Option("--shell", help="Only its surface.")] = False,
) -> None:
    """Make a label map of what a mesh encloses."""
    from palpate.cli_surface import MASK_SUFFIXES, check_target, mesh_file, write_voxels
    from palpate.errors import OptionError
    from palpate.io import read

    check_target(file, MASK_SUFFIXES)
    if (spacing is None) == (like is None):
        raise OptionError("one grid is needed; allowed: --spacing MM, or --like SCAN")
    with quiet_libraries(), Display() as display:
        given = mesh_file(mesh, frame=frame, unit=unit, close=close)
        grid = spacing if like is None else read(like, progress=display)
    assert grid is not None  # noqa: S101  # one of both is given
    write_voxels(given, file, grid=grid, shell=shell)


app.add_typer(scenario, name="scenario")


bench = typer.Typer(help="Measure.", no_args_is_help=True)
app.add_typer(bench, name="bench")
bench.command("fuzz-import")(bench_fuzz_import)
bench.command("deform")(bench_deform)
bench.command("open")(bench_open)
bench.command("render")(bench_render)
bench.command("register")(bench_register)
bench.command("segment")(bench_segment)
bench.command("session")(bench_session)
bench.command("truth-cube")(bench_truth_cube)


@bench.command("haptics")
def bench_haptics(
    *,
    data: Annotated[
        list[str] | None,
        typer.Option(help="A data set by name, or a scan; again for more; by default all."),
    ] = None,
    json_file: Annotated[
        Path | None, typer.Option("--json", help="Write the figures to this file.")
    ] = None,
    plot: Plot = None,
    count: Annotated[int | None, typer.Option(help="Calls of each case.")] = None,
    quick: Annotated[bool, typer.Option("--quick", help="Few calls: rough figures.")] = False,
) -> None:
    """Measure touch: contact detection alone, the hard proxy, and the complete tick."""
    from palpate.bench import haptics
    from palpate.bench.plots import check_plot, plot_haptics
    from palpate.bench.report import write_rows

    check_plot(plot)
    effort = haptics.effort(count=count, quick=quick)
    with quiet_libraries(), Display() as display:
        rows = haptics.measure(data or (), effort, progress=display)
    haptics.print_tables(rows)
    if json_file is not None:
        write_rows("haptics", rows, json_file)
    if plot is not None:
        plot_haptics(rows, plot)


@bench.command("passivity")
def bench_passivity(
    *,
    data: Annotated[
        Path | None, typer.Option(help="Scan to touch; by default the phantom.")
    ] = None,
    seconds: Annotated[float, typer.Option(help="Simulated time of each run.")] = 60.0,
    device: Annotated[
        list[str] | None, typer.Option(help="A device, again for more; by default all.")
    ] = None,
    json_file: Annotated[
        Path | None, typer.Option("--json", help="Write the figures to this file.")
    ] = None,
) -> None:
    """Measure whether touch gives the hand energy, and the stiffest wall that does not."""
    from palpate.bench.passivity import DEVICES, measure, print_table
    from palpate.bench.report import write_rows
    from palpate.errors import OptionError
    from palpate.io import read
    from palpate.phantom_scan import phantom

    for name in device or ():
        if name not in DEVICES:
            raise OptionError(f"device {name!r} given; allowed: {', '.join(DEVICES)}")
    devices = [name for name in DEVICES if not device or name in device]
    with quiet_libraries(), Display() as display:
        display("loading the scan", None)
        volume = phantom().volume if data is None else read(data, progress=display)
        bone = volume.offered_bone()
        rows = measure(bone, seconds=seconds, devices=devices, progress=display)
    print_table(rows)
    if json_file is not None:
        write_rows("passivity", rows, json_file)


@bench.command("touch-quality")
def bench_touch_quality(
    *,
    touch: Annotated[
        list[str] | None,
        typer.Option(help="A way of touch, again for more; by default all."),
    ] = None,
    json_file: Annotated[
        Path | None, typer.Option("--json", help="Write the figures to this file.")
    ] = None,
    plot: Plot = None,
) -> None:
    """Measure how well touch tells bodies whose shape is known exactly."""
    from palpate.bench.goals import TOUCHES
    from palpate.bench.plots import check_plot, plot_quality
    from palpate.bench.quality import measure, print_tables
    from palpate.bench.report import write_rows
    from palpate.errors import OptionError

    for name in touch or ():
        if name not in TOUCHES:
            raise OptionError(f"way of touch {name!r} given; allowed: {', '.join(TOUCHES)}")
    touches = [name for name in TOUCHES if not touch or name in touch]
    check_plot(plot)
    with Display() as display:
        rows = measure(touches=touches, progress=display)
    print_tables(rows)
    if json_file is not None:
        write_rows("touch-quality", rows, json_file)
    if plot is not None:
        plot_quality(rows, plot)


@bench.command("stress")
def bench_stress(  # one per option of the command line
    *,
    moves: Annotated[int, typer.Option(help="Moves to make at least.")] = 1_000_000,
    seed: Annotated[int, typer.Option(help="Another seed makes other moves.")] = 1,
    replay: Annotated[
        Path | None, typer.Option(help="Make only the run of this file again.")
    ] = None,
    data: Annotated[
        Path | None, typer.Option(help="Scan with bone to touch; by default the phantom.")
    ] = None,
    json_file: Annotated[
        Path | None, typer.Option("--json", help="Write the figures to this file.")
    ] = None,
    threads: Annotated[
        int | None, typer.Option(help="How many work at it; by default all cores.")
    ] = None,
    case: Annotated[
        Path, typer.Option(help="Where a violation is written, to be replayed.")
    ] = Path("stress-violation.json"),
    deform: Annotated[
        list[str] | None,
        typer.Option(help="Instead, work in matter that gives way by this model, or by all."),
    ] = None,
    model: Annotated[str, typer.Option(hidden=True)] = "exact",
) -> int:
    """Move at random and fast, and check every guarantee of touch at each move."""
    if deform:
        return stress_in_matter(
            deform, moves=moves, seed=seed, threads=threads, json_file=json_file
        )
    from palpate.bench.report import print_rows, write_rows
    from palpate.bench.stress import Plan, again, measure, rows_of, write_case
    from palpate.io import read
    from palpate.phantom_scan import phantom

    plan = Plan(seed=seed, model=model, data=None if data is None else str(data))
    if replay is not None:
        plan = Plan.of_file(replay)
    with quiet_libraries(), Display() as display:
        display("loading the scan", None)
        volume = phantom().volume if plan.data is None else read(Path(plan.data), progress=display)
        bone = volume.offered_bone()
        found = (
            measure(bone, plan, moves=moves, threads=threads, progress=display)
            if replay is None
            else again(bone, plan)
        )
    rows = rows_of(found)
    print_rows(f"stress among the bone of {volume.name}", rows)
    if json_file is not None:
        write_rows("stress", rows, json_file)
    if found.violation is None:
        return 0
    typer.echo(found.told())
    if replay is None:
        write_case(found, case)
        typer.echo(f"again: palpate bench stress --replay {case}")
    return 1


@bench.command("servo")
def bench_servo(
    *,
    seconds: Annotated[float, typer.Option(help="Time of each case [s].")] = 10.0,
    json_file: Annotated[
        Path | None, typer.Option("--json", help="Write the figures to this file.")
    ] = None,
) -> None:
    """Measure how late the ticks of the servo begin, at rest and with all cores busy."""
    from palpate.bench.report import print_rows, write_rows
    from palpate.bench.servo import measure, rows_of, told

    with Display() as display:
        found = measure(seconds, display)
    for one in found:
        typer.echo(told(one) + "\n")
    rows = rows_of(found)
    print_rows("servo", rows)
    if not all(one.real_time for one in found):
        warn("no real-time priority here; allowed: as root, or with ulimit -r 70")
    if json_file is not None:
        write_rows("servo", rows, json_file)


@bench.command("edit")
def bench_edit(
    scan: Annotated[
        Path | None, typer.Argument(help="A scan with bone; by default CThead.", metavar="PATH")
    ] = None,
    *,
    seconds: Annotated[float, typer.Option(help="How long to erase in each case.")] = 8.0,
    json_file: Annotated[
        Path | None, typer.Option("--json", help="Write the figures to this file.")
    ] = None,
) -> None:
    """Measure how long edits take to a page's GPU; needs an installed Chromium."""
    from palpate.bench.edit import measure
    from palpate.bench.report import print_rows, write_rows

    with quiet_libraries(), Display() as display:
        rows = measure(scan, seconds=seconds, progress=display)
    print_rows("edit", rows)
    if json_file is not None:
        write_rows("edit", rows, json_file)


@bench.command("surface")
def bench_surface(
    *,
    json_file: Annotated[
        Path | None, typer.Option("--json", help="Write the figures to this file.")
    ] = None,
) -> None:
    """Measure how fast surfaces are made and follow edits, beside VTK."""
    from palpate.bench.report import print_rows, write_rows
    from palpate.bench.surface import measure

    with quiet_libraries(), Display() as display:
        rows, missing = measure(display)
    print_rows("surface", rows)
    for sentence in missing:
        warn(f"not measured: {sentence} is not there; allowed: PALPATE_DATA with it")
    if json_file is not None:
        write_rows("surface", rows, json_file)
