"""``palpate run --over``, ``--table`` and ``--bids``: a recipe over many scans."""

from __future__ import annotations

import signal
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path

import typer

from palpate.base.console import clear_line, replace_line, warn
from palpate.base.errors import OptionError
from palpate.cohort.bids import cases_of_bids
from palpate.cohort.case import Case, share_of
from palpate.cohort.limits import Limits
from palpate.cohort.locked_cases import locked_cases
from palpate.cohort.matches import cases_over
from palpate.cohort.one_case import CaseResult
from palpate.cohort.output_folder import CohortFolder
from palpate.cohort.overview import write_overview
from palpate.cohort.run import Outcome, run_cases, wanted_cases
from palpate.cohort.table import cases_of_table

__all__ = ["SOME_FAILED", "OverOptions", "run_over"]

SOME_FAILED = 3
"""Exit code where some cases failed."""
STOPPED = 130

NO_DASK = (
    "Dask is not installed; allowed: neither --workers nor --scheduler, or with it "
    "(`pip install 'palpate[cohort]'`)"
)


@dataclass(frozen=True, kw_only=True)
class OverOptions:
    """Which cases are run, where to, and how."""

    over: str | None = None
    table: Path | None = None
    bids: Path | None = None
    participants: Sequence[str] = ()
    suffix: str | None = None
    output: Path | None
    shard: str | None = None
    only_failed: bool = False
    dry_run: bool = False
    workers: int | None = None
    scheduler: str | None = None
    limits: Limits


def run_over(recipe: Path, options: OverOptions) -> int:
    """Runs a recipe over many scans; returns the exit code.

    Raises:
        OptionError: Something given is wrong; nothing was written.
        OSError: The output folder cannot be written.
    """
    output = _checked(options)
    cases = _cases(options)
    folder = CohortFolder(output)
    wanted = wanted_cases(recipe, cases, folder, only_failed=options.only_failed)
    others = "left out" if options.only_failed else "kept"
    rest = f"{len(cases) - len(wanted)} {others}"
    for case in wanted if options.dry_run else ():
        typer.echo(case.name)
    typer.echo(f"{len(wanted)} to run, {rest}")
    if options.dry_run:
        return 0
    folder.begin()
    with locked_cases(folder, wanted, warned=warn):
        outcome = _run(recipe, wanted, folder, options=options)
    page, _ = write_overview(folder)
    left = len(wanted) - len(outcome.done) - len(outcome.failed)
    typer.echo(
        f"{len(outcome.done)} done, {len(outcome.failed)} failed, {rest}"
        + (f", {left} left: the same command goes on" if left else "")
    )
    typer.echo(f"{page} written")
    if outcome.stopped:
        return STOPPED
    return SOME_FAILED if outcome.failed else 0


def _checked(options: OverOptions) -> Path:
    """Returns the output folder of options that go together.

    Raises:
        OptionError: They do not.
    """
    ways = {"--over": options.over, "--table": options.table, "--bids": options.bids}
    given = [name for name, value in ways.items() if value is not None]
    if len(given) != 1:
        raise OptionError(f"{' and '.join(given)} given; allowed: one of {', '.join(ways)}")
    if options.bids is None and (options.participants or options.suffix):
        raise OptionError("--participant-label or --suffix given; allowed: with --bids")
    if options.output is None:
        raise OptionError("no output folder given; allowed: --output FOLDER")
    if options.workers is not None and options.scheduler is not None:
        raise OptionError("--workers and --scheduler given; allowed: one of both")
    if options.limits.memory is not None and sys.platform != "linux":
        raise OptionError("a memory limit given; allowed: none on this system, only Linux has one")
    return options.output


def _cases(options: OverOptions) -> list[Case]:
    if options.table is not None:
        cases = cases_of_table(options.table)
    elif options.bids is not None:
        cases = cases_of_bids(
            options.bids, participants=options.participants, suffix=options.suffix
        )
    else:
        cases = cases_over(options.over or "")
    return cases if options.shard is None else share_of(cases, options.shard)


def _run(recipe: Path, cases: list[Case], folder: CohortFolder, *, options: OverOptions) -> Outcome:
    stopping: list[bool] = []

    def stop(*_: object) -> None:
        if stopping:
            raise KeyboardInterrupt
        stopping.append(True)
        warn("stopping once the cases that run are done; Ctrl-C again stops at once")

    told, stopped = _progress(len(cases)), lambda: bool(stopping)
    before = signal.signal(signal.SIGINT, stop)
    try:
        if cases and (options.workers is not None or options.scheduler is not None):
            return _run_on_cluster(recipe, cases, folder, options=options, told=told, stop=stopped)
        return run_cases(recipe, cases, folder, limits=options.limits, told=told, stop=stopped)
    finally:
        clear_line()
        signal.signal(signal.SIGINT, before)


def _progress(count: int) -> Callable[[Outcome, CaseResult], None]:
    """Returns what tells failed cases, and on a terminal how far all are."""
    begun = time.monotonic()

    def told(outcome: Outcome, result: CaseResult) -> None:
        if result.reason is not None:
            warn(f"{result.name} failed: {result.reason}")
        if sys.stderr.isatty():
            ended = len(outcome.done) + len(outcome.failed)
            rate = ended / (time.monotonic() - begun)
            left = count - ended
            replace_line(
                f"{len(outcome.done)} done, {len(outcome.failed)} failed, {left} left, "
                f"{rate * 60:.1f} a minute, {left / rate / 60:.0f} min to go",
                last=not left,
            )

    return told


def _run_on_cluster(
    recipe: Path,
    cases: list[Case],
    folder: CohortFolder,
    *,
    options: OverOptions,
    told: Callable[[Outcome, CaseResult], None],
    stop: Callable[[], bool],
) -> Outcome:
    if find_spec("distributed") is None:
        raise OptionError(NO_DASK)
    from palpate.cohort.cluster import cluster_client, workers_page
    from palpate.cohort.dask_run import run_on_cluster

    with cluster_client(workers=options.workers, scheduler=options.scheduler) as client:
        typer.echo(f"workers: {workers_page(client)}")
        return run_on_cluster(
            recipe,
            cases,
            folder,
            client=client,
            limits=options.limits,
            told=told,
            warned=warn,
            stop=stop,
        )
