"""``palpate bench fuzz-import``: what it damages, and what it calls a violation."""

from __future__ import annotations

import multiprocessing
import os
import signal
from contextlib import suppress
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from palpate.base.errors import OptionError
from palpate.bench import fuzz_dicom, fuzz_import
from palpate.bench.fuzz_import import Limits, damaged, measure, sample_of, tried
from palpate.bench.fuzz_samples import Sample, samples_in
from palpate.bench.structured_damage import restructured
from palpate.cli.commands import run
from pydicom import dcmread

CASES = 15
KINDS = {
    "archive", "dicom", "labels", "mesh", "neuro", "pictures", "recipe", "scan", "scene",
    "segments", "series",
}  # fmt: skip
MADE = ("dicom", "neuro", "segments")
"""Kinds of which all samples are made."""


def test_damage_follows_from_the_seed_alone() -> None:
    content = bytes(range(256)) * 40
    made = [damaged(content, seed) for seed in range(200)]
    assert made == [damaged(content, seed) for seed in range(200)]
    assert len(set(made)) > 190
    assert any(len(each) < len(content) // 2 for each in made)
    assert any(len(each) > len(content) for each in made)
    assert damaged(b"", 3) == b""


@pytest.mark.data
def test_every_reader_has_samples(data_folder: Path, tmp_path: Path) -> None:
    samples = samples_in(data_folder, tmp_path)
    assert {each.kind for each in samples} == KINDS
    endings = {each.path.suffix for each in samples}
    assert endings >= {".dcm", ".gz", ".nii", ".mha", ".mhd", ".nrrd", ".nhdr", ".zip", ".stl"}
    assert endings >= {".mgh", ".mgz", ".hdr", ".img", ".mnc", ".PAR", ".REC", ".HEAD", ".BRIK"}
    drawn = [sample_of(samples, seed) for seed in range(100)]
    assert drawn == [sample_of(samples, seed) for seed in range(100)]
    assert {each.kind for each in drawn} == KINDS


@pytest.mark.data
def test_made_samples_are_the_same_on_every_run_and_can_be_read(
    data_folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    one, other = tmp_path / "one", tmp_path / "other"
    one.mkdir()
    other.mkdir()
    samples = [each for each in samples_in(data_folder, one) if each.kind in MADE]
    again = [each for each in samples_in(data_folder, other) if each.kind in MADE]
    assert [each.path.read_bytes() for each in samples] == [
        each.path.read_bytes() for each in again
    ]
    monkeypatch.setattr("palpate.bench.fuzz_import.damaged", lambda content, _: content)
    for number, each in enumerate(samples):
        # rows and columns of nibabel's own are sheared
        if each.path.name != "test.mgz":
            place = tmp_path / f"{number}"
            place.mkdir()
            fuzz_import.read_sample(each, fuzz_import.laid(each, 1, place))


def test_of_a_kind_that_is_not_there_is_told_which_are(tmp_path: Path) -> None:
    (tmp_path / "a.stl").write_bytes(b"solid")
    with pytest.raises(OptionError, match="kind 'x' given; allowed: dicom, labels, mesh, neuro"):
        measure(tmp_path, cases=1, only=["neuro", "x"])
    found = measure(tmp_path, cases=2, only=["segments"])
    assert found.cases == 2


class Ends:
    """Ends the process that takes it up; or waits there for ever."""

    def __init__(self, *, at_once: bool) -> None:
        self.at_once = at_once

    def __reduce__(self) -> tuple[Any, tuple[Any, ...]]:
        return (os._exit, (3,)) if self.at_once else (signal.pause, ())


@pytest.mark.parametrize(
    ("scan", "limits", "outcome"),
    [
        (Ends(at_once=True), Limits(), "crash: the process ended with code 3"),
        (Ends(at_once=False), Limits(wall=0.0), "hang: more than 30 s of work"),
    ],
    ids=["crash", "hang"],
)
def test_what_is_no_sentence_is_a_violation(
    tmp_path: Path, scan: Any, limits: Limits, outcome: str
) -> None:
    path = tmp_path / "some.nii"
    path.write_bytes(bytes(400))
    context = multiprocessing.get_context("forkserver")
    sample = Sample(path, "labels", scan)
    assert tried(sample, 1, limits=limits, context=context).startswith(outcome)


def test_a_reader_that_fails_is_a_violation(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: Any) -> None:
        raise ZeroDivisionError

    monkeypatch.setattr("palpate.bench.fuzz_import.read_sample", fail)
    path = tmp_path / "some.nii"
    path.write_bytes(bytes(400))
    # a forked child has the failing reader too
    context: Any = multiprocessing.get_context("fork")
    found = tried(Sample(path, "scan", None), 1, limits=Limits(), context=context)
    assert found.startswith("uncaught: Traceback")


@pytest.mark.data
def test_damaged_files_are_read_or_refused(data_folder: Path) -> None:
    found = measure(data_folder, seed=1, cases=CASES)
    assert found.cases == CASES
    assert found.violations == []
    assert found.outcomes["read"] > 0
    assert found.outcomes["refused"] > CASES // 4


def test_without_files_to_damage_there_is_nothing_to_measure(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(OptionError, match="holds no scan, label or mesh"):
        measure(tmp_path, cases=1)
    assert run(["bench", "fuzz-import", str(tmp_path), "--cases", "1", "--minutes", "1"]) == 2
    assert "allowed: one of both" in capsys.readouterr().err


@pytest.mark.data
def test_structured_damage_knows_files(data_folder: Path, tmp_path: Path) -> None:
    listed = samples_in(data_folder, tmp_path)
    samples = {each.path.suffix: each.path for each in listed if each.kind not in MADE}
    endings = {".dcm", ".gz", ".nii", ".mha", ".nrrd", ".zip", ".png", ".tif", ".palpate"}
    known = [path for ending, path in samples.items() if ending in endings]
    voxels = (".img", ".REC", ".BRIK", "BRIK.gz")
    known += [each.path for each in listed if each.kind in MADE]
    for path in known:
        content, ending = path.read_bytes(), path.name
        if ending.endswith(voxels) or content[:4] == b"\x89HDF":
            continue
        made = [restructured(content, np.random.default_rng(seed)) for seed in range(30)]
        assert len(set(made) - {content}) >= 8, ending
        # what it is can still be seen
        assert sum(each[:2] == content[:2] for each in made) >= 15, ending


@pytest.mark.filterwarnings("ignore:::pydicom")
def test_damage_inside_sequences_leaves_what_follows_readable(tmp_path: Path) -> None:
    path = fuzz_dicom.dicom_folders(tmp_path)["enhanced-pet"][0]
    content = path.read_bytes()
    sequences, pixels = content.find(b"\xfe\xff\x00\xe0"), content.rfind(b"\xe0\x7f\x10\x00")
    nested = readable = 0
    for seed in range(300):
        made = restructured(content, np.random.default_rng(seed))
        pairs = enumerate(zip(content, made, strict=False))
        place = next((at for at, (one, other) in pairs if one != other), 0)
        nested += sequences < place < pixels
        with suppress(Exception):
            read = dcmread(BytesIO(made), force=True)
            readable += "PixelData" in read and len(read.PerFrameFunctionalGroupsSequence) == 3
    assert nested > 100
    assert readable > 150
