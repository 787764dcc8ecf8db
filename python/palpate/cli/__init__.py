"""The command line: one module for each command, and what it does."""

from __future__ import annotations

import gc
import sys

from palpate.base.early_imports import importing
from palpate.base.harmless_text import print_harmlessly
from palpate.base.reader_process import warm

__all__ = ["main"]

READING = {
    "open", "import", "export", "info", "record", "register", "run", "segment", "series",
    "statistics", "transform",
}  # fmt: skip
"""Commands that read files in most cases."""


def main() -> None:
    """Runs the command line and ends the process."""
    print_harmlessly()
    if READING.intersection(sys.argv[1:2]) and not {"-h", "--help"}.intersection(sys.argv):
        # it starts while the modules of the commands do
        warm()
    with importing():
        from palpate.cli.commands import run

    code = run(sys.argv[1:])
    # Python ends itself by SIGINT where Ctrl-C once came while a string was executed, as for each
    # dataclass, although it was handled; a string that ends well has it forgotten
    exec("")  # noqa: S102
    # all goes with the process: it is not searched for garbage before, which takes long
    gc.freeze()
    sys.exit(code)
