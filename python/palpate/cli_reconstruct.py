"""``palpate reconstruct``: a scan out of projections."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, cast

import typer

from palpate.console import Display, quiet_libraries

if TYPE_CHECKING:
    from palpate.reconstruction import Beam

__all__ = ["EXAMPLES", "reconstruct"]

EXAMPLES = """\b
Examples:
  palpate reconstruct cone.nrrd -o scan.nii.gz --beam cone --arc 360 --pixel 0.8,0.8
    --source-axis 1000 --source-detector 1536 --size 256,256,200 --voxel 1,1,1
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
    pixel: Annotated[str, typer.Option(help="Of the detector [mm].", metavar="U,V")],
    size: Annotated[str, typer.Option(help="Voxels of the scan.", metavar="X,Y,Z")],
    voxel: Annotated[str, typer.Option(help="Their edges [mm].", metavar="X,Y,Z")],
    arc: Annotated[float, typer.Option(help="That the projections cover [degrees].")] = 360.0,
    first_angle: Annotated[float, typer.Option(help="Of the gantry [degrees].")] = 0.0,
    source_axis: Annotated[float, typer.Option(help="Cone: source to axis [mm].")] = 0.0,
    source_detector: Annotated[float, typer.Option(help="Cone: source to detector [mm].")] = 0.0,
    offset: Annotated[
        str, typer.Option(help="Of the detector's middle from the central ray [mm].", metavar="U,V")
    ] = "0,0",
    sinograms: Annotated[
        bool, typer.Option("--sinograms", help="Images are sinograms: one for each row.")
    ] = False,
    intensities: Annotated[
        float | None, typer.Option(help="What the detector counts without a patient.")
    ] = None,
    water: Annotated[float | None, typer.Option(help="Attenuation of water [1/mm].")] = None,
    hann: Annotated[
        float, typer.Option(help="Smooths: share of the highest frequency; 0 for none.")
    ] = 0.0,
) -> None:
    """Make a scan out of projections."""
    import numpy as np

    from palpate.cli_surface import check_target
    from palpate.export_image import IMAGE_SUFFIXES, write_scan
    from palpate.projections import integrals_of, read_projections
    from palpate.reconstruction import WATER, Scanner
    from palpate.reconstruction import reconstruct as make

    check_target(out, IMAGE_SUFFIXES)
    u, v = _numbers(pixel, 2, "pixel")
    shift_u, shift_v = _numbers(offset, 2, "offset")
    x, y, z = _numbers(voxel, 3, "voxel")
    columns, rows, slices = (round(count) for count in _numbers(size, 3, "size"))
    with quiet_libraries(), Display() as display:
        images = read_projections(projections, sinograms=sinograms, progress=display)
        if intensities is not None:
            images = integrals_of(images, intensities)
        scanner = Scanner(
            beam=cast("Beam", beam),
            angles=(first_angle + arc / len(images) * np.arange(len(images))).tolist(),
            pixel=(u, v),
            offset=(shift_u, shift_v),
            source_to_axis=source_axis,
            source_to_detector=source_detector,
        )
        volume = make(
            images,
            scanner,
            size=(columns, rows, slices),
            voxel=(x, y, z),
            water=WATER if water is None else water,
            hann=hann,
            progress=display,
        )
        write_scan(volume, out)
    low, high = volume.range
    typer.echo(f"{out}: {columns} x {rows} x {slices} voxels, {low:.0f} to {high:.0f} HU")


def _numbers(given: str, count: int, name: str) -> list[float]:
    from palpate.errors import OptionError

    try:
        numbers = [float(part) for part in given.split(",")]
    except ValueError:
        numbers = []
    if len(numbers) != count:
        raise OptionError(f"{name} {given!r} given; allowed: {count} numbers with commas between")
    return numbers
