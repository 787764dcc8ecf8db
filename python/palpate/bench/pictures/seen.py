"""What a person sees of a scan that is opened, turned, let rest and drilled.

The page is opened in a fresh browser and draws by whom it chooses itself, or by whom it is told to;
the session behind it runs at 1 kHz. The mouse then drags the view back and forth for some seconds,
60 times a second, and rests; at last an eraser drills circles into the bone. Everything is read off
what was noted in the page (``watched_pictures.py``). Meanwhile a key that does nothing
is pressed ten times a second; its delay is the time from the key to the page's first handler.
"""

from __future__ import annotations

import time
from collections import defaultdict
from dataclasses import dataclass
from pathlib import Path
from statistics import median

import numpy as np

from palpate.bench.edit import erased
from palpate.bench.page import Page, opened, served
from palpate.bench.pictures.watched_pictures import NOTING, Watched, press_until, watched

__all__ = ["Looking", "drilled_figures", "opened_figures", "seen", "turned_figures"]

WINDOW = {"width": 1366, "height": 768}
"""Size of the browser's window [pixels], with room for panels beside the picture."""
COARSEST_FIRST = 3.0
"""By what the resolution of a first picture may be divided."""
COARSEST_DRILLED = 2.0
"""By what that of a picture may be divided that shows a hole."""
PATIENCE = 120.0
"""Longest wait for the final picture [s]."""
MOVES_PER_SECOND = 60.0
DRAG = 5.0
"""Way of the mouse between two moves [CSS pixels]."""
DRAGS = 60
"""Moves to one side."""
MOVES_BETWEEN_KEYS = 6


@dataclass(frozen=True)
class Looking:
    """How long is looked."""

    openings: int = 3
    """Times that the page is opened; the median counts."""
    turning: float = 6.0
    """Time of turning [s]."""
    rests: int = 3
    """Times that the view is turned and rests."""
    drilling: float = 4.0
    """Time of drilling [s]."""


def seen(scan: Path, looking: Looking, *, drawer: str | None = None) -> dict[str, float]:
    """Returns the figures of what is seen of a scan; where something never came they lack it.

    ``drawer``: "engine" or "browser"; None leaves it to the page.
    """
    found: dict[str, list[float]] = defaultdict(list)

    def learn(figures: dict[str, float]) -> None:
        for name, figure in figures.items():
            found[name].append(figure)

    began = time.perf_counter()
    with served(scan) as url:
        found["served"].append(time.perf_counter() - began)
        for opening in range(looking.openings):
            with opened(None, **WINDOW, drawer=drawer) as page:
                page.before(NOTING)
                page.go(url)
                page.wait("window.palpate.finished")
                learn(opened_figures(watched(page)))
                if opening == looking.openings - 1:
                    found["by engine"].append(float(page.read("window.palpate.drawer.engine")))
                    for _ in range(looking.rests):
                        learn(_turned(page, looking.turning / looking.rests))
                    learn(_drilled(page, looking.drilling))
    figures = {name: median(taken) for name, taken in found.items()}
    # of what may not happen once the worst counts
    return figures | {name: max(found[name]) for name in WORST if name in found}


WORST = ("coarsest", "key turning", "key resting")


# --- what is done -------------------------------------------------------------------------


def _turned(page: Page, seconds: float) -> dict[str, float]:
    """Drags the view for some seconds and lets it rest until its picture is final."""
    begin = float(page.read("performance.now()"))
    _drag(page, seconds)
    # the last move reaches the picture within 50 ms
    time.sleep(0.05)
    press_until(page, PATIENCE, "window.palpate.finished")
    return turned_figures(watched(page).after(begin))


def _drag(page: Page, seconds: float) -> None:
    """Drags the middle of the view to the right and back with the left button."""
    x, y = page.read(
        "(({x, y, width, height}) => [x + width / 2, y + height / 2])"
        "(document.querySelector('[data-testid=canvas]').getBoundingClientRect())"
    )
    began, moved = time.monotonic(), 0
    page.mouse("mousePressed", (x, y))
    while time.monotonic() - began < seconds:
        moved += 1
        away = moved % (2 * DRAGS)
        page.mouse("mouseMoved", (x + DRAG * min(away, 2 * DRAGS - away), y))
        if moved % MOVES_BETWEEN_KEYS == 0:
            page.press("F13")
        time.sleep(max(0.0, began + moved / MOVES_PER_SECOND - time.monotonic()))
    page.mouse("mouseReleased", (x, y))


def _drilled(page: Page, seconds: float) -> dict[str, float]:
    begin = float(page.read("performance.now()"))
    erased(page, seconds)
    return drilled_figures(watched(page).after(begin))


# --- what it tells ------------------------------------------------------------------------


def opened_figures(notes: Watched) -> dict[str, float]:
    """Returns the times from opening the page to pictures that are fine enough [s]."""
    times = {
        "first": notes.first(lambda one: one.divisor <= COARSEST_FIRST),
        "sharp": notes.first(lambda one: one.divisor <= 1.0),
        "final": notes.first(lambda one: one.finished),
    }
    return {name: at / 1e3 for name, at in times.items() if at is not None}


def turned_figures(notes: Watched) -> dict[str, float]:
    """Returns the figures of a view that was dragged from its first move to its last [s]."""
    begin, rested = notes.moves[0].at, notes.moves[-1].at
    turning, resting = notes.after(begin, rested), notes.after(rested)
    figures = {"rate": 1e3 * len({one.pieces for one in turning.pictures}) / (rested - begin)}
    if turning.pictures:
        figures["coarsest"] = max(one.divisor for one in turning.pictures)
    # what the last moves changed may be shown after them
    if turning.turns:
        figures["turned rate"] = 1e3 * len(turning.turns) / (rested - begin)
    for name, latencies in (
        ("mouse", notes.latencies(notes.moves)),
        ("turned", notes.turned_latencies()),
    ):
        if latencies:
            middle, tail = np.quantile(latencies, [0.5, 0.95])
            figures |= {f"{name} median": middle / 1e3, f"{name} p95": tail / 1e3}
    last = notes.moves[-1].requested
    for name, finished in (("rest sharp", False), ("rest final", True)):
        at = _shown_after(resting, last, finished=finished)
        if at is not None:
            figures[name] = (at - rested) / 1e3
    for name, part in (("key turning", turning), ("key resting", resting)):
        delay = part.key_delay()
        if delay is not None:
            figures[name] = delay / 1e3
    return figures


def _shown_after(notes: Watched, request: int | None, *, finished: bool) -> float | None:
    """Returns when a picture of the whole resolution, or the final one, answered a later request.

    Without numbers of requests, as the browser draws, any picture counts.
    """
    return notes.first(
        lambda one: (
            one.divisor <= 1.0
            and (one.finished or not finished)
            and (request is None or (one.answers is not None and one.answers > request))
        )
    )


def drilled_figures(notes: Watched) -> dict[str, float]:
    """Returns the times from an edit until a picture shows it [s]."""
    latencies = notes.latencies(notes.edits, coarsest=COARSEST_DRILLED)
    if not latencies:
        return {}
    middle, tail = np.quantile(latencies, [0.5, 0.95])
    return {"drill median": middle / 1e3, "drill p95": tail / 1e3}
