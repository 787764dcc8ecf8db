"""``palpate bench fuzz-import``: what it damages, and what it calls a violation."""

from __future__ import annotations

import multiprocessing
import os
import signal
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from palpate.base.errors import OptionError
from palpate.bench.fuzz_import import Limits, Sample, damaged, measure, sample_of, samples_in, tried
from palpate.bench.structured_damage import restructured
from palpate.cli.commands import run

CASES = 15
KINDS = {"archive", "labels", "mesh", "pictures", "recipe", "scan", "scene", "series"}


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
    drawn = [sample_of(samples, seed) for seed in range(100)]
    assert drawn == [sample_of(samples, seed) for seed in range(100)]
    assert {each.kind for each in drawn} == KINDS


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

    monkeypatch.setattr("palpate.bench.fuzz_import._read", fail)
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
    samples = {each.path.suffix: each.path for each in samples_in(data_folder, tmp_path)}
    endings = {".dcm", ".gz", ".nii", ".mha", ".nrrd", ".zip", ".png", ".tif", ".palpate"}
    for ending in sorted(endings & samples.keys()):
        content = samples[ending].read_bytes()
        made = [restructured(content, np.random.default_rng(seed)) for seed in range(30)]
        assert len(set(made) - {content}) >= 8, ending
        # what it is can still be seen
        assert sum(each[:2] == content[:2] for each in made) >= 15, ending
