"""A recipe over a BIDS data set: with ``palpate run --bids``, and as a BIDS App."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from made_cohort import write_block
from palpate.base.errors import OptionError
from palpate.base.package_version import package_version
from palpate.cli.commands import run
from palpate.cohort.bids import cases_of_bids


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A data set of three participants, one of them with two sessions, one with a CT."""
    data = tmp_path / "data"
    for name in (
        "sub-01/anat/sub-01_T1w", "sub-01/anat/sub-01_run-2_T2w",
        "sub-02/ses-a/anat/sub-02_ses-a_T1w", "sub-02/ses-b/anat/sub-02_ses-b_T1w",
        "sub-03/ct/sub-03_ct", "sub-01/anat/sub-01_mod-T1w_defacemask",
        "derivatives/other/sub-01/anat/sub-01_desc-x_T1w",
    ):  # fmt: skip
        write_block(data / f"{name}.nii.gz", 4)
    description = {"Name": "Blocks", "BIDSVersion": "1.10.0", "DatasetType": "raw"}
    (data / "dataset_description.json").write_text(json.dumps(description))
    (data / "README").write_text("Blocks of a test.")
    (tmp_path / "recipe.yaml").write_text("segment:\n  - threshold: 100\n    name: block\n")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def names(*participants: str, suffix: str | None = None) -> list[str]:
    cases = cases_of_bids(Path("data"), participants=participants, suffix=suffix)
    return [case.name for case in cases]


@pytest.mark.usefixtures("folder")
def test_cases_are_the_scans_of_participants_and_sessions() -> None:
    assert names() == [
        "sub-01_T1w", "sub-01_run-2_T2w", "sub-02_ses-a_T1w", "sub-02_ses-b_T1w", "sub-03_ct",
    ]  # fmt: skip
    assert names("sub-03", "01") == ["sub-01_T1w", "sub-01_run-2_T2w", "sub-03_ct"]
    assert names(suffix="ct") == ["sub-03_ct"]
    (case,) = cases_of_bids(Path("data"), participants=["02"], suffix="T1w")[1:]
    assert (case.variables["subject"], case.variables["session"]) == ("02", "b")
    with pytest.raises(OptionError, match=r"participant '4' given; allowed: 01, 02, 03"):
        names("4")
    with pytest.raises(OptionError, match=r"no scan of suffix 'bold'"):
        names(suffix="bold")
    with pytest.raises(OptionError, match=r"has no dataset_description\.json"):
        cases_of_bids(Path("data/sub-01"))
    write_block(Path("data/sub-01/anat/brain.nii.gz"), 4)
    with pytest.raises(OptionError, match=r"brain.nii.gz is no name of BIDS; allowed: sub-LABEL"):
        names()


def test_run_takes_a_data_set_and_the_labels_of_participants(folder: Path, capsys: Any) -> None:
    command = ["run", "recipe.yaml", "--bids", "data", "-o", "out", "--participant-label", "02"]
    assert run([*command, "--suffix", "T1w", "--dry-run"]) == 0
    told = capsys.readouterr().out
    assert told == "sub-02_ses-a_T1w\nsub-02_ses-b_T1w\n2 to run, 0 kept\n"
    assert run([*command, "--over", "data/*"]) == 2
    assert "--over and --bids given; allowed: one of" in capsys.readouterr().err
    assert run(["run", "recipe.yaml", "--participant-label", "02"]) == 2
    assert not (folder / "out").exists()


def test_a_bids_app_runs_participants_then_the_group(folder: Path, capsys: Any) -> None:
    level = ["bids", "data", "out", "participant"]
    assert run(level) == 2
    assert "no recipe given; allowed: --recipe FILE" in capsys.readouterr().err
    # as BIDS Apps are called: several labels after one option
    command = [*level, "--recipe", "recipe.yaml", "--participant_label", "01", "03"]
    assert run(command) == 0
    assert "3 done, 0 failed" in capsys.readouterr().out
    told = json.loads((folder / "out" / "dataset_description.json").read_text())
    assert told["DatasetType"] == "derivative"
    assert told["GeneratedBy"] == [{"Name": "Palpate", "Version": package_version()}]
    assert re.fullmatch(r"\d+\.\d+\.\d+", told["BIDSVersion"])
    assert told["SourceDatasets"] == [{"URL": (folder / "data").as_uri()}]
    assert (folder / "out" / "sub-03_ct" / "done.json").is_file()
    # a validator of BIDS takes a folder by a pattern without a slash at its end
    assert "sub-*_*" in (folder / "out" / ".bidsignore").read_text().splitlines()

    assert run([*level, "--recipe", "recipe.yaml", "--participant-label", "02"]) == 0
    (folder / "out" / "cohort.csv").unlink()
    assert run(["bids", "data", "out", "group"]) == 0
    table = (folder / "out" / "cohort.csv").read_text().splitlines()
    assert [line.partition(",")[0] for line in table[1:]] == names()
    assert run(["bids", "data", "elsewhere", "group"]) == 2
    assert run([*level, "02", "--recipe", "recipe.yaml"]) == 2
    assert "'02' given; allowed: labels after --participant-label" in capsys.readouterr().err


def test_a_validator_finds_no_error_in_the_derivative(folder: Path) -> None:
    level = ["bids", "data", "out", "participant", "--participant-label", "03"]
    assert run([*level, "--recipe", "recipe.yaml"]) == 0
    assert run(["bids", "data", "out", "group"]) == 0
    assert errors(folder / "out") == set()
    # it would find one: what it is told to leave out, and what a description must have
    hidden = (folder / "out" / ".bidsignore").read_text()
    (folder / "out" / ".bidsignore").write_text(hidden.replace("index.html", ""))
    description = folder / "out" / "dataset_description.json"
    description.write_text(description.read_text().replace('"Name"', '"Title"'))
    assert errors(folder / "out") == {"NOT_INCLUDED", "JSON_SCHEMA_VALIDATION_ERROR"}


def errors(data: Path) -> set[str]:
    """Returns what the BIDS validator takes for wrong in a data set."""
    validator = Path(sys.executable).with_name("bids-validator-deno")
    command = [str(validator), "--format", "json", str(data)]
    told = subprocess.run(command, check=False, capture_output=True, text=True).stdout
    issues = json.loads(told)["issues"]["issues"]
    return {issue["code"] for issue in issues if issue["severity"] == "error"}
