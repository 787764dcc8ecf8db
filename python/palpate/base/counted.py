"""Counts of things in sentences: "1 file is", "2 files are"."""

from __future__ import annotations

__all__ = ["counted"]


def counted(count: int, one: str, many: str, *, of: int | None = None) -> str:
    """Returns a count with what is said of one or of many; ``of`` how many, if some of them."""
    among = "" if of is None else f" of {of}"
    return f"{count}{among} {one if count == 1 else many}"
