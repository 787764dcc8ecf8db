"""Options that messages name, in the words of whoever reads them.

A message names an option as Python does, in backticks: "or others with `resample=True`". The
command line and recipes tell it in their own form; where neither has it, they name the command
that has it, with all that it needs to be typed as it stands.
"""

from __future__ import annotations

import re
import shlex
from collections.abc import Callable, Collection, Iterable
from pathlib import Path

__all__ = ["HINT", "elsewhere", "file_of", "in_recipe", "prefixed", "retold"]

HINT = re.compile(r"`([a-z]\w*)=([^`]+)`")
"""An option and its value in a message."""

LINES: tuple[tuple[str, tuple[str, ...]], ...] = (
    (
        "palpate import {file} {flag} -o NEW.nrrd",
        ("series", "frame", "orientation", "unit", "fill", "raw", "voxel_size", "max_voxels"),
    ),
    (
        "palpate segment {file} {flag} -o NEW.seg.nrrd",
        ("threshold", "otsu", "grow", "seeds", "auto"),
    ),
    ("palpate surface voxels {file} NEW.nii.gz {flag}", ("close", "as_shell")),
)
"""Commands that do one thing to one file, and the options that messages may name of them."""
FLAGS = {"as_shell": "shell"}
"""Options that are called otherwise on the command line."""
INPUTS = ("fixed_", "moving_", "mesh_")
"""What options of one of several inputs begin with."""


def retold(message: str, tell: Callable[[str, str], str]) -> str:
    """Returns a message with each option, by name and value, told otherwise."""
    return HINT.sub(lambda found: tell(found[1], found[2]), message)


def prefixed(message: str, prefix: str) -> str:
    """Returns a message where options are those of one of several inputs, such as "moving"."""
    return retold(message, lambda name, value: f"`{prefix}_{name}={value}`")


def in_recipe(message: str, *, known: Collection[str], files: Iterable[Path] = ()) -> str:
    """Returns a message where options are as a recipe has them, such as "resample: true".

    Args:
        message: The message.
        known: Options of the step that it is about.
        files: What the step reads, for a command in the place of an option that it lacks.
    """

    def tell(name: str, value: str) -> str:
        if name not in known:
            return elsewhere(name, value, file_of(message, files))
        return f"`{name.replace('_', '-')}: {'true' if value == 'True' else value}`"

    return retold(message, tell)


def elsewhere(name: str, value: str, file: str) -> str:
    """Returns the command that has an option which is lacking here, whole as it is typed.

    Args:
        name: The option in Python.
        value: Its value in the message.
        file: The file to type there.
    """
    plain = next((name.removeprefix(one) for one in INPUTS if name.startswith(one)), name)
    flag = f"--{FLAGS.get(plain, plain).replace('_', '-')}"
    flag += "" if value == "True" else f" {value}"
    for line, names in LINES:
        if plain in names:
            return f"`{line.format(file=shlex.quote(file), flag=flag)}`"
    return f"{name.replace('_', ' ')} {value}"


def file_of(message: str, files: Iterable[Path]) -> str:
    """Returns the file that a message is about: one that it names, or else the first."""
    there = list(files)
    named = [
        path for path in there if re.search(rf"(?<![\w.-]){re.escape(path.name)}(?![\w-])", message)
    ]
    found = max(named, key=lambda path: len(path.name), default=there[0] if there else "FILE")
    return str(found)
