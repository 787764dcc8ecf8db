"""A step of recipes that carries a file through a transform, as ``palpate transform`` does."""

from __future__ import annotations

from collections.abc import Collection
from pathlib import Path

from palpate.base.errors import OptionError
from palpate.base.interpolation import InterpolationChoice
from palpate.base.progress import Progress
from palpate.export.carried_file import CarryOptions, carried_kind, carry_file, check_ending
from palpate.io.reading import read
from palpate.recipes.steps import Step
from palpate.registration.carry import Carrier
from palpate.volumes.mesh_read import Frame, Unit
from palpate.volumes.second_scan import read_transform
from palpate.volumes.volume import Volume

__all__ = ["TransformStep"]


class TransformStep(Step, frozen=True, kw_only=True):
    """A file that is carried from one scan to the other, once all other files are written."""

    path: Path
    transform: Path
    """From points of the fixed scan to those of the moving one."""
    output: Path
    inverse: bool = False
    """Whether it is carried from the fixed scan to the moving one."""
    like: Path | None = None
    """The grid for images; the recipe's scan where none is given."""
    of: Path | None = None
    interpolation: InterpolationChoice = "automatic"
    series: str | int | None = None
    like_series: str | int | None = None
    frame: Frame | None = None
    unit: Unit | None = None

    def check(self, made: Collection[Path]) -> None:
        """Refuses what could not be done; ``made`` are files that other steps write.

        Raises:
            OptionError: A file is missing, or the output's name does not fit.
        """
        for path in (self.path, self.transform, self.like, self.of):
            if path is not None and not path.exists() and path not in made:
                raise OptionError(f"{path} does not exist")
        if self.inverse and self.like is None:
            raise OptionError(
                "inverse without like given; allowed: inverse with like, the moving scan"
            )
        if self.path.exists():
            check_ending(carried_kind(self.path), self.output)

    def run(self, scan: Volume, *, progress: Progress) -> list[str]:
        """Writes the carried file beside a recipe's ``scan``; returns what a person should know.

        Raises:
            PalpateError: It cannot be carried.
            OSError: The disk refuses it.
        """
        grid = scan
        if self.like is not None:
            grid = read(self.like, series=_text(self.like_series), progress=progress)
        carrier = Carrier(
            read_transform(self.transform),
            toward="moving" if self.inverse else "fixed",
            grid=grid,
            interpolation=self.interpolation,
        )
        options = CarryOptions(
            series=_text(self.series),
            of=None if self.of is None else read(self.of, progress=progress),
            frame=self.frame,
            unit=self.unit,
        )
        kind = carried_kind(self.path, progress=progress)
        what, told = carry_file(
            self.path, self.output, carrier, kind=kind, options=options, progress=progress
        )
        return [f"{self.output.name}: {what}, {carrier.sentence}", *told]


def _text(series: str | int | None) -> str | None:
    return None if series is None else str(series)
