"""The commands of ``palpate surface``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, cast

import typer

from palpate.base.console import Display, quiet_libraries, warn
from palpate.cli.options import Scan, Segments, Threshold
from palpate.cli.reading_options import Reading, with_reading

if TYPE_CHECKING:
    from palpate.volumes.mesh_read import MeshFile
    from palpate.volumes.segment import Segment
    from palpate.volumes.surface import Source
    from palpate.volumes.volume import Volume

__all__ = ["surface"]

MASK_SUFFIXES = (".nrrd", ".nii", ".nii.gz", ".mha")

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
    _export(chosen, file, step=step, smoothing=smoothing, source=source)


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
    from palpate.cli.scenes import mesh_file
    from palpate.io.reading import read

    check_target(file, MASK_SUFFIXES)
    if (spacing is None) == (like is None):
        raise OptionError("one grid is needed; allowed: --spacing MM, or --like SCAN")
    with quiet_libraries(), Display() as display:
        given = mesh_file(mesh, frame=frame, unit=unit, close=close)
        grid = spacing if like is None else read(like, progress=display)
    assert grid is not None  # noqa: S101  # one of both is given
    _write_voxels(given, file, grid=grid, shell=shell)


def _export(
    segment: Segment, path: Path, *, step: int | None, smoothing: int | None, source: str
) -> None:
    """Writes the surface of a segment and prints its size.

    Raises:
        OptionError: A setting is not allowed.
    """
    from palpate.base.volume_text import volume_text
    from palpate.volumes.mesh_write import write_mesh
    from palpate.volumes.surface import Surface

    surface = Surface(segment, step=step, smoothing=smoothing, source=cast("Source", source))
    write_mesh(surface.mesh(), path)
    typer.echo(
        f"{path}: {surface.triangle_count} triangles, {surface.area / 100.0:.1f} cm², "
        f"{volume_text(surface.volume)}, LPS, {'m' if path.suffix == '.glb' else 'mm'}"
    )


def _write_voxels(file: MeshFile, path: Path, *, grid: Volume | float, shell: bool) -> None:
    """Writes the voxels of a mesh as a label map, on the grid of a scan or of cubes [mm]."""
    from palpate.export.image import write_image
    from palpate.volumes.mesh_read import grid_around, segment_of_mesh

    volume = grid_around([file.mesh], grid) if isinstance(grid, float) else grid
    segment = segment_of_mesh(file, volume, as_shell=shell)
    write_image(segment.mask(), volume, path)
    typer.echo(f"{path}: {segment.voxel_count} voxels, {segment.volume_text}")
