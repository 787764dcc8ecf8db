"""The command ``palpate compare``: segments beside those of a reference."""

from __future__ import annotations

import typer

from palpate.base.console import Display, quiet_libraries, warn
from palpate.cli.options import ScanOrScene, Segments, Threshold
from palpate.cli.request_options import with_requests
from palpate.cli.table_form import AsCsv, AsJson, table_form
from palpate.io.request import ReadRequest
from palpate.segmentation.measures.comparison_request import CompareRequest

__all__ = ["EXAMPLES", "compare"]

EXAMPLES = """\b
Examples:
  palpate compare ct/ --segments mine.seg.nrrd --reference truth.seg.nrrd
  palpate compare ct.nii.gz --threshold 250 --reference bone.nii.gz -o bone.csv
  palpate compare work.palpate --segment 1 --reference labels.nii.gz --against 2

HD95 is the 95th percentile of distances between borders, the larger one of both ways; the mean
surface distance is that of both ways together. Distances run between centres of border voxels.
"""


@with_requests
def compare(
    path: ScanOrScene,
    *,
    request: CompareRequest,
    segments: Segments = None,
    threshold: Threshold = None,
    as_csv: AsCsv = False,
    as_json: AsJson = False,
    reading: ReadRequest,
) -> None:
    """Compare segments with a reference: Dice, Hausdorff and mean surface distance."""
    from palpate.cli.scenes import measured_scene
    from palpate.saved.ending import is_scene
    from palpate.segmentation.measures.comparison_table import comparison_text

    form = table_form(request.out, as_csv=as_csv, as_json=as_json)
    # of a saved scene, they are about the reference alone
    fits = not is_scene(path)
    with quiet_libraries(), Display() as display:
        scene = measured_scene(
            path,
            reading,
            threshold=threshold,
            segments=segments,
            resample=request.resample and fits,
            another_patient=request.another_patient and fits,
            progress=display,
        )
        found = request.compare(scene, progress=display)
    for sentence in found.warnings:
        warn(sentence)
    if request.out is None:
        typer.echo(comparison_text(found, form), nl=False)
    else:
        typer.echo(f"{request.out}: {len(found.segments)} segments")
