"""Plots of benchmarks, for ``--plot FILE``; they need matplotlib (``pip install palpate[plot]``).

The colours are those of Okabe and Ito, distinguishable with any colour vision; every series also
has a marker of its own.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from palpate.base.whole_file import whole_file
from palpate.bench.goals.haptics import PUBLISHED_BY_OTHERS
from palpate.bench.goals.quality import BODIES, GRIDS, TOUCHES, Touch, quality_case
from palpate.bench.goals.soft_tissue import TRUTH_LEVELS, TRUTH_MODELS, truth_case
from palpate.bench.report import Row

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from palpate.bench.truth_cube import Cube, Points

__all__ = ["plot_haptics", "plot_quality", "plot_truth_cube"]


BLUE, SKY, VERMILION, ORANGE, GREEN, GREY = (
    "#0072B2",
    "#56B4E9",
    "#D55E00",
    "#E69F00",
    "#009E73",
    "#595959",
)

# arguments of matplotlib, which has no types for them
STYLE: dict[str, dict[str, Any]] = {
    "exact": {"color": BLUE, "marker": "o"},
    "exact, intensities": {"color": GREEN, "marker": "D"},
    "exact, range's end": {"color": GREEN, "marker": "d"},
    "exact, r 1": {"color": BLUE, "marker": "1"},
    "exact, r 2": {"color": BLUE, "marker": "2"},
    "exact, r 5": {"color": BLUE, "marker": "3"},
    "stairs": {"color": SKY, "marker": "s"},
    "thesis-original": {"color": VERMILION, "marker": "v"},
    "thesis-improved": {"color": ORANGE, "marker": "^"},
}

GROUND_STYLES = (
    (BLUE, "o"),
    (SKY, "s"),
    (GREEN, "D"),
    (VERMILION, "v"),
    (ORANGE, "^"),
    ("#CC79A7", "P"),
    (GREY, "*"),
)

QUALITY = (
    ("direction 95 %", "direction, 95 % [°]", 0.1),
    ("magnitude RMSE", "magnitude, RMS [%]", 0.1),
    ("lag", "largest lag [h]", 0.01),
    ("force step", "force step [h]", 0.01),
)
"""Plotted figures of touch-quality, one row of panels each, and the smallest value that is shown.
"""

LOST = 50.0
"""Forces are not plotted below this fraction of updates in contact [%]."""

LEAST = 1e-3
"""Smaller figures are plotted as this value, on logarithmic axes."""


def plot_haptics(rows: Iterable[Row], path: Path) -> None:
    """Plots calls per second and their 99.9th percentile: a line per case, a mark per data set.

    Published figures of other machines are below, without a ratio.
    """
    table: dict[str, dict[str, dict[str, Row]]] = {}
    for row in rows:
        ground, _, case = row.case.partition(": ")
        table.setdefault(ground, {}).setdefault(case, {})[row.metric] = row
    others = table.pop(PUBLISHED_BY_OTHERS, {})
    grounds = [ground for ground, cases in table.items() if _timed(cases)]
    cases = list(dict.fromkeys(case for ground in grounds for case in _timed(table[ground])))
    figure = _figure(11.0, 1.6 + 0.24 * (len(cases) + len(others)))
    left, right = figure.subplots(1, 2, sharey=True)
    for nth, ground in enumerate(grounds):
        colour, marker = GROUND_STYLES[nth % len(GROUND_STYLES)]
        style = {"color": colour, "marker": marker, "markersize": 5, "linestyle": "none"}
        drawn = [(place, table[ground].get(case, {})) for place, case in enumerate(cases)]
        for panel, metric in ((left, "rate"), (right, "p99.9")):
            plotted = [(place, row[metric]) for place, row in drawn if metric in row]
            values = [max(LEAST, row.value) for _, row in plotted]
            panel.plot(values, [place for place, _ in plotted], label=ground, **style)
            for place, row in plotted:
                if row.goal is not None:
                    panel.plot([row.goal] * 2, [place - 0.4, place + 0.4], color=GREY, linewidth=2)
    places = range(len(cases), len(cases) + len(others))
    rates = [figures["rate"].value for figures in others.values()]
    left.plot(rates, places, "x", color=GREY, label="published, other machines")
    left.set_yticks(range(len(cases) + len(others)), [*cases, *others], fontsize=8)
    left.margins(y=0.01)
    left.invert_yaxis()
    for panel in (left, right):
        panel.set_xscale("log")
    left.set_xlabel("calls a second [M/s]; grey: goal")
    right.set_xlabel("99.9 % of calls end within [µs]; grey: goal")
    _finish(figure, [left, right], left, path=path)


def _timed(cases: dict[str, dict[str, Row]]) -> list[str]:
    """Returns the cases of a data set with times of single calls."""
    return [case for case, figures in cases.items() if {"rate", "p99.9"} <= figures.keys()]


def plot_quality(rows: Iterable[Row], path: Path) -> None:
    """Plots touch on each body, a panel for each figure and grid; 5 h deep, 0.2 h per update."""
    by_key = {(row.case, row.metric): row for row in rows}
    figure = _figure(11.0, 2.2 * len(QUALITY) + 1.2)
    axes = figure.subplots(len(QUALITY), len(GRIDS), sharex=True, sharey="row", squeeze=False)
    for line, (metric, label, least) in zip(axes, QUALITY, strict=True):
        for panel, grid in zip(line, GRIDS, strict=True):
            panel.set_yscale("log")
            for nth, touch in enumerate(TOUCHES):
                points = _points(by_key, touch, grid, metric=metric)
                _draw_touch(
                    panel, touch, points, least=least, shift=0.09 * (nth - 0.5 * (len(TOUCHES) - 1))
                )
        line[0].set_ylabel(label)
    for panel, grid in zip(axes[0], GRIDS, strict=True):
        panel.set_title(f"{'cubes' if grid == GRIDS[0] else f'{grid} mm'}, 5 h deep, 0.2 h a move")
    for panel in axes[-1]:
        panel.set_xticks(range(len(BODIES)), BODIES, rotation=45, ha="right")
    _finish(figure, list(axes.flat), axes[0][0], path=path)


def _points(
    by_key: dict[tuple[str, str], Row], touch: Touch, grid: str, *, metric: str
) -> list[tuple[int, Row]]:
    """Returns the position of each body and its figure, where there is enough contact."""
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


def plot_truth_cube(cube: Cube, moved: Mapping[str, Points], path: Path) -> None:
    """Plots errors of beads by compression, and displacements in the middle slice."""
    from palpate.bench.truth_cube import errors_of

    figure = _figure(11.0, 5.2)
    left, right = figure.subplots(1, 2)
    levels = list(TRUTH_LEVELS)
    deepest = max(levels)
    slice_ = abs(cube.beads[:, 1] - cube.beads[:, 1].mean()) < cube.sides[1] / 16.0
    went = cube.beads + cube.measured[deepest]
    right.plot(*went[slice_][:, ::2].T, "o", color=GREY, fillstyle="none", label="measured")
    for name, (colour, marker) in zip(TRUTH_MODELS, GROUND_STYLES, strict=False):
        errors = [errors_of(cube, level, moved[truth_case(name, level)]) for level in levels]
        style = {"color": colour, "marker": marker, "markersize": 5}
        left.plot(levels, [error["rmse"] for error in errors], label=name, **style)
        left.plot(levels, [error["without_drift"] for error in errors], linestyle=":", **style)
        placed = (cube.beads + moved[truth_case(name, deepest)])[slice_]
        right.plot(*placed[:, ::2].T, linestyle="none", **(style | {"markersize": 3}))
    left.set_xlabel("compression [%]")
    left.set_ylabel("RMSE of the beads [mm]; dotted: without the plate's drift")
    left.set_ylim(bottom=0.0)
    right.set_xlabel("x [mm]")
    right.set_ylabel(f"z [mm], middle slice at {deepest:g} %")
    right.set_aspect("equal")
    left.plot([], [], "o", color=GREY, fillstyle="none", label="measured (right)")
    _finish(figure, [left, right], left, path=path)


def _figure(width: float, height: float) -> Figure:
    from matplotlib.figure import Figure

    return Figure(figsize=(width, height), layout="constrained")


def _finish(figure: Figure, panels: list[Axes], legend_of: Axes, *, path: Path) -> None:
    for panel in panels:
        panel.grid(visible=True, color="#DDDDDD", linewidth=0.6)
        panel.set_axisbelow(True)
        panel.spines[["top", "right"]].set_visible(False)
    handles, labels = legend_of.get_legend_handles_labels()
    columns = min(len(labels), 4)
    figure.legend(handles, labels, loc="outside upper center", ncols=columns, frameon=False)
    with whole_file(path) as unfinished:
        figure.savefig(unfinished, dpi=150)
