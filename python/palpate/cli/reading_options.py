"""How a scan is read: the same options for every command that reads one."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields
from functools import wraps
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar, get_type_hints

from palpate.base.typed_numbers import parse_voxel_size
from palpate.cli.options import (
    Fill,
    Frame,
    MaxVoxels,
    Orientation,
    Raw,
    Series,
    Strict,
    Unit,
    VoxelSize,
)

if TYPE_CHECKING:
    from palpate.base.progress import Progress
    from palpate.volumes.volume import Volume

__all__ = ["Reading", "with_reading"]

Result = TypeVar("Result")


@dataclass(frozen=True, kw_only=True)
class Reading:
    """Options of ``palpate.io.read``, as they stand on the command line.

    Raises:
        OptionError: The voxel size is no three numbers.
    """

    series: Series = None
    frame: Frame = None
    orientation: Orientation = None
    unit: Unit = None
    fill: Fill = None
    strict: Strict = False
    raw: Raw = None
    voxel_size: VoxelSize = None
    max_voxels: MaxVoxels = 1024**3

    def __post_init__(self) -> None:
        # what cannot be understood is refused before anything is read
        parse_voxel_size(self.voxel_size)

    def read(self, path: Path | Sequence[Path], progress: Progress) -> Volume:
        """Reads the scan at this place, or at these.

        Raises:
            PalpateError: It cannot be read, or there are several.
        """
        from palpate.io.reading import read

        return read(
            path,
            series=self.series,
            frame=self.frame,
            orientation=self.orientation,
            unit=self.unit,
            fill=self.fill,
            strict=self.strict,
            raw=self.raw,
            voxel_size=parse_voxel_size(self.voxel_size),
            max_voxels=self.max_voxels,
            progress=progress,
        )


def with_reading(command: Callable[..., Result]) -> Callable[..., Result]:
    """Gives a command the options of ``Reading`` in the place of its parameter ``reading``.

    An option of the same name that the command has itself stays what it is there.
    """
    written = inspect.signature(command, eval_str=True)
    annotations = get_type_hints(Reading, include_extras=True)
    options = [
        inspect.Parameter(
            field.name,
            inspect.Parameter.KEYWORD_ONLY,
            default=field.default,
            annotation=annotations[field.name],
        )
        for field in fields(Reading)
        if field.name not in written.parameters
    ]

    @wraps(command)
    def run(**given: Any) -> Result:  # noqa: ANN401  # each option has a type of its own
        reading = Reading(**{option.name: given.pop(option.name) for option in options})
        return command(reading=reading, **given)

    # what the command line is made of
    run.__signature__ = written.replace(  # type: ignore[attr-defined]
        parameters=[
            each
            for parameter in written.parameters.values()
            for each in (options if parameter.name == "reading" else [parameter])
        ]
    )
    return run
