"""Measures what a person at the page sees: `make bench-page` runs it.

For each scan, in a fresh browser on software GL: seconds from the command to the first
picture, servo ticks that begin more than 2 ms late while the page is open and the probe is
led over the bone, and the memory of the process.
"""

from __future__ import annotations

import math
import statistics
import sys
import time
from pathlib import Path

from browser import Browser, Command, browser, palpate

SIZE = {"width": 1280, "height": 800}
"""Size of the browser's window [pixels]."""
RUNS = 3
"""Openings and sessions of each scan; the median counts."""
WATCHED_SECONDS = 20.0
"""Time of each session over which late ticks are counted."""


def first_picture(path: Path) -> float:
    """Returns the seconds from starting the command to the first picture."""
    with browser(drawer="browser") as page:
        began = time.monotonic()
        with palpate("open", path) as command:
            served = time.monotonic() - began
            shown: float = page.do("open", url=command.url, **SIZE)["firstPicture"]
            return served + shown / 1000.0


def lead_the_hand(page: Browser, seconds: float) -> None:
    """Moves the hand in circles through the middle of the scan, as a person would."""
    x, y, z = page.read("window.palpate.camera.target")
    ends, step = time.monotonic() + seconds, 0
    while time.monotonic() < ends:
        angle = step * math.tau / 80.0
        point = [x + 40.0 * math.cos(angle), y - 40.0, z + 40.0 * math.sin(angle)]
        page.read(f"window.palpate.hand({point})")
        step += 1


def servo(page: Browser) -> tuple[int, int]:
    """Returns the servo's ticks and those that began late."""
    rate = page.read("window.palpate.state.rates.servo")
    return int(rate["ticks"]), int(rate["late"])


def memory_mib(command: Command) -> float:
    """Returns the resident memory of the process [MiB]."""
    status = Path(f"/proc/{command.process.pid}/status").read_text()
    kib = next(line for line in status.splitlines() if line.startswith("VmRSS")).split()[1]
    return int(kib) / 1024.0


def watch(path: Path, *, with_priority: bool) -> tuple[float, float]:
    """Returns the share of late ticks in one session, and its memory [MiB]."""
    with (
        palpate("open", path, real_time=with_priority) as command,
        browser(drawer="browser") as page,
    ):
        page.do("open", url=command.url, **SIZE)
        if page.read("window.palpate.state.rates.real_time") != with_priority:
            sys.exit("no real-time priority here; allowed: as root, or with ulimit -r 70")
        before = servo(page)
        lead_the_hand(page, WATCHED_SECONDS)
        ticks, late = (now - then for now, then in zip(servo(page), before, strict=True))
        return late / ticks, memory_mib(command)


def main(paths: list[Path]) -> None:
    """Measures each scan."""
    for path in paths:
        times = [first_picture(path) for _ in range(RUNS)]
        listed = ", ".join(f"{seconds:.2f}" for seconds in times)
        print(f"{path.name}: first picture after {statistics.median(times):.2f} s ({listed})")
        for with_priority in (True, False):
            sessions = [watch(path, with_priority=with_priority) for _ in range(RUNS)]
            shares = [share for share, _ in sessions]
            listed = ", ".join(f"{share:.3%}" for share in shares)
            print(
                f"{path.name}: real-time priority {'on' if with_priority else 'off'}: "
                f"{statistics.median(shares):.3%} of ticks late ({listed}), "
                f"memory {sessions[0][1]:.0f} MiB"
            )


if __name__ == "__main__":
    main([Path(argument) for argument in sys.argv[1:]])
