"""Checks that no file names a place that exists on one machine only.

Such places are folders of one person's machine, and addresses that packages were fetched
from: lock files without them work behind any mirror.
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

from repository_files import ROOT, repository_files

FORBIDDEN = {
    "a folder of one machine": re.compile(r"(?<![\w.])/(?:root|home|Users|mnt|opt)/\w"),
    "an address of a package": re.compile(
        r"\"resolved\": *\"http|--(?:extra-)?index-url|https?://\S+\.(?:tgz|whl|crate)\b"
    ),
    "work left over": re.compile(r"\b(?:TODO|FIXME|XXX)\b"),
}


def forbidden_words(text: str) -> list[tuple[int, str, str]]:
    """Returns line number, reason and line of each place that must not be named."""
    return [
        (number, reason, line.strip())
        for number, line in enumerate(text.splitlines(), start=1)
        for reason, pattern in FORBIDDEN.items()
        if pattern.search(line)
    ]


def read_text(file: Path) -> str:
    """Returns the text of a file, nothing where it is binary."""
    try:
        return file.read_text(encoding="utf-8")
    except UnicodeDecodeError:
        return ""


def main() -> int:
    """Prints the places found."""
    # this file and its test must spell them out
    files = [file for file in repository_files() if "check_words" not in file.name]
    found = [(file, *place) for file in files for place in forbidden_words(read_text(file))]
    for file, number, reason, line in found:
        print(f"{file.relative_to(ROOT)}:{number}: {reason}: {line}")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
