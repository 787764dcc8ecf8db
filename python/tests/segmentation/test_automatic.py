"""``palpate segment --auto``: the program is called as its own manual says, or missed by name."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from palpate.cli.commands import run
from palpate.io.reading import read
from palpate.labels.labels import read_labels

PROGRAM = """#!{python}
# stands for the program: the same arguments, the same folder of masks, and no weights
import sys
from pathlib import Path
import SimpleITK
arguments = dict(zip(sys.argv[1::2], sys.argv[2::2]))
if "{fails}":
    sys.exit("{fails}")
scan = SimpleITK.ReadImage(arguments["-i"])
folder = Path(arguments["-o"])
folder.mkdir()
for name, low in (("spleen", 300), ("liver", 5000)):
    mask = SimpleITK.BinaryThreshold(scan, low, 32000, 1, 0)
    SimpleITK.WriteImage(mask, str(folder / (name + ".nii.gz")))
"""


@pytest.fixture
def scan(write_image: Any) -> Path:
    values = np.zeros((10, 12, 14), np.int16)
    values[3:7, 4:9, 5:11] = 400
    path: Path = write_image(values, "scan.mha", spacing=(1.0, 1.5, 2.0))
    return path


def install(folder: Path, monkeypatch: pytest.MonkeyPatch, fails: str = "") -> None:
    program = folder / "bin" / "TotalSegmentator"
    program.parent.mkdir()
    program.write_text(PROGRAM.format(python=sys.executable, fails=fails))
    program.chmod(0o755)
    monkeypatch.setenv("PATH", f"{program.parent}{os.pathsep}{os.environ['PATH']}")


def test_what_it_finds_is_written_under_its_names(
    scan: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Any
) -> None:
    install(tmp_path, monkeypatch)
    out = tmp_path / "organs.seg.nrrd"
    assert run(["segment", str(scan), "--auto", "-o", str(out)]) == 0
    volume = read(scan)
    (spleen,) = (one.segment for one in read_labels(out, volume).labels)
    assert spleen.name == "spleen"
    np.testing.assert_array_equal(spleen.mask() != 0, volume.array == 400)
    assert "1 segment is empty: liver" in capsys.readouterr().err


def test_a_person_without_it_is_told_how_to_install_it(
    scan: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Any
) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    assert run(["segment", str(scan), "--auto", "-o", str(tmp_path / "out.mha")]) == 2
    assert "pip install TotalSegmentator" in capsys.readouterr().err
    assert not (tmp_path / "out.mha").exists()


def test_what_it_says_where_it_fails_is_passed_on(
    scan: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Any
) -> None:
    install(tmp_path, monkeypatch, fails="no weights here")
    assert run(["segment", str(scan), "--auto", "-o", str(tmp_path / "out.mha")]) == 2
    assert "no weights here" in capsys.readouterr().err
