"""What a touch felt, as CSV, JSON, a plot, and numbers of its segment; units are in the names."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from palpate.base.whole_file import whole_file
from palpate.segmentation.measures.statistics_table import Row, rows_csv
from palpate.session.scripted_touch import TouchResult, touch
from palpate.session.touch_request import TouchRequest
from palpate.volumes.scene import Scene

__all__ = ["plot_touch", "touch_and_write", "touch_cells", "touch_row", "touch_text"]


HEADINGS = {
    "largest_force_N": "largest force [N]",
    "stiffness_N_per_mm": "stiffness [N/mm]",
    "residual_N": "residual [N]",
    "volume_mm3": "removed [mm³]",
    "mean_force_N": "mean force [N]",
    "mean_lateral_force_N": "mean force across [N]",
}
"""Columns of a touch, as people read them."""


def touch_and_write(scene: Scene, request: TouchRequest) -> TouchResult:
    """Touches a segment, and writes curve and plot where those are asked for.

    Raises:
        OptionError: There is no such segment or place.
        OSError: The disk refuses a file.
    """
    felt = touch(scene, request)
    if request.out is not None:
        text = touch_text(felt, request.out.suffix.lower())
        with whole_file(request.out) as unfinished:
            unfinished.write_text(text, "utf-8")
    if request.plot is not None:
        plot_touch(felt, request.plot)
    return felt


def touch_row(felt: TouchResult) -> Row:
    """Returns the numbers of a touch by the name of their column; None where there is none."""
    do = felt.do
    row: Row = {f"{do}_largest_force_N": felt.largest_force}
    if do == "stroke":
        there = felt.forces > 0.0
        row["stroke_mean_force_N"] = float(felt.forces[there].mean()) if there.any() else None
        row["stroke_mean_lateral_force_N"] = (
            float(felt.lateral[there].mean()) if there.any() else None
        )
        return row
    row[f"{do}_stiffness_N_per_mm"] = felt.stiffness
    row[f"{do}_residual_N"] = felt.residual
    if do == "drill":
        row["drill_volume_mm3"] = float(felt.volumes.max())
    return row


def touch_cells(felt: TouchResult) -> list[list[str]]:
    """Returns a table for people: what was measured, and a row with its numbers."""
    row = touch_row(felt)
    place = ", ".join(f"{along:.1f}" for along in felt.place)
    numbers = ["–" if cell is None else f"{cell:.4g}" for cell in row.values()]
    headings = [HEADINGS[name.removeprefix(f"{felt.do}_")] for name in row]
    return [["segment", "place L, P, S [mm]", *headings], [felt.segment, place, *numbers]]


def touch_text(felt: TouchResult, form: str) -> str:
    """Returns the curve as the text of a ".csv" or a ".json", one line or value for each ms."""
    columns = {
        "time_s": felt.times,
        "depth_mm": felt.depths,
        "force_N": felt.forces,
        "lateral_force_N": felt.lateral,
        "volume_mm3": felt.volumes,
        **{f"device_{axis}_mm": felt.devices[:, at] for at, axis in enumerate("LPS")},
        **{f"probe_{axis}_mm": felt.probes[:, at] for at, axis in enumerate("LPS")},
    }
    lists = {name: np.round(column, 6).tolist() for name, column in columns.items()}
    if form == ".csv":
        rows = zip(*lists.values(), strict=True)
        return rows_csv([dict(zip(lists, row, strict=True)) for row in rows])
    told = {
        "segment": felt.segment,
        "do": felt.do,
        "place_LPS_mm": felt.place,
        "inward_LPS": felt.inward,
        **touch_row(felt),
        "warnings": felt.warnings,
        "samples": lists,
    }
    return json.dumps(told, ensure_ascii=False) + "\n"


def plot_touch(felt: TouchResult, path: Path) -> None:
    """Plots force over depth, of a stroke over time; the same touch gives the same bytes.

    Raises:
        OSError: The disk refuses it.
    """
    import matplotlib as mpl
    from matplotlib.figure import Figure

    figure = Figure(figsize=(6.4, 4.0), layout="constrained")
    panel = figure.subplots()
    over = felt.times if felt.do == "stroke" else felt.depths
    panel.plot(over, felt.forces, color="#0072B2", lw=1.2, label="against the way in")
    panel.plot(over, felt.lateral, color="#D55E00", lw=1.0, label="across it")
    if felt.stiffness is not None and felt.residual is not None:
        title = f"{felt.stiffness:.3g} N/mm, residual {felt.residual:.2g} N"
        panel.set_title(title, loc="right", fontsize=9)
    panel.set_title(f"{felt.do} of {felt.segment}", loc="left")
    panel.set_xlabel("time [s]" if felt.do == "stroke" else "depth of the hand [mm]")
    panel.set_ylabel("force on the hand [N]")
    panel.spines[["top", "right"]].set_visible(False)
    panel.legend(frameon=False)
    ending = path.suffix.lower()
    dated = {".svg": {"Date": None}, ".pdf": {"CreationDate": None}, ".png": {}}[ending]
    # names within an SVG are random by default
    with mpl.rc_context({"svg.hashsalt": "palpate"}), whole_file(path) as unfinished:
        figure.savefig(unfinished, dpi=150, format=ending[1:], metadata=dated)
