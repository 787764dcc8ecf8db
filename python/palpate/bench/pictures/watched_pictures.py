"""What a person at a page sees, noted in the page from its opening on.

A script, put into the page before its own, looks at it with every frame: when a picture stands on
the screen, by what its resolution is divided, and which request it answers. Pointer events and
edits are noted with the number of the last request before the frame after them, in which the page
takes them: the first picture with a higher one shows what they changed. Between its pictures the
page turns the last one to the present view: such turned pictures are noted apart, and a picture of
the engine counts as shown whether it is turned or not. Times are from the opening of the page [ms];
a picture counts from the frame after the one in which it was drawn.
"""

from __future__ import annotations

import time
from collections.abc import Callable

import msgspec
import numpy as np

from palpate.bench.page import Page

__all__ = [
    "NOTING",
    "NotedEdit",
    "NotedKey",
    "NotedMove",
    "NotedPicture",
    "NotedTurn",
    "Watched",
    "press_until",
    "watched",
]

PRESSES = 0.1
"""Time between two keys [s]."""


class NotedPicture(msgspec.Struct, frozen=True, kw_only=True):
    """A picture on the screen."""

    at: float
    pieces: int
    """Number of what was drawn last; notes with the same one tell more of the same picture."""
    divisor: float
    """Of the resolution."""
    finished: bool
    """It does not become finer."""
    answers: int | None
    """Number of the request that it answers; None of a picture that the browser drew."""


class NotedTurn(msgspec.Struct, frozen=True, kw_only=True):
    """A picture on the screen that was turned to the view of the frame before; no true picture."""

    at: float
    turns: int
    """How many were drawn by then."""


class NotedMove(msgspec.Struct, frozen=True, kw_only=True):
    """A pointer event; both numbers are of what was before the next frame."""

    at: float
    requested: int | None
    """Number of the last request."""
    turns: int | None
    """How many turned pictures were drawn."""


class NotedEdit(msgspec.Struct, frozen=True, kw_only=True):
    """An edit; ``at`` is when the engine applied it."""

    at: float
    requested: int | None


class NotedKey(msgspec.Struct, frozen=True, kw_only=True):
    """A key, and how long it waited for the page's first handler."""

    at: float
    delay: float


class Watched(msgspec.Struct, frozen=True, kw_only=True):
    """What was noted, in the order of time; changes of what is on the screen only."""

    now: float
    pictures: list[NotedPicture]
    turns: list[NotedTurn]
    moves: list[NotedMove]
    edits: list[NotedEdit]
    keys: list[NotedKey]

    def after(self, begin: float, end: float = float("inf")) -> Watched:
        """Returns what was noted from a time up to, but without, another."""
        return Watched(
            now=self.now,
            pictures=[one for one in self.pictures if begin <= one.at < end],
            turns=[one for one in self.turns if begin <= one.at < end],
            moves=[one for one in self.moves if begin <= one.at < end],
            edits=[one for one in self.edits if begin <= one.at < end],
            keys=[one for one in self.keys if begin <= one.at < end],
        )

    def first(self, accept: Callable[[NotedPicture], bool]) -> float | None:
        """Returns when the first picture came that is accepted."""
        return next((one.at for one in self.pictures if accept(one)), None)

    def latencies(
        self, events: list[NotedMove] | list[NotedEdit], *, coarsest: float = float("inf")
    ) -> list[float]:
        """Returns the times from events to the pictures that show them [ms].

        Events that nothing showed before the end of the notes have none.

        Args:
            events: Among those that were noted.
            coarsest: Pictures with a larger divisor do not count.
        """
        counted = [one for one in self.pictures if one.divisor <= coarsest]
        found = []
        for event in events:
            if event.requested is None:
                continue
            showing = (
                one.at
                for one in counted
                if one.answers is not None and one.answers > event.requested
            )
            shown = next(showing, None)
            if shown is not None:
                found.append(shown - event.at)
        return found

    def turned_latencies(self) -> list[float]:
        """Returns the times from moves to the turned pictures that show them [ms].

        Moves that no turned picture showed before the end of the notes have none.
        """
        found = []
        for move in self.moves:
            showing = (
                one.at for one in self.turns if move.turns is not None and one.turns > move.turns
            )
            shown = next(showing, None)
            if shown is not None:
                found.append(shown - move.at)
        return found

    def key_delay(self) -> float | None:
        """Returns the 95th percentile of the keys' delays [ms]; None without keys."""
        delays = [one.delay for one in self.keys]
        return float(np.quantile(delays, 0.95)) if delays else None


def watched(page: Page) -> Watched:
    """Returns what was noted in a page so far."""
    return msgspec.convert(page.read("window.watched()"), Watched)


def press_until(page: Page, seconds: float, until: str) -> None:
    """Presses a key that does nothing, again and again, until something is true or time is up."""
    ends = time.monotonic() + seconds
    while time.monotonic() < ends and not page.read(until):
        began = time.monotonic()
        page.press("F13")
        time.sleep(max(0.0, PRESSES - (time.monotonic() - began)))


NOTING = """(() => {
  const pictures = [], turns = [], moves = [], edits = [], keys = [];
  let drawn = null, lastEdit = 0, lastMove = 0, lastTurn = 0;
  const note = () => {
    const numbers = window.palpate?.bench.numbers ?? null, requested = numbers?.requested ?? null;
    // what they change is requested, or shown by a turn, in this frame at the earliest
    for (; lastMove < moves.length; lastMove += 1) {
      Object.assign(moves[lastMove], { requested, turns: numbers?.turns ?? null });
    }
    if (numbers !== null && numbers.turns > lastTurn) {
      lastTurn = numbers.turns;
      turns.push({ at: performance.now(), turns: lastTurn });
    }
    const { palpate } = window, shown = palpate?.shown ?? null;
    if (shown !== null && palpate.firstPicture !== null && shown.divisor > 0) {
      const { divisor, finished } = shown, { pieces } = palpate.bench;
      if (drawn?.pieces !== pieces || drawn.divisor !== divisor || drawn.finished !== finished) {
        drawn = { pieces, divisor, finished };
        const answers = numbers?.shown ?? null;
        pictures.push({ at: performance.now(), pieces, divisor, finished, answers });
      }
      for (const { applied, edit } of palpate.editTimes.filter(({ edit }) => edit > lastEdit)) {
        edits.push({ at: applied - performance.timeOrigin, requested });
        lastEdit = edit;
      }
    }
    requestAnimationFrame(note);
  };
  requestAnimationFrame(note);
  addEventListener("pointermove", ({ timeStamp }) => {
    moves.push({ at: timeStamp, requested: null, turns: null });
  }, true);
  addEventListener("keydown", ({ timeStamp }) => {
    keys.push({ at: timeStamp, delay: performance.now() - timeStamp });
  }, true);
  window.watched = () => ({ now: performance.now(), pictures, turns, moves, edits, keys });
})()"""
"""Notes everything of ``Watched``; it runs first in every frame, since it asked for frames first.

Until ``firstPicture`` what the page reports is not on the screen yet.
"""
