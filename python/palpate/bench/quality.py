"""``palpate bench touch-quality``: how well touch tells the shape of bodies that are known exactly.

Planes, a sphere, a torus, a cylinder from outside and inside, a ramp, steps, a wedge and thin
shells are voxelised on cubes and on thick slices; a device is led under their surfaces, and what
is felt is held against the true surface. The loops run in the engine, on one thread.

``exact`` is what the servo does with a point on what a mask made; "exact, intensities" what it
does where a threshold made the segment: bodies then are partial volumes, of which half is the
threshold. "exact, r N" is a ball of N h, whose middle goes as deep and is held against the body
dilated by it. ``stairs`` is ``exact`` with the force of the hard proxy; the thesis' models as
printed get the same device paths.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from palpate import _core
from palpate.base.errors import OptionError
from palpate.base.progress import Progress, silent
from palpate.bench.goals import GOALS, TOUCHES, Touch
from palpate.bench.report import Row, row_of

__all__ = ["all_cases", "feel", "measure", "print_tables"]

SEPARATOR = ": "

WIDTH = 150
"""Letters that a line of the table takes."""


def measure(*, touches: Sequence[Touch] = TOUCHES, progress: Progress = silent) -> list[Row]:
    """Measures ways of touch on all bodies.

    Args:
        touches: Which ways of touch.
        progress: Told which case is measured.
    """
    goals = [goal for goal in GOALS["touch-quality"] if _parts(goal.case)[0] in touches]
    cases = list(dict.fromkeys(goal.case for goal in goals))
    reports: dict[str, dict[str, float]] = {}
    for done, case in enumerate(cases):
        progress(f"feeling {case}", done / len(cases))
        touch, body = _parts(case)
        reports[case] = feel(body, touch)
    return [row_of(goal, reports[goal.case]) for goal in goals]


def all_cases() -> list[str]:
    """Lists the engine's cases, in the order of their report."""
    return _core.touch_quality_cases()


def feel(case: str, touch: Touch) -> dict[str, float]:
    """Returns the engine's figures of one case in one way of touch.

    Raises:
        OptionError: The case or the way of touch does not exist.
    """
    try:
        return _core.bench_touch_quality(case, touch)
    except ValueError as error:
        raise OptionError(str(error)) from None


def _parts(case: str) -> tuple[Touch, str]:
    """Returns the way of touch and the engine's name of a case."""
    for touch in TOUCHES:
        if case.startswith(f"{touch}{SEPARATOR}"):
            return touch, case.removeprefix(f"{touch}{SEPARATOR}")
    raise AssertionError(case)


EXPLAINED = (
    "Red misses its goal. Lengths in h, the smallest spacing; a ball (r) is held against the "
    "dilated body: depths are those of its middle below that."
)


def print_tables(rows: Iterable[Row]) -> None:
    """Prints a table for each way of touch, grid and stroke: a line per body.

    Figures that miss their goal are red.
    """
    from rich.console import Console
    from rich.table import Table

    tables: dict[str, dict[str, list[Row]]] = {}
    for row in rows:
        touch, case = _parts(row.case)
        body, stroke = case.split(", ", maxsplit=1)
        tables.setdefault(f"{touch}: {stroke}", {}).setdefault(body, []).append(row)
    console = Console()
    console.width = max(console.width, WIDTH)
    for title, bodies in tables.items():
        table = Table(title=title, title_justify="left", box=None, padding=(0, 1))
        table.add_column("")
        for row in next(iter(bodies.values())):
            table.add_column(f"{row.metric.replace(' ', chr(10), 1)}\n{row.unit}", justify="right")
        for body, figures in bodies.items():
            table.add_row(body, *map(_figure, figures))
        console.print(table)
        console.print()
    console.print(EXPLAINED)


def _figure(row: Row) -> str:
    told = f"{row.value:.3g}"
    return f"[red]{told}[/red]" if row.met is False else told
