"""nibabel, imported late and without the warnings that it prints by itself."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from importlib import import_module
from types import ModuleType

from palpate.base.reader_process import limits

__all__ = ["nibabel"]


def nibabel() -> ModuleType:
    """Returns the module nibabel; what it would print is checked by whoever reads with it."""
    module = sys.modules.get("nibabel")
    if module is None:
        with _without_pydicom():
            module = import_module("nibabel")
    module.imageglobals.logger.disabled = True
    return module


@contextmanager
def _without_pydicom() -> Iterator[None]:
    """Leaves pydicom out of nibabel in a worker: it takes most of the time of the import.

    nibabel takes it for extensions of NIfTI headers only, which are not read. In a process that is
    a person's own, nibabel stays as it is.
    """
    if not limits.inside() or "pydicom" in sys.modules:
        yield
        return
    # what the import system takes as not installed
    sys.modules["pydicom"] = None  # type: ignore[assignment]
    try:
        yield
    finally:
        del sys.modules["pydicom"]
