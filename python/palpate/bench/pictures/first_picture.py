"""Time until the first picture of a page, and processor time of the browser until then."""

from __future__ import annotations

from collections import defaultdict
from pathlib import Path
from statistics import median

from palpate.bench.page import Page, opened, served

__all__ = ["first_picture", "used_until_picture"]


def first_picture(scan: Path, *, runs: int, width: int, height: int) -> dict[str, float]:
    """Returns the time from opening a page to its picture, and the processor time until it [s].

    Medians of a number of runs. The scan is freshly read: pages of a session with edits have more
    to draw.
    """
    found: dict[str, list[float]] = defaultdict(list)
    with served(scan) as url:
        for _ in range(runs):
            with opened(None, width=width, height=height) as page:
                for share, taken in used_until_picture(page, url).items():
                    found[share].append(taken)
                found["first"].append(float(page.read("window.palpate.firstPicture")) / 1e3)
    return {name: median(taken) for name, taken in found.items()}


def used_until_picture(page: Page, url: str) -> dict[str, float]:
    """Opens an address; returns the processor time of the browser until its picture [s]."""
    before = page.spent()
    page.glimpse(url)
    return {share: until - before[share] for share, until in page.spent().items()}
