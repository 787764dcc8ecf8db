"""What ``palpate scenario`` does once its options are understood: needles in scans.

``needle-skull`` goes through skin, fat and muscle to bone, ``needle-liver`` through the liver to
bone behind it; on the built-in phantom, or on a scan. See ``docs/algorithms/needle.md``.
"""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
import typer
from numpy.typing import NDArray

from palpate.errors import EmptySegmentError, OptionError
from palpate.needle import TISSUES, NeedleRun, Tissue, drive_needle, line_through
from palpate.phantom_scan import phantom
from palpate.segment import Segment
from palpate.volume import Volume

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["Scenario", "needle_in_phantom", "needle_in_scan", "plot_run", "print_run", "write_run"]

Scenario = Literal["needle-skull", "needle-liver"]
Layers = list[tuple[Segment, Tissue | None]]

SOFT = {"skin": "skin", "fat": "fat", "muscle": "muscle", "liver": "liver"}
"""Parts of the phantom and the tissues that they are."""

BONES = ("ribs", "sternum", "spine", "pelvis", "shoulders", "femurs")

AIR_END = -300.0
"""Where a body begins [HU]."""

RAW_SHIFT = 1024.0
"""What scans without HU that begin at 0 have beyond them: CThead does."""


def needle_in_phantom(scenario: Scenario, **drive: float) -> NeedleRun:
    """Drives a needle into the phantom.

    Args:
        scenario: Which one.
        drive: Options of ``drive_needle``.
    """
    made = phantom()
    layers: Layers = [(made.part(name), TISSUES[tissue]) for name, tissue in SOFT.items()]
    bone = np.isin(made.labels, [made.names[name] for name in BONES])
    layers.append((made.volume.segment(bone, name="bone"), None))
    # what is left of the body is as soft as muscle: only these two decide
    known = np.isin(made.labels, [made.names[name] for name in (*SOFT, "air")]) | bone
    layers.append((made.volume.segment(~known, name="organs"), TISSUES["muscle"]))
    first = "liver" if scenario == "needle-liver" else "muscle"
    through = made.labels == made.names[first]
    start, target = line_through(made.volume, through, bone, longest=_longest(scenario))
    start = _outside(made.volume, made.labels != made.names["air"], start)
    return drive_needle(made.volume, layers, start=start, target=target, **drive)


def needle_in_scan(
    scenario: Scenario,
    volume: Volume,
    *,
    labels: Volume | None = None,
    liver: int = 6,
    bone: float | None = None,
    **drive: float,
) -> NeedleRun:
    """Drives a needle into a scan.

    Args:
        scenario: Which one.
        volume: The scan.
        labels: Its label map; the liver is taken from it.
        liver: Number of the liver in the label map.
        bone: Where bone begins [unit of the scan]; by default as it is offered for touch.
        drive: Options of ``drive_needle``.

    Raises:
        OptionError: The label map does not fit, or no line meets what is asked for.
        EmptySegmentError: There is no such voxel.
    """
    values = volume.slope * volume.array.astype(np.float32) + volume.intercept
    shift = RAW_SHIFT if volume.unit != "HU" and volume.range[0] >= 0.0 else 0.0
    hard = values > (volume.anchors.bone if bone is None else bone)
    body = values > AIR_END + shift
    if scenario == "needle-liver":
        soft = _label(volume, labels, liver)
        hard &= ~soft
        layers: Layers = [
            (volume.segment(body & ~soft & ~hard, name="soft tissue"), TISSUES["muscle"]),
            (volume.segment(soft, name="liver"), TISSUES["liver"]),
        ]
    else:
        soft = body & ~hard
        layers = [(volume.segment(soft, name="skin"), TISSUES["skin"])]
    layers.append((volume.segment(hard, name="bone"), None))
    if not hard.any():
        raise EmptySegmentError("the scan has no bone; allowed: --bone with a lower value")
    start, target = line_through(volume, soft, hard, longest=_longest(scenario))
    start = _outside(volume, body, start)
    return drive_needle(volume, layers, start=start, target=target, **drive)


def print_run(scenario: str, run: NeedleRun) -> None:
    """Prints what happened and what was felt."""
    from rich.console import Console
    from rich.table import Table

    table = Table(title=scenario, title_justify="left")
    for name in ("event", "segment", "time [s]", "depth [mm]", "force [N]"):
        table.add_column(name, justify="left" if name in ("event", "segment") else "right")
    for event in run.events:
        numbers = (f"{event.time:.2f}", f"{event.depth:.1f}", f"{event.force:.2f}")
        table.add_row(event.kind, event.segment, *numbers)
    Console().print(table)
    figures = _figures(run)
    wall = figures["wall"]
    bone = "no bone on the way" if wall is None else f"bone at {wall:.2f} mm"
    typer.echo(
        f"largest force {figures['largest_force']:.2f} N, deepest tip {figures['deepest']:.2f} mm, "
        f"{bone}, spikes {figures['spikes']}, violations {run.violations}"
    )


def write_run(scenario: str, run: NeedleRun, path: Path) -> None:
    """Writes all samples and events as one JSON object; lengths mm, times s, forces N."""
    samples: dict[str, NDArray[Any]] = {
        "time": run.time,
        "travel": run.travel,
        "tip": run.tip,
        "probe": run.probe,
        "force": run.force,
        "across": run.across,
        **run.parts,
        "segment": run.segment,
    }
    told = {
        "scenario": scenario,
        "layers": run.names,
        "figures": _figures(run),
        "events": [asdict(event) for event in run.events],
        "phase": run.phase,
        "samples": {name: np.round(values, 6).tolist() for name, values in samples.items()},
    }
    path.write_text(json.dumps(told) + "\n", encoding="utf-8")


def plot_run(scenario: str, run: NeedleRun, path: Path) -> None:
    """Draws force over depth, in and out, and its parts."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9.0, 7.0), layout="constrained")
    upper, lower = figure.subplots(2, 1, sharex=True)
    phases = np.array(run.phase)
    for phase, colour in (("in", "#0B5394"), ("rest", "#999999"), ("out", "#B45F06")):
        of = phases == phase
        upper.plot(run.travel[of], run.force[of], color=colour, label=phase, linewidth=1.2)
    going_in = phases == "in"
    for name in ("stiffness", "cutting", "friction", "wall"):
        lower.plot(run.travel[going_in], run.parts[name][going_in], label=name, linewidth=1.2)
    for panel, title in ((upper, "force on the hand [N]"), (lower, "parts on the way in [N]")):
        _mark(panel, run)
        panel.set_ylabel(title)
        panel.legend(frameon=False)
        panel.spines[["top", "right"]].set_visible(False)
    upper.set_title(scenario, loc="left")
    lower.set_xlabel("travel of the drive [mm]")
    figure.savefig(path, dpi=150)


def _mark(panel: Axes, run: NeedleRun) -> None:
    """Marks where the needle punctured what, and where bone is."""
    for event in run.events:
        if event.kind == "punctured":
            at = float(np.interp(event.time, run.time, run.travel))
            panel.axvline(at, color="#BBBBBB", linewidth=0.8)
            panel.text(
                at,
                0.98,
                f" {event.segment}",
                transform=panel.get_xaxis_transform(),
                va="top",
                fontsize=8,
                color="#555555",
            )
    if run.wall_at is not None:
        panel.axvline(run.wall_at, color="black", linewidth=1.0, linestyle="--")


def _figures(run: NeedleRun) -> dict[str, float | int | None]:
    return {
        "largest_force": float(np.abs(run.force).max()),
        "deepest": float(run.tip.max()),
        "deepest_probe": float(run.probe.max()),
        "wall": run.wall_at,
        "spikes": run.spikes(),
        "violations": run.violations,
    }


def _longest(scenario: Scenario) -> float:
    """How long a way to take before the bone [mm]: a skull is close under its skin."""
    return 15.0 if scenario == "needle-skull" else 300.0


def _label(volume: Volume, labels: Volume | None, number: int) -> NDArray[np.bool_]:
    if labels is None:
        raise OptionError("no label map given; allowed: --segments FILE, which has the liver")
    if labels.dimensions != volume.dimensions:
        raise OptionError(
            f"label map of {labels.dimensions} voxels given; allowed: {volume.dimensions}"
        )
    mask = np.asarray(labels.array == number)
    if not mask.any():
        raise EmptySegmentError(f"label {number} has no voxel; allowed: a label of the map")
    return mask


def _outside(
    volume: Volume, body: NDArray[np.bool_], start: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Draws a start back along the second axis of the arrays until nothing is before it."""
    grid_from_patient = np.linalg.inv(volume.patient_from_grid)
    place = grid_from_patient @ np.append(start, 1.0)
    x, z = int(place[0]), int(place[2])
    column = body[z, :, x]
    first = int(np.argmax(column)) if np.any(column) else int(place[1])
    place[1] = min(place[1], first - 5.0 / volume.spacing[1])
    return np.asarray((volume.patient_from_grid @ place)[:3])
