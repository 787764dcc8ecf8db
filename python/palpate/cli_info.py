"""The command ``palpate info``."""

from __future__ import annotations

from typing import Annotated

import typer

from palpate.cli_options import Fill, MaxVoxels, Orientation, Raw, Scan, Series, Unit, VoxelSize
from palpate.console import Display, quiet_libraries

__all__ = ["info"]


def info(  # one per option of the command line
    path: Scan,
    *,
    series: Series = None,
    orientation: Orientation = None,
    unit: Unit = None,
    fill: Fill = None,
    raw: Raw = None,
    voxel_size: VoxelSize = None,
    max_voxels: MaxVoxels = 1024**3,
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object.")] = False,
) -> None:
    """Tell what a scan is."""
    from palpate.cli_open import parse_voxel_size
    from palpate.info import describe, print_table
    from palpate.io import read

    size = parse_voxel_size(voxel_size)
    with quiet_libraries(), Display() as display:
        volume = read(
            path,
            series=series,
            orientation=orientation,
            unit=unit,
            fill=fill,
            raw=raw,
            voxel_size=size,
            max_voxels=max_voxels,
            progress=display,
        )
    if as_json:
        import json

        typer.echo(json.dumps(describe(volume), indent=2))
    else:
        print_table(volume)
