"""The commands of ``palpate surface``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from palpate.base.console import Display, quiet_libraries, warn
from palpate.cli.options import Scan, Segments, Threshold
from palpate.cli.reading_options import Reading, with_reading

__all__ = ["surface"]

surface = typer.Typer(
    help="Convert segments to meshes and meshes to label maps.", no_args_is_help=True
)


@surface.command("export")
@with_reading
def surface_export(
    path: Scan,
    file: Annotated[
        Path, typer.Argument(help="Mesh to write (.stl, .ply, .obj, .glb).", metavar="FILE")
    ],
    *,
    segment: Annotated[
        str | None, typer.Option(help="Name of the segment, if there are several.")
    ] = None,
    smoothing: Annotated[
        int | None,
        typer.Option(help="Degree of smoothing, 0 to 12; 0 keeps the shape of the voxels."),
    ] = None,
    step: Annotated[int | None, typer.Option(help="Cell size: 1, 2 or 4 voxels.")] = None,
    source: Annotated[
        str,
        typer.Option(
            "--from", help="intensities (of a threshold; smooth) or bits (the voxels; with steps)."
        ),
    ] = "intensities",
    reading: Reading,
    threshold: Threshold = None,
    segments: Segments = None,
) -> None:
    """Write the surface of a segment as a mesh, in LPS mm."""
    from palpate.base.typed_numbers import parse_threshold
    from palpate.base.whole_file import check_target
    from palpate.cli.scenes import scene_of
    from palpate.cli.surface_run import export_surface
    from palpate.volumes.mesh_write import SUFFIXES
    from palpate.volumes.scene import choose_segment

    check_target(file, SUFFIXES)
    bounds = parse_threshold(threshold)
    with quiet_libraries(), Display() as display:
        volume = reading.read(path, display)
        scene = scene_of(volume, bounds=bounds, label_map=segments, progress=display)
    for warning in volume.warnings:
        warn(warning)
    chosen = choose_segment(scene, segment)
    export_surface(chosen, file, step=step, smoothing=smoothing, source=source)


@surface.command("voxels")
def surface_voxels(
    mesh: Annotated[
        Path, typer.Argument(help="Mesh to read (.stl, .ply, .obj, .glb).", metavar="MESH")
    ],
    file: Annotated[
        Path, typer.Argument(help="Label map to write (.nrrd, .nii.gz, .mha).", metavar="FILE")
    ],
    *,
    spacing: Annotated[float | None, typer.Option(help="Voxel size in mm.")] = None,
    like: Annotated[Path | None, typer.Option(help="Use the grid of this scan.")] = None,
    frame: Annotated[str | None, typer.Option(help="Frame of the mesh: LPS or RAS.")] = None,
    unit: Annotated[str | None, typer.Option(help="Unit of the mesh: mm or m.")] = None,
    close: Annotated[bool, typer.Option("--close", help="Close holes in the mesh.")] = False,
    shell: Annotated[
        bool, typer.Option("--shell", help="Label only the surface, not the inside.")
    ] = False,
) -> None:
    """Make a label map of the inside of a mesh."""
    from palpate.base.errors import OptionError
    from palpate.base.whole_file import check_target
    from palpate.cli.surface_run import MASK_SUFFIXES, mesh_file, write_voxels
    from palpate.io.reading import read

    check_target(file, MASK_SUFFIXES)
    if (spacing is None) == (like is None):
        raise OptionError("one grid is needed; allowed: --spacing MM, or --like SCAN")
    with quiet_libraries(), Display() as display:
        given = mesh_file(mesh, frame=frame, unit=unit, close=close)
        grid = spacing if like is None else read(like, progress=display)
    assert grid is not None  # noqa: S101  # one of both is given
    write_voxels(given, file, grid=grid, shell=shell)
