"""Colours of anatomical structures as atlases use them, by their names.

Colours are sRGB, each 0..1.
"""

from __future__ import annotations

import re
from collections.abc import Iterable

from palpate.volumes.appearance import Colour

__all__ = ["Colour", "colour_of_name", "first_colour"]


BY_NAME: tuple[tuple[str, Colour], ...] = (
    ("vertebra|sternum|sacrum|femur|tibia|fibula|patella|humerus|scapula|clavic|costal|bone|skull",
     (0.94, 0.89, 0.78)),
    ("(?<![a-z])(rib|hip|mandib|crani)", (0.94, 0.89, 0.78)),
    ("aorta|arter|trunk", (0.80, 0.16, 0.14)),
    ("vein|vena", (0.22, 0.36, 0.72)),
    ("heart|(?<![a-z])(atri|ventric)|myocard", (0.72, 0.22, 0.24)),
    ("lung|trachea|bronch", (0.93, 0.70, 0.72)),
    ("gallbladder", (0.42, 0.62, 0.26)),
    ("(?<![a-z])liver", (0.62, 0.28, 0.20)),
    ("spleen", (0.52, 0.24, 0.40)),
    ("kidney|adrenal", (0.66, 0.36, 0.22)),
    ("pancreas", (0.90, 0.70, 0.40)),
    ("bladder|prostate", (0.92, 0.84, 0.44)),
    ("stomach|bowel|colon|duodenum|esophagus|rectum", (0.82, 0.62, 0.52)),
    ("glut|iliopsoas|autochthon|muscle", (0.70, 0.32, 0.28)),
    ("brain|spinal|nerve", (0.86, 0.82, 0.72)),
    ("(?<![a-z])(fat|skin|body)", (0.92, 0.76, 0.62)),
)  # fmt: skip
"""Patterns of names and the colour of what they match; the first match counts."""


def colour_of_name(name: str) -> Colour | None:
    """Returns the usual colour of a structure; None where its name is not known."""
    found = (colour for pattern, colour in BY_NAME if re.search(pattern, name.lower()))
    return next(found, None)


def first_colour(name: str, others: Iterable[str], *, otherwise: Colour) -> Colour:
    """Returns the colour of a segment for which nobody has chosen one.

    It is the usual colour of its name; ``otherwise`` where the name is not known, or where one of
    the ``others`` has the same usual colour, so that the two can be distinguished.
    """
    if any(other.casefold() == name.casefold() for other in others):
        return otherwise
    return colour_of_name(name) or otherwise
