"""Sentences for the page: what they say of options of the command line is left out."""

from __future__ import annotations

import re

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


def page_words(sentence: str) -> str:
    """Returns a sentence without the options of the command line that it names."""
    for named, instead in OPTIONS:
        sentence = re.sub(named, instead, sentence)
    return sentence
