"""The commands of ``palpate surface``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from palpate.base.console import Display, quiet_libraries, warn
from palpate.base.file_suffixes import IMAGE_SUFFIXES
from palpate.cli.options import AnotherPatient, Resample, ScanOrScene, Segments, Threshold
from palpate.cli.request_options import with_requests
from palpate.cli.written_files import WRITES, keeping_files
from palpate.io.request import ReadRequest
from palpate.volumes.surface_request import SurfaceRequest

if TYPE_CHECKING:
    from palpate.volumes.mesh_read import MeshFile
    from palpate.volumes.surface_report import SurfaceReport
    from palpate.volumes.volume import Volume

__all__ = ["surface"]

surface = typer.Typer(
    help="Convert segments to meshes and meshes to label maps.", no_args_is_help=True
)


@surface.command("export")
@keeping_files
@with_requests
def surface_export(
    path: ScanOrScene,
    *,
    request: SurfaceRequest,
    json_file: Annotated[
        Path | None,
        typer.Option("--json", help="Write the report to this file (.json); in mm, mm² and mm³."),
        WRITES,
    ] = None,
    reading: ReadRequest,
    threshold: Threshold = None,
    segments: Segments = None,
    resample: Resample = False,
    another_patient: AnotherPatient = False,
) -> None:
    """Write the surface of a segment as a mesh, in LPS mm, and say what it keeps."""
    from palpate.base.typed_numbers import parse_threshold
    from palpate.base.whole_file import check_target
    from palpate.cli.scenes import scene_at
    from palpate.volumes.mesh_write import write_mesh
    from palpate.volumes.scene import choose_segment
    from palpate.volumes.surface import Surface

    if json_file is not None:
        check_target(json_file, (".json",))
    bounds = parse_threshold(threshold)
    with quiet_libraries(), Display() as display:
        scene = scene_at(
            path,
            reading,
            bounds=bounds,
            label_map=segments,
            resample=resample,
            another_patient=another_patient,
            offered=True,
            progress=display,
        )
    chosen = choose_segment(scene, request.segment)
    made = Surface(chosen, step=request.step, smoothing=request.smoothing, source=request.source)
    write_mesh(made.mesh(), request.out)
    report = made.report()
    _print_report(report, request.out, count=len(scene))
    if json_file is not None:
        _write_report(report, request.out, json_file, count=len(scene))


@surface.command("voxels")
@keeping_files
def surface_voxels(
    mesh: Annotated[
        Path, typer.Argument(help="Mesh to read (.stl, .ply, .obj, .glb).", metavar="MESH")
    ],
    file: Annotated[
        Path,
        typer.Argument(help="Label map to write (.nrrd, .nii.gz, .mha).", metavar="FILE"),
        WRITES,
    ],
    *,
    spacing: Annotated[float | None, typer.Option(help="Voxel size in mm.")] = None,
    like: Annotated[Path | None, typer.Option(help="Use the grid of this scan.")] = None,
    frame: Annotated[str | None, typer.Option(help="Frame of the mesh: LPS or RAS.")] = None,
    unit: Annotated[str | None, typer.Option(help="Unit of the mesh: mm or m.")] = None,
    close: Annotated[bool, typer.Option("--close", help="Close holes in the mesh.")] = False,
    as_shell: Annotated[
        bool, typer.Option("--shell", help="Label only the surface, not the inside.")
    ] = False,
) -> None:
    """Make a label map of the inside of a mesh."""
    from palpate.base.errors import OptionError
    from palpate.base.whole_file import check_target
    from palpate.cli.scenes import further_scan, mesh_file

    check_target(file, IMAGE_SUFFIXES)
    if (spacing is None) == (like is None):
        raise OptionError("one grid is needed; allowed: --spacing MM, or --like SCAN")
    with quiet_libraries(), Display() as display:
        given = mesh_file(mesh, frame=frame, unit=unit, close=close)
        grid = spacing if like is None else further_scan(like, display)
    assert grid is not None  # noqa: S101  # one of both is given
    _write_voxels(given, file, grid=grid, shell=as_shell)


def _print_report(report: SurfaceReport, path: Path, *, count: int) -> None:
    """Says what was written, of how many segments, and what was lost."""
    for warning in report.warnings:
        warn(warning)
    typer.echo(f"{path}: {report.of(count)}, LPS, {'m' if path.suffix == '.glb' else 'mm'}")


def _write_report(report: SurfaceReport, mesh: Path, path: Path, *, count: int) -> None:
    """Writes the same as JSON, volumes in mm³ and areas in mm²."""
    import json

    from palpate.base.whole_file import whole_file

    told = {"file": str(mesh), "segments": count, **report.as_dict()}
    with whole_file(path) as unfinished:
        unfinished.write_text(json.dumps(told, indent=1, ensure_ascii=False) + "\n", "utf-8")


def _write_voxels(file: MeshFile, path: Path, *, grid: Volume | float, shell: bool) -> None:
    """Writes the voxels of a mesh as a label map, on the grid of a scan or of cubes [mm]."""
    from palpate.export.image import write_image
    from palpate.volumes.mesh_read import grid_around, segment_of_mesh

    volume = grid_around([file.mesh], grid) if isinstance(grid, float) else grid
    segment = segment_of_mesh(file, volume, as_shell=shell)
    write_image(segment.mask(), volume, path)
    typer.echo(f"{path}: {segment.voxel_count} voxels, {segment.volume_text}")
