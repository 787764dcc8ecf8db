"""``palpate register``: one scan brought to another, without a page."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from palpate.base.console import Display, quiet_libraries, warn
from palpate.cli.request_options import with_requests
from palpate.registration.request import RegisterRequest

__all__ = ["EXAMPLES", "register"]

EXAMPLES = """\b
Examples:
  palpate register ct/ mr/ -o mr-to-ct.tfm --resampled mr-on-ct.nii.gz
  palpate register before.mha after.mha -o T.tfm --kind bspline --picture T.png
  palpate register ct.nii.gz mr.nii.gz -o T.tfm --landmarks pairs.csv
  palpate register a.mha b.mha -o T.tfm --kind affine --fixed-mask body.nii.gz

The transform maps points of FIXED to MOVING (LPS, mm), as ITK and 3D Slicer expect. Each line of
the landmarks has six numbers: X,Y,Z in FIXED and X,Y,Z in MOVING.
"""


@with_requests
def register(
    fixed: Annotated[Path, typer.Argument(help="Fixed scan, as for `palpate open`.")],
    *,
    request: RegisterRequest,
    fixed_series: Annotated[
        str | None, typer.Option(help="DICOM series of the fixed scan.")
    ] = None,
    fixed_frame: Annotated[
        int | None, typer.Option(help="Volume of a fixed image file that holds several.")
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print the report as JSON.")] = False,
) -> None:
    """Register one scan to another."""
    import json

    from palpate.base.errors import OptionError
    from palpate.base.request_files import files_of
    from palpate.io.reading import read
    from palpate.recipes.register_step import read_moving, registered
    from palpate.registration.report import sentence_of

    if not any(option.writes for option, _ in files_of(request)):
        raise OptionError(
            "nothing to write given; allowed: --output, --write-inverse, --resampled, --picture "
            "or --report"
        )
    with quiet_libraries(), Display() as display:
        still = read(fixed, series=fixed_series, frame=fixed_frame, progress=display)
        other = read_moving(request, progress=display)
        made = registered(still, other, request, progress=display)
    for path, volume in ((fixed, still), (request.moving, other)):
        for warning in volume.warnings:
            warn(f"{path.name}: {warning}")
    for warning in dict.fromkeys(made.warnings):
        warn(warning)
    told = json.dumps(made.report, indent=2)
    typer.echo(told if as_json else f"{made.written[0]}: {sentence_of(made.report)}")
