"""``palpate reconstruct``: a scan out of projections."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from palpate.base.console import Display, quiet_libraries
from palpate.cli.request_options import with_requests
from palpate.cli.written_files import WRITES
from palpate.reconstruction.request import ReconstructionRequest

__all__ = ["EXAMPLES", "reconstruct"]

EXAMPLES = """\b
Examples:
  palpate reconstruct cone.nrrd -o scan.nii.gz --beam cone --arc 360 --pixel 0.8,0.8
    --source-axis 1000 --source-detector 1536
  palpate reconstruct sinograms.tif -o scan.nii.gz --beam parallel --arc 180 --sinograms
    --pixel 1.2,2.5 --size 256,256,64 --voxel 1.2,1.2,2.5 --hann 0.8
  palpate reconstruct projections.mha -o scan.nii.gz --beam cone --pixel 0.8,0.8
    --geometry geometry.xml

Projections are images of line integrals, one for each angle, evenly spaced over the arc or where
--geometry says; with --intensities, images of detector counts. Cone beams need RTK: install the
extra "reconstruct".
"""


@with_requests
def reconstruct(
    projections: Annotated[
        Path,
        typer.Argument(
            help="Projections: NRRD, NIfTI, MetaImage or multi-page TIFF file, or a folder "
            "of TIFFs."
        ),
    ],
    *,
    out: Annotated[
        Path,
        typer.Option(
            "--out", "--output", "-o", help="Scan to write, in HU (.nii.gz, .nii, .nrrd, .mha)."
        ),
        WRITES,
    ],
    request: ReconstructionRequest,
) -> None:
    """Reconstruct a scan from projections."""
    from palpate.base.file_suffixes import IMAGE_SUFFIXES
    from palpate.base.whole_file import check_target
    from palpate.export.image import write_scan
    from palpate.reconstruction.request import reconstruct_file

    check_target(out, IMAGE_SUFFIXES)
    with quiet_libraries(), Display() as display:
        volume = reconstruct_file(projections, request, progress=display)
        write_scan(volume, out)
    low, high = volume.range
    size_told = " x ".join(map(str, volume.dimensions))
    typer.echo(f"{out}: {size_told} voxels, {low:.0f} to {high:.0f} HU")
