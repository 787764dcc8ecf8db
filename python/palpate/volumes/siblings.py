"""The volumes of one file or series, such as times, of which a scan is one."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from palpate.base.errors import OptionError

__all__ = ["Siblings"]


@dataclass(frozen=True)
class Siblings:
    """Volumes that one place holds, and which of them a scan is."""

    option: Literal["frame", "series"]
    """Of ``palpate.read``, which chooses one."""
    keys: tuple[int | str, ...]
    """Its value for each volume, in their order."""
    number: int
    """Of the scan among them, from 1."""

    def key_of(self, number: int) -> int | str:
        """Returns the value of the option for a volume, counted from 1.

        Raises:
            OptionError: There is no such volume.
        """
        if not 1 <= number <= len(self.keys):
            raise OptionError(f"volume {number} given; allowed: 1 to {len(self.keys)}")
        return self.keys[number - 1]
