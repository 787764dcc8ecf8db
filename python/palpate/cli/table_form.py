"""How a command writes a table of numbers: for people, as CSV, or as JSON."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

__all__ = ["AsCsv", "AsJson", "table_form"]

AsCsv = Annotated[bool, typer.Option("--csv", help="Print CSV.")]
AsJson = Annotated[bool, typer.Option("--json", help="Print a JSON object.")]


def table_form(out: Path | None, *, as_csv: bool, as_json: bool) -> str:
    """Returns how numbers are written: "table", ".csv" or ".json".

    Raises:
        OptionError: Two ways are asked for.
    """
    from palpate.base.errors import OptionError

    forms = [".csv"] * as_csv + [".json"] * as_json
    if out is not None:
        forms.append(out.suffix.lower())
    if len(set(forms)) > 1:
        raise OptionError(
            f"{' and '.join(forms)} asked for; allowed: one of --csv, --json, and -o FILE with "
            "the same extension"
        )
    return forms[0] if forms else "table"
