"""The command ``palpate statistics``: volumes, values and sizes of segments."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from palpate.base.console import Display, quiet_libraries
from palpate.cli.options import AnotherPatient, Resample, ScanOrScene, Segments, Threshold
from palpate.cli.request_options import with_requests
from palpate.cli.table_form import AsCsv, AsJson, table_form
from palpate.cli.written_files import WRITES
from palpate.io.request import ReadRequest

if TYPE_CHECKING:
    from palpate.segmentation.measures.segment_statistics import SegmentStatistics
    from palpate.volumes.volume import Volume

__all__ = ["EXAMPLES", "statistics"]

EXAMPLES = """\b
Examples:
  palpate statistics ct/ --segments organs.seg.nrrd
  palpate statistics ct.nii.gz --threshold 250 -o bone.csv
  palpate statistics work.palpate -o work.json     (a saved scene)

Values are those of the file, in its unit. The axial diameter is the largest within one slice, of
the scan's slices that are nearest to axial; diameters run from corner to corner of voxels.
"""

SUFFIXES = (".csv", ".json")


@with_requests
def statistics(
    path: ScanOrScene,
    *,
    segments: Segments = None,
    threshold: Threshold = None,
    resample: Resample = False,
    another_patient: AnotherPatient = False,
    as_csv: AsCsv = False,
    as_json: AsJson = False,
    out: Annotated[
        Path | None,
        typer.Option("--out", "-o", help="Write a file (.csv, .json) instead."),
        WRITES,
    ] = None,
    reading: ReadRequest,
) -> None:
    """Measure segments: volume, values, diameters, surface area, centroid."""
    from palpate.base.whole_file import check_target, whole_file
    from palpate.cli.scenes import measured_scene
    from palpate.segmentation.measures.segment_statistics import statistics as measure

    form = table_form(out, as_csv=as_csv, as_json=as_json)
    if out is not None:
        check_target(out, SUFFIXES)
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
        measured = measure(scene, progress=display)
    text = _text(measured, scene.volume, form)
    if out is None:
        typer.echo(text, nl=False)
        return
    with whole_file(out) as unfinished:
        unfinished.write_text(text, "utf-8")
    typer.echo(f"{out}: {len(measured)} segments")


def _text(measured: list[SegmentStatistics], volume: Volume, form: str) -> str:
    from palpate.segmentation.measures.statistics_table import (
        statistics_csv,
        statistics_json,
        statistics_lines,
    )

    if form == ".csv":
        return statistics_csv(measured)
    if form == ".json":
        return statistics_json(measured, {"scan": volume.name, "unit": volume.unit})
    return "".join(f"{line}\n" for line in statistics_lines(measured))
