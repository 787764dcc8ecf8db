"""``palpate bench haptics``, ``passivity``, ``touch-quality``, ``stress``, ``servo`` of touch."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from palpate.base.console import Display, quiet_libraries, warn
from palpate.cli.bench import stress_in_matter
from palpate.cli.options import Plot

__all__ = ["bench_haptics", "bench_passivity", "bench_servo", "bench_stress", "bench_touch_quality"]


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
        typer.Option(help="A way of touch, again for more; by default all."),
    ] = None,
    json_file: Annotated[
        Path | None, typer.Option("--json", help="Write the figures to this file.")
    ] = None,
    plot: Plot = None,
) -> None:
    """Measure how well touch tells bodies whose shape is known exactly."""
    from palpate.base.errors import OptionError
    from palpate.bench.goals import TOUCHES
    from palpate.bench.plots import check_plot, plot_quality
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
    typer.echo(found.told())
    if replay is None:
        write_case(found, case)
        typer.echo(f"again: palpate bench stress --replay {case}")
    return 1


def bench_servo(
    *,
    seconds: Annotated[float, typer.Option(help="Of each case.")] = 10.0,
    json_file: Annotated[
        Path | None, typer.Option("--json", help="Write the figures to this file.")
    ] = None,
) -> None:
    """Measure how late servo ticks begin: at rest, with all cores busy, with matter giving way."""
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
