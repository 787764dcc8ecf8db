"""Sentences for the page: what happened, then what to do, and no options of the command line."""

from __future__ import annotations

import re
from tempfile import gettempdir

__all__ = ["page_words"]

OPTIONS = (
    # "; give `unit=HU` if it is HU", "; give it, such as `orientation=LPS`": not on the page
    (r"; give [^;]*`[a-z_]+=[^;]*", ""),
    # more voxels may be taken with an option only
    (r", or (more|others) with `[a-z_]+=[^`]*`", ""),
    # choose one with `series=NUMBER` or its UID; one of them, with `frame=NUMBER` from 1 to 6
    (
        r",? with `[a-z_]+=[^`]*`(, its [^;]*list| or its UID| from \d+ to \d+| \[mm\])?",
        "",
    ),
    # what is left is no more than a word
    (r"`([a-z_]+)=True`", r"\1"),
    (r"`([a-z_]+)=([^`]*)`", r"\1 \2"),
)
"""How messages name options, and what stands for that on the page."""


DROPPED = re.escape(gettempdir()) + r"[\\/]palpate-\w{8}[\\/]"
"""Where files wait that were dropped into the page: a person knows them by their own names."""

ADVICE = (
    # "to try again", "to unlock it"
    (r"to (?=\w)", ""),
    (r"choosing ", "choose "),
    (r"(add|choose|give|look|open|set|stop|try|unlock) ", r"\1 "),
    (r"(?=once more)", "try "),
    (r"(?=after |none\b)", "possible: "),
    # whatever else is allowed is a thing, a number or a range
    (r"", "use "),
)
"""How what is allowed begins, and how the advice begins that stands for it: the first that fits."""


def page_words(sentence: str) -> str:
    """Returns a sentence without the options of the command line that it names.

    "radius 30 mm given; allowed: 0 to 20 mm" becomes "radius 30 mm cannot be used. Use 0 to 20 mm".
    """
    sentence = re.sub(DROPPED, "", sentence)
    for named, instead in OPTIONS:
        sentence = re.sub(named, instead, sentence)
    happened, is_told, allowed = sentence.partition("; allowed: ")
    return f"{_what_happened(happened)}. {_advice(allowed)}" if is_told else sentence


def _what_happened(given: str) -> str:
    instead = " was given" if re.search(r"(^|[\s:])no [^:]*$", given) else " cannot be used"
    return re.sub(r" given$", instead, given)


def _advice(allowed: str) -> str:
    begins, instead = next(each for each in ADVICE if re.match(each[0], allowed))
    advice = re.sub(begins, instead, allowed, count=1)
    return advice[:1].upper() + advice[1:]
