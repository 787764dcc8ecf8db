"""Writes the reference of the command line and of the Python package to docs/reference.

python scripts/make_reference.py           # writes both pages
python scripts/make_reference.py --check   # says which page is not up to date; exit code 1
"""

from __future__ import annotations

import sys
from pathlib import Path

from reference_cli import cli_page
from reference_python import python_page

FOLDER = Path(__file__).parent.parent / "docs" / "reference"


def pages() -> dict[str, str]:
    """Returns the text of each page by the name of its file."""
    import palpate
    from palpate.cli.commands import app

    return {"cli.md": cli_page(app), "python.md": python_page(palpate)}


def stale(folder: Path = FOLDER) -> list[str]:
    """Returns the names of pages that differ from what the code says."""
    return [name for name, text in pages().items() if _read(folder / name) != text]


def _read(file: Path) -> str:
    return file.read_text(encoding="utf-8") if file.exists() else ""


def main() -> int:
    """Writes the pages, or checks them."""
    if "--check" in sys.argv[1:]:
        for name in stale():
            print(f"docs/reference/{name} is not up to date: run scripts/make_reference.py")
        return 1 if stale() else 0
    FOLDER.mkdir(exist_ok=True)
    for name, text in pages().items():
        (FOLDER / name).write_text(text, encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
