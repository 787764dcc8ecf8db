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

What is asked for is done in the order of the options above, whatever order they are given in.
"""


@with_reading
def segment(  # noqa: PLR0913  # one per option of the command line
    path: Annotated[
        Path,
        typer.Argument(help="A scan, as `palpate open` takes it.", metavar="PATH"),
    ],
    *,
    out: Annotated[
        Path,
        typer.Option("--out", "-o", help="New .seg.nrrd, .nrrd, .nii, .nii.gz or .mha."),
    ],
    reading: Reading,
    threshold: Annotated[
        str | None,
        typer.Option(
            help="Values of the segment, or for CT a tissue: bone, compact bone, spongy bone, "
            "soft tissue, muscle, fat, skin, lung.",
            metavar="LOW[,HIGH]",
        ),
    ] = None,
    otsu: Annotated[
        int | None,
        typer.Option(help="Segments by Otsu's thresholds, from so many classes.", metavar="2..4"),
    ] = None,
    grow: Annotated[
        list[str] | None,
        typer.Option(
            help="Grows from a point in the patient (LPS), in mm; again for more points.",
            metavar="X,Y,Z",
        ),
    ] = None,
    seeds: Annotated[
        Path | None,
        typer.Option(help="Grows the segments of a file until they meet; one is what is around."),
    ] = None,
    auto: Annotated[
        bool, typer.Option("--auto", help="By TotalSegmentator, where it is installed.")
    ] = False,
    fast: Annotated[
        bool, typer.Option("--fast", help="With --auto: at 3 mm, which takes minutes.")
    ] = False,
    spread: Annotated[
        float | None,
        typer.Option(help="Of grown values, in standard deviations of those around the point."),
    ] = None,
    passage: Annotated[
        float | None, typer.Option(help="Passages narrower than this are not entered, in mm.")
    ] = None,
    most: Annotated[
        float | None, typer.Option(help="A grown segment becomes no larger than this, in ml.")
    ] = None,
    keep_largest: Annotated[
        bool, typer.Option("--keep-largest", help="Keep the largest island.")
    ] = False,
    drop_below: Annotated[
        float | None, typer.Option(help="Remove islands smaller than this, in ml.")
    ] = None,
    fill: Annotated[bool, typer.Option("--fill", help="Fill holes.")] = False,
    between_slices: Annotated[
        bool, typer.Option("--between-slices", help="Fill empty slices between painted ones.")
    ] = False,
    smooth: Annotated[
        float | None, typer.Option(help="Standard deviation of a Gaussian on the mask, in mm.")
    ] = None,
    median: Annotated[
        float | None, typer.Option(help="Half edge of the box of a median on the mask, in mm.")
    ] = None,
    joint: Annotated[
        float | None,
        typer.Option(help="Smooth all segments together by such a deviation: they still meet."),
    ] = None,
    opening: Annotated[
        float | None, typer.Option(help="Remove bridges that a ball does not fit into, in mm.")
    ] = None,
    closing: Annotated[
        float | None, typer.Option(help="Close gaps that a ball does not fit into, in mm.")
    ] = None,
    margin: Annotated[
        float | None, typer.Option(help="Grow by this, or shrink where it is below 0, in mm.")
    ] = None,
    hollow: Annotated[
        float | None,
        typer.Option(help="Keep a shell so thick inside the border, or outside below 0, in mm."),
    ] = None,
    unite: Annotated[
        Path | None, typer.Option(help="Add the segments of a file.", metavar="FILE")
    ] = None,
    subtract: Annotated[
        Path | None, typer.Option(help="Take the segments of a file away.", metavar="FILE")
    ] = None,
    intersect: Annotated[
        Path | None, typer.Option(help="Keep what segments of a file have too.", metavar="FILE")
    ] = None,
    name: Annotated[str | None, typer.Option(help="What to call the segment.")] = None,
) -> None:
    """Make a segment of a scan and write it."""
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
        typer.echo(f"{out}: {one.name}, {one.voxel_count} voxels, {one.volume_ml:.1f} ml")
