"""What server and browser take of the memory while scans are opened one after another on a page.

Run: ``python scripts/measure_memory.py [--times 90] SCAN SCAN …``. The scans are opened by turns.
What counts is the proportional set size of all processes of each (Linux, ``smaps_rollup``), once
the picture is final.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "support"))

from browser import Browser, browser, palpate

SHOWN = 10
"""Every so many openings a line is printed; the first three too."""
MIB = 1 << 20


def main(scans: list[str], times: int) -> None:
    """Opens scans by turns and prints what is taken [MiB]."""
    with palpate("open", scans[0]) as command, browser() as page:
        page.do("open", url=command.url, width=1366, height=768)
        page.finish()
        driver = page._process.pid  # noqa: SLF001  # the browser's processes are its children
        second = 0.0
        print("openings  server  browser [MiB]")
        for number in range(1, times + 1):
            if number > 1:
                _open(page, Path(scans[(number - 1) % len(scans)]))
            server, shown = taken(command.process.pid), taken(driver)
            second = server + shown if number == 2 * len(scans) else second
            if number <= 2 * len(scans) or number % SHOWN == 0:
                print(f"{number:8} {server / MIB:7.0f} {shown / MIB:8.0f}", flush=True)
        print(f"the last by the second of each: {(server + shown) / second:.2f}")


def _open(page: Browser, path: Path) -> None:
    """Opens a scan in the place of the one that is shown, and waits for its final picture."""
    before = page.read("performance.timeOrigin")
    page.do("click", testid="open-scan")
    page.do("fill", testid="open-path", text=str(path))
    page.do("click", testid="open-look")
    page.wait(f"performance.timeOrigin > {before} && window.palpate?.ready === true", seconds=120)
    page.finish()


def taken(process: int) -> float:
    """Returns the proportional set size of a process and all that it has started [bytes]."""
    return sum(_own(each) for each in _with_children(process))


def _with_children(process: int) -> Iterator[int]:
    yield process
    for thread in Path(f"/proc/{process}/task").iterdir():
        for child in (thread / "children").read_text().split():
            yield from _with_children(int(child))


def _own(process: int) -> float:
    try:
        lines = Path(f"/proc/{process}/smaps_rollup").read_text().splitlines()
    except OSError:
        # it has ended
        return 0.0
    return sum(1024.0 * int(line.split()[1]) for line in lines if line.startswith("Pss:"))


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("scans", nargs="+", metavar="SCAN")
    parser.add_argument("--times", type=int, default=90)
    given = parser.parse_args()
    main(given.scans, given.times)
