"""``palpate bench haptics``: collision detection alone, the contact model, the complete tick.

Each is timed on bones of scans and of the phantom, warm, on a path that presses and slides 0.2 h
per update and repeats no sample; detection is timed on rays of 1, 4 and 10 voxels near the surface
that meet nothing. The loops run in the engine, on one thread, on the data structures of the servo.

"hard proxy" is the contact model alone; "complete tick" adds smoothing, friction, coupling and the
safety stage. The thesis' models as printed follow the same path in the same run; they only have
points, so balls are measured with ``exact`` only. Radii are in h, the smallest spacing; a ball
presses as deep as a point, measured from its own surface. A ratio is one of calls per second.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, cast

from palpate import _core
from palpate.base.errors import OptionError
from palpate.base.harmless_text import terminal
from palpate.base.progress import Progress, silent
from palpate.bench.goals import Goal
from palpate.bench.goals.haptics import (
    EMBEDDED,
    EMBEDDED_ROWS,
    EMBEDDED_WORKS,
    EXACT,
    GROUNDS,
    IMPROVED,
    PUBLISHED,
    PUBLISHED_BY_OTHERS,
    RADII,
    RATIO,
    TOUCH_CASES,
    WORKS,
    TouchCase,
    haptics_rows,
)
from palpate.bench.haptics_data import (
    EMBEDDED_IN,
    SOURCES,
    MissingDataError,
    Source,
    cthead_bone,
    ground_of,
)
from palpate.bench.report import Row, row_of
from palpate.io.reading import read
from palpate.volumes.segment import Segment

__all__ = [
    "Effort",
    "effort",
    "measure",
    "measure_embedded",
    "measure_ground",
    "print_tables",
    "published",
    "sources",
]

SEED = 1

COUNT = 300_000
QUICK_COUNT = 2_000
COLD_COUNT = 300
QUICK_COLD_COUNT = 10

SEPARATOR = ": "
LEFT_OUT = "left out"


@dataclass(frozen=True)
class Effort:
    """How much is measured."""

    count: int = COUNT
    """Calls of each case."""
    cold_count: int = COLD_COUNT
    """Cold random starts."""


def effort(*, count: int | None, quick: bool) -> Effort:
    """Returns how much is measured: little, much, or so many calls of each case."""
    usual = Effort(QUICK_COUNT, QUICK_COLD_COUNT) if quick else Effort()
    return usual if count is None else replace(usual, count=count)


def sources(names: Sequence[str]) -> tuple[Source, ...]:
    """Returns the data sets of these names, or all of them; a path is one of a scan.

    Raises:
        OptionError: It is neither a name nor a path.
    """
    known = {source.name: source for source in SOURCES}
    found = []
    for name in names:
        if name == EMBEDDED:
            continue
        if name not in known and not Path(name).exists():
            allowed = ", ".join((*GROUNDS, EMBEDDED))
            raise OptionError(f"data {name!r} given; allowed: the path of a scan, or {allowed}")
        found.append(known.get(name) or _scan(Path(name)))
    return tuple(found) if names else SOURCES


def _scan(path: Path) -> Source:
    return Source(f"bone of {path.name}", lambda: ground_of(read(path).offered_bone()))


def measure(names: Sequence[str], amount: Effort, *, progress: Progress = silent) -> list[Row]:
    """Measures touch on data sets, and the embedded body where it is among them.

    Args:
        names: Names of data sets; none for all. A missing one gives a row that says so.
        amount: How much is measured.
        progress: Takes the progress.
    """
    rows: list[Row] = []
    for source in sources(names):
        progress(f"loading {source.name}", None)
        try:
            ground = source.load()
        except MissingDataError as error:
            rows.append(_left_out(source.name, error))
            continue
        rows += measure_ground(source.name, ground, amount.count, progress=progress)
    if not names or EMBEDDED in names:
        try:
            rows += measure_embedded(cthead_bone(), amount, progress=progress)
        except MissingDataError as error:
            rows.append(_left_out(EMBEDDED, error))
    return rows + published()


def measure_ground(
    name: str, ground: _core.Ground | Segment, count: int, *, progress: Progress = silent
) -> list[Row]:
    """Measures all cases on one data set.

    Args:
        name: Name in the report.
        ground: The segments to touch.
        count: Calls of each case.
        progress: Takes the progress.

    Raises:
        OptionError: There is no surface, or the count is not allowed.
    """
    touched = ground_of(ground) if isinstance(ground, Segment) else ground
    reports: dict[TouchCase, dict[str, float]] = {}
    try:
        for radius in RADII:
            progress(f"{name}: a path for r {radius}", None)
            bench = _core.TouchBench(touched, float(radius), count, SEED)
            for case in TOUCH_CASES:
                if case.radius == radius:
                    progress(f"{name}: {case.name}", len(reports) / len(TOUCH_CASES))
                    reports[case] = bench.run(WORKS[case.work], cast("Any", case.model))
    except ValueError as error:
        raise OptionError(str(error)) from None
    for case, report in reports.items():
        beside = reports.get(TouchCase(case.work, IMPROVED, case.radius))
        if beside is not None:
            report[RATIO] = report["per_second"] / beside["per_second"]
    by_case = {f"{name}{SEPARATOR}{case.name}": report for case, report in reports.items()}
    return [row_of(goal, by_case[goal.case]) for goal in haptics_rows(name)]


def measure_embedded(
    small: _core.Ground, amount: Effort, *, progress: Progress = silent
) -> list[Row]:
    """Measures the same body and path in its own scan and inside a large one.

    Raises:
        OptionError: There is no surface, or the count is not allowed.
    """
    reports: dict[str, dict[str, float]] = {}
    progress(f"making {EMBEDDED}", None)
    try:
        large = small.embedded(EMBEDDED_IN)
        for done, work in enumerate(EMBEDDED_WORKS):
            progress(f"{EMBEDDED}: {work}", done / len(EMBEDDED_WORKS))
            report = _core.bench_embedded(
                small, large, WORKS[work], amount.count, amount.cold_count, SEED
            )
            reports[f"{EMBEDDED}: {work}"] = {
                "small_per_second": report["small_per_second"],
                "large_per_second": report["large_per_second"],
                "ratio": report["ratio"],
                "contact_share": report["contact_share"],
            }
            cold = f"{EMBEDDED}: hard proxy, cold random starts"
            reports[f"{cold}, small"] = report["small_cold"]
            reports[f"{cold}, 1024³"] = report["large_cold"]
    except ValueError as error:
        raise OptionError(str(error)) from None
    return [row_of(goal, reports[goal.case]) for goal in EMBEDDED_ROWS]


def published() -> list[Row]:
    """Returns published figures of other programs on other machines."""
    return [
        row_of(
            Goal(f"{PUBLISHED_BY_OTHERS}: {case}", "rate", "rate", 1.0, "M/s", None, "higher"),
            {"rate": rate},
        )
        for case, rate in PUBLISHED
    ]


def _left_out(name: str, error: MissingDataError) -> Row:
    """Returns the row of a missing data set, without any time."""
    return Row(name, f"{LEFT_OUT}: no {error} (PALPATE_DATA)", 0.0, "calls", None, "higher")


# --- tables ------------------------------------------------------------------------------

WIDTH = 132
"""Width of the table in characters."""

EXPLAINED = (
    "Times in µs; red misses its goal. r and h in the smallest spacing; balls are of "
    f"{EXACT} only, for the thesis has points."
)


def print_tables(rows: Iterable[Row]) -> None:
    """Prints a table for each data set, with a line for each case."""
    from rich.table import Table

    grounds: dict[str, dict[str, list[Row]]] = {}
    for row in rows:
        ground, _, case = row.case.partition(SEPARATOR)
        grounds.setdefault(ground, {}).setdefault(case, []).append(row)
    console = terminal(markup=True)
    console.width = max(console.width, WIDTH)
    for ground, cases in grounds.items():
        metrics = list(dict.fromkeys(row.metric for rows in cases.values() for row in rows))
        table = Table(title=ground, title_justify="left", box=None, padding=(0, 1))
        table.add_column("", no_wrap=True)
        units = {row.metric: row.unit for rows in cases.values() for row in rows}
        for metric in metrics:
            head = metric.replace("ratio to ", "ratio to\n")
            table.add_column(f"{head}\n{units[metric]}", justify="right")
        for case, of_case in cases.items():
            figures = {row.metric: _figure(row) for row in of_case}
            table.add_row(case, *(figures.get(metric, "") for metric in metrics))
        console.print(table)
        console.print()
    console.print(EXPLAINED)


def _figure(row: Row) -> str:
    text = f"{row.value:.3g}"
    if row.goal is None:
        return text
    sign = "≥" if row.better == "higher" else "≤"
    text = f"{text} ({sign} {row.goal:g})"
    return f"[red]{text}[/red]" if row.met is False else text
