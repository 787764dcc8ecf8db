"""Plots of benchmarks, for ``--plot FILE``; they need matplotlib (``pip install palpate[plot]``).

Colours are those of Okabe and Ito, which people with any colour vision can tell apart; every
series has a marker of its own as well.
"""

from __future__ import annotations

from collections.abc import Iterable
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

from palpate.bench.goals import BODIES, GRIDS, TOUCHES, Touch, quality_case
from palpate.bench.report import Row
from palpate.errors import OptionError

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["check_plot", "plot_haptics", "plot_quality"]

ENDINGS = (".png", ".svg", ".pdf")

BLUE, SKY, VERMILION, ORANGE, GREEN, GREY = (
    "#0072B2",
    "#56B4E9",
    "#D55E00",
    "#E69F00",
    "#009E73",
    "#595959",
)

STYLE: dict[str, dict[str, Any]] = {
    "exact": {"color": BLUE, "marker": "o"},
    "stairs": {"color": SKY, "marker": "s"},
    "thesis-original": {"color": VERMILION, "marker": "v"},
    "thesis-improved": {"color": ORANGE, "marker": "^"},
}

QUALITY = (
    ("direction 95 %", "direction, 95 % [°]", 0.1),
    ("magnitude RMSE", "magnitude, RMS [%]", 0.1),
    ("lag", "largest lag [h]", 0.01),
    ("force step", "force step [h]", 0.01),
)
"""What is plotted of touch-quality, a row of panels each, and the least that is told apart."""

LOST = 50.0
"""Below this share of updates in contact [%] nothing is said of a force."""

LEAST = 1e-3
"""Smaller figures are plotted as this one, on axes that have no zero."""


def check_plot(path: Path | None) -> None:
    """Refuses what would fail after measuring.

    Raises:
        OptionError: It is no kind of picture, or matplotlib is missing.
    """
    if path is None:
        return
    if path.suffix.lower() not in ENDINGS:
        raise OptionError(f"plot {path} given; allowed: a file that ends in {', '.join(ENDINGS)}")
    if find_spec("matplotlib") is None:
        raise OptionError(
            "a plot needs matplotlib, which is not here; allowed: after pip install palpate[plot]"
        )


def plot_haptics(rows: Iterable[Row], path: Path) -> None:
    """Draws updates a second and the times of single ones, of the first ground: a line per case."""
    by_case: dict[str, dict[str, Row]] = {}
    for row in rows:
        by_case.setdefault(row.case, {})[row.metric] = row
    timed = [case for case, figures in by_case.items() if {"rate", "median"} <= figures.keys()]
    ground = timed[0].partition(": ")[0] if timed else ""
    cases = [case for case in timed if case.startswith(f"{ground}: ")]
    figure = _figure(10.0, 1.3 + 0.42 * len(cases))
    left, right = figure.subplots(1, 2, sharey=True)
    places = range(len(cases))
    rates = [by_case[case]["rate"] for case in cases]
    colours = [ORANGE if "thesis" in case else BLUE for case in cases]
    left.barh(places, [row.value for row in rates], color=colours, height=0.6)
    for place, row in zip(places, rates, strict=True):
        left.annotate(
            f"{row.value:.3g}", (row.value, place), (3, 0), textcoords="offset points", va="center"
        )
        if row.goal is not None:
            left.plot([row.goal] * 2, [place - 0.4, place + 0.4], color=GREY, linewidth=2.0)
    left.set_yticks(places, cases)
    left.invert_yaxis()
    left.set_xlabel("updates a second [M/s]; grey: least that is asked for")
    left.margins(x=0.12)
    for metric, marker, colour in (
        ("median", "o", BLUE),
        ("p99", "s", GREEN),
        ("p99.9", "D", ORANGE),
        ("max", "v", VERMILION),
    ):
        values = [max(LEAST, by_case[case][metric].value) for case in cases]
        right.plot(values, places, marker, color=colour, label=metric)
    right.set_xscale("log")
    right.set_xlabel("time of one update [µs]")
    _finish(figure, [left, right], right, path=path)


def plot_quality(rows: Iterable[Row], path: Path) -> None:
    """Draws what is felt on each body, a panel for each figure and grid; 5 h deep, 0.2 h a move."""
    by_key = {(row.case, row.metric): row for row in rows}
    figure = _figure(11.0, 2.2 * len(QUALITY) + 1.2)
    axes = figure.subplots(len(QUALITY), len(GRIDS), sharex=True, sharey="row", squeeze=False)
    for line, (metric, label, least) in zip(axes, QUALITY, strict=True):
        for panel, grid in zip(line, GRIDS, strict=True):
            panel.set_yscale("log")
            for nth, touch in enumerate(TOUCHES):
                points = _points(by_key, touch, grid, metric=metric)
                _draw_touch(panel, touch, points, least=least, shift=0.18 * (nth - 1.5))
        line[0].set_ylabel(label)
    for panel, grid in zip(axes[0], GRIDS, strict=True):
        panel.set_title(f"{'cubes' if grid == GRIDS[0] else f'{grid} mm'}, 5 h deep, 0.2 h a move")
    for panel in axes[-1]:
        panel.set_xticks(range(len(BODIES)), BODIES, rotation=45, ha="right")
    _finish(figure, list(axes.flat), axes[0][0], path=path)


def _points(
    by_key: dict[tuple[str, str], Row], touch: Touch, grid: str, *, metric: str
) -> list[tuple[int, Row]]:
    """Returns the place of each body and its figure, where there is a force to speak of."""
    cases = [quality_case(touch, body, grid, stroke=(5.0, 0.2)) for body in BODIES]
    return [
        (place, by_key[case, metric])
        for place, case in enumerate(cases)
        if (case, metric) in by_key and by_key[case, "in contact"].value >= LOST
    ]


def _draw_touch(
    panel: Axes, touch: Touch, points: list[tuple[int, Row]], *, least: float, shift: float
) -> None:
    if not points:
        return
    places = [place + shift for place, _ in points]
    values = [max(least, row.value) for _, row in points]
    panel.plot(places, values, linestyle="none", markersize=5, label=touch, **STYLE[touch])
    for place, row in points:
        if row.goal:
            panel.plot([place - 0.4, place + 0.4], [row.goal] * 2, color=GREY, linewidth=2.0)


def _figure(width: float, height: float) -> Figure:
    from matplotlib.figure import Figure

    return Figure(figsize=(width, height), layout="constrained")


def _finish(figure: Figure, panels: list[Axes], legend_of: Axes, *, path: Path) -> None:
    for panel in panels:
        panel.grid(visible=True, color="#DDDDDD", linewidth=0.6)
        panel.set_axisbelow(True)
        panel.spines[["top", "right"]].set_visible(False)
    handles, labels = legend_of.get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper center", ncols=len(labels), frameon=False)
    figure.savefig(path, dpi=150)
