"""Checks that every source file begins by saying what it is for.

A header is a doc comment of at least one sentence on the first line (after `#!`, an
eslint line or `#version`).
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

from repository_files import ROOT, repository_files

OPENINGS = {
    ".rs": re.compile(r"//! \S"),
    ".py": re.compile(r'"""\S'),
    ".pyi": re.compile(r'"""\S'),
    ".ts": re.compile(r"/\*\*|// \S"),
    ".js": re.compile(r"/\*\*|// \S"),
    ".mjs": re.compile(r"/\*\*|// \S"),
    ".svelte": re.compile(r"<!--"),
    ".glsl": re.compile(r"//|/\*"),
    ".vert": re.compile(r"//|/\*"),
    ".frag": re.compile(r"//|/\*"),
    ".css": re.compile(r"/\*"),
    ".sh": re.compile(r"# \S"),
}
SKIPPED = re.compile(r"#!|#version|\s*$")


def lacks_header(file: Path) -> bool:
    """Tells whether a source file begins with something else than its purpose."""
    opening = OPENINGS.get(file.suffix)
    # a unit test of the page is about the source file that it is named after
    if opening is None or file.name.endswith(".test.ts"):
        return False
    lines = file.read_text(encoding="utf-8").splitlines()
    first = next((line for line in lines if not SKIPPED.match(line)), None)
    return first is not None and not opening.match(first)


def main() -> int:
    """Prints the files without a header."""
    bare = [file for file in repository_files() if lacks_header(file)]
    for file in bare:
        print(f"{file.relative_to(ROOT)}: begins without saying what the file is for")
    return 1 if bare else 0


if __name__ == "__main__":
    sys.exit(main())
