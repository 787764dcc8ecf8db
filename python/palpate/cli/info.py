"""The command ``palpate info``."""

from __future__ import annotations

from typing import Annotated

import typer

from palpate.base.console import Display, quiet_libraries
from palpate.cli.options import Scan
from palpate.cli.reading_options import Reading, with_reading

__all__ = ["info"]


@with_reading
def info(
    path: Scan,
    *,
    reading: Reading,
    as_json: Annotated[bool, typer.Option("--json", help="Print a JSON object.")] = False,
) -> None:
    """Print the properties of a scan."""
    from palpate.cli.scan_info import describe, print_table

    with quiet_libraries(), Display() as display:
        volume = reading.read(path, display)
    if as_json:
        import json

        typer.echo(json.dumps(describe(volume), indent=2))
    else:
        print_table(volume)
