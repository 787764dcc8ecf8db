"""Options that messages name, in the words of whoever reads them.

A message names an option as Python does, in backticks: "or others with `resample=True`". The
command line and recipes tell it in their own form.
"""

from __future__ import annotations

import re
from collections.abc import Callable

__all__ = ["HINT", "in_recipe", "prefixed", "retold"]

HINT = re.compile(r"`([a-z]\w*)=([^`]+)`")
"""An option and its value in a message."""


def retold(message: str, tell: Callable[[str, str], str]) -> str:
    """Returns a message with each option, by name and value, told otherwise."""
    return HINT.sub(lambda found: tell(found[1], found[2]), message)


def prefixed(message: str, prefix: str) -> str:
    """Returns a message where options are those of one of several inputs, such as "moving"."""
    return retold(message, lambda name, value: f"`{prefix}_{name}={value}`")


def in_recipe(message: str) -> str:
    """Returns a message where options are as a recipe has them, such as "resample: true"."""

    def tell(name: str, value: str) -> str:
        return f"`{name.replace('_', '-')}: {'true' if value == 'True' else value}`"

    return retold(message, tell)
