"""``palpate bench haptics``, ``passivity``, ``touch-quality``, ``stress``, ``servo`` of touch."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from palpate.base.console import Display, quiet_libraries, warn
from palpate.cli.options import Plot
from palpate.cli.written_files import WRITES

__all__ = ["bench_haptics", "bench_passivity", "bench_servo", "bench_stress", "bench_touch_quality"]


def bench_haptics(
    *,
    data: Annotated[
        list[str] | None,
        typer.Option(help="Data set by name, or a scan; repeatable; by default all."),
    ] = None,
    json_file: Annotated[
        Path | None,
        typer.Option("--json", help="Write the results to this file (.json)."),
        WRITES,
    ] = None,
    plot: Plot = None,
    count: Annotated[int | None, typer.Option(help="Number of calls per case.")] = None,
    quick: Annotated[bool, typer.Option("--quick", help="Few calls with rough results.")] = False,
) -> None:
    """Measure touch: contact detection alone, the hard proxy, and the complete tick."""
    from palpate.base.plot_file import check_plot
    from palpate.bench import haptics
    from palpate.bench.plots import plot_haptics
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


def bench_passivity(
    *,
    data: Annotated[
        Path | None, typer.Option(help="Scan to touch; by default the phantom.")
    ] = None,
    seconds: Annotated[float, typer.Option(help="Simulated time per run in s.")] = 60.0,
    device: Annotated[
        list[str] | None, typer.Option(help="Device; repeatable; by default all.")
    ] = None,
    json_file: Annotated[
        Path | None,
        typer.Option("--json", help="Write the results to this file (.json)."),
        WRITES,
    ] = None,
) -> None:
    """Measure passivity: energy given to the hand, and the stiffest passive wall."""
    from palpate.base.errors import OptionError
    from palpate.bench.passivity import DEVICES, measure, print_table
    from palpate.bench.report import write_rows
    from palpate.io.reading import read
    from palpate.volumes.phantom import phantom

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


def bench_touch_quality(
    *,
    touch: Annotated[
        list[str] | None,
        typer.Option(help="Kind of touch; repeatable; by default all."),
    ] = None,
    json_file: Annotated[
        Path | None,
        typer.Option("--json", help="Write the results to this file (.json)."),
        WRITES,
    ] = None,
    plot: Plot = None,
) -> None:
    """Measure the accuracy of the force on bodies that are known exactly."""
    from palpate.base.errors import OptionError
    from palpate.base.plot_file import check_plot
    from palpate.bench.goals.quality import TOUCHES
    from palpate.bench.plots import plot_quality
    from palpate.bench.quality import measure, print_tables
    from palpate.bench.report import write_rows

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


def bench_stress(  # one per option of the command line
    *,
    moves: Annotated[int, typer.Option(help="Minimum number of moves.")] = 1_000_000,
    seed: Annotated[int, typer.Option(help="Random seed of the moves.")] = 1,
    replay: Annotated[Path | None, typer.Option(help="Repeat only the run of this file.")] = None,
    data: Annotated[
        Path | None, typer.Option(help="Scan with bone; by default the phantom.")
    ] = None,
    json_file: Annotated[
        Path | None,
        typer.Option("--json", help="Write the results to this file (.json)."),
        WRITES,
    ] = None,
    threads: Annotated[
        int | None, typer.Option(help="Number of threads; by default all cores.")
    ] = None,
    case: Annotated[
        Path, typer.Option(help="Write a violation to this file, for --replay."), WRITES
    ] = Path("stress-violation.json"),
    deform: Annotated[
        list[str] | None,
        typer.Option(help="Stress soft tissue instead, with this deformation model or with all."),
    ] = None,
    model: Annotated[str, typer.Option(hidden=True)] = "exact",
) -> int:
    """Check every guarantee of touch under fast random motion."""
    if deform:
        return _stress_in_soft_tissue(
            deform, moves=moves, seed=seed, threads=threads, json_file=json_file
        )
    from palpate.bench.report import print_rows, write_rows
    from palpate.bench.stress import Plan, again, measure, rows_of, write_case
    from palpate.io.reading import read
    from palpate.volumes.phantom import phantom

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
    typer.echo(found.message())
    if replay is None:
        write_case(found, case)
        typer.echo(f"again: palpate bench stress --replay {case}")
    return 1


def bench_servo(
    *,
    seconds: Annotated[float, typer.Option(help="Duration per case in s.")] = 10.0,
    json_file: Annotated[
        Path | None,
        typer.Option("--json", help="Write the results to this file (.json)."),
        WRITES,
    ] = None,
) -> None:
    """Measure the lateness of servo ticks: idle, with all cores busy, and with soft tissue."""
    from palpate.bench.report import print_rows, write_rows
    from palpate.bench.servo import histogram, measure, rows_of

    with Display() as display:
        found = measure(seconds, display)
    for one in found:
        typer.echo(histogram(one) + "\n")
    rows = rows_of(found)
    print_rows("servo", rows)
    if not all(one.real_time for one in found):
        warn("no real-time priority here; allowed: as root, or with ulimit -r 70")
    if json_file is not None:
        write_rows("servo", rows, json_file)


def _stress_in_soft_tissue(
    models: list[str], *, moves: int, seed: int, threads: int | None, json_file: Path | None
) -> int:
    """Works in soft tissue with each model of deformation for so many ticks."""
    from palpate.bench.report import print_rows, write_rows
    from palpate.bench.soft_tissue_stress import checked_models, rows_of, work

    chosen = checked_models(models)
    with Display() as display:
        found = [
            work(model, moves=moves, seed=seed, threads=threads, progress=display)
            for model in chosen
        ]
    rows = rows_of(found)
    print_rows("stress in soft tissue", rows)
    if json_file is not None:
        write_rows("stress-deform", rows, json_file)
    broken = [f"{one.model}: {one.violation}" for one in found if one.violation is not None]
    for sentence in broken:
        typer.echo(sentence)
    return 1 if broken else 0
