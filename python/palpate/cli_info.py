"""The command ``palpate info``."""

from __future__ import annotations

from typing import Annotated

import typer

from palpate.cli_options import Scan
from palpate.cli_reading import Reading, with_reading
from palpate.console import Display, quiet_libraries

__all__ = ["info"]


@with_reading
def info(
    path: Scan,
    *,
    reading: Reading,
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object.")] = False,
) -> None:
    """Tell what a scan is."""
    from palpate.info import describe, print_table

    with quiet_libraries(), Display() as display:
        volume = reading.read(path, display)
    if as_json:
        import json

        typer.echo(json.dumps(describe(volume), indent=2))
    else:
        print_table(volume)
