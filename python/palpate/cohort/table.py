"""Cases by a table: one a row, its columns are variables of the recipe."""

from __future__ import annotations

import csv
import re
from collections.abc import Iterator
from pathlib import Path

from palpate.base.errors import OptionError
from palpate.base.plain_file import check_plain
from palpate.cohort.case import Case
from palpate.cohort.matches import case_name

__all__ = ["cases_of_table"]


def cases_of_table(path: Path) -> list[Case]:
    """Returns a case for each row, by its column ``case``.

    Args:
        path: CSV with commas, semicolons or tabs; the first line names the columns.

    Raises:
        FileNotFoundError: The table does not exist.
        OptionError: Something in it is wrong; the message says in which line.
    """
    check_plain(path)
    try:
        text = path.read_text("utf-8-sig")
    except UnicodeDecodeError:
        raise OptionError(f"{path} is no text in UTF-8; allowed: a table as CSV") from None
    heading = text.partition("\n")[0]
    separator = max(",;\t", key=heading.count)
    try:
        cases = list(_rows(path, text, separator=separator))
    except csv.Error as error:
        raise OptionError(f"{path} is no table ({error}); allowed: CSV") from None
    if not cases:
        raise OptionError(f"{path} has no rows; allowed: one for each case")
    return cases


def _rows(path: Path, text: str, *, separator: str) -> Iterator[Case]:
    reader = csv.reader(text.splitlines(keepends=True), delimiter=separator)
    columns = [name.strip() for name in next(reader, [])]
    _check_columns(path, columns)
    seen: dict[str, int] = {}
    for row in reader:
        if not any(cell.strip() for cell in row):
            continue
        where = f"{path}, line {reader.line_num}"
        if len(row) != len(columns):
            raise OptionError(f"{where}: {len(row)} values given; allowed: {len(columns)}")
        variables = {name: cell.strip() for name, cell in zip(columns, row, strict=True)}
        for name, value in variables.items():
            if not value:
                raise OptionError(f"{where}: {name} is empty; allowed: a value in each column")
        name = variables["case"]
        if case_name(name) != name:
            raise OptionError(
                f"{where}: case {name!r} given; allowed: letters, digits, _ . and - within"
            )
        if name.casefold() in seen:
            raise OptionError(
                f"{where}: case {name!r} stands in line {seen[name.casefold()]} too; allowed: a "
                "name for each"
            )
        seen[name.casefold()] = reader.line_num
        yield Case(name, variables)


def _check_columns(path: Path, columns: list[str]) -> None:
    for name in columns:
        if not re.fullmatch(r"[A-Za-z_]\w*", name, flags=re.ASCII):
            raise OptionError(f"{path}, line 1: column {name!r} given; allowed: a word for each")
        if columns.count(name) > 1:
            raise OptionError(f"{path}, line 1: two columns are called {name!r}; allowed: one")
    if "case" not in columns:
        raise OptionError(f"{path}, line 1: no column 'case'; allowed: one, with a name for each")
