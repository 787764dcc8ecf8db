"""What someone may have meant who misspelt one of several words."""

from __future__ import annotations

from collections.abc import Iterable
from difflib import get_close_matches

__all__ = ["perhaps"]


def perhaps(given: object, known: Iterable[str]) -> str:
    """Returns " (did you mean 'word'?)" for the nearest word; "" where none is near."""
    by_small = {word.casefold(): word for word in known}
    near = get_close_matches(str(given).casefold(), by_small, n=1)
    return f" (did you mean {by_small[near[0]]!r}?)" if near else ""
