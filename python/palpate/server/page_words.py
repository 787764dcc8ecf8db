"""Sentences for the page: what happened, then what to do, and no options of the command line."""

from __future__ import annotations

import re

from palpate.base.temporary_files import OF_A_COMMAND, SYSTEM_FOLDER

__all__ = ["page_words"]

OPTIONS = (
    # "; allowed: with `voxel_size=X,Y,Z` [mm], such as 1,1,2": nothing else would help
    (r"; allowed: with `[a-z_]+=[^`]*`( \[mm\])?, such as [^;]*$", ""),
    # "; give `unit=HU` if it is HU", "; give it, such as `orientation=LPS`": not on the page
    (r"; give [^;]*`[a-z_]+=[^;]*", ""),
    # more voxels may be taken with an option only
    (r", or (more|others) with `[a-z_]+=[^`]*`", ""),
    # choose one with `series=NUMBER` or its UID; one of them, with `frame=NUMBER` from 1 to 6
    (
        r",? with `[a-z_]+=[^`]*`(, its [^;]*list| or its UID| from \d+ to \d+| \[mm\])?",
        "",
    ),
    (r"`pixels_checked=True` once", "the tick at Export once"),
    (
        r"`keep_identity=True` for an archive that may know the patient",
        "a DICOM format that names the patient",
    ),
    # what is left is no more than a word
    (r"`([a-z_]+)=True`", r"\1"),
    (r"`([a-z_]+)=([^`]*)`", r"\1 \2"),
)
"""How messages name options, and what stands for that on the page."""


DROPPED = re.escape(str(SYSTEM_FOLDER)) + rf"[\\/]({OF_A_COMMAND}\w{{8}}[\\/])?palpate-\w{{8}}[\\/]"
"""Where files wait that were dropped into the page: a person knows them by their own names."""

TIMES = r"(?<=\d) x (?=\d)"
"""Between the sizes of a grid, for terminals of any letters."""

ADVICE = (
    # "to try again", "to unlock it"
    (r"to (?=[a-z])", ""),
    (r"choosing ", "choose "),
    (r"(add|choose|end|give|look|open|picture|put|set|stop|try|unlock) ", r"\1 "),
    (r"(?=once more)", "try "),
    (
        r"(?=(after|for|in|of|once|only|together|with|within|without|none|each once)\b)",
        "possible: ",
    ),
    # "above 0 to 20 mm", "finite, slope not 0"
    (r"finite(, | and )", r"use a finite value\1"),
    (r"(both )?(?=above |below )", "use a value "),
    (r"odd, ", "use an odd number, "),
    # whatever else is allowed is a thing, a number or a range
    (r"", "use "),
)
"""How what is allowed begins, and how the advice begins that stands for it: the first that fits."""

ASIDE = r"\(([^()]*); allowed: [^()]*\)"
"""What another message says in brackets: its advice is not that of the whole."""


def page_words(sentence: str) -> str:
    """Returns a sentence without the options of the command line that it names.

    "radius 30 mm given; allowed: 0 to 20 mm" becomes "radius 30 mm cannot be used. Use 0 to 20 mm".
    """
    sentence = re.sub(DROPPED, "", sentence)
    sentence = re.sub(TIMES, " × ", sentence)
    for named, instead in OPTIONS:
        sentence = re.sub(named, instead, sentence)
    sentence = re.sub(ASIDE, lambda found: f"({_what_happened(found[1])})", sentence)
    # where a message holds another one, the inner advice is the nearer one
    happened, *advices = sentence.split("; allowed: ")
    return f"{_what_happened(happened)}. {_advice(advices[0])}" if advices else sentence


def _what_happened(given: str) -> str:
    none = re.search(r"(^|[\s:])no ([a-z]+)[^:]*$", given)
    if none is None:
        instead = " cannot be used"
    else:
        instead = " were given" if re.search(r"[^s]s$", none[2]) else " was given"
    return re.sub(r" given$", instead, given)


def _advice(allowed: str) -> str:
    begins, instead = next(each for each in ADVICE if re.match(each[0], allowed))
    advice = re.sub(begins, instead, allowed, count=1)
    # what comes second is told as what comes first
    advice = re.sub(r"(, or) to (?=[a-z])", r"\1 ", advice)
    return advice[:1].upper() + advice[1:]
