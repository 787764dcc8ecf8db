"""``palpate bench stress``: random fast moves with every guarantee of touch checked at each.

Runs are determined by a seed and a number, so that these two identify a violation and ``--replay``
repeats it, whatever the number of threads. The loops and the checker run in the engine.
"""

from __future__ import annotations

import json
import os
import time
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any, Self, cast

from palpate import _core
from palpate.base.errors import OptionError
from palpate.base.progress import Progress, silent
from palpate.base.whole_file import whole_file
from palpate.bench.goals import GOALS
from palpate.bench.report import Row, row_of
from palpate.bench.results import StressResult, StressViolation
from palpate.volumes.segment import Segment

__all__ = ["Found", "Plan", "again", "measure", "rows_of", "write_case"]

CHUNK_SECONDS = 2.0
"""Time between two calls of the engine, for Ctrl-C and progress [s]; a core may idle there."""

MOST_RUNS = 2**32


@dataclass(frozen=True)
class Plan:
    """Which runs are made."""

    seed: int
    model: str = "exact"
    data: str | None = None
    """Path of the scan; None for the phantom."""
    run: int = 0
    """Number of the first run."""

    def __post_init__(self) -> None:
        """Refuses seeds that the engine does not accept."""
        if not (0 <= self.seed < 2**64 and 0 <= self.run < MOST_RUNS):
            raise OptionError(f"seed {self.seed} given; allowed: 0 to {2**64 - 1}")

    @classmethod
    def of_file(cls, path: Path) -> Self:
        """Returns the run of a violation from its file.

        Raises:
            OptionError: The file is not such a case.
        """
        try:
            content = json.loads(path.read_text(encoding="utf-8"))
            data = content["data"]
            return cls(
                seed=int(content["seed"]),
                model=str(content["model"]),
                data=None if data is None else str(data),
                run=int(content["run"]),
            )
        except (KeyError, TypeError, ValueError) as error:
            raise OptionError(
                f"{path} is no case of palpate bench stress ({error}); "
                "allowed: a file that it wrote"
            ) from None


@dataclass(frozen=True)
class Found:
    """Results of some runs."""

    plan: Plan
    moves: int = 0
    contacts: int = 0
    edits: int = 0
    poses: int = 0
    cuts: int = 0
    seconds: float = 0.0
    violation: StressViolation | None = None

    def message(self) -> str:
        """Says what was violated."""
        if self.violation is None:
            return "no guarantee violated"
        return (
            f"guarantee {self.violation['guarantee']} violated in run {self.violation['run']} "
            f"of seed {self.plan.seed} after {self.violation['move']} moves: "
            f"{self.violation['what']}\n{self.violation['plan']}"
        )


def measure(
    bone: Segment,
    plan: Plan,
    *,
    moves: int,
    threads: int | None = None,
    progress: Progress = silent,
) -> Found:
    """Makes runs until there are so many moves, or a violation.

    Args:
        bone: Parts of it are some of the worlds.
        plan: Seed and model.
        moves: Least number of moves.
        threads: Number of threads; the default is the number of cores.
        progress: Takes the progress.

    Raises:
        OptionError: The number of moves or of threads or the model is not allowed.
    """
    if moves < 1:
        raise OptionError(f"{moves} moves given; allowed: 1 or more")
    found = Found(plan)
    if threads is None:
        threads = os.cpu_count() or 1
    run, count = plan.run, 8
    begun = time.monotonic()
    while found.moves < moves and found.violation is None:
        progress(f"{found.moves / 1e6:.1f} M moves, no violation", found.moves / moves)
        chunk_begun = time.monotonic()
        found = _and(found, _runs(bone, plan, run=run, count=count, threads=threads))
        run += count
        # as many runs as fit between two looks at the keyboard
        took = time.monotonic() - chunk_begun
        count = max(4, min(1000, round(count * CHUNK_SECONDS / max(took, 1e-3))))
        # no more than needed, once the moves of a run are known
        left = moves - found.moves
        per_run = max(1, found.moves // (run - plan.run))
        count = max(1, min(count, -(-left // per_run)))
    return replace(found, seconds=time.monotonic() - begun)


def again(bone: Segment, plan: Plan) -> Found:
    """Repeats one run."""
    begun = time.monotonic()
    found = _and(Found(plan), _runs(bone, plan, run=plan.run, count=1, threads=1))
    return replace(found, seconds=time.monotonic() - begun)


def _runs(bone: Segment, plan: Plan, *, run: int, count: int, threads: int) -> StressResult:
    try:
        return _core.bench_stress(
            plan.seed,
            run,
            count,
            cast("Any", plan.model),
            threads,
            bone.volume._internal,  # noqa: SLF001
            bone._internal,  # noqa: SLF001
        )
    except ValueError as error:
        raise OptionError(str(error)) from None


def _and(found: Found, report: StressResult) -> Found:
    """Adds the results of further runs."""
    return replace(
        found,
        moves=found.moves + report["moves"],
        contacts=found.contacts + report["contacts"],
        edits=found.edits + report["edits"],
        poses=found.poses + report["poses"],
        cuts=found.cuts + report["cuts"],
        violation=report["violation"],
    )


def rows_of(found: Found) -> list[Row]:
    """Returns the rows."""
    report = {
        "violations": float(found.violation is not None),
        "moves": float(found.moves),
        "contact_share": found.contacts / max(1, found.moves),
        "edits": float(found.edits),
        "poses": float(found.poses),
        "cuts": float(found.cuts),
        "per_second": found.moves / max(found.seconds, 1e-9),
    }
    return [row_of(goal, report) for goal in GOALS["stress"]]


def write_case(found: Found, path: Path) -> None:
    """Writes a violation so that its run can be repeated."""
    content = {"bench": "stress", **asdict(found.plan), **(found.violation or {})}
    with whole_file(path) as unfinished:
        unfinished.write_text(json.dumps(content, indent=2) + "\n", encoding="utf-8")
