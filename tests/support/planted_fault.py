"""The package with an engine that breaks a guarantee on purpose, in a folder of its own.

The engine is built with the feature ``planted-fault``, by which walls give way under a hard press
(``crates/engine/src/touch/planted_fault.rs``). The usual build, and what is installed, stay as they
are.
"""

from __future__ import annotations

import json
import shutil
import subprocess
from pathlib import Path

from browser import ROOT

BUILD = (
    *("cargo", "build", "--locked", "--package", "palpate-py"),
    *("--features", "planted-fault", "--message-format", "json"),
)
"""As tests are built, so that only what the feature changes is built anew."""


def faulty_tool(folder: Path) -> tuple[str | Path, ...]:
    """Builds the package into an empty folder; returns the command that runs its command line."""
    shutil.copytree(
        ROOT / "python" / "palpate",
        folder / "palpate",
        ignore=shutil.ignore_patterns("_core*.so", "__pycache__"),
    )
    shutil.copy2(build(), folder / "palpate" / "_core.abi3.so")
    return ("env", f"PYTHONPATH={folder}", ROOT / ".venv" / "bin" / "python", "-m", "palpate")


def build() -> Path:
    """Builds the extension module and returns where it lies."""
    built = subprocess.run(BUILD, cwd=ROOT, check=True, stdout=subprocess.PIPE, text=True)
    messages = [json.loads(line) for line in built.stdout.splitlines()]
    [module] = [
        Path(file)
        for message in messages
        if message["reason"] == "compiler-artifact" and message["target"]["name"] == "_core"
        for file in message["filenames"]
        if Path(file).suffix == ".so"
    ]
    return module
