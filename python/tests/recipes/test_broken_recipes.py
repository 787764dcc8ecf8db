"""``palpate run`` on broken recipes, tables, scans and scenes: done, or one line that says why.

A long form (PALPATE_LONG) tries many more.
"""

from __future__ import annotations

import json
import os

import pytest
from broken_runs import KINDS, ended

CASES = 1500 if os.environ.get("PALPATE_LONG") else 24
UNCLEAR = ("Traceback", "\x1b[2J", "the system: ", "object has no", "NoneType", "Error:")


@pytest.mark.parametrize("kind", KINDS)
def test_what_is_broken_is_done_or_told_in_a_line(
    kind: str, tmp_path_factory: pytest.TempPathFactory
) -> None:
    first = int(os.environ.get("PALPATE_SEED", "1"))
    wrong = []
    for seed in range(first, first + CASES // len(KINDS)):
        folder = tmp_path_factory.mktemp(kind)
        command, code, said = ended(kind, seed, folder)
        lines = [line for line in said.split("\n") if line.startswith("palpate: ")]
        errors = [line for line in lines if not line.startswith("palpate: warning: ")]
        fits = len(errors) == (code != 0) and code in {0, 2, 3}
        if not fits or any(each in said for each in UNCLEAR):
            wrong.append((seed, command, code, said[-1500:]))
    assert wrong == [], json.dumps(wrong, indent=1)
