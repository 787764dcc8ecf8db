"""``palpate report``: page and table of all cases of a cohort."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

__all__ = ["report", "write_report_of"]


def report(
    folder: Annotated[
        Path, typer.Argument(help="Output folder of `palpate run --over`.", metavar="FOLDER")
    ],
) -> None:
    """Write page and table of all cases of a cohort."""
    write_report_of(folder)


def write_report_of(folder: Path) -> None:
    """Writes both, and says so.

    Raises:
        OptionError: It is no folder of a cohort.
        OSError: The disk refuses it.
    """
    from palpate.base.errors import OptionError
    from palpate.cohort.output_folder import CohortFolder
    from palpate.cohort.overview import write_overview

    cohort = CohortFolder(folder)
    if not cohort.mark.is_file():
        raise OptionError(f"{folder} given; allowed: an output folder of `palpate run --over`")
    page, count = write_overview(cohort)
    typer.echo(f"{page}: {count} cases")
