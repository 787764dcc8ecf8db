"""What ``palpate surface`` does once its options are understood."""

from __future__ import annotations

from pathlib import Path
from typing import cast

import typer

from palpate.console import warn
from palpate.errors import OptionError
from palpate.mesh_io import (
    Frame,
    MeshFile,
    Unit,
    closed,
    grid_around,
    read_mesh,
    segment_of_mesh,
)
from palpate.mesh_write import SUFFIXES, write_mesh
from palpate.scene import Scene
from palpate.segment import Segment
from palpate.simpleitk import simpleitk
from palpate.surface import Source, Surface
from palpate.volume import Volume

__all__ = [
    "MASK_SUFFIXES",
    "add_mesh",
    "check_target",
    "choose_segment",
    "export_surface",
    "mesh_file",
    "write_voxels",
]

MASK_SUFFIXES = (".nrrd", ".nii", ".nii.gz", ".mha")


def check_target(path: Path, suffixes: tuple[str, ...] = SUFFIXES) -> None:
    """Refuses a file that could not be written, before anything is computed.

    Raises:
        OptionError: Its name ends with nothing known, or its folder is not there.
    """
    if not path.name.lower().endswith(suffixes):
        raise OptionError(f"{path.name!r} given; allowed: a name with {', '.join(suffixes)}")
    if not path.parent.is_dir():
        raise OptionError(f"folder {str(path.parent)!r} given; allowed: one that exists")


def choose_segment(scene: Scene, name: str | None) -> Segment:
    """Returns the segment of a name; the only one where none is named.

    Raises:
        OptionError: There is none, or it is not clear which one.
    """
    segments = {one.name: one.segment for one in scene}
    if name is None and len(segments) == 1:
        return next(iter(segments.values()))
    if name is None or name not in segments:
        given = "no segment" if name is None else f"segment {name!r}"
        raise OptionError(f"{given} given; allowed: {', '.join(segments) or 'none in this scan'}")
    return segments[name]


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


def add_mesh(scene: Scene, path: Path, *, frame: str | None, unit: str | None) -> None:
    """Adds the voxels of a closed mesh, on the scan's grid, shown as a surface.

    Raises:
        OptionError: Its frame or its unit is not known, or it has holes.
        MeshFormatError: It holds no mesh.
        EmptySegmentError: None of it lies in the scan.
    """
    file = mesh_file(path, frame=frame, unit=unit, close=False)
    segment = segment_of_mesh(file, scene.volume)
    scene.add(segment, shown_as="surface")
    thinnest = min(scene.volume.spacing)
    typer.echo(
        f"{file.name}: {segment.voxel_count} voxels of the scan, {segment.volume_ml:.2f} ml; "
        f"what is thinner than a voxel ({thinnest:g} mm) may be missing"
    )


def write_voxels(file: MeshFile, path: Path, *, grid: Volume | float, shell: bool) -> None:
    """Writes the voxels of a mesh as a label map, on the grid of a scan or of cubes [mm]."""
    volume = grid_around([file.mesh], grid) if isinstance(grid, float) else grid
    segment = segment_of_mesh(file, volume, as_shell=shell)
    sitk = simpleitk()
    image = sitk.GetImageFromArray(segment.mask())
    image.SetSpacing(volume.spacing)
    image.SetOrigin(volume.origin)
    image.SetDirection(volume.direction.ravel().tolist())
    suffix = next(one for one in MASK_SUFFIXES if path.name.lower().endswith(one))
    unfinished = path.with_name(f".{path.name}.part{suffix}")
    try:
        sitk.WriteImage(image, str(unfinished), useCompression=True)
        unfinished.replace(path)
    finally:
        unfinished.unlink(missing_ok=True)
    typer.echo(f"{path}: {segment.voxel_count} voxels, {segment.volume_ml:.1f} ml")
