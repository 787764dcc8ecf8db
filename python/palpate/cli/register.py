"""``palpate register``: one scan brought to another, without a page."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, cast

import typer

from palpate.base.console import Display, quiet_libraries, warn
from palpate.cli.options import Interpolated

if TYPE_CHECKING:
    from palpate.base.interpolation import InterpolationChoice
    from palpate.base.progress import Progress
    from palpate.registration.options import Kind, MetricChoice, Pairs, SearchOptions, Start
    from palpate.volumes.segment import Segment
    from palpate.volumes.volume import Volume

__all__ = ["EXAMPLES", "read_landmarks", "register"]

EXAMPLES = """\b
Examples:
  palpate register ct/ mr/ -o mr-to-ct.tfm --resampled mr-on-ct.nii.gz
  palpate register before.mha after.mha -o T.tfm --kind bspline --picture T.png
  palpate register ct.nii.gz mr.nii.gz -o T.tfm --landmarks pairs.csv
  palpate register a.mha b.mha -o T.tfm --kind affine --fixed-mask body.nii.gz

The transform maps points of FIXED to MOVING (LPS, mm), as ITK and 3D Slicer expect. Each line of
the landmarks has six numbers: X,Y,Z in FIXED and X,Y,Z in MOVING.
"""


def register(  # noqa: PLR0913  # one per option of the command line
    fixed: Annotated[Path, typer.Argument(help="Fixed scan, as for `palpate open`.")],
    moving: Annotated[Path, typer.Argument(help="Moving scan, registered to the fixed one.")],
    *,
    output: Annotated[
        Path | None, typer.Option("--output", "-o", help="Transform to write (.tfm).")
    ] = None,
    resampled: Annotated[
        Path | None,
        typer.Option(
            help="Write the moving scan, resampled on the grid of the fixed one (.nii.gz, "
            ".nii, .nrrd, .mha)."
        ),
    ] = None,
    interpolation: Interpolated = "automatic",
    write_inverse: Annotated[
        Path | None,
        typer.Option(help="Write the inverse transform, from points of MOVING to FIXED (.tfm)."),
    ] = None,
    picture: Annotated[
        Path | None,
        typer.Option(
            help="Write a checkerboard of both scans (.png): top before, bottom after registration."
        ),
    ] = None,
    report: Annotated[
        Path | None,
        typer.Option(help="Write figures, matrix and the course of the metric (.json)."),
    ] = None,
    kind: Annotated[
        str,
        typer.Option(
            help="rigid, affine or bspline; each starts from the result of the one before."
        ),
    ] = "rigid",
    metric: Annotated[
        str,
        typer.Option(
            help="mutual-information (for different modalities), correlation, "
            "mean-squares, or automatic: correlation for two CT scans, otherwise "
            "mutual information."
        ),
    ] = "automatic",
    start: Annotated[
        str | None,
        typer.Option(
            help="Initial alignment: geometry (as the files state), centre (of the grids), "
            "moments (centres of mass) or landmarks; by default landmarks if given, "
            "otherwise centre."
        ),
    ] = None,
    landmarks: Annotated[
        Path | None, typer.Option(help="CSV file with pairs of points in mm.", metavar="FILE")
    ] = None,
    fixed_mask: Annotated[
        Path | None, typer.Option(help="Label map: use only these voxels of the fixed scan.")
    ] = None,
    moving_mask: Annotated[
        Path | None, typer.Option(help="Label map: use only these voxels of the moving scan.")
    ] = None,
    knots: Annotated[
        float | None, typer.Option(help="Spacing of the B-spline's control points in mm.")
    ] = None,
    iterations: Annotated[
        int | None, typer.Option(help="Maximum number of iterations per stage and level.")
    ] = None,
    samples: Annotated[int | None, typer.Option(help="Number of voxels sampled per level.")] = None,
    seed: Annotated[int | None, typer.Option(help="Random seed of the sampling.")] = None,
    fixed_series: Annotated[
        str | None, typer.Option(help="DICOM series of the fixed scan.")
    ] = None,
    moving_series: Annotated[
        str | None, typer.Option(help="DICOM series of the moving scan.")
    ] = None,
    fixed_frame: Annotated[
        int | None, typer.Option(help="Volume of a fixed image file that holds several.")
    ] = None,
    moving_frame: Annotated[
        int | None, typer.Option(help="Volume of a moving image file that holds several.")
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print the report as JSON.")] = False,
) -> None:
    """Register one scan to another."""
    import json

    from palpate.base.whole_file import whole_file
    from palpate.export.image import IMAGE_SUFFIXES, write_scan
    from palpate.io.reading import read
    from palpate.registration.options import check_choices
    from palpate.registration.registration import register as search
    from palpate.registration.report import report_of, sentence_of, write_checkerboard
    from palpate.volumes.resampled import check_interpolation, interpolation_for

    _check_targets(
        (output, (".tfm",)),
        (write_inverse, (".tfm",)),
        (resampled, IMAGE_SUFFIXES),
        (picture, (".png",)),
        (report, (".json",)),
    )
    check_choices(kind, metric, start or "centre")
    check_interpolation(interpolation)
    pairs = None if landmarks is None else read_landmarks(landmarks)
    options = _options(knots=knots, iterations=iterations, samples=samples, seed=seed)
    with quiet_libraries(), Display() as display:
        still = read(fixed, series=fixed_series, frame=fixed_frame, progress=display)
        other = read(moving, series=moving_series, frame=moving_frame, progress=display)
        found = search(
            still,
            other,
            kind=cast("Kind", kind),
            metric=cast("MetricChoice", metric),
            start=cast("Start | None", start),
            landmarks=pairs,
            fixed_mask=_mask(fixed_mask, still, progress=display),
            moving_mask=_mask(moving_mask, other, progress=display),
            options=options,
            progress=display,
        )
        display("writing", None)
        told = report_of(found, still, other, landmarks=pairs)
        if output is not None:
            found.save(output)
        if write_inverse is not None:
            told["inverse"] = found.save_inverse(write_inverse, other)
        if resampled is not None:
            by = interpolation_for(other, cast("InterpolationChoice", interpolation))
            write_scan(found.resampled(other, still, interpolation=by), resampled)
            told["interpolation"] = by
        if picture is not None:
            write_checkerboard(found, still, other, path=picture)
        if report is not None:
            with whole_file(report) as unfinished:
                unfinished.write_text(json.dumps(told, indent=2) + "\n", encoding="utf-8")
    for warning in dict.fromkeys((*still.warnings, *other.warnings)):
        warn(warning)
    target = output or write_inverse or resampled or picture or report
    typer.echo(json.dumps(told, indent=2) if as_json else f"{target}: {sentence_of(told)}")


def read_landmarks(path: Path) -> Pairs:
    """Reads pairs of points: six numbers a line, with commas; empty and other lines are left out.

    Raises:
        OptionError: A line that begins with a number has not six of them, or there is none.
    """
    from palpate.base.errors import OptionError

    fixed, moving = [], []
    for number, row in enumerate(csv.reader(path.read_text(encoding="utf-8").splitlines()), 1):
        if not row or not _is_number(row[0]):
            continue
        if len(row) != 6 or not all(map(_is_number, row)):
            raise OptionError(
                f"{path}, line {number}: {','.join(row)!r} given; allowed: X,Y,Z,X,Y,Z [mm], a "
                "point of the fixed scan and the same place in the moving one"
            )
        values = [float(word) for word in row]
        fixed.append(values[:3])
        moving.append(values[3:])
    if not fixed:
        raise OptionError(f"no pairs of points in {path}; allowed: lines of X,Y,Z,X,Y,Z [mm]")
    return fixed, moving


def _is_number(word: str) -> bool:
    try:
        float(word)
    except ValueError:
        return False
    return True


def _check_targets(*targets: tuple[Path | None, tuple[str, ...]]) -> None:
    from palpate.base.errors import OptionError
    from palpate.base.whole_file import check_target

    if all(path is None for path, _ in targets):
        raise OptionError(
            "nothing to write given; allowed: --output, --write-inverse, --resampled, --picture "
            "or --report"
        )
    for path, suffixes in targets:
        if path is not None:
            check_target(path, suffixes)


def _options(
    *, knots: float | None, iterations: int | None, samples: int | None, seed: int | None
) -> SearchOptions:
    from palpate.registration.options import SearchOptions

    given = {
        "knots": knots,
        "iterations": iterations,
        "bent_iterations": iterations,
        "samples": samples,
        "bent_samples": samples,
        "seed": seed,
    }
    options = SearchOptions(**{name: each for name, each in given.items() if each is not None})  # type: ignore[arg-type]
    options.check()
    return options


def _mask(path: Path | None, volume: Volume, *, progress: Progress) -> Segment | None:
    """Returns all labels of a file as one segment."""
    if path is None:
        return None
    import numpy as np

    from palpate.labels.labels import read_labels

    read = read_labels(path, volume, progress=progress)
    for warning in read.warnings:
        warn(f"{path.name}: {warning}")
    together = np.any([one.segment.mask() != 0 for one in read.labels], axis=0)
    return volume.segment(together, name=path.name)
