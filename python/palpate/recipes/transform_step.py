"""What ``palpate transform`` and the step of that name do with files of a scan."""

from __future__ import annotations

from palpate.base.progress import Progress
from palpate.export.carried_file import CarryOptions, carried_kind, carry_file
from palpate.io.reading import read
from palpate.recipes.steps import TransformStep
from palpate.registration.carry import Carrier
from palpate.registration.transform_request import TransformRequest
from palpate.volumes.second_scan import read_transform
from palpate.volumes.volume import Volume

__all__ = ["carried", "carry_options", "grid_of"]


def grid_of(request: TransformRequest, *, progress: Progress) -> Volume | None:
    """Returns the scan with the grid for images; None where none is given.

    Raises:
        PalpateError: It cannot be read, or there are several.
    """
    if request.like is None:
        return None
    return read(request.like, series=_text(request.like_series), progress=progress)


def carry_options(request: TransformRequest, *, progress: Progress) -> CarryOptions:
    """Returns how files are read that do not say everything.

    Raises:
        PalpateError: The scan of the segments cannot be read.
    """
    return CarryOptions(
        series=_text(request.series),
        of=None if request.of is None else read(request.of, progress=progress),
        resample=request.resample,
        another_patient=request.another_patient,
        frame=request.frame,
        unit=request.unit,
    )


def carried(step: TransformStep, scan: Volume, *, progress: Progress) -> list[str]:
    """Writes the carried file beside a recipe's scan; returns what a person should know.

    Raises:
        PalpateError: It cannot be carried.
        OSError: The disk refuses it.
    """
    carrier = Carrier(
        read_transform(step.transform),
        toward="moving" if step.inverse else "fixed",
        grid=grid_of(step, progress=progress) or scan,
        interpolation=step.interpolation,
    )
    options = carry_options(step, progress=progress)
    kind = carried_kind(step.path, progress=progress)
    what, told = carry_file(
        step.path, step.output, carrier, kind=kind, options=options, progress=progress
    )
    return [f"{step.output.name}: {what}, {carrier.sentence}", *told]


def _text(series: str | int | None) -> str | None:
    return None if series is None else str(series)
