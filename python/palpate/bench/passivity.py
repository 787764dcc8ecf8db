"""``palpate bench passivity``: whether touch supplies energy to the hand.

Simulated devices with the limits, damping, encoder resolution and delay of real ones press, tap and
slide on a flat wall and on the bone of a scan, whose surface comes from its values where a
threshold made it, each at its initial stiffness; then the largest stiffness is searched at which no
contact gains energy. The loops are those of a session, with device and servo at one rate, and run
in the engine, in simulated time.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from palpate import _core
from palpate.base.errors import OptionError
from palpate.base.harmless_text import terminal
from palpate.base.progress import Progress, silent
from palpate.bench.goals import GOALS
from palpate.bench.goals.passivity import DEFAULT_STIFFNESS, FLAT_WALL, RATES_KHZ, WALLS
from palpate.bench.report import Row, row_of
from palpate.volumes.segment import Segment

__all__ = ["DEVICES", "measure", "print_table", "rub"]

DEVICES = tuple(DEFAULT_STIFFNESS)
"""Names of the devices."""

SEARCH_SECONDS = 3.0
"""Length of each motion while the largest stiffness is searched."""

WIDTH = 120
"""Width of the table in characters."""


def measure(
    bone: Segment,
    *,
    seconds: float = 60.0,
    devices: Sequence[str] = DEVICES,
    progress: Progress = silent,
) -> list[Row]:
    """Measures devices on a flat wall and on a segment.

    Args:
        bone: The segment.
        seconds: Duration of each run [s], a third for each motion.
        devices: Names of the devices.
        progress: Takes the progress.

    Raises:
        OptionError: The segment has no surface, or an argument is not allowed.
    """
    reports: dict[str, dict[str, float]] = {}
    count = len(devices) * len(WALLS) * len(RATES_KHZ)
    for device in devices:
        for wall in WALLS:
            for rate in RATES_KHZ:
                case = f"{device}, {rate} kHz, {wall}"
                progress(f"rubbing: {case}", len(reports) / count)
                segment = None if wall == FLAT_WALL else bone
                reports[case] = rub(device, 1000 * rate, seconds=seconds, segment=segment)
    goals = [goal for goal in GOALS["passivity"] if goal.case in reports]
    return [row_of(goal, reports[goal.case]) for goal in goals]


def rub(
    device: str,
    rate_hz: int,
    *,
    seconds: float,
    search_seconds: float = SEARCH_SECONDS,
    segment: Segment | None = None,
) -> dict[str, float]:
    """Returns the engine's figures of one device at one rate, on a flat wall or a segment.

    Raises:
        OptionError: The segment has no surface, or an argument is not allowed.
    """
    wall = None
    if segment is not None:
        wall = (segment.volume._internal, segment._internal, segment.range)  # noqa: SLF001
    try:
        return _core.bench_passivity(device, rate_hz, seconds, search_seconds, wall)
    except ValueError as error:
        raise OptionError(str(error)) from None


def print_table(rows: Iterable[Row]) -> None:
    """Prints a line for each case; figures that miss their goal are red."""
    from rich.table import Table

    cases: dict[str, list[Row]] = {}
    for row in rows:
        cases.setdefault(row.case, []).append(row)
    table = Table(title="passivity", title_justify="left", box=None, padding=(0, 1))
    table.add_column("", no_wrap=True)
    for row in next(iter(cases.values()), []):
        heading = "\n".join(row.metric.rsplit(" ", 1))
        table.add_column(f"{heading}\n{row.unit}", justify="right")
    for case, figures in cases.items():
        table.add_row(case, *map(_figure, figures))
    console = terminal(markup=True)
    console.width = max(console.width, WIDTH)
    console.print(table)


def _figure(row: Row) -> str:
    text = f"{row.value:.3g}"
    return f"[red]{text}[/red]" if row.met is False else text
