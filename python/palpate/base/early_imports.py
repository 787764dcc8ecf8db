"""Modules that a command needs later, imported while a scan is still being read.

The reading goes on in another process, for which this one would only wait.
"""

from __future__ import annotations

import gc
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from importlib import import_module
from threading import Thread

__all__ = ["DICOM_WRITING", "IMAGE_WRITING", "import_early", "importing"]

IMAGE_WRITING = ("palpate.io.reading", "palpate.export.export", "SimpleITK")
"""What an image file needs. What reads is the first, so that it is asked soon."""
DICOM_WRITING = ("palpate.io.reading", "palpate.export.export", "highdicom")
"""What SEG and RTSTRUCT need."""


def import_early(modules: tuple[str, ...]) -> None:
    """Begins to import modules in turn, in a thread that only the end of the process waits for."""
    Thread(target=_import, args=(modules,)).start()


@contextmanager
def importing() -> Iterator[None]:
    """Collects no garbage within: what is imported stays, and a third of the time goes there."""
    was = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was:
            gc.enable()


def _import(modules: tuple[str, ...]) -> None:
    # whoever needs one is told what is wrong with it
    with suppress(Exception), importing():
        for name in modules:
            import_module(name)
        if "highdicom" in modules:
            # several MB of JSON, which the first object would read
            import_module("highdicom._standard_utils").get_module_attribute_map()
