"""Sentences for the page: what they say of options of the command line is left out."""

from __future__ import annotations

import re

__all__ = ["page_words"]

OPTIONS = (
    # "; give --unit HU if it is HU": there is nothing to give on the page
    (r"; give [^;]*--[^;]*", ""),
    # "1000 voxels, or more with --max-voxels"
    (r", or (more|others) with --[a-z-]+", ""),
    # " (--resample)", beside which a switch stands on the page
    (r" \(--[a-z-][^()]*\)", ""),
    # choose one with --series NUMBER or UID; one of them, with --frame 1 to 6
    (r",? with --[a-z-]+( \d+( to \d+)?| [A-Z][A-Z,]*( or [A-Z]+)*( \[mm\])?)?", ""),
)
"""How messages name options, and what stands for that on the page."""


def page_words(sentence: str) -> str:
    """Returns a sentence without the options of the command line that it names."""
    for named, instead in OPTIONS:
        sentence = re.sub(named, instead, sentence)
    return sentence
