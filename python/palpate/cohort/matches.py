"""Cases by a pattern of paths, named by the part of the path that the pattern leaves open."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Sequence
from glob import glob, has_magic
from hashlib import sha256
from pathlib import Path

from palpate.base.errors import OptionError
from palpate.cohort.case import Case

__all__ = ["case_name", "cases_over"]

ENDING = re.compile(
    r"(\.nii\.gz|\.nii|\.nrrd|\.nhdr|\.mha|\.mhd|\.mnc|\.dcm|\.zip)$", re.IGNORECASE
)


def cases_over(pattern: str) -> list[Case]:
    """Returns a case for each path that matches, by name.

    A name does not depend on which other paths match, unless two names would be alike.

    Raises:
        OptionError: Nothing matches.
    """
    paths = sorted(glob(pattern, recursive=True))  # noqa: PTH207  # of absolute patterns too
    if not paths:
        raise OptionError(f"{pattern!r} matches no file; allowed: a pattern that does")
    cases = [
        Case(name, {"case": name, "scan": str(Path(path).absolute())}, Path(path).absolute())
        for path, name in zip(paths, _names(pattern, paths), strict=True)
    ]
    return sorted(cases, key=lambda case: case.name)


def case_name(text: str) -> str:
    """Returns a text as the name of a folder that every system takes."""
    name = re.sub(r"[^\w.-]+", "_", text, flags=re.ASCII).strip(".-_")
    return re.sub(r"\.(part|old|csv|html|json|lock)$", r"_\1", name) or "case"


def _names(pattern: str, paths: Sequence[str]) -> list[str]:
    """Returns a name for each path; those that would be alike end with a hash of their path."""
    plain = [case_name(_open_part(pattern, path)) for path in paths]
    # some systems take large and small letters for one
    alike = Counter(name.casefold() for name in plain)
    return [
        name
        if alike[name.casefold()] == 1
        else f"{name}-{sha256(path.encode('utf-8', 'surrogateescape')).hexdigest()[:8]}"
        for name, path in zip(plain, paths, strict=True)
    ]


def _open_part(pattern: str, path: str) -> str:
    """Returns what stands in a path from the first to the last wildcard of its pattern."""
    wanted, given = Path(pattern).parts, Path(path).parts
    marked = [number for number, part in enumerate(wanted) if has_magic(part)]
    if not marked:
        return ENDING.sub("", given[-1])
    after = len(wanted) - 1 - marked[-1]
    part = given[marked[0] : len(given) - after]
    return ENDING.sub("", "_".join(part)) if after == 0 else "_".join(part)
