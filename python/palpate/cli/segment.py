"""``palpate segment``: a segment out of a scan, without a page."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from palpate.base.console import Display, quiet_libraries, warn
from palpate.cli.reading_options import Reading, with_reading

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


@with_reading
def segment(  # noqa: PLR0913  # one per option of the command line
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
    ],
    reading: Reading,
    threshold: Annotated[
        str | None,
        typer.Option(
            help="Values from LOW to HIGH, or for CT a tissue: bone, compact bone, spongy "
            "bone, soft tissue, muscle, fat, skin, lung.",
            metavar="LOW[,HIGH]",
        ),
    ] = None,
    otsu: Annotated[
        int | None,
        typer.Option(help="Otsu's thresholds with this number of classes.", metavar="2..4"),
    ] = None,
    grow: Annotated[
        list[str] | None,
        typer.Option(
            help="Grow a region from a point in LPS, in mm; repeatable.",
            metavar="X,Y,Z",
        ),
    ] = None,
    seeds: Annotated[
        Path | None,
        typer.Option(
            help="Grow the segments of a file until they meet (watershed); one of them "
            "marks the background."
        ),
    ] = None,
    auto: Annotated[
        bool, typer.Option("--auto", help="Use TotalSegmentator, which must be installed.")
    ] = False,
    fast: Annotated[
        bool, typer.Option("--fast", help="With --auto: work at 3 mm, which takes minutes.")
    ] = False,
    spread: Annotated[
        float | None,
        typer.Option(help="Range of values for --grow, in standard deviations around the point."),
    ] = None,
    passage: Annotated[
        float | None,
        typer.Option(help="For --grow: do not grow through passages narrower than this, in mm."),
    ] = None,
    most: Annotated[
        float | None, typer.Option(help="For --grow: maximum volume of the segment in ml.")
    ] = None,
    keep_largest: Annotated[
        bool, typer.Option("--keep-largest", help="Keep only the largest connected component.")
    ] = False,
    drop_below: Annotated[
        float | None, typer.Option(help="Remove connected components smaller than this, in ml.")
    ] = None,
    fill: Annotated[bool, typer.Option("--fill", help="Fill holes.")] = False,
    between_slices: Annotated[
        bool, typer.Option("--between-slices", help="Interpolate between painted slices.")
    ] = False,
    smooth: Annotated[
        float | None,
        typer.Option(help="Smooth the mask with a Gaussian of this standard deviation in mm."),
    ] = None,
    median: Annotated[
        float | None,
        typer.Option(help="Smooth the mask with a median filter of this radius in mm."),
    ] = None,
    joint: Annotated[
        float | None,
        typer.Option(
            help="Smooth all segments jointly with a Gaussian of this standard deviation "
            "in mm; no gaps appear."
        ),
    ] = None,
    opening: Annotated[
        float | None,
        typer.Option(
            help="Morphological opening with a ball of this radius in mm: removes thin bridges."
        ),
    ] = None,
    closing: Annotated[
        float | None,
        typer.Option(
            help="Morphological closing with a ball of this radius in mm: closes narrow gaps."
        ),
    ] = None,
    margin: Annotated[
        float | None,
        typer.Option(help="Grow the segment by this margin in mm, or shrink it if negative."),
    ] = None,
    hollow: Annotated[
        float | None,
        typer.Option(
            help="Keep a shell of this thickness in mm inside the border, or outside if negative."
        ),
    ] = None,
    unite: Annotated[
        Path | None, typer.Option(help="Union with the segments of a file.", metavar="FILE")
    ] = None,
    subtract: Annotated[
        Path | None, typer.Option(help="Subtract the segments of a file.", metavar="FILE")
    ] = None,
    intersect: Annotated[
        Path | None, typer.Option(help="Intersect with the segments of a file.", metavar="FILE")
    ] = None,
    name: Annotated[str | None, typer.Option(help="Name of the segment.")] = None,
) -> None:
    """Segment a scan and write the result."""
    from palpate.base.whole_file import check_target
    from palpate.export.export import export_scene
    from palpate.export.image import IMAGE_SUFFIXES
    from palpate.segmentation.request import SegmentRequest
    from palpate.volumes.scene import Scene

    check_target(out, (".seg.nrrd", *IMAGE_SUFFIXES))
    request = SegmentRequest(
        threshold=threshold,
        otsu=otsu,
        grow=grow or [],
        seeds=seeds,
        auto=auto,
        fast=fast,
        spread=spread,
        passage=passage,
        most=most,
        keep_largest=keep_largest,
        drop_below=drop_below,
        fill=fill,
        between_slices=between_slices,
        smooth=smooth,
        median=median,
        joint=joint,
        opening=opening,
        closing=closing,
        margin=margin,
        hollow=hollow,
        unite=unite,
        subtract=subtract,
        intersect=intersect,
        name=name,
    )
    request.check()
    with quiet_libraries(), Display() as display:
        volume = reading.read(path, display)
        made, found_warnings = request.make(volume, progress=display)
        scene = Scene(volume)
        for one in made:
            scene.add(one)
        told = export_scene(scene, out, progress=display)
    for warning in (*volume.warnings, *found_warnings, *told):
        warn(warning)
    for one in made:
        typer.echo(f"{out}: {one.name}, {one.voxel_count} voxels, {one.volume_text}")
