"""``palpate reconstruct``: a scan out of projections."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, cast

import typer

from palpate.base.console import Display, quiet_libraries

if TYPE_CHECKING:
    from palpate.reconstruction.scanner import Beam, Zero

__all__ = ["EXAMPLES", "reconstruct"]

EXAMPLES = """\b
Examples:
  palpate reconstruct cone.nrrd -o scan.nii.gz --beam cone --arc 360 --pixel 0.8,0.8
    --source-axis 1000 --source-detector 1536
  palpate reconstruct sinograms.tif -o scan.nii.gz --beam parallel --arc 180 --sinograms
    --pixel 1.2,2.5 --size 256,256,64 --voxel 1.2,1.2,2.5 --hann 0.8

Projections are images of line integrals, one for each angle, evenly spaced over the arc; with
--intensities, images of detector counts. Cone beams need RTK: install the extra "reconstruct".
"""


def reconstruct(  # noqa: PLR0913  # one per option of the command line
    projections: Annotated[
        Path,
        typer.Argument(
            help="Projections: NRRD, NIfTI, MetaImage or multi-page TIFF file, or a folder "
            "of TIFFs."
        ),
    ],
    *,
    out: Annotated[
        Path, typer.Option("--out", "-o", help="Scan to write, in HU (.nii.gz, .nii, .nrrd, .mha).")
    ],
    beam: Annotated[
        str, typer.Option(help="Geometry: parallel, or cone (circular source trajectory).")
    ],
    pixel: Annotated[str, typer.Option(help="Pixel size of the detector in mm.", metavar="U,V")],
    size: Annotated[
        str | None,
        typer.Option(help="Number of voxels; by default the whole field of view.", metavar="X,Y,Z"),
    ] = None,
    voxel: Annotated[
        str | None,
        typer.Option(
            help="Voxel size in mm; by default the pixel size at the axis.", metavar="X,Y,Z"
        ),
    ] = None,
    arc: Annotated[
        float, typer.Option(help="Angular range of the projections in degrees.")
    ] = 360.0,
    first_angle: Annotated[
        float, typer.Option(help="Angle of the first projection in degrees.")
    ] = 0.0,
    source_axis: Annotated[
        float, typer.Option(help="Cone: distance from source to rotation axis in mm.")
    ] = 0.0,
    source_detector: Annotated[
        float, typer.Option(help="Cone: distance from source to detector in mm.")
    ] = 0.0,
    offset: Annotated[
        str,
        typer.Option(
            help="Offset of the detector's centre from the central ray in mm.", metavar="U,V"
        ),
    ] = "0,0",
    zero: Annotated[
        str,
        typer.Option(
            help="Side of the patient with the source at angle 0: back, or front (IEC 61217, RTK); "
            "it moves to the patient's left."
        ),
    ] = "back",
    sinograms: Annotated[
        bool,
        typer.Option("--sinograms", help="The images are sinograms, one for each detector row."),
    ] = False,
    intensities: Annotated[
        float | None,
        typer.Option(
            help="The images are intensities; the value is the intensity without a patient."
        ),
    ] = None,
    water: Annotated[
        float | None, typer.Option(help="Attenuation coefficient of water in 1/mm.")
    ] = None,
    hann: Annotated[
        float,
        typer.Option(
            help="Cut-off of the Hann window as a fraction of the highest frequency; 0 for "
            "no window."
        ),
    ] = 0.0,
) -> None:
    """Reconstruct a scan from projections."""
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
        zero=cast("Zero", zero),
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
