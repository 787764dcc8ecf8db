"""Checks that crates, and folders within a crate, depend on lower floors only.

So siblings never know one another. The floors of crates are those of ARCHITECTURE.md. Python
modules are checked by import-linter and ruff (pyproject.toml), the viewer by eslint
(viewer/eslint.config.js).
"""

from __future__ import annotations

import json
import re
import subprocess
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from repository_files import ROOT

FLOORS = {
    "palpate-volume": 0,
    "palpate-haptics": 1,
    "palpate-device": 1,
    "palpate-surface": 1,
    "palpate-render": 1,
    "palpate-tools": 1,
    "palpate-deform": 1,
    "palpate-engine": 2,
    "palpate-bench": 3,
    "palpate-py": 4,
}
BENCHES = "palpate-benches"
"""Measures the floors below the engine; nothing may depend on it."""

FOLDERS: dict[str, Sequence[Sequence[str]]] = {
    "haptics": (
        ("noise", "scene"),
        ("contact", "force"),
        ("admission", "thesis"),
        ("ball",),
        ("smooth",),
        ("tick",),
        ("soft_contact",),
        ("needle",),
    ),
    "deform": (
        ("at_rest", "material", "potential"),
        ("model", "voxel_ledger"),
        ("displacement", "observed_voxels", "work_time"),
        ("lattice", "particles"),
        ("pressed_block", "registry"),
    ),
    "tools": (
        ("journal", "measure", "specific_energy", "stroke", "sweep"),
        ("surface_layer", "tool", "undo"),
        ("adder", "drill", "eraser", "needle", "painter"),
        ("factory",),
    ),
    "engine": (
        ("notice",),
        ("threads", "touch"),
        ("scene", "servo"),
        ("deformable", "replay"),
        ("error", "picture"),
        ("simulation",),
        ("session",),
        ("scenario",),
    ),
    "bench": (
        ("random", "timing"),
        ("haptics", "quality", "stress"),
        ("deformation", "passivity"),
    ),
}
"""Folders of ``crates/NAME/src`` from the ground up; a file beside ``lib.rs`` counts as one."""


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


def wrong_folder_arrows(source: Path, floors: Sequence[Sequence[str]]) -> list[str]:
    """Returns a sentence for each path between folders of a crate that points the wrong way.

    Args:
        source: The crate's ``src``.
        floors: Its folders, from the ground up.
    """
    floor_of = {name: floor for floor, names in enumerate(floors) for name in names}
    files = [(path, path.relative_to(source)) for path in sorted(source.rglob("*.rs"))]
    files = [(path, relative) for path, relative in files if relative.as_posix() != "lib.rs"]
    there = {_folder_of(relative) for _, relative in files}
    found = [
        f"{source}: folder {name} stands on no floor; add it to FOLDERS in scripts/check_arrows.py"
        for name in sorted(there - floor_of.keys())
    ]
    found += [
        f"{source}: there is no folder {name}; take it out of FOLDERS in scripts/check_arrows.py"
        for name in sorted(floor_of.keys() - there)
    ]
    for path, relative in files:
        own = _folder_of(relative)
        for target in sorted(set(_targets(path.read_text(encoding="utf-8"), relative)) - {own}):
            if target not in floor_of:
                found.append(f"{path} names crate::{target}, which is no folder of FOLDERS")
            elif floor_of[target] >= floor_of.get(own, len(floors)):
                found.append(f"{path} ({own}) uses crate::{target}; allowed: lower floors only")
    return found


def _folder_of(relative: Path) -> str:
    return relative.parts[0].removesuffix(".rs")


def _targets(text: str, relative: Path) -> Iterator[str]:
    """Gives the first name of each path from the crate's root, in code only."""
    code = re.sub(r"//[^\n]*", "", text)
    yield from _first_names(code, r"(?<![\w$])crate")
    # modules above a file, up to the root; one in the file itself has one more
    depth = len(relative.parts) - (relative.name == "mod.rs")
    inline = re.search(r"^(?:pub )?mod \w+ \{", code, re.MULTILINE)
    outer, inner = (code, "") if inline is None else (code[: inline.start()], code[inline.end() :])
    yield from _first_names(outer, _climb(depth))
    yield from _first_names(inner, _climb(depth + 1))


def _climb(steps: int) -> str:
    return r"(?<![\w:])" + "::".join(["super"] * steps)


def _first_names(code: str, root: str) -> Iterator[str]:
    """Gives the name after each ``root::``, or those of the group that follows it."""
    for match in re.finditer(root + r"::\s*(?:(?!super\b)(\w+)|(\{))", code):
        if match[1]:
            yield match[1]
            continue
        depth = 0
        for piece in re.finditer(r"[{}]|(?<=[{,])\s*(\w+)", code[match.end() - 1 :]):
            depth += {"{": 1, "}": -1}.get(piece[0], 0)
            if depth == 0:
                break
            if piece[1] and depth == 1:
                yield piece[1]


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
    for name, floors in FOLDERS.items():
        found += wrong_folder_arrows(ROOT / "crates" / name / "src", floors)
    for sentence in found:
        print(sentence)
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
