"""The command ``palpate render``: pictures and films of a scan, without a page."""

from __future__ import annotations

import typer

from palpate.base.console import Display, quiet_libraries
from palpate.cli.options import AnotherPatient, Resample, ScanOrScene, Segments, Threshold
from palpate.cli.request_options import with_requests
from palpate.io.request import ReadRequest
from palpate.pictures.request import PictureRequest

__all__ = ["EXAMPLES", "render"]

EXAMPLES = """\b
Examples:
  palpate render ct/ -o head.png
  palpate render ct.nii.gz -o bone.png --view left --preset ct-bone
  palpate render ct.nii.gz -o lungs.png --mode minip --view anterior
  palpate render ct.nii.gz --segments organs.seg.nrrd -o organs.png --size 1600x1200
  palpate render work.palpate --turntable turn.gif     (a saved scene)

Segments are solid, in their colours. The engine draws: no display, browser or graphics card is
needed.
"""


@with_requests
def render(
    path: ScanOrScene,
    *,
    request: PictureRequest,
    segments: Segments = None,
    threshold: Threshold = None,
    resample: Resample = False,
    another_patient: AnotherPatient = False,
    reading: ReadRequest,
) -> None:
    """Draw a scan as a picture, or as a film of one turn."""
    from palpate.base.typed_numbers import parse_threshold
    from palpate.cli.scenes import scene_at

    bounds = parse_threshold(threshold)
    with quiet_libraries(), Display() as display:
        scene = scene_at(
            path,
            reading,
            bounds=bounds,
            label_map=segments,
            resample=resample,
            another_patient=another_patient,
            progress=display,
        )
        written = request.write(scene, progress=display)
    for file in written:
        typer.echo(f"{file}: {request.size} pixels")
