"""``palpate transform``: what belongs to one scan, carried to the other one through a transform."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from palpate.base.console import Display, quiet_libraries, warn
from palpate.cli.request_options import with_requests
from palpate.cli.written_files import WRITES
from palpate.registration.transform_request import TransformRequest

if TYPE_CHECKING:
    from collections.abc import Sequence

    from palpate.base.progress import Progress
    from palpate.export.carried_file import CarriedKind, CarryOptions
    from palpate.registration.carry import Carrier

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


@with_requests
def transform(
    inputs: Annotated[
        list[Path] | None,
        typer.Argument(
            help="Scan, label map, .seg.nrrd, folder of masks, DICOM SEG or RTSTRUCT, mesh (.stl, "
            ".ply, .obj, .glb), table of points in LPS mm (.csv), or saved scene; repeatable.",
            metavar="INPUT",
        ),
    ] = None,
    *,
    request: TransformRequest,
    output: Annotated[
        list[Path] | None,
        typer.Option("--output", "-o", help="File to write; once for each INPUT, in their order."),
        WRITES,
    ] = None,
    write_inverse: Annotated[
        Path | None,
        typer.Option(
            help="Write the inverse transform (.tfm). One that bends needs --like MOVING.",
            metavar="FILE",
        ),
        WRITES,
    ] = None,
) -> None:
    """Carry scans, segments, surfaces and points from one scan to another."""
    from palpate.base.whole_file import check_target
    from palpate.recipes.transform_step import carry_options, grid_of
    from palpate.registration.carry import Carrier
    from palpate.registration.registration import write_transform
    from palpate.volumes.second_scan import read_transform

    pairs = _pairs(inputs or [], output or [], more=write_inverse is not None)
    if write_inverse is not None:
        check_target(write_inverse, (".tfm",))
    with quiet_libraries(), Display() as display:
        carrier = Carrier(
            read_transform(request.transform),
            toward="moving" if request.inverse or not pairs else "fixed",
            grid=grid_of(request, progress=display),
            interpolation=request.interpolation,
        )
        options = carry_options(request, progress=display)
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
    return list(zip(inputs, outputs, strict=True))


def _check_tables(pairs: list[tuple[Path, Path]], kinds: Sequence[CarriedKind | None]) -> None:
    """Refuses an output that a table of names would replace, or that would replace one.

    Raises:
        OptionError: There is one, or a table is there that must not be replaced.
    """
    from palpate.base.errors import OptionError
    from palpate.base.replacing import check_replaceable
    from palpate.export.carried_file import carried_table

    taken = {path.resolve() for pair in pairs for path in pair}
    outputs = [out for _, out in pairs]
    for number, (out, kind) in enumerate(zip(outputs, kinds, strict=True)):
        table = None if kind is None else carried_table(kind, out, planned=outputs[:number])
        if table is not None and table.resolve() in taken:
            raise OptionError(
                f"{table} is the table of names of {out} too; allowed: another name for one of them"
            )
        if table is not None:
            check_replaceable(table)


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
    from palpate.saved.ending import ENDING, is_scene

    kinds = [None if is_scene(path) else carried_kind(path, progress=progress) for path, _ in pairs]
    for (_, out), kind in zip(pairs, kinds, strict=True):
        if kind is None:
            check_target(out, (ENDING,))
            carrier.require_grid()
        else:
            check_carried(kind, out, carrier)
    _check_tables(pairs, kinds)
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
