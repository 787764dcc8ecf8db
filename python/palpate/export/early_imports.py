"""What takes long to import for DICOM, imported while a scan is still being read.

The reading goes on in another process, for which this one would only wait.
"""

from __future__ import annotations

from contextlib import suppress
from importlib import import_module
from threading import Thread

__all__ = ["import_early"]


def import_early() -> None:
    """Begins to import what makes SEG and RTSTRUCT objects, in a thread that nobody waits for."""
    Thread(target=_import, daemon=True).start()


def _import() -> None:
    # whoever needs it is told what is wrong with it
    with suppress(Exception):
        import_module("highdicom")
        tables = import_module("highdicom._standard_utils")
        # several MB of JSON, which the first object would read
        tables.get_module_attribute_map()
