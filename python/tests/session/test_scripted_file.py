"""Paths in files: what is read, and what is refused."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from palpate.base.errors import OptionError
from palpate.session.scripted_file import read_path

ROWS = [[0.0, 1.0, 2.0, 3.0], [0.5, -1.5, 2.0, 3e1]]


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("a.csv", "0,1,2,3\n0.5,-1.5,2,3e1\n"),
        ("a.csv", "\ufefftime_s,x_mm,y_mm,z_mm\r\n0,1,2,3\r\n\r\n0.5,-1.5,2,30\r\n"),
        ("a.JSON", "[[0, 1, 2, 3], [0.5, -1.5, 2, 30]]"),
        ("a.json", '{"path": [[0, 1, 2, 3], [0.5, -1.5, 2.0, 3e1]]}'),
    ],
)
def test_rows_are_read(tmp_path: Path, name: str, text: str) -> None:
    file = tmp_path / name
    file.write_text(text, encoding="utf-8", newline="")
    np.testing.assert_array_equal(read_path(file).rows, ROWS)


@pytest.mark.parametrize(
    ("name", "text", "reason"),
    [
        ("a.txt", "0,1,2,3\n", "allowed: a .csv or .json file"),
        ("a.csv", "", "is empty"),
        ("a.csv", "time,x,y,z\n", "is empty"),
        ("a.csv", "0,1,2\n", "row 1 has 3 numbers"),
        ("a.csv", "0,1,2,3\n1,a,2,3\n", "cannot be read"),
        ("a.csv", "0,1,2,nan\n", "NaN"),
        ("a.csv", "1,1,2,3\n", "rise from 0"),
        ("a.csv", "0,1,2,3\n0,1,2,3\n", "rise from 0"),
        ("a.json", "", "cannot be read"),
        ("a.json", "[]", "is empty"),
        ("a.json", '{"path": []}', "cannot be read"),
        ("a.json", '{"way": [[0, 1, 2, 3]]}', "cannot be read"),
        ("a.json", "[[0, 1, 2]]", "cannot be read"),
        ("a.json", '[["0", 1, 2, 3]]', "cannot be read"),
    ],
)
def test_what_is_no_path_is_refused(tmp_path: Path, name: str, text: str, reason: str) -> None:
    file = tmp_path / name
    file.write_text(text)
    with pytest.raises(OptionError, match=reason) as refused:
        read_path(file)
    assert name in str(refused.value)


def test_bytes_that_are_no_text_are_refused(tmp_path: Path) -> None:
    file = tmp_path / "a.csv"
    file.write_bytes(b"\xff\xfe\x00\x01")
    with pytest.raises(OptionError, match="cannot be read"):
        read_path(file)
