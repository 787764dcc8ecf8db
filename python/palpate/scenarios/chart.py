"""Charts of scenarios like the thesis' figures 5.27, 5.29 and 5.31; they need matplotlib."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from palpate.base.whole_file import whole_file
from palpate.scenarios.hole import BONE, COME, EMPTY, GONE, Hole
from palpate.scenarios.run import UNITS, Lump, ScenarioRun

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["plot_run"]

PHASES = {"in": "#0072B2", "rest": "#999999", "out": "#D55E00"}
PARTS = {
    "stiffness": "#0072B2",
    "cutting": "#009E73",
    "friction": "#E69F00",
    "wall": "#D55E00",
}


def plot_run(run: ScenarioRun, path: Path) -> None:
    """Plots the force of a run, and below it what caused it."""
    from matplotlib.figure import Figure

    size = (9.0, 7.0) if run.hole is None else (9.0, 10.0)
    figure = Figure(figsize=size if run.lump is None else (11.0, 5.0), layout="constrained")
    if run.lump is not None:
        upper, lower = figure.subplots(1, 2)
    elif run.hole is None:
        upper, lower = figure.subplots(2, 1, sharex=not run.presses)
    else:
        upper, lower, below = figure.subplots(3, 1)
        lower.sharex(upper)
        _draw_hole(below, run.hole)
    if run.lump is not None:
        _draw_map(upper, run, run.lump)
        _draw_depths(lower, run)
    elif run.presses:
        _draw_presses(upper, run)
        _draw_depths(lower, run)
    else:
        _draw_force(upper, run)
        _draw_parts(lower, run)
        for panel in (upper, lower):
            _mark(panel, run)
        lower.set_xlabel(_label(run.over))
    title = f"{run.scenario}: {run.scan}"
    if run.lump is None:
        upper.set_title(title, loc="left")
    else:
        figure.suptitle(title)
    for panel in (upper, lower):
        panel.spines[["top", "right"]].set_visible(False)
        # above the panel, where it hides nothing
        panel.legend(frameon=False, loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=4)
    with whole_file(path) as unfinished:
        figure.savefig(unfinished, dpi=150)


def _draw_force(panel: Axes, run: ScenarioRun) -> None:
    phases = np.array(run.phase)
    for phase, colour in PHASES.items():
        of = phases == phase
        panel.plot(run.samples[run.over][of], run.force[of], color=colour, label=phase, lw=1.2)
    panel.set_ylabel("force on the hand [N]")


def _draw_parts(panel: Axes, run: ScenarioRun) -> None:
    over = run.samples[run.over]
    if "volume" in run.samples:
        panel.plot(over, run.samples["volume"], color=PHASES["in"], label="gone from its place")
        if "piled" in run.samples:
            panel.plot(over, run.samples["piled"], color=PHASES["out"], label="come elsewhere")
        panel.set_ylabel("volume [mm³]")
        return
    going_in = np.array(run.phase) == "in"
    for name, colour in PARTS.items():
        panel.plot(over[going_in], run.samples[name][going_in], color=colour, label=name, lw=1.2)
    panel.set_ylabel("parts on the way in [N]")


def _draw_hole(panel: Axes, hole: Hole) -> None:
    """Draws the section through the hole; the tool comes from above."""
    from matplotlib.colors import ListedColormap
    from matplotlib.patches import Patch

    shown = {EMPTY: "white", BONE: "#BBBBBB", GONE: "#9ecae9", COME: PHASES["out"]}
    kinds = list(shown)
    drawn = [[kinds.index(sign) for sign in row] for row in hole.section]
    width, height = len(hole.section[0]) * hole.spacing[0], len(drawn) * hole.spacing[1]
    panel.imshow(
        drawn,
        cmap=ListedColormap(list(shown.values())),
        vmin=-0.5,
        vmax=3.5,
        extent=(0.0, width, height, 0.0),
        interpolation="nearest",
    )
    panel.set_xlabel("across the path [mm]")
    panel.set_ylabel("along the path [mm]")
    names = {BONE: "bone", GONE: "gone from here", COME: "come here"}
    panel.legend(
        handles=[Patch(color=shown[sign], label=name) for sign, name in names.items()],
        frameon=False,
        loc="center left",
        bbox_to_anchor=(1.02, 0.5),
    )


def _draw_presses(panel: Axes, run: ScenarioRun) -> None:
    """Plots stiffness along the line of places, and the thickness of soft tissue below them."""
    along = [press.along for press in run.presses]
    stiffness = [press.stiffness for press in run.presses]
    panel.plot(along, stiffness, "o-", color=PHASES["in"], label="stiffness [N/mm]")
    force = [press.force for press in run.presses]
    panel.plot(along, force, "s--", color=PHASES["out"], label="force at that depth [N]")
    panel.set_xlabel("along the line of places [mm]")
    panel.set_ylabel("stiffness [N/mm], force [N]")
    panel.set_ylim(bottom=0.0)
    beside = panel.twinx()
    soft = [np.nan if press.thickness is None else press.thickness for press in run.presses]
    beside.fill_between(along, soft, color="#BBBBBB", alpha=0.35, lw=0)
    beside.set_ylabel("soft tissue over the bone [mm] (grey)")
    beside.set_ylim(bottom=0.0)
    beside.spines["top"].set_visible(False)


def _draw_map(panel: Axes, run: ScenarioRun, lump: Lump) -> None:
    """Plots the stiffness at the places of a square as one who presses sees it."""
    across = sorted({press.across or 0.0 for press in run.presses})
    along = sorted({press.along for press in run.presses})
    # presses come row by row
    places = np.array([press.place for press in run.presses]).reshape(len(across), len(along), 3)
    young = np.array([press.young or 0.0 for press in run.presses])
    drawn = panel.pcolormesh(
        places[..., 0],
        places[..., 2],
        young.reshape(len(across), len(along)),
        shading="nearest",
        cmap="viridis",
    )
    panel.figure.colorbar(drawn, ax=panel, label="felt modulus [kPa]")
    panel.plot(
        lump.place[0], lump.place[2], "x", color="#D55E00", ms=10, mew=2, label="felt stiffest"
    )
    if lump.hidden is not None:
        x, _, z = lump.hidden
        panel.plot(x, z, "o", mfc="none", mec="#D55E00", ms=16, mew=2, label="tumour")
    panel.set_aspect("equal")
    panel.set_xlabel("to the patient's left [mm]")
    panel.set_ylabel("to the head [mm]")


def _draw_depths(panel: Axes, run: ScenarioRun) -> None:
    """Plots force over depth at each place; the stiffest and the softest are in colour."""
    going_in = np.array(run.phase) == "in"
    order = np.argsort([press.stiffness for press in run.presses])
    shown = {int(order[-1]): ("stiffest", PHASES["out"]), int(order[0]): ("softest", PHASES["in"])}
    for number in range(len(run.presses)):
        of = going_in & (run.samples["press"] == number)
        name, colour = shown.get(number, (None, "#BBBBBB"))
        panel.plot(
            run.tip[of], run.force[of], color=colour, label=name, lw=1.2, zorder=2 if name else 1
        )
    panel.set_xlabel("way of the ball [mm]")
    panel.set_ylabel("force on the hand [N]")


def _mark(panel: Axes, run: ScenarioRun) -> None:
    """Marks events, and where the path meets a rigid obstacle."""
    over = run.samples[run.over]
    near = 0.06 * float(np.ptp(over))
    last, height = -np.inf, 0.98
    for event in run.events:
        if event.kind not in ("punctured", "contact", "free"):
            continue
        at = float(np.interp(event.time, run.time, over))
        # names side by side stand below one another
        height = height - 0.05 if at - last < near else 0.98
        last = at
        panel.axvline(at, color="#BBBBBB", lw=0.8)
        panel.text(
            at,
            height,
            f" {event.segment}" if event.kind == "punctured" else f" {event.kind}",
            transform=panel.get_xaxis_transform(),
            va="top",
            fontsize=8,
            color="#555555",
        )
    if run.wall_at is not None:
        panel.axvline(run.wall_at, color="black", lw=1.0, linestyle="--")


def _label(column: str) -> str:
    name = {"travel": "travel of the drive", "time": "time"}.get(column, column)
    return f"{name} [{UNITS[column]}]"
