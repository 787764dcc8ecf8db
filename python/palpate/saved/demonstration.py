"""The built-in phantom, as ``palpate demo`` and the page's "Try the demo" open it."""

from __future__ import annotations

from palpate.base.progress import Progress
from palpate.saved.opening import Opening, opening_of
from palpate.volumes.phantom import phantom

__all__ = ["demonstration"]


def demonstration(progress: Progress) -> Opening:
    """Makes the phantom with its bone, and its liver as something to make soft."""
    progress("making the phantom", None)
    made = phantom()
    opened = opening_of(made.volume)
    opened.scene.add(made.part("liver"), shown_as="surface")
    return opened
