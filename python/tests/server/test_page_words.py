"""Sentences for the page name no options of the command line."""

from __future__ import annotations

import ast
import re
from pathlib import Path
from tempfile import TemporaryDirectory

import nibabel
import numpy as np
import palpate
import pytest
from palpate.server.messages.hello import scan_of
from palpate.server.page_words import ADVICE, ASIDE, OPTIONS, page_words
from running_server import LibraryClient

PACKAGE = Path(palpate.__file__).parent
ELSEWHERE = ("volumes/mesh_read.py", "volumes/material.py")
"""Meshes and materials by options are of the command line only."""


def sentences() -> list[str]:
    """Returns all texts of reading that name an option, values in them as a number."""
    found = []
    for room in ("io", "volumes", "labels"):
        for file in sorted((PACKAGE / room).rglob("*.py")):
            if file.as_posix().endswith(ELSEWHERE):
                continue
            for node in ast.walk(ast.parse(file.read_text())):
                text = _text(node)
                if re.search(r"`[a-z_]+=", text):
                    found.append(text)
    return found


def _text(node: ast.AST) -> str:
    if isinstance(node, ast.JoinedStr):
        return "".join(
            str(part.value) if isinstance(part, ast.Constant) else "6" for part in node.values
        )
    return node.value if isinstance(node, ast.Constant) and isinstance(node.value, str) else ""


def test_no_sentence_of_reading_names_an_option_on_the_page() -> None:
    given = sentences()
    assert len(given) > 10
    assert [page_words(each) for each in given if re.search(r"`[a-z_]+=", page_words(each))] == []


EXACT: list[tuple[str, str]] = [
    (
        "the unit of the values is unknown; give `unit=HU` if it is HU",
        "the unit of the values is unknown",
    ),
    (
        "a holds 2 series; choose one with `series=NUMBER` or its UID: [1] x",
        "a holds 2 series; choose one: [1] x",
    ),
    (
        "a is a 4-D image of 6 volumes; allowed: one of them, with `frame=NUMBER` from 1 to 6",
        "a is a 4-D image of 6 volumes. Use one of them",
    ),
    ("allowed: at most 8, or more with `max_voxels=COUNT`", "allowed: at most 8"),
    (
        "allowed: the scan's voxels, or others with `resample=True`",
        "allowed: the scan's voxels",
    ),
    ("radius 30 mm given; allowed: 0 to 20 mm", "radius 30 mm cannot be used. Use 0 to 20 mm"),
    ("no seed given; allowed: one or more", "no seed was given. Use one or more"),
    (
        "skin is locked; allowed: to unlock it, or hide it",
        "skin is locked. Unlock it, or hide it",
    ),
    (
        "a stroke without a tool given; allowed: choosing a tool first",
        "a stroke without a tool cannot be used. Choose a tool first",
    ),
    ("no scan is open; allowed: open one first", "no scan is open. Open one first"),
    (
        "segments came or went meanwhile; allowed: once more",
        "segments came or went meanwhile. Try once more",
    ),
    (
        "it is deformed; allowed: after it is laid as it was",
        "it is deformed. Possible: after it is laid as it was",
    ),
    ("a -- b, -1 to --1; slices are missing", "a -- b, -1 to --1; slices are missing"),
    # no advice but an option
    (
        "its voxels may have any size; allowed: with `voxel_size=X,Y,Z` [mm], such as 1,1,2",
        "its voxels may have any size",
    ),
    (
        "a has 3 holes; allowed: a closed mesh, `close=True` to close them, or `fill=1,2` for one",
        "a has 3 holes. Use a closed mesh, close to close them, or fill 1,2 for one",
    ),
    # more than one of what is not there
    (
        "scripted path: no samples given; allowed: at least one",
        "scripted path: no samples were given. Use at least one",
    ),
    ("no address given; allowed: one", "no address was given. Use one"),
    # verbs
    (
        "skin is locked; allowed: to unlock it, or to hide it meanwhile",
        "skin is locked. Unlock it, or hide it meanwhile",
    ),
    (
        "nothing would be left of skin; allowed: a smaller deviation, or to hide it meanwhile",
        "nothing would be left of skin. Use a smaller deviation, or hide it meanwhile",
    ),
    ("a.nii is not there; allowed: put it back", "a.nii is not there. Put it back"),
    # where and when
    (
        "offset 1,2 given, and a.xml places its middle; allowed: without an offset",
        "offset 1,2 given, and a.xml places its middle. Possible: without an offset",
    ),
    ("a tells b twice; allowed: once", "a tells b twice. Possible: once"),
    (
        "images have text in their pixels; allowed: `pixels_checked=True` once you have looked",
        "images have text in their pixels. Use the tick at Export once you have looked",
    ),
    (
        "a is in b; allowed: `keep_identity=True` for an archive that may know the patient",
        "a is in b. Use a DICOM format that names the patient",
    ),
    # values by what they are like
    (
        "stiffness is -1 N/mm; allowed: finite, 0 to 4",
        "stiffness is -1 N/mm. Use a finite value, 0 to 4",
    ),
    (
        "direction 0, 0, 0 given; allowed: finite and not zero",
        "direction 0, 0, 0 cannot be used. Use a finite value and not zero",
    ),
    (
        "radius 0 mm given; allowed: above 0 to 20 mm",
        "radius 0 mm cannot be used. Use a value above 0 to 20 mm",
    ),
    ("0 and 1 given; allowed: both above 0", "0 and 1 cannot be used. Use a value above 0"),
    (
        "a box of 4 given; allowed: odd, 3 to 9",
        "a box of 4 cannot be used. Use an odd number, 3 to 9",
    ),
    # a message in another one
    (
        "a.h5 cannot be read (radius 5 given; allowed: 0 to 3); allowed: whole files",
        "a.h5 cannot be read (radius 5 cannot be used). Use whole files",
    ),
    (
        "step 2: radius 5 mm given; allowed: 0 to 3 mm; allowed: other steps",
        "step 2: radius 5 mm cannot be used. Use 0 to 3 mm",
    ),
]


@pytest.mark.parametrize(("given", "told"), EXACT)
def test_a_sentence_becomes_exactly_this_one(given: str, told: str) -> None:
    assert page_words(given) == told
    # also where it was told before
    assert page_words(told) == told


def test_every_pattern_has_an_example() -> None:
    given = [each for each, _ in EXACT]
    advices = [each.partition("; allowed: ")[2] for each in given if "; allowed: " in each]
    begins = [next(begin for begin, _ in ADVICE if re.match(begin, advice)) for advice in advices]
    assert {begin for begin, _ in ADVICE} - set(begins) == set()
    for named, _ in OPTIONS:
        assert any(re.search(named, each) for each in given), named
    assert any(re.search(ASIDE, each) for each in given)


CLUMSY = (
    r"allowed: ",
    r"\. Use (with|without|above|below|finite,|in|of|to|or|odd)\b",
    r"or to [a-z]",
    r"\bno [a-z]+[^s]s was given",
    r"[.:;,] *[.;,)]",
    r"  ",
)
"""What no sentence has that a person would write."""


def test_no_message_of_the_package_becomes_clumsy_or_changes_twice() -> None:
    told = {page_words(each) for each in messages()}
    assert len(told) > 300
    assert [each for each in told if any(re.search(clumsy, each) for clumsy in CLUMSY)] == []
    assert [each for each in told if page_words(each) != each] == []


def messages() -> list[str]:
    """Returns all messages with an advice that work for a page may meet."""
    found = []
    for file in sorted(PACKAGE.rglob("*.py")):
        if file.relative_to(PACKAGE).parts[0] in {"bench", "cli", "_core.pyi"}:
            continue
        tree = ast.parse(file.read_text())
        parts = {
            id(part)
            for text in ast.walk(tree)
            if isinstance(text, ast.JoinedStr)
            for part in text.values
        }
        texts = (_text(node) for node in ast.walk(tree) if id(node) not in parts)
        found += [each for each in texts if re.search(r"^[^\n]*\w; allowed: \w[^\n]*$", each)]
    return found


def test_warnings_and_failures_on_the_page_name_no_option(
    client: LibraryClient, tmp_path: Path
) -> None:
    path = tmp_path / "a.nii.gz"
    nibabel.save(nibabel.Nifti1Image(np.zeros((3, 4, 5), np.int16), None), path)
    client.job("open", {"path": str(path)})
    opened = client.workbench.opened
    assert opened is not None
    assert any("`unit=" in each for each in opened.session.scene.volume.warnings)
    told = scan_of(opened.session.scene.volume).warnings
    assert "the unit of the values is unknown" in told
    assert not any("`" in each for each in told)
    (tmp_path / "a.txt").write_text("no scan")
    (failed,) = client.job("open", {"path": str(tmp_path / "a.txt")})
    assert "or pictures of slices" in failed["reason"]
    assert "`" not in failed["reason"]


def test_a_dropped_file_is_named_as_the_person_knows_it() -> None:
    with TemporaryDirectory(prefix="palpate-") as folder:
        told = page_words(f"{folder}/head/slice 1.dcm: no pixels given; allowed: DICOM images")
    assert told.startswith("head/slice 1.dcm: ")
    assert folder not in told
