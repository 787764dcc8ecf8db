"""nibabel, imported late and without the warnings that it prints by itself."""

from __future__ import annotations

from importlib import import_module
from types import ModuleType

__all__ = ["nibabel"]


def nibabel() -> ModuleType:
    """Returns the module nibabel; what it would print is checked by whoever reads with it."""
    module = import_module("nibabel")
    module.imageglobals.logger.disabled = True
    return module
