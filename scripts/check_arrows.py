"""Checks that crates depend on lower floors only, so that siblings never know one another.

The floors are those of ARCHITECTURE.md. Python modules are checked by import-linter and
ruff (pyproject.toml), the viewer by eslint (viewer/eslint.config.js).
"""

from __future__ import annotations

import json
import subprocess
import sys
from typing import Any

from repository_files import ROOT

FLOORS = {
    "palpate-volume": 0,
    "palpate-haptics": 1,
    "palpate-device": 1,
    "palpate-surface": 1,
    "palpate-tools": 1,
    "palpate-deform": 1,
    "palpate-engine": 2,
    "palpate-bench": 3,
    "palpate-py": 4,
}
BENCHES = "palpate-benches"
"""Measures the floors below the engine; nothing may depend on it."""


def wrong_arrows(metadata: dict[str, Any]) -> list[str]:
    """Returns a sentence for each dependency between crates that points the wrong way.

    Args:
        metadata: What ``cargo metadata --no-deps`` prints.
    """
    packages = {package["name"]: package for package in metadata["packages"]}
    found = [
        f"{name} stands on no floor; add it to FLOORS in scripts/check_arrows.py"
        for name in packages
        if name not in FLOORS and name != BENCHES
    ]
    for name, package in packages.items():
        # a benchmark stands beside the engine
        floor = FLOORS["palpate-engine"] if name == BENCHES else FLOORS.get(name)
        if floor is None:
            continue
        for dependency in package["dependencies"]:
            target = dependency["name"]
            if target in packages and FLOORS.get(target, floor) >= floor:
                kind = dependency["kind"] or "normal"
                found.append(f"{name} depends on {target} ({kind}); allowed: lower floors only")
    return found


def main() -> int:
    """Prints the arrows that point the wrong way."""
    printed = subprocess.run(
        ["cargo", "metadata", "--no-deps", "--format-version", "1", "--locked"],
        cwd=ROOT,
        check=True,
        capture_output=True,
        text=True,
    ).stdout
    found = wrong_arrows(json.loads(printed))
    for sentence in found:
        print(sentence)
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
