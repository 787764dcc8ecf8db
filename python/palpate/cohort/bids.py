"""Cases of a BIDS data set, and what makes an output folder a BIDS derivative.

Source: Brain Imaging Data Structure 1.10 (bids-specification.readthedocs.io): names of files,
``dataset_description.json``; CT as in its proposal BEP 024, ``sub-01/ct/sub-01_ct.nii.gz``.
"""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from pathlib import Path

from palpate.base.errors import OptionError
from palpate.base.package_version import package_version
from palpate.base.whole_file import whole_file
from palpate.cohort.case import Case
from palpate.cohort.output_folder import CohortFolder

__all__ = ["cases_of_bids", "describe_derivative"]

DESCRIPTION = "dataset_description.json"
VERSION = "1.10.0"
DATA_TYPES = ("anat", "ct")
"""Folders that hold scans of a body."""
NO_SCANS = ("defacemask", "mask", "dseg", "probseg")
"""Suffixes of images in them that are none."""

NAME = re.compile(
    r"sub-(?P<subject>[A-Za-z0-9]+)(_ses-(?P<session>[A-Za-z0-9]+))?(_[a-z]+-[A-Za-z0-9+]+)*"
    r"_(?P<suffix>[A-Za-z0-9]+)\.nii(\.gz)?"
)
"""Name of an image: entities, and what kind it is."""

IGNORED = "sub-*_*\ncohort.*\nindex.html\n"
"""Names in the output that BIDS has no rules for."""


def cases_of_bids(
    folder: Path, *, participants: Sequence[str] = (), suffix: str | None = None
) -> list[Case]:
    """Returns a case for each scan of a data set, by name.

    A case is called as its file, such as ``sub-01_ses-2_T1w``. Its variables are ``case``,
    ``scan``, ``subject``, ``session`` ("" where there is none) and ``suffix``.

    Args:
        folder: The data set.
        participants: Labels of the participants, with or without ``sub-``; by default all.
        suffix: What kind of image, such as T1w or ct; by default all scans.

    Raises:
        OptionError: It is no BIDS data set, or has no such participant or scan.
    """
    if not (folder / DESCRIPTION).is_file():
        raise OptionError(f"{folder} has no {DESCRIPTION}; allowed: the folder of a BIDS data set")
    known = sorted(path.name.removeprefix("sub-") for path in folder.glob("sub-*/"))
    wanted = [label.removeprefix("sub-") for label in participants] or known
    for label in wanted:
        if label not in known:
            raise OptionError(f"participant {label!r} given; allowed: {', '.join(known) or 'none'}")
    cases = [
        case
        for label in sorted(set(wanted))
        for path in _images(folder / f"sub-{label}")
        if (case := _case(path, suffix)) is not None
    ]
    if not cases:
        kind = "" if suffix is None else f" of suffix {suffix!r}"
        raise OptionError(
            f"{folder} has no scan{kind}; allowed: images in {' or '.join(DATA_TYPES)} of its "
            "participants"
        )
    return sorted(cases, key=lambda case: case.name)


def describe_derivative(folder: CohortFolder, source: Path) -> None:
    """Says in an output folder that it is a BIDS derivative, of which data set and by what.

    Raises:
        OSError: The disk refuses it.
    """
    told = {
        "Name": "Palpate",
        "BIDSVersion": VERSION,
        "DatasetType": "derivative",
        "GeneratedBy": [{"Name": "Palpate", "Version": package_version()}],
        "SourceDatasets": [{"URL": source.resolve().as_uri()}],
    }
    text = json.dumps(told, indent=2, ensure_ascii=False) + "\n"
    for name, content in ((DESCRIPTION, text), (".bidsignore", IGNORED)):
        with whole_file(folder.of(name)) as unfinished:
            unfinished.write_text(content, "utf-8")


def _images(subject: Path) -> list[Path]:
    places = [subject, *sorted(subject.glob("ses-*/"))]
    return [
        path
        for place in places
        for kind in DATA_TYPES
        for path in sorted((place / kind).glob("*.nii*"))
    ]


def _case(path: Path, suffix: str | None) -> Case | None:
    """Returns the case of an image; None where it is not meant.

    Raises:
        OptionError: Its name is not one of BIDS.
    """
    named = NAME.fullmatch(path.name)
    if named is None:
        raise OptionError(
            f"{path} is no name of BIDS; allowed: sub-LABEL, entities and a suffix, such as "
            "sub-01_T1w.nii.gz"
        )
    if named["suffix"] in NO_SCANS or suffix not in (None, named["suffix"]):
        return None
    name = path.name.removesuffix(".gz").removesuffix(".nii")
    variables = {
        "case": name,
        "scan": str(path.absolute()),
        "subject": named["subject"],
        "session": named["session"] or "",
        "suffix": named["suffix"],
    }
    return Case(name, variables, path.absolute())
