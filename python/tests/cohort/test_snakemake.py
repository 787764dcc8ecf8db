"""The Snakemake rule that the docs show: shares fail alone, and the same command runs the rest."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

from made_cohort import BLOCK_RECIPE, write_block

DOCUMENT = Path(__file__).parents[3] / "docs" / "use" / "recipes.md"


def rule(shares: int) -> str:
    """Returns the rule as the document has it, with another number of shares."""
    block = re.search(
        r"As a rule of \[Snakemake\].*?```python\n(.*?)```", DOCUMENT.read_text(), re.S
    )
    assert block is not None
    text, count = re.subn(r"^SHARES = 8$", f"SHARES = {shares}", block[1], flags=re.M)
    assert count == 1
    return text


def snakemake(folder: Path) -> subprocess.CompletedProcess[str]:
    """Runs what the folder's Snakefile has, as the document says."""
    own = Path(sys.executable).parent
    settings = {
        "PATH": f"{own}{os.pathsep}{os.environ['PATH']}",
        # what it keeps for itself
        "XDG_CACHE_HOME": str(folder / "cache"),
        "XDG_CONFIG_HOME": str(folder / "config"),
    }
    return subprocess.run(
        [sys.executable, "-m", "snakemake", "--cores", "2", "--keep-going"],
        check=False,
        capture_output=True,
        cwd=folder,
        env={**os.environ, **settings},
        text=True,
    )


def test_a_share_fails_alone_and_the_same_command_runs_what_is_missing(tmp_path: Path) -> None:
    for number in (1, 2, 3):
        write_block(tmp_path / "data" / f"p{number}" / "ct.nii.gz", 3 + number)
    broken = tmp_path / "data" / "p2" / "ct.nii.gz"
    whole = broken.read_bytes()
    broken.write_bytes(b"")
    (tmp_path / "recipe.yaml").write_text(BLOCK_RECIPE, "utf-8")
    (tmp_path / "Snakefile").write_text(rule(shares=2), "utf-8")
    out = tmp_path / "out"

    ran = snakemake(tmp_path)
    assert ran.returncode != 0
    assert "p2 failed: " in ran.stderr, ran.stderr
    assert [path.name for path in (tmp_path / "shares").iterdir()] == ["1.done"]
    assert sorted(path.parent.name for path in out.glob("*/done.json")) == ["p1", "p3"]

    # as where the share that failed was the last to end
    (out / "index.html").touch()
    broken.write_bytes(whole)
    before = (out / "p1" / "done.json").read_bytes()
    ran = snakemake(tmp_path)
    assert ran.returncode == 0, ran.stderr
    assert sorted(path.parent.name for path in out.glob("*/done.json")) == ["p1", "p2", "p3"]
    assert (out / "p1" / "done.json").read_bytes() == before
    assert len((out / "cohort.csv").read_text().splitlines()) == 1 + 3
