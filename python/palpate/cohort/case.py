"""One case of a cohort: its name, its variables, and its share of all cases."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from palpate.base.errors import OptionError

__all__ = ["Case", "share_of"]


@dataclass(frozen=True)
class Case:
    """One case."""

    name: str
    """Its folder in the output folder; no two cases share one."""
    variables: dict[str, str]
    """What stands in the place of ``{variable}`` in the recipe."""
    scan: Path | None = None
    """Takes the place of the recipe's scan; None where the recipe names it by a variable."""


def share_of(cases: Sequence[Case], shard: str) -> list[Case]:
    """Returns the i-th of n shares of all cases, i from 1; every case is in exactly one.

    Raises:
        OptionError: The shard is not written as i/n.
    """
    way = re.fullmatch(r"(\d+)/(\d+)", shard)
    number, count = (int(way[1]), int(way[2])) if way else (0, 0)
    if not 1 <= number <= count:
        raise OptionError(f"shard {shard!r} given; allowed: i/n with i from 1 to n, such as 1/4")
    return list(cases[number - 1 :: count])
