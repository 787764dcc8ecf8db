"""Counts of things in sentences: "1 file is", "2 files are", "a, b and 3 more", "12 %"."""

from __future__ import annotations

from collections.abc import Sequence

__all__ = ["counted", "listed", "percent"]

MOST_NAMED = 5
"""Of things in a row."""


def counted(count: int, one: str, many: str, *, of: int | None = None) -> str:
    """Returns a count with what is said of one or of many; ``of`` how many, if some of them."""
    among = "" if of is None else f" of {of}"
    return f"{count}{among} {one if count == 1 else many}"


def listed(names: Sequence[str], *, most: int = MOST_NAMED) -> str:
    """Returns the first few names, and how many more there are."""
    more = len(names) - most
    return ", ".join(names[:most]) + (f" and {more} more" if more > 0 else "")


def percent(share: float) -> str:
    """Returns a share of 0..1 in percent; "100 %" only of all, and "0 %" only of nothing."""
    if 0.99 < share < 1.0:
        return "over 99 %"
    if 0.0 < share < 1e-4:
        return "under 0.01 %"
    return f"{100.0 * share:.0f} %" if share >= 1.0 else f"{100.0 * share:.2g} %"
