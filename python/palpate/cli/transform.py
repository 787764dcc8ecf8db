"""``palpate transform``: what belongs to one scan, carried to the other one through a transform."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, cast

import typer

from palpate.base.console import Display, quiet_libraries, warn
from palpate.cli.options import Interpolated

if TYPE_CHECKING:
    from palpate.base.interpolation import InterpolationChoice
    from palpate.base.progress import Progress
    from palpate.export.carried_file import CarryOptions
    from palpate.registration.carry import Carrier
    from palpate.volumes.mesh_read import Frame, Unit

__all__ = ["EXAMPLES", "transform"]

EXAMPLES = """\b
Examples:
  palpate transform mr.nii.gz --transform T.tfm --like ct/ -o mr-on-ct.nrrd
  palpate transform mr.seg.nrrd --transform T.tfm --like ct/ -o on-ct.seg.nrrd
  palpate transform a.obj marks.csv --transform T.tfm -o b.stl -o moved.csv
  palpate transform ct/ --transform T.tfm --inverse --like mr/ -o ct-on-mr.mha
  palpate transform seg.dcm --of ct/ --transform T.tfm --inverse --like mr/ -o s.nrrd
  palpate transform mr.palpate --transform T.tfm --like ct/ -o on-ct.palpate

The transform is one that `palpate register FIXED MOVING` writes. What belongs to MOVING is carried
to FIXED, and --like is FIXED; with --inverse, what belongs to FIXED is carried to MOVING, and
--like is MOVING. So it is for images, surfaces and points alike.
"""


def transform(  # noqa: PLR0913  # one per option of the command line
    inputs: Annotated[
        list[Path] | None,
        typer.Argument(
            help="Scan, label map, .seg.nrrd, folder of masks, DICOM SEG or RTSTRUCT, mesh (.stl, "
            ".ply, .obj, .glb), table of points in LPS mm (.csv), or saved scene; repeatable.",
            metavar="INPUT",
        ),
    ] = None,
    *,
    file: Annotated[
        Path,
        typer.Option(
            "--transform",
            help="Transform (.tfm or .h5) from points of FIXED to MOVING.",
            metavar="FILE",
        ),
    ],
    output: Annotated[
        list[Path] | None,
        typer.Option("--output", "-o", help="File to write; once for each INPUT, in their order."),
    ] = None,
    inverse: Annotated[
        bool,
        typer.Option(
            "--inverse/--forward",
            help="Carry from FIXED to MOVING; forward, the default, is from MOVING to FIXED.",
        ),
    ] = False,
    like: Annotated[
        Path | None,
        typer.Option(
            help="Scan with the grid for images: FIXED, or MOVING with --inverse. Surfaces and "
            "points need none.",
            metavar="SCAN",
        ),
    ] = None,
    of: Annotated[
        Path | None,
        typer.Option(
            help="Scan that the segments of a DICOM SEG or RTSTRUCT belong to.", metavar="SCAN"
        ),
    ] = None,
    interpolation: Interpolated = "automatic",
    write_inverse: Annotated[
        Path | None,
        typer.Option(
            help="Write the inverse transform (.tfm). One that bends needs --like MOVING.",
            metavar="FILE",
        ),
    ] = None,
    series: Annotated[str | None, typer.Option(help="DICOM series of the input scan.")] = None,
    like_series: Annotated[
        str | None, typer.Option(help="DICOM series of the scan of --like.")
    ] = None,
    frame: Annotated[str | None, typer.Option(help="Frame of a mesh: LPS or RAS.")] = None,
    unit: Annotated[str | None, typer.Option(help="Unit of a mesh: mm or m.")] = None,
) -> None:
    """Carry scans, segments, surfaces and points from one scan to another."""
    from palpate.base.whole_file import check_target
    from palpate.export.carried_file import CarryOptions
    from palpate.io.reading import read
    from palpate.registration.carry import Carrier
    from palpate.registration.registration import write_transform
    from palpate.volumes.second_scan import read_transform

    pairs = _pairs(inputs or [], output or [], more=write_inverse is not None)
    if write_inverse is not None:
        check_target(write_inverse, (".tfm",))
    with quiet_libraries(), Display() as display:
        carrier = Carrier(
            read_transform(file),
            toward="moving" if inverse or not pairs else "fixed",
            grid=None if like is None else read(like, series=like_series, progress=display),
            interpolation=cast("InterpolationChoice", interpolation),
        )
        options = CarryOptions(
            series=series,
            of=None if of is None else read(of, progress=display),
            frame=cast("Frame | None", frame),
            unit=cast("Unit | None", unit),
        )
        said = _carried(pairs, carrier, options, progress=display)
        if write_inverse is not None:
            write_transform(carrier.inverse.transform, write_inverse)
            said.append((f"{write_inverse}: {carrier.inverse.sentence}", []))
    for line, told in said:
        for warning in dict.fromkeys(told):
            warn(warning)
        typer.echo(line)


def _pairs(inputs: list[Path], outputs: list[Path], *, more: bool) -> list[tuple[Path, Path]]:
    """Returns each input with its output; there may be none where ``more`` is written."""
    from palpate.base.errors import OptionError

    if not (inputs or more):
        raise OptionError("nothing to carry given; allowed: one INPUT or more, or --write-inverse")
    if len(inputs) != len(outputs):
        raise OptionError(
            f"{len(inputs)} inputs and {len(outputs)} outputs given; allowed: --output once for "
            "each INPUT, in their order"
        )
    taken = [path.resolve() for path in (*inputs, *outputs)]
    for path in outputs:
        if taken.count(path.resolve()) > 1:
            raise OptionError(f"{path} is given twice; allowed: a new file for each INPUT")
    return list(zip(inputs, outputs, strict=True))


def _carried(
    pairs: list[tuple[Path, Path]],
    carrier: Carrier,
    options: CarryOptions,
    *,
    progress: Progress,
) -> list[tuple[str, list[str]]]:
    """Writes all outputs; returns what is said of each, and its warnings."""
    from palpate.base.whole_file import check_target
    from palpate.export.carried_file import carried_kind, carry_file, check_carried
    from palpate.saved.carried_scene import carry_scene
    from palpate.saved.opening import is_scene
    from palpate.saved.scene_file import ENDING

    kinds = [None if is_scene(path) else carried_kind(path, progress=progress) for path, _ in pairs]
    for (_, out), kind in zip(pairs, kinds, strict=True):
        if kind is None:
            check_target(out, (ENDING,))
            carrier.require_grid()
        else:
            check_carried(kind, out, carrier)
    said = []
    for (path, out), kind in zip(pairs, kinds, strict=True):
        what, told = (
            carry_scene(path, out, carrier, progress=progress)
            if kind is None
            else carry_file(path, out, carrier, kind=kind, options=options, progress=progress)
        )
        said.append((f"{out}: {what}, {carrier.sentence}", told))
    if carrier.grid is not None and carrier.toward == "moving" and not carrier.inverse.exact:
        said.append((carrier.inverse.sentence, []))
    return said
