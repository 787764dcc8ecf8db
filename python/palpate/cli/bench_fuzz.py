"""``palpate bench fuzz-import``: whether readers withstand damaged files."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from palpate.base.console import Display

__all__ = ["bench_fuzz_import"]


def bench_fuzz_import(
    folder: Annotated[
        Path | None,
        typer.Argument(help="Files to damage; by default the data sets.", metavar="FOLDER"),
    ] = None,
    *,
    minutes: Annotated[
        float | None, typer.Option(help="Duration in minutes; by default one.")
    ] = None,
    cases: Annotated[
        int | None, typer.Option(min=1, help="Number of cases, instead of a duration.")
    ] = None,
    seed: Annotated[
        int, typer.Option(min=0, help="Random seed of the first case; each further case adds one.")
    ] = 1,
) -> int:
    """Fuzz the readers with damaged real files, each in its own process."""
    from palpate.base.errors import OptionError
    from palpate.bench.fuzz_import import measure
    from palpate.bench.haptics_data import folder as data_folder

    if minutes is not None and cases is not None:
        raise OptionError("minutes and cases given; allowed: one of both")
    place = folder or data_folder()
    if not place.is_dir():
        raise OptionError(f"{place} is no folder; allowed: a folder with scans, or PALPATE_DATA")
    seconds = None if cases is not None else 60.0 * (minutes or 1.0)
    with Display() as display:
        found = measure(place, seed=seed, cases=cases, seconds=seconds, progress=display)
    for case, sample, outcome in found.violations:
        typer.echo(f"seed {case}, {sample}: {outcome}")
        typer.echo(f"again: palpate bench fuzz-import {folder or ''} --cases 1 --seed {case}\n")
    told = ", ".join(f"{number} {kind}" for kind, number in sorted(found.outcomes.items()))
    typer.echo(f"{found.cases} damaged files from seed {seed} on: {told}")
    return 1 if found.violations else 0
