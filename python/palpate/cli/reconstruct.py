"""``palpate reconstruct``: a scan out of projections."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, cast

import typer

from palpate.base.console import Display, quiet_libraries

if TYPE_CHECKING:
    from palpate.reconstruction.scanner import Beam

__all__ = ["EXAMPLES", "reconstruct"]

EXAMPLES = """\b
Examples:
  palpate reconstruct cone.nrrd -o scan.nii.gz --beam cone --arc 360 --pixel 0.8,0.8
    --source-axis 1000 --source-detector 1536
  palpate reconstruct sinograms.tif -o scan.nii.gz --beam parallel --arc 180 --sinograms
    --pixel 1.2,2.5 --size 256,256,64 --voxel 1.2,1.2,2.5 --hann 0.8

Projections are images of line integrals, one for each angle, evenly over the arc; or, with
--intensities, of what the detector counted. RTK does the work (pip install 'palpate[reconstruct]').
"""


def reconstruct(  # noqa: PLR0913  # one per option of the command line
    projections: Annotated[
        Path, typer.Argument(help="NRRD, NIfTI, MetaImage or TIFF stack, or a folder of TIFFs.")
    ],
    *,
    out: Annotated[
        Path, typer.Option("--out", "-o", help="New .nii.gz, .nii, .nrrd or .mha, in HU.")
    ],
    beam: Annotated[str, typer.Option(help="parallel or cone (a source on a circle).")],
    pixel: Annotated[str, typer.Option(help="Of the detector, in mm.", metavar="U,V")],
    size: Annotated[
        str | None,
        typer.Option(help="Voxels of the scan; by default all that is seen.", metavar="X,Y,Z"),
    ] = None,
    voxel: Annotated[
        str | None,
        typer.Option(help="Their edges in mm; by default those of pixels.", metavar="X,Y,Z"),
    ] = None,
    arc: Annotated[float, typer.Option(help="That the projections cover, in degrees.")] = 360.0,
    first_angle: Annotated[float, typer.Option(help="Of the gantry, in degrees.")] = 0.0,
    source_axis: Annotated[float, typer.Option(help="Cone: source to axis, in mm.")] = 0.0,
    source_detector: Annotated[float, typer.Option(help="Cone: source to detector, in mm.")] = 0.0,
    offset: Annotated[
        str,
        typer.Option(help="Of the detector's middle from the central ray, in mm.", metavar="U,V"),
    ] = "0,0",
    sinograms: Annotated[
        bool, typer.Option("--sinograms", help="Images are sinograms: one for each row.")
    ] = False,
    intensities: Annotated[
        float | None, typer.Option(help="What the detector counts without a patient.")
    ] = None,
    water: Annotated[float | None, typer.Option(help="Attenuation of water, per mm.")] = None,
    hann: Annotated[
        float, typer.Option(help="Smooths: share of the highest frequency; 0 for none.")
    ] = 0.0,
) -> None:
    """Make a scan out of projections."""
    from palpate.base.whole_file import check_target
    from palpate.export.image import IMAGE_SUFFIXES, write_scan
    from palpate.reconstruction.reconstruction import WATER
    from palpate.reconstruction.request import ReconstructionRequest, reconstruct_file

    check_target(out, IMAGE_SUFFIXES)
    u, v = _numbers(pixel, 2, "pixel")
    shift_u, shift_v = _numbers(offset, 2, "offset")
    request = ReconstructionRequest(
        beam=cast("Beam", beam),
        pixel=(u, v),
        arc=arc,
        first_angle=first_angle,
        offset=(shift_u, shift_v),
        source_to_axis=source_axis,
        source_to_detector=source_detector,
        sinograms=sinograms,
        intensities=intensities,
        size=None if size is None else _size(size),
        voxel=None if voxel is None else _lengths(voxel),
        water=WATER if water is None else water,
        hann=hann,
    )
    with quiet_libraries(), Display() as display:
        volume = reconstruct_file(projections, request, progress=display)
        write_scan(volume, out)
    low, high = volume.range
    size_told = " x ".join(map(str, volume.dimensions))
    typer.echo(f"{out}: {size_told} voxels, {low:.0f} to {high:.0f} HU")


def _size(given: str) -> tuple[int, int, int]:
    x, y, z = (round(count) for count in _numbers(given, 3, "size"))
    return x, y, z


def _lengths(given: str) -> tuple[float, float, float]:
    x, y, z = _numbers(given, 3, "voxel")
    return x, y, z


def _numbers(given: str, count: int, name: str) -> list[float]:
    from palpate.base.errors import OptionError

    try:
        numbers = [float(part) for part in given.split(",")]
    except ValueError:
        numbers = []
    if len(numbers) != count:
        raise OptionError(f"{name} {given!r} given; allowed: {count} numbers with commas between")
    return numbers
