"""The command ``palpate landmarks``: named points of segments."""

from __future__ import annotations

import typer

from palpate.base.console import Display, quiet_libraries, warn
from palpate.cli.options import AnotherPatient, Resample, ScanOrScene, Segments, Threshold
from palpate.cli.request_options import with_requests
from palpate.cli.table_form import AsCsv, AsJson, table_form
from palpate.io.request import ReadRequest
from palpate.segmentation.measures.landmarks_request import LandmarksRequest

__all__ = ["EXAMPLES", "landmarks"]

EXAMPLES = """\b
Examples:
  palpate landmarks ct/ --segments organs.seg.nrrd -o landmarks.csv
  palpate landmarks ct.nii.gz --threshold 250 --points anterior --points superior

Points are in the patient, LPS in mm. A side is the voxel that lies farthest there.
"""


@with_requests
def landmarks(
    path: ScanOrScene,
    *,
    request: LandmarksRequest,
    segments: Segments = None,
    threshold: Threshold = None,
    resample: Resample = False,
    another_patient: AnotherPatient = False,
    as_csv: AsCsv = False,
    as_json: AsJson = False,
    reading: ReadRequest,
) -> None:
    """List landmarks of segments: centroid, and the farthest point to each side."""
    from palpate.cli.scenes import measured_scene
    from palpate.segmentation.measures.landmarks_request import landmarks_text

    form = table_form(request.out, as_csv=as_csv, as_json=as_json)
    with quiet_libraries(), Display() as display:
        scene = measured_scene(
            path,
            reading,
            threshold=threshold,
            segments=segments,
            resample=resample,
            another_patient=another_patient,
            progress=display,
        )
        found, told = request.find(scene)
    for sentence in told:
        warn(sentence)
    if request.out is None:
        typer.echo(landmarks_text(found, form), nl=False)
    else:
        typer.echo(f"{request.out}: {len(found)} landmarks")
