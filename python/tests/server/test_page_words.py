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
from palpate.server.page_words import page_words
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


@pytest.mark.parametrize(
    ("given", "told"),
    [
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
    ],
)
def test_the_rest_of_a_sentence_stays(given: str, told: str) -> None:
    assert page_words(given) == told


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
