"""The check of words finds places of one machine, and nothing else."""

from __future__ import annotations

from pathlib import Path

import pytest
from check_headers import lacks_header
from check_words import forbidden_words


@pytest.mark.parametrize(
    "line",
    [
        'path = "/home/someone/scan.nii"',
        "see /root/notes",
        "DATA=/mnt/data",
        '"resolved": "https://example.org/three/-/three.tgz"',
        "--index-url https://example.org/simple",
        "fetch https://example.org/a-1.0.whl first",
        "// TODO: later",
    ],
)
def test_places_of_one_machine_are_found(line: str) -> None:
    assert [place[0] for place in forbidden_words(f"first line\n{line}\n")] == [2]


@pytest.mark.parametrize(
    "line",
    [
        "crates/engine/src/home/queue.rs",
        "../shared/data",
        'registry+https://github.com/rust-lang/crates.io-index"',
        "the homework",
    ],
)
def test_other_paths_are_left_alone(line: str) -> None:
    assert forbidden_words(line) == []


@pytest.mark.parametrize(
    ("name", "text", "bare"),
    [
        ("a.rs", "//! What it is.\n", False),
        ("a.rs", "use std::fmt;\n", True),
        ("a.py", '#!/usr/bin/env python\n"""What it is."""\n', False),
        ("a.py", "import sys\n", True),
        ("a.glsl", "#version 300 es\n// What it is.\n", False),
        ("a.svelte", "<script>\n</script>\n", True),
        ("a.md", "anything", False),
    ],
)
def test_a_file_without_a_header_is_found(
    tmp_path: Path, name: str, text: str, *, bare: bool
) -> None:
    file = tmp_path / name
    file.write_text(text)
    assert lacks_header(file) == bare
