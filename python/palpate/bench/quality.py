"""``palpate bench touch-quality``: accuracy of touch on bodies whose surface is known exactly.

Planes, a sphere, a torus, a cylinder from outside and inside, a ramp, steps, a wedge and thin
shells are voxelised on cubes and on thick slices; a device moves below their surfaces, and force
and probe are compared with the true surface. The loops run in the engine, on one thread.

``exact`` is the servo with a point on a segment made from a mask; "exact, intensities" is one on a
segment made by a threshold: bodies then are partial volumes with the threshold at one half. "exact,
range's end" is the same with a threshold up to the scan's highest value, which all of the body has,
made in a session's scene. "exact, r N" is a ball of N h, whose centre goes as deep and is compared
with the body dilated by it.
``stairs`` is ``exact`` with the force of the hard proxy; the thesis' models as printed follow the
same paths.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from palpate import _core
from palpate.base.errors import OptionError
from palpate.base.harmless_text import terminal
from palpate.base.progress import Progress, silent
from palpate.bench.goals import GOALS
from palpate.bench.goals.quality import TOUCHES, Touch
from palpate.bench.report import Row, row_of

__all__ = ["all_cases", "feel", "measure", "print_tables"]

SEPARATOR = ": "

WIDTH = 150
"""Width of the table in characters."""


def measure(*, touches: Sequence[Touch] = TOUCHES, progress: Progress = silent) -> list[Row]:
    """Measures models of touch on all bodies.

    Args:
        touches: Names of the models.
        progress: Takes the progress.
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
    """Returns the names of the engine's cases, in the order of their report."""
    return _core.touch_quality_cases()


def feel(case: str, touch: Touch) -> dict[str, float]:
    """Returns the engine's figures of one case with one model of touch.

    Raises:
        OptionError: The case or the model does not exist.
    """
    try:
        return _core.bench_touch_quality(case, touch)
    except ValueError as error:
        raise OptionError(str(error)) from None


def _parts(case: str) -> tuple[Touch, str]:
    """Returns the model of touch and the engine's name of a case."""
    for touch in TOUCHES:
        if case.startswith(f"{touch}{SEPARATOR}"):
            return touch, case.removeprefix(f"{touch}{SEPARATOR}")
    raise AssertionError(case)


EXPLAINED = (
    "Red misses its goal. Lengths in h, the smallest spacing; a ball (r) is held against the "
    "dilated body: depths are those of its middle below that."
)


def print_tables(rows: Iterable[Row]) -> None:
    """Prints a table for each model, grid and stroke, with a line for each body.

    Figures that miss their goal are red.
    """
    from rich.table import Table

    tables: dict[str, dict[str, list[Row]]] = {}
    for row in rows:
        touch, case = _parts(row.case)
        body, stroke = case.split(", ", maxsplit=1)
        tables.setdefault(f"{touch}: {stroke}", {}).setdefault(body, []).append(row)
    console = terminal(markup=True)
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
    text = f"{row.value:.3g}"
    return f"[red]{text}[/red]" if row.met is False else text
