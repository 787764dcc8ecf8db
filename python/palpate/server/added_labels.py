"""Segments of files, added to a session that is shown."""

from __future__ import annotations

from palpate.base.errors import OptionError
from palpate.labels.labels import Labels
from palpate.server.live import Live
from palpate.server.page_words import page_words
from palpate.volumes.scene import MOST_SEGMENTS

__all__ = ["add_labels"]


def add_labels(live: Live, found: Labels) -> None:
    """Adds segments to a session, and notifies all pages; for any thread.

    Raises:
        OptionError: They are too many.
    """
    room, count = MOST_SEGMENTS - len(live.session.segments()), len(found.labels)
    if count > room:
        raise OptionError(f"{count} segments given; allowed: {room} more")
    for label in found.labels:
        live.segments.add(label.segment, colour=label.colour)
    for warning in found.warnings:
        said = page_words(warning)
        live.notify("warning", f"{said[:1].upper()}{said[1:]}.")
    one = count == 1
    live.notify(
        "info",
        f"{'One segment was' if one else f'{count} segments were'} added: "
        f"undo takes {'it back' if one else 'them back one by one'}.",
    )
