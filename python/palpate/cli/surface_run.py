"""What ``palpate surface`` does once its options are understood."""

from __future__ import annotations

from pathlib import Path
from typing import cast

import typer

from palpate.base.console import warn
from palpate.base.errors import MeshFormatError, OptionError
from palpate.export.image import write_image
from palpate.volumes.mesh_read import (
    Frame,
    MeshFile,
    Unit,
    closed,
    grid_around,
    object_of_mesh,
    read_mesh,
    segment_of_mesh,
    suitable_spacing,
)
from palpate.volumes.mesh_write import write_mesh
from palpate.volumes.scene import Scene
from palpate.volumes.segment import Segment
from palpate.volumes.surface import Source, Surface
from palpate.volumes.volume import Volume

__all__ = [
    "MASK_SUFFIXES",
    "add_mesh",
    "export_surface",
    "mesh_file",
    "write_voxels",
]

MASK_SUFFIXES = (".nrrd", ".nii", ".nii.gz", ".mha")


def export_surface(
    segment: Segment, path: Path, *, step: int | None, smoothing: int | None, source: str
) -> None:
    """Writes the surface of a segment and tells what it is.

    Raises:
        OptionError: A setting is not allowed.
    """
    surface = Surface(segment, step=step, smoothing=smoothing, source=cast(Source, source))
    write_mesh(surface.mesh(), path)
    typer.echo(
        f"{path}: {surface.triangle_count} triangles, {surface.area / 100.0:.1f} cm², "
        f"{surface.volume / 1000.0:.1f} ml, LPS, {'m' if path.suffix == '.glb' else 'mm'}"
    )


def mesh_file(path: Path, *, frame: str | None, unit: str | None, close: bool) -> MeshFile:
    """Reads a mesh and tells what was repaired.

    Raises:
        OptionError: The frame or the unit is not known.
    """
    frames: dict[str | None, Frame | None] = {None: None, "LPS": "LPS", "RAS": "RAS"}
    units: dict[str | None, Unit | None] = {None: None, "mm": "mm", "m": "m"}
    if frame not in frames:
        raise OptionError(f"frame {frame!r} given; allowed: LPS, RAS")
    if unit not in units:
        raise OptionError(f"unit {unit!r} given; allowed: mm, m")
    file = read_mesh(path, frame=frames[frame], unit=units[unit])
    if close:
        file = closed(file)
    for note in file.notes:
        warn(f"{file.name}: {note}")
    return file


def add_mesh(
    scene: Scene, path: Path, *, frame: str | None, unit: str | None, spacing: float | None
) -> None:
    """Adds a closed mesh as an object with voxels of its own [mm], shown as a surface.

    Raises:
        OptionError: Its frame or its unit is not known, or the spacing is not allowed.
        MeshFormatError: It holds no mesh, or is open.
        EmptySegmentError: It is thinner than a voxel everywhere.
    """
    try:
        file = mesh_file(path, frame=frame, unit=unit, close=False)
    except OptionError as error:
        # here the options of a mesh are called otherwise than in `palpate surface`
        said = str(error).replace("--frame", "--mesh-frame").replace("--unit", "--mesh-unit")
        raise OptionError(said) from None
    if file.holes:
        raise MeshFormatError(
            f"{file.name!r} has {file.holes} hole{'s' if file.holes > 1 else ''}, so no inside; "
            "allowed: a closed mesh (`palpate surface voxels --close` makes a label map of it)"
        )
    edge = suitable_spacing(file.mesh, scene.volume) if spacing is None else spacing
    segment = object_of_mesh(file, edge)
    scene.add(segment, shown_as="surface")
    typer.echo(
        f"{file.name}: {segment.voxel_count} voxels of {edge:.3g} mm, {segment.volume_ml:.2f} ml"
    )


def write_voxels(file: MeshFile, path: Path, *, grid: Volume | float, shell: bool) -> None:
    """Writes the voxels of a mesh as a label map, on the grid of a scan or of cubes [mm]."""
    volume = grid_around([file.mesh], grid) if isinstance(grid, float) else grid
    segment = segment_of_mesh(file, volume, as_shell=shell)
    write_image(segment.mask(), volume, path)
    typer.echo(f"{path}: {segment.voxel_count} voxels, {segment.volume_ml:.1f} ml")
