"""What a person sees of a view that turns and rests, and how long the page's controls wait.

The view rotates with every frame for some seconds and then rests. A frame counts as a picture if
the renderer has drawn something since the one before. From the last rotation on, the time is noted
when each finer picture is on display. Meanwhile a key that does nothing is pressed ten times a
second; its delay is the time from the key to the page's first handler.
"""

from __future__ import annotations

import time
from typing import Any

import numpy as np

from palpate.bench.page import Page

__all__ = ["figures_of", "seen"]

PRESSES = 0.1
"""Time between two keys [s]."""
STEP_ANGLE = 0.02
"""Rotation of the view from frame to frame [rad]."""
PATIENCE = 120.0
"""Longest wait for the final picture [s]."""
LEVELS = (4, 2, 1)
"""By what the resolution of pictures is divided whose times are reported."""


def seen(page: Page, seconds: float) -> dict[str, float]:
    """Turns a page's view for some seconds and lets it rest.

    Returns:
        Pictures per second, and by what the resolution of the middle one is divided, while the
        view turns; times from the last rotation until a picture is as fine as each of ``LEVELS``
        and until the final one, and quantiles of the delay of keys while it turns and rests [s].
    """
    page.wait("window.palpate.finished")
    page.read(WATCHING % STEP_ANGLE)
    _press(page, seconds, "false")
    page.read("window.watched.rest()")
    _press(page, PATIENCE, "window.palpate.finished && window.watched.final !== null")
    return figures_of(page.read("window.watched.stop()"))


def _press(page: Page, seconds: float, until: str) -> None:
    """Presses a key that does nothing, again and again, until something is true."""
    ends = time.monotonic() + seconds
    while time.monotonic() < ends and not page.read(until):
        began = time.monotonic()
        page.press("F13")
        time.sleep(max(0.0, PRESSES - (time.monotonic() - began)))


def figures_of(watched: dict[str, Any]) -> dict[str, float]:
    """Returns the figures of what a page has noted; ``seen`` tells what they are."""
    turning, rested = watched["turning"], watched["rested"]
    divisors = [divisor for _, divisor in turning]
    figures = {
        "seen rate": len(turning) / (rested / 1e3),
        "seen divisor": float(np.median(divisors)) if divisors else float("nan"),
    }
    for level in LEVELS:
        times = [at for at, divisor in watched["resting"] if divisor <= level]
        if times:
            figures[f"seen {level}"] = (min(times) - rested) / 1e3
    if watched["final"] is not None:
        figures["seen final"] = (watched["final"] - rested) / 1e3
    for name, delays in (
        ("turning", [delay for at, delay in watched["delays"] if at <= rested]),
        ("resting", [delay for at, delay in watched["delays"] if at > rested]),
    ):
        if delays:
            figures[f"key {name}"] = float(np.quantile(delays, 0.95)) / 1e3
    return figures


WATCHING = """void (() => {
  const begun = performance.now(), { bench } = window.palpate;
  const watched = { turning: [], resting: [], delays: [], rested: null, final: null };
  let pieces = bench.pieces, going = true;
  const pressed = ({ timeStamp }) => {
    watched.delays.push([timeStamp - begun, performance.now() - timeStamp]);
  };
  addEventListener("keydown", pressed, true);
  const look = () => {
    const { divisor, finished } = window.palpate.shown, now = performance.now() - begun;
    const { rested } = watched;
    if (rested === null) {
      if (bench.pieces !== pieces) watched.turning.push([now, divisor]);
      bench.turn(%g);
    } else {
      watched.resting.push([now, divisor]);
      // a rotation reaches the picture within 50 ms
      if (finished && now - rested > 50) watched.final ??= now;
    }
    pieces = bench.pieces;
    if (going) requestAnimationFrame(look);
  };
  requestAnimationFrame(look);
  window.watched = {
    get final() { return watched.final; },
    rest: () => { watched.rested = performance.now() - begun; },
    stop: () => {
      going = false;
      removeEventListener("keydown", pressed, true);
      return watched;
    },
  };
})()"""
"""Turns the view with every frame until it is to rest; notes pictures, their divisors and delays.

All times are from the beginning [ms].
"""
