"""``palpate segment``: a segment out of a scan, without a page."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from palpate.base.console import Display, quiet_libraries, warn
from palpate.cli.request_options import with_requests
from palpate.cli.written_files import WRITES
from palpate.io.request import ReadRequest
from palpate.segmentation.request import SegmentRequest

__all__ = ["EXAMPLES", "segment"]

EXAMPLES = """\b
Examples:
  palpate segment ct/ --threshold 250 --keep-largest -o bone.seg.nrrd
  palpate segment ct.nii.gz --otsu 3 -o classes.nii.gz
  palpate segment ct.mha --grow=-83,278,1170 --smooth 2 -o liver.seg.nrrd
  palpate segment ct.mha --threshold -200 --fill --hollow 3 -o skin.nii.gz
  palpate segment mr.nii.gz --seeds painted.seg.nrrd -o grown.seg.nrrd
  palpate segment ct/ --threshold bone --subtract teeth.seg.nrrd -o jaw.seg.nrrd
  palpate segment ct/ --auto -o organs.seg.nrrd

Operations are applied in the order of the options above, whatever order they are given in.
"""


@with_requests
def segment(
    path: Annotated[
        Path,
        typer.Argument(help="Scan, as for `palpate open`.", metavar="PATH"),
    ],
    *,
    out: Annotated[
        Path,
        typer.Option(
            "--out", "-o", help="Segments to write (.seg.nrrd, .nrrd, .nii, .nii.gz, .mha)."
        ),
        WRITES,
    ],
    request: SegmentRequest,
    reading: ReadRequest,
) -> None:
    """Segment a scan and write the result."""
    from palpate.base.early_imports import IMAGE_WRITING, import_early
    from palpate.base.file_suffixes import IMAGE_SUFFIXES
    from palpate.base.replacing import check_replaceable
    from palpate.base.whole_file import check_target
    from palpate.labels.name_table import table_beside

    check_target(out, (".seg.nrrd", *IMAGE_SUFFIXES))
    if not out.name.lower().endswith(".seg.nrrd"):
        check_replaceable(table_beside(out))
    import_early(IMAGE_WRITING)
    with quiet_libraries(), Display() as display:
        volume = reading.read(path, display)
        from palpate.export.export import export_scene
        from palpate.volumes.scene import Scene

        made, found_warnings = request.make(volume, progress=display)
        scene = Scene(volume)
        for one in made:
            scene.add(one)
        told = export_scene(scene, out, progress=display)
    for warning in (*volume.warnings, *found_warnings, *told):
        warn(warning)
    for one in made:
        typer.echo(f"{out}: {one.name}, {one.voxel_count} voxels, {one.volume_text}")
