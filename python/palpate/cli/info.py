"""The command ``palpate info``."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

import typer

from palpate.base.console import Display, quiet_libraries, spoken
from palpate.base.harmless_text import terminal
from palpate.cli.options import Scan
from palpate.cli.request_options import with_requests
from palpate.io.request import ReadRequest

if TYPE_CHECKING:
    from palpate.volumes.volume import Volume

__all__ = ["describe", "info", "print_table"]


@with_requests
def info(
    path: Scan,
    *,
    reading: ReadRequest,
    as_json: Annotated[bool, typer.Option("--json", help="Print a JSON object.")] = False,
) -> None:
    """Print the properties of a scan."""
    with quiet_libraries(), Display() as display:
        volume = reading.read(path, display)
    if as_json:
        import json

        typer.echo(json.dumps(describe(volume), indent=2))
    else:
        print_table(volume)


def describe(volume: Volume) -> dict[str, Any]:
    """Returns what is known of a scan, ready for JSON; lengths in mm, points in LPS."""
    return {
        "name": volume.name,
        "modality": volume.modality,
        "unit": volume.unit,
        "dimensions": list(volume.dimensions),
        "spacing_mm": list(volume.spacing),
        "origin_mm": list(volume.origin),
        "direction": volume.direction.tolist(),
        "orientation": volume.orientation,
        "range": list(volume.range),
        "slope": volume.slope,
        "intercept": volume.intercept,
        "bone_threshold": volume.anchors.bone,
        "soft_tissue": volume.anchors.soft_tissue,
        "memory_bytes": volume.memory_bytes,
        "series": volume.traits.series,
        "warnings": [spoken(warning) for warning in volume.warnings],
        "notes": [spoken(note) for note in volume.notes],
    }


def _rows(volume: Volume) -> list[tuple[str, str]]:
    """Returns what is known of a scan as lines of a table."""
    low, high = volume.range
    unit = f" {volume.unit}" if volume.unit else ""
    size = [step * count for step, count in zip(volume.spacing, volume.dimensions, strict=True)]
    return [
        ("name", volume.name),
        ("modality", volume.modality or "unknown"),
        ("dimensions", " x ".join(map(str, volume.dimensions))),
        ("spacing", " x ".join(f"{step:.4g}" for step in volume.spacing) + " mm"),
        ("size", " x ".join(f"{length:.0f}" for length in size) + " mm"),
        ("orientation", volume.orientation),
        ("values", f"{low:g} to {high:g}{unit or ' (unit unknown)'}"),
        ("bone from", f"{volume.anchors.bone:.4g}{unit}"),
        ("memory", f"{volume.memory_bytes / 2**20:.1f} MiB"),
        *([("series", volume.traits.series)] if volume.traits.series else []),
        *(("warning", spoken(warning)) for warning in volume.warnings),
        *(("note", spoken(note)) for note in volume.notes),
    ]


def print_table(volume: Volume) -> None:
    """Prints what is known of a scan for a person."""
    from rich.table import Table

    table = Table(show_header=False, box=None, padding=(0, 2, 0, 0))
    table.add_column(style="bold")
    for name, value in _rows(volume):
        table.add_row(name, value)
    terminal().print(table)
