"""Files that a request reads and writes, checked before anything is done."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from palpate.base.files_read import note_read
from palpate.base.replacing import check_replaceable
from palpate.base.request import Option, Request, options_of
from palpate.base.whole_file import check_target

__all__ = ["check_file", "files_of"]


def files_of(request: Request) -> Iterator[tuple[Option, Path]]:
    """Yields what a request reads or writes, in the order of its options."""
    for option in options_of(type(request)):
        path = getattr(request, option.field)
        if (option.reads or option.writes) and path is not None:
            yield option, path


def check_file(option: Option, path: Path) -> None:
    """Refuses a file that could not be read, or not be written.

    Raises:
        FileNotFoundError: What is to be read is not there.
        OptionError: What is to be written has another ending, its folder does not exist, or a file
            is there that must not be replaced.
    """
    if option.reads:
        if not path.exists():
            raise FileNotFoundError(f"{path} does not exist; allowed: an existing file or folder")
        note_read(path)
    if option.writes:
        check_target(path, option.writes)
        check_replaceable(path)
