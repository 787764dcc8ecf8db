"""``palpate bench deform``, ``session``, ``truth-cube`` of soft tissue; ``open`` and others."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import typer

from palpate.base.console import Display, quiet_libraries, warn
from palpate.cli.options import Plot
from palpate.cli.written_files import WRITES

__all__ = [
    "bench_cohort",
    "bench_deform",
    "bench_edit",
    "bench_fuzz_import",
    "bench_open",
    "bench_register",
    "bench_render",
    "bench_segment",
    "bench_session",
    "bench_surface",
    "bench_truth_cube",
]

Json = Annotated[
    Path | None,
    typer.Option("--json", help="Write the results to this file (.json)."),
    WRITES,
]


def bench_deform(
    *,
    json_file: Json = None,
    quick: Annotated[bool, typer.Option("--quick", help="Short run with rough results.")] = False,
) -> None:
    """Measure deformation models: the lattice, and Lennard-Jones pairs compared with LAMMPS."""
    from palpate.bench.deform import CANNOT, QUICK, Effort, measure
    from palpate.bench.report import print_rows, write_rows

    with Display() as display:
        rows, missing = measure(QUICK if quick else Effort(), display)
    print_rows("deform", rows)
    typer.echo(CANNOT)
    for sentence in missing:
        warn(f"not measured: {sentence}")
    if json_file is not None:
        write_rows("deform", rows, json_file)


def bench_session(
    *,
    seconds: Annotated[
        int, typer.Option(min=1, max=3600, help="Number of one-second samples per case.")
    ] = 60,
    data: Annotated[
        list[str] | None,
        typer.Option(help="Data set to touch; repeatable; by default all."),
    ] = None,
    model: Annotated[
        list[str] | None,
        typer.Option(help="Deformation model, or none for hard; repeatable; by default all."),
    ] = None,
    json_file: Json = None,
) -> None:
    """Measure the rates of servo and deformation, with each model and without."""
    from palpate.bench.free_session import Pace, measure
    from palpate.bench.report import print_rows, write_rows

    with quiet_libraries(), Display() as display:
        rows, missing = measure(data or (), Pace(seconds), display, models=model or ())
    print_rows("session", rows)
    for sentence in missing:
        warn(f"not measured: {sentence} is not there; allowed: PALPATE_DATA with it")
    if json_file is not None:
        write_rows("session", rows, json_file)


def bench_open(*, json_file: Json = None) -> None:
    """Measure the time from a DICOM series to the first picture; needs Chromium."""
    from palpate.base.errors import OptionError
    from palpate.bench.haptics_data import MissingDataError
    from palpate.bench.opening import measure
    from palpate.bench.report import print_rows, write_rows

    try:
        with quiet_libraries(), Display() as display:
            rows = measure(progress=display)
    except MissingDataError as error:
        raise OptionError(f"no {error}; allowed: PALPATE_DATA with it") from None
    print_rows("open", rows)
    if json_file is not None:
        write_rows("open", rows, json_file)


def bench_render(
    *,
    scan: Annotated[
        Path | None, typer.Argument(help="Scan to draw; by default CThead.", show_default=False)
    ] = None,
    drawer: Annotated[
        Literal["auto", "engine", "browser"],
        typer.Option(
            help="Who draws what is seen: auto as the page chooses, and the browser alone as well; "
            "engine or browser for one of them."
        ),
    ] = "auto",
    quick: Annotated[
        bool, typer.Option("--quick", help="Few pictures with rough results.")
    ] = False,
    vtk: Annotated[
        Path | None,
        typer.Option(
            help="vtk.js as built by `npm run build:bench`; by default that of the source tree.",
            show_default=False,
        ),
    ] = None,
    json_file: Json = None,
) -> None:
    """Measure what is seen on the page, compared with VTK and vtk.js; needs Chromium."""
    from palpate.base.errors import OptionError
    from palpate.bench.haptics_data import MissingDataError
    from palpate.bench.pictures.render import QUICK, Effort, built_peer, measure
    from palpate.bench.report import print_rows, write_rows

    peer = vtk or built_peer()
    try:
        with quiet_libraries(), Display() as display:
            effort = QUICK if quick else Effort()
            found = measure(scan, drawer=drawer, peer=peer, effort=effort, progress=display)
    except MissingDataError as error:
        raise OptionError(f"no {error}; allowed: PALPATE_DATA with it, or SCAN") from None
    print_rows(f"render, the browser's own by {found.renderer}", found.rows)
    for sentence in found.missing:
        warn(f"not measured: {sentence}")
    if peer is None:
        warn(
            "not measured: vtk.js is not built; allowed: `npm run build:bench` in viewer/, or --vtk"
        )
    if json_file is not None:
        write_rows("render", found.rows, json_file)


def bench_cohort(
    *,
    cases: Annotated[
        int, typer.Option(min=1, max=1_000_000, help="Number of cases without steps.")
    ] = 10_000,
    json_file: Json = None,
) -> None:
    """Measure what a case of a cohort costs beside its steps."""
    from importlib.util import find_spec

    from palpate.base.errors import OptionError
    from palpate.bench.report import print_rows, write_rows
    from palpate.cli.recipe_over import NO_DASK

    if find_spec("distributed") is None:
        raise OptionError(NO_DASK)
    from palpate.bench.cohort import measure

    with Display() as display:
        rows = measure(cases, display)
    print_rows("cohort", rows)
    if json_file is not None:
        write_rows("cohort", rows, json_file)


def bench_register(*, json_file: Json = None) -> None:
    """Measure registration: lung landmarks compared with elastix, and CT with simulated MR."""
    from palpate.base.errors import OptionError
    from palpate.bench.haptics_data import MissingDataError
    from palpate.bench.registration import measure
    from palpate.bench.report import print_rows, write_rows

    try:
        with quiet_libraries(), Display() as display:
            rows = measure(display)
    except MissingDataError as error:
        raise OptionError(f"no {error}; allowed: PALPATE_DATA with it") from None
    print_rows("register", rows)
    if json_file is not None:
        write_rows("register", rows, json_file)


def bench_segment(
    *,
    runs: Annotated[
        int, typer.Option(min=1, max=20, help="Number of runs; the median is reported.")
    ] = 3,
    grow: Annotated[
        bool, typer.Option("--grow", help="Only click into labelled organs, and grow crisp balls.")
    ] = False,
    json_file: Json = None,
) -> None:
    """Measure thresholds with their surface, region growing, and many segments at once."""
    from palpate.base.errors import OptionError
    from palpate.bench import growing, segmenting
    from palpate.bench.haptics_data import MissingDataError
    from palpate.bench.report import print_rows, write_rows

    try:
        with quiet_libraries(), Display() as display:
            if grow:
                rows = growing.measure(progress=display)
            else:
                rows = segmenting.measure(runs=runs, progress=display)
    except MissingDataError as error:
        raise OptionError(f"no {error}; allowed: PALPATE_DATA with it") from None
    print_rows("segment --grow" if grow else "segment", rows)
    if json_file is not None:
        write_rows("segment --grow" if grow else "segment", rows, json_file)


def bench_truth_cube(*, json_file: Json = None, plot: Plot = None) -> None:
    """Compare the lattice with a measured silicone cube under load, and with FEM."""
    from palpate.base.errors import OptionError
    from palpate.base.plot_file import check_plot
    from palpate.bench.haptics_data import MissingDataError
    from palpate.bench.plots import plot_truth_cube
    from palpate.bench.report import print_rows, write_rows
    from palpate.bench.truth_cube import Cube, measure

    check_plot(plot)
    try:
        with Display() as display:
            rows, moved = measure(display)
    except MissingDataError as error:
        raise OptionError(f"no {error}; allowed: PALPATE_DATA with it") from None
    print_rows("truth-cube", rows)
    if json_file is not None:
        write_rows("truth-cube", rows, json_file)
    if plot is not None:
        plot_truth_cube(Cube.load(), moved, plot)


def bench_edit(
    scan: Annotated[
        Path | None, typer.Argument(help="Scan with bone; by default CThead.", metavar="PATH")
    ] = None,
    *,
    seconds: Annotated[float, typer.Option(help="Duration of erasing per case in s.")] = 8.0,
    json_file: Json = None,
) -> None:
    """Measure the time from an edit to the page's GPU; needs Chromium."""
    from palpate.bench.edit import measure
    from palpate.bench.report import print_rows, write_rows

    with quiet_libraries(), Display() as display:
        rows = measure(scan, seconds=seconds, progress=display)
    print_rows("edit", rows)
    if json_file is not None:
        write_rows("edit", rows, json_file)


def bench_surface(*, json_file: Json = None) -> None:
    """Measure surface extraction and updates after edits, compared with VTK."""
    from palpate.bench.report import print_rows, write_rows
    from palpate.bench.surface import measure

    with quiet_libraries(), Display() as display:
        rows, missing = measure(display)
    print_rows("surface", rows)
    for sentence in missing:
        warn(f"not measured: {sentence} is not there; allowed: PALPATE_DATA with it")
    if json_file is not None:
        write_rows("surface", rows, json_file)


def bench_fuzz_import(
    folder: Annotated[
        Path | None,
        typer.Argument(help="Files to damage; by default the data sets.", metavar="FOLDER"),
    ] = None,
    *,
    minutes: Annotated[
        float | None, typer.Option(help="Duration in minutes; by default one.")
    ] = None,
    cases: Annotated[
        int | None, typer.Option(min=1, help="Number of cases, instead of a duration.")
    ] = None,
    seed: Annotated[
        int, typer.Option(min=0, help="Random seed of the first case; each further case adds one.")
    ] = 1,
    only: Annotated[
        list[str] | None,
        typer.Option(help="Kind of files, such as neuro, dicom or segments; may be repeated."),
    ] = None,
) -> int:
    """Fuzz the readers with damaged real files, each in its own process."""
    from palpate.base.errors import OptionError
    from palpate.bench.fuzz_import import measure
    from palpate.bench.haptics_data import folder as data_folder

    if minutes is not None and cases is not None:
        raise OptionError("minutes and cases given; allowed: one of both")
    place = folder or data_folder()
    if not place.is_dir():
        raise OptionError(f"{place} is no folder; allowed: a folder with scans, or PALPATE_DATA")
    seconds = None if cases is not None else 60.0 * (minutes or 1.0)
    kinds = only or []
    with Display() as display:
        found = measure(
            place, seed=seed, cases=cases, seconds=seconds, only=kinds, progress=display
        )
    again = " ".join(
        ["palpate bench fuzz-import", *([str(folder)] if folder else [])]
        + [f"--only {kind}" for kind in kinds]
    )
    for case, sample, outcome in found.violations:
        typer.echo(f"seed {case}, {sample}: {outcome}")
        typer.echo(f"again: {again} --cases 1 --seed {case}\n")
    told = ", ".join(f"{number} {kind}" for kind, number in sorted(found.outcomes.items()))
    typer.echo(f"{found.cases} damaged files from seed {seed} on: {told}")
    return 1 if found.violations else 0
