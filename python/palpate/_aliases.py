"""Module paths of version 0.1 that documents showed: they lead to where the modules are now.

They go with version 1.0.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from importlib import import_module
from importlib.machinery import ModuleSpec
from types import ModuleType

__all__ = ["ALIASES", "alias_modules"]

ALIASES = {
    "palpate.drive": "palpate.scenarios.drive",
    "palpate.errors": "palpate.base.errors",
    "palpate.gap": "palpate.session.gap",
    "palpate.io_dicomweb": "palpate.io.dicomweb.series",
    "palpate.io_dicomweb_address": "palpate.io.dicomweb.address",
    "palpate.material": "palpate.volumes.material",
    "palpate.mesh_io": "palpate.volumes.mesh_read",
    "palpate.mesh_write": "palpate.volumes.mesh_write",
    "palpate.model_options": "palpate.session.model_options",
    "palpate.needle": "palpate.session.needle",
    "palpate.painted_cut": "palpate.session.painted_cut",
    "palpate.phantom_scan": "palpate.volumes.phantom",
    "palpate.projections": "palpate.reconstruction.projections",
    "palpate.recording": "palpate.session.recording",
    "palpate.registration_options": "palpate.registration.options",
    "palpate.scanner": "palpate.reconstruction.scanner",
    "palpate.scenario_run": "palpate.scenarios.run",
    "palpate.scene": "palpate.volumes.scene",
    "palpate.scripted_path": "palpate.session.scripted_path",
    "palpate.segment": "palpate.volumes.segment",
    "palpate.surface": "palpate.volumes.surface",
    "palpate.touch_settings": "palpate.session.touch_settings",
    "palpate.volume": "palpate.volumes.volume",
}
"""Old paths, and those of now."""


class _Alias:
    """Finds and loads a module under its old path: the same module, not a copy."""

    def find_spec(
        self,
        fullname: str,
        path: Sequence[str] | None = None,  # noqa: ARG002  # as the interface has it
        target: ModuleType | None = None,  # noqa: ARG002
    ) -> ModuleSpec | None:
        return ModuleSpec(fullname, self) if fullname in ALIASES else None  # type: ignore[arg-type]

    def create_module(self, spec: ModuleSpec) -> None:
        """Leaves it to the import system."""

    def exec_module(self, module: ModuleType) -> None:
        # a module may put another one in its own place
        sys.modules[module.__name__] = import_module(ALIASES[module.__name__])


def alias_modules() -> None:
    """Has the old paths be found; nothing is imported yet."""
    if not any(isinstance(finder, _Alias) for finder in sys.meta_path):
        sys.meta_path.append(_Alias())
