"""The command ``palpate touch``: what a ball feels of a segment, without a hand."""

from __future__ import annotations

import typer

from palpate.base.console import Display, quiet_libraries, warn
from palpate.cli.options import AnotherPatient, Resample, ScanOrScene, Segments, Threshold
from palpate.cli.request_options import with_requests
from palpate.io.request import ReadRequest
from palpate.session.touch_request import TouchRequest

__all__ = ["EXAMPLES", "touch"]

EXAMPLES = """\b
Examples:
  palpate touch ct/ --threshold 250 --at superior --depth 3 -o press.csv
  palpate touch ct/ --segments organs.seg.nrrd --segment 1 --material liver --plot liver.svg
  palpate touch ct/ --threshold 250 --do drill --at anterior --offset 0,0,20 --depth 4 -o drill.csv
  palpate touch ct/ --threshold 250 --do stroke --along superior --length 15 -o stroke.csv

The ball comes from the side of the place, along the axis, or from the point toward the centroid.
Stiffness is the slope of force over depth on the way in. The same touch gives the same numbers.
"""


@with_requests
def touch(
    path: ScanOrScene,
    *,
    request: TouchRequest,
    segments: Segments = None,
    threshold: Threshold = None,
    resample: Resample = False,
    another_patient: AnotherPatient = False,
    reading: ReadRequest,
) -> None:
    """Press, stroke or drill a segment by a script: force curve and stiffness."""
    from palpate.cli.scenes import measured_scene
    from palpate.segmentation.measures.statistics_table import aligned_lines
    from palpate.session.touch_table import touch_and_write, touch_cells

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
        display("touching", None)
        felt = touch_and_write(scene, request)
    for sentence in felt.warnings:
        warn(sentence)
    for line in aligned_lines(touch_cells(felt)):
        typer.echo(line)
    for file in (request.out, request.plot):
        if file is not None:
            typer.echo(f"{file} written")
