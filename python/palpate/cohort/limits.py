"""What a case may take."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["Limits"]


@dataclass(frozen=True)
class Limits:
    """What a case may take."""

    seconds: float | None = None
    memory: int | None = None
    """Of its process, for data [bytes]; Linux alone counts that."""
    retry: int = 0
    """How often a case that failed is tried again."""
    threads: int | None = None
    """Of algebra and the engine, each; None: as many as the machine has cores. ITK has one."""
