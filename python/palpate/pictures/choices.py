"""What can be chosen of a picture beside its look, and how it is checked."""

from __future__ import annotations

from typing import Literal, get_args

from palpate.base.errors import OptionError
from palpate.base.nearest import perhaps
from palpate.pictures.looks import looks

__all__ = ["Background", "Size", "View", "require_drawable", "require_view"]

View = Literal["first", "anterior", "posterior", "left", "right", "superior", "inferior"]
"""Side of the patient on which the viewer stands; "first" is the view that the page begins with."""

Background = Literal["dark", "white", "transparent"]
"""What is behind the scan: the page's ground, white, or nothing."""

Size = tuple[int, int]
"""Columns and rows."""

MOST_SAMPLES = 64
"""Per pixel; more are not told from these."""

MOST_PIXELS = 16_384
"""Along an edge of a picture."""


def require_view(view: object) -> View:
    """Returns the name of a view.

    Raises:
        OptionError: There is none of this name.
    """
    names: tuple[View, ...] = get_args(View)
    for known in names:
        if known == view:
            return known
    raise OptionError(
        f"view {view!r} given{perhaps(view, names)}; allowed: {', '.join(names)}, or a Camera"
    )


def require_drawable(size: Size, *, quality: str, samples: int | None, background: str) -> None:
    """Refuses what no picture can be made with.

    Raises:
        OptionError: A number or a name is not allowed.
    """
    whole = isinstance(size, tuple | list) and all(isinstance(each, int) for each in size)
    if not whole or len(size) != 2 or not all(1 <= each <= MOST_PIXELS for each in size):
        raise OptionError(
            f"size {size!r} given; allowed: columns and rows, each 1 to {MOST_PIXELS}"
        )
    for name, given, known in (
        ("quality", quality, tuple(looks().qualities)),
        ("background", background, get_args(Background)),
    ):
        if given not in known:
            raise OptionError(
                f"{name} {given!r} given{perhaps(given, known)}; allowed: {', '.join(known)}"
            )
    if samples is not None and not (isinstance(samples, int) and 1 <= samples <= MOST_SAMPLES):
        raise OptionError(f"samples {samples!r} given; allowed: 1 to {MOST_SAMPLES}")
