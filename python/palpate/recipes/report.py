"""The report of a recipe: one HTML file with pictures and the statistics of segments.

It does not name the patient.
"""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from palpate.base.package_version import package_version
from palpate.base.whole_file import whole_file
from palpate.pictures.choices import View
from palpate.pictures.picture_file import png_bytes
from palpate.pictures.render import DrawnScene
from palpate.recipes.html_page import data_url, html_page
from palpate.recipes.measures import Table
from palpate.segmentation.mask_shape import box_of
from palpate.segmentation.measures.segment_statistics import statistics
from palpate.segmentation.measures.statistics_table import statistics_cells
from palpate.volumes.scene import Scene

__all__ = ["slice_pictures", "write_report"]

TINT = 0.45
"""Share of a segment's colour over the scan."""

WINDOW_HU = (-160.0, 240.0)
"""What is black and white of a scan in HU: soft tissue."""

PICTURE_WIDTH = 320

VIEWS: tuple[View, ...] = ("anterior", "left", "superior")

STYLE = """
body { max-width: 1040px; }
figure { display: inline-block; margin: 0 12px 12px 0; } figcaption { color: var(--muted); }
figure img { border-radius: 6px; }
"""


def write_report(
    scene: Scene,
    path: Path,
    *,
    written: Sequence[Path],
    told: Sequence[str],
    tables: Sequence[Table] = (),
) -> None:
    """Writes what was made of a scan.

    Args:
        scene: The scan and its segments.
        path: The new file.
        written: Other files that were written.
        told: What a person should know.
        tables: What steps have measured.

    Raises:
        OSError: The disk refuses it.
    """
    volume = scene.volume
    size = " × ".join(str(count) for count in volume.dimensions)
    spacing = " × ".join(f"{edge:.3g}" for edge in volume.spacing)
    low, high = volume.range
    headings, *numbers = statistics_cells(statistics(scene))
    rows = "\n".join(
        f'<tr><td><span class="swatch" style="background:{_hex(shown.colour)}"></span>'
        f"{escape(name)}</td>{_row('td', cells)}</tr>"
        for shown, (name, *cells) in zip(scene, numbers, strict=True)
    )
    figures = "\n".join(
        f'<figure><img src="{_png(picture)}" '
        f'width="{PICTURE_WIDTH}" height="{round(PICTURE_WIDTH * ratio)}" alt="{name} slice">'
        f"<figcaption>{name}</figcaption></figure>"
        for name, picture, ratio in slice_pictures(scene)
    )
    views = "\n".join(
        f'<figure><img src="{_png(picture)}" '
        f'width="{PICTURE_WIDTH}" height="{PICTURE_WIDTH}" alt="seen from {side}">'
        f"<figcaption>{side}</figcaption></figure>"
        for side, picture in _views(scene)
    )
    measured = "\n".join(map(_table, tables))
    files = "".join(f"<li>{escape(each.name)}</li>" for each in written)
    notes = "".join(f"<li>{escape(each)}</li>" for each in told)
    body = f"""<h1>Segments</h1>
<p>{escape(volume.modality or "Scan")}, {size} voxels of {spacing} mm, values {low:g} to {high:g}
{escape(volume.unit)}. For research and teaching, not for clinical use.</p>
<div class="wide"><table>
<tr><th>{headings[0]}</th>{_row("th", headings[1:])}</tr>
{rows}
</table></div>
{measured}
<h2>Seen from outside</h2>
{views}
<h2>Slices through the middle of all segments</h2>
{figures}
{f"<h2>Files</h2><ul>{files}</ul>" if files else ""}
{f"<h2>To know</h2><ul>{notes}</ul>" if notes else ""}
<p class="muted">Palpate {escape(package_version())}</p>"""
    with whole_file(path) as unfinished:
        unfinished.write_text(html_page("Palpate: report", body, style=STYLE), "utf-8")


def _views(scene: Scene) -> list[tuple[str, NDArray[np.uint8]]]:
    """Returns pictures of all segments in the scan, from sides of the patient."""
    size = (2 * PICTURE_WIDTH, 2 * PICTURE_WIDTH)
    drawn = DrawnScene(scene)
    return [(view, drawn.draw(drawn.camera(view, size), size, quality="fast")) for view in VIEWS]


def _row(tag: str, cells: Sequence[str]) -> str:
    return "".join(f'<{tag} class="number">{escape(cell)}</{tag}>' for cell in cells)


def slice_pictures(scene: Scene) -> list[tuple[str, NDArray[np.uint8], float]]:
    """Returns slices across each axis of the scan through the middle of all segments.

    Each is its axis, RGB of shape [rows, columns, 3] and its height by its width. The last slice
    along an axis is at the top or the left.
    """
    volume = scene.volume
    union = np.zeros(volume.shape, bool)
    for shown in scene:
        union |= shown.segment.mask() != 0
    box = box_of(union) if union.any() else tuple(slice(0, count) for count in volume.shape)
    middle = [
        min((max(0, side.start) + min(side.stop, count)) // 2, count - 1)
        for side, count in zip(box, volume.shape, strict=True)
    ]
    low, high = _window(scene)
    pictures = []
    for axis, name in enumerate(("across z", "across y", "across x")):
        values = np.take(volume.array, middle[axis], axis=axis)
        grey = np.clip((volume.slope * values + volume.intercept - low) / (high - low), 0.0, 1.0)
        colour = np.repeat(grey[..., None], 3, axis=-1)
        for shown in scene:
            mask = np.take(shown.segment.mask(), middle[axis], axis=axis) != 0
            colour[mask] = (1.0 - TINT) * colour[mask] + TINT * np.array(shown.colour)
        if axis > 0:
            # rows run along z: upright where z runs up
            colour = colour[::-1]
        rows, columns = (edge for other, edge in enumerate(volume.spacing[::-1]) if other != axis)
        ratio = colour.shape[0] * rows / (colour.shape[1] * columns)
        pictures.append((name, np.rint(255.0 * colour).astype(np.uint8), ratio))
    return pictures


def _window(scene: Scene) -> tuple[float, float]:
    """Returns the values that are black and white."""
    volume = scene.volume
    if volume.unit == "HU":
        return WINDOW_HU
    stored = np.percentile(volume.array[::4, ::4, ::4], (1.0, 99.0))
    low, high = sorted(volume.value_of(float(value)) for value in stored)
    return low, max(high, low + 1e-9)


def _table(table: Table) -> str:
    headings, *rows = table.cells
    lines = "\n".join(
        f"<tr><td>{escape(name)}</td>{_row('td', cells)}</tr>" for name, *cells in rows
    )
    return f"""<h2>{escape(table.title)}</h2>
<div class="wide"><table>
<tr><th>{escape(headings[0])}</th>{_row("th", headings[1:])}</tr>
{lines}
</table></div>"""


def _hex(colour: tuple[float, float, float]) -> str:
    return "#" + "".join(f"{round(255 * share):02x}" for share in colour)


def _png(picture: NDArray[np.uint8]) -> str:
    return data_url("image/png", png_bytes(picture))
