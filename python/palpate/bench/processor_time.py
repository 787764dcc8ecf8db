"""Processor time of a running browser by the role of its processes, as the Linux kernel reports it.

On a busy machine it says more than elapsed time: other programs make a page wait, not work more.
"""

from __future__ import annotations

import os
from pathlib import Path
from typing import Literal

__all__ = ["spent"]

Share = Literal["page", "graphics", "rest"]

PROC = Path("/proc")


def spent(browser: int) -> dict[str, float]:
    """Returns the processor time of a browser's processes until now [s]; empty on other systems.

    ``page`` runs scripts, lays out and paints; ``graphics`` is the GPU process, which draws in
    software where there is no GPU. Processes that have ended do not count.
    """
    if not PROC.is_dir():
        return {}
    running = (int(path.name) for path in PROC.iterdir() if path.name.isdecimal())
    stats = {number: stat for number in running if (stat := _stat(number)) is not None}
    times: dict[str, float] = {"page": 0.0, "graphics": 0.0, "rest": 0.0}
    for number, (_, seconds) in stats.items():
        if _is_below(number, browser, stats):
            times[_share(number)] += seconds
    return times


def _is_below(number: int, browser: int, stats: dict[int, tuple[int, float]]) -> bool:
    while number in stats and number != browser:
        number = stats[number][0]
    return number == browser


def _stat(number: int) -> tuple[int, float] | None:
    """Returns the parent and the time of a process [s]; None where it has ended meanwhile."""
    try:
        stat = (PROC / str(number) / "stat").read_text(encoding="utf-8", errors="replace")
    except OSError:
        return None
    # the name before them may hold anything
    parts = stat.rpartition(")")[2].split()
    return int(parts[1]), (int(parts[11]) + int(parts[12])) / os.sysconf("SC_CLK_TCK")


def _share(number: int) -> Share:
    try:
        command = (PROC / str(number) / "cmdline").read_bytes()
    except OSError:
        return "rest"
    if b"--type=renderer" in command:
        return "page"
    return "graphics" if b"--type=gpu-process" in command else "rest"
