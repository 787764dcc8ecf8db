"""``palpate segment``: a segment out of a scan, without a page."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from palpate.console import Display, quiet_libraries, warn

if TYPE_CHECKING:
    from palpate.progress import Progress
    from palpate.segment import Segment
    from palpate.segmentation import Growing, ShapeKind
    from palpate.volume import Volume

__all__ = ["EXAMPLES", "segment"]

EXAMPLES = """\b
Examples:
  palpate segment ct/ --threshold 250 --keep-largest -o bone.seg.nrrd
  palpate segment ct.nii.gz --otsu 3 -o classes.nii.gz
  palpate segment ct.mha --grow=-83,278,1170 --smooth 2 -o liver.seg.nrrd
  palpate segment ct.mha --threshold -200 --fill --hollow 3 -o skin.nii.gz

What is asked for is done in the order of the options above, whatever order they are given in.
"""


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
    series: Annotated[str | None, typer.Option(help="DICOM series.")] = None,
    threshold: Annotated[
        str | None, typer.Option(help="Values of the segment.", metavar="LOW[,HIGH]")
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
    smooth: Annotated[
        float | None, typer.Option(help="Standard deviation of a Gaussian on the mask, in mm.")
    ] = None,
    margin: Annotated[
        float | None, typer.Option(help="Grow by this, or shrink where it is below 0, in mm.")
    ] = None,
    hollow: Annotated[
        float | None, typer.Option(help="Keep a shell so thick inside the border, in mm.")
    ] = None,
    name: Annotated[str | None, typer.Option(help="What to call the segment.")] = None,
) -> None:
    """Make a segment of a scan and write it."""
    from palpate.cli_open import parse_threshold
    from palpate.cli_surface import check_target
    from palpate.errors import OptionError
    from palpate.export import export_scene
    from palpate.export_image import IMAGE_SUFFIXES
    from palpate.io import read
    from palpate.scene import Scene
    from palpate.segmentation import Growing, changed_shape

    check_target(out, (".seg.nrrd", *IMAGE_SUFFIXES))
    ways = [way for way in (threshold, otsu, grow or None) if way is not None]
    if len(ways) != 1:
        raise OptionError(
            f"{len(ways)} ways to make a segment given; allowed: one of --threshold, --otsu, --grow"
        )
    if not grow and not spread is passage is most is None:
        raise OptionError("options of growing given; allowed: with --grow only")
    usual = Growing()
    growing = Growing(
        spread=usual.spread if spread is None else spread,
        passage=usual.passage if passage is None else passage,
        most_ml=usual.most_ml if most is None else most,
    )
    growing.check()
    bounds = parse_threshold(threshold)
    seeds = [parse_point(one) for one in grow or ()]
    changes = _changes(
        keep_largest=keep_largest,
        drop_below=drop_below,
        fill=fill,
        lengths=(smooth, margin, hollow),
    )
    with quiet_libraries(), Display() as display:
        volume = read(path, series=series, progress=display)
        made = _make(volume, bounds, (otsu, seeds, growing), progress=display)
        for kind, amount in changes:
            display(kind.replace("-", " "), None)
            made = [changed_shape(one, kind, amount=amount) for one in made]
        if name is not None:
            for one in made:
                one.name = name if len(made) == 1 else f"{name}, {one.name}"
        made = [one for one in made if one.voxel_count > 0]
        if not made:
            raise OptionError("nothing is left of the segment; allowed: smaller changes")
        scene = Scene(volume)
        for one in made:
            scene.add(one)
        told = export_scene(scene, out, progress=display)
    for warning in (*volume.warnings, *told):
        warn(warning)
    for one in made:
        typer.echo(f"{out}: {one.name}, {one.voxel_count} voxels, {one.volume_ml:.1f} ml")


def parse_point(given: str) -> tuple[float, float, float]:
    """Returns the point that X,Y,Z stands for [mm].

    Raises:
        OptionError: It is none.
    """
    import math

    from palpate.errors import OptionError

    try:
        x, y, z = (float(part) for part in given.split(","))
    except ValueError:
        x = y = z = math.nan
    if not all(map(math.isfinite, (x, y, z))):
        raise OptionError(f"point {given!r} given; allowed: X,Y,Z [mm], such as 12.5,-40,310")
    return x, y, z


def _make(
    volume: Volume,
    bounds: tuple[float, float | None] | None,
    ways: tuple[int | None, list[tuple[float, float, float]], Growing],
    *,
    progress: Progress,
) -> list[Segment]:
    from palpate.segmentation import grown, otsu

    classes, seeds, growing = ways
    if bounds is not None:
        return [volume.threshold(*bounds, name="threshold")]
    if classes is not None:
        return otsu(volume, classes=classes)
    return [grown(volume, seeds, growing=growing, progress=progress)]


def _changes(
    *,
    keep_largest: bool,
    drop_below: float | None,
    fill: bool,
    lengths: tuple[float | None, float | None, float | None],
) -> list[tuple[ShapeKind, float]]:
    """Lists what is to be done, in order."""

    def asked() -> Iterator[tuple[ShapeKind, float]]:
        smooth, margin, hollow = lengths
        if keep_largest:
            yield "keep-largest", 1.0
        if drop_below is not None:
            yield "drop-small", drop_below
        if fill:
            yield "fill-holes", 0.0
        if smooth is not None:
            yield "smooth", smooth
        if margin is not None:
            yield ("grow", margin) if margin >= 0.0 else ("shrink", -margin)
        if hollow is not None:
            yield "hollow-inside", hollow

    return list(asked())
