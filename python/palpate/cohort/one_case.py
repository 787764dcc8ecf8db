"""Runs one case into its folder, wherever that is asked for: here, or on a worker of a cluster."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from palpate.cohort.case import Case
from palpate.cohort.case_process import CaseProcess, CaseProcesses
from palpate.cohort.limits import Limits
from palpate.cohort.output_folder import CohortFolder

__all__ = ["CaseResult", "run_case"]

TAKEN_OVER = "another worker took it over; what that one made of it counts"


@dataclass(frozen=True)
class CaseResult:
    """What became of a case."""

    name: str
    reason: str | None
    """Why it failed; None where it is done."""


def run_case(
    case: Case,
    *,
    recipe: str | Path,
    output: str | Path,
    limits: Limits | None = None,
    processes: CaseProcesses | None = None,
) -> CaseResult:
    """Runs one case in a process of its own; its folder appears once it is whole.

    A case that fails leaves ``failed.json``, and its result says why: nothing is raised for it.

    Args:
        case: Its name and variables, as ``cases_over`` and ``cases_of_table`` give them.
        recipe: The recipe.
        output: The folder of all cases; on a cluster one that all workers share.
        limits: What it may take.
        processes: Where its process comes from; one is started where none is given.

    Raises:
        OptionError: The output folder holds something else.
        OSError: The output folder cannot be written.
    """
    limits = limits or Limits()
    folder = CohortFolder(Path(output))
    folder.begin()
    request = {
        "recipe": str(Path(recipe).absolute()),
        "variables": case.variables,
        "scan": None if case.scan is None else str(case.scan),
        "memory": limits.memory,
    }
    reason: str | None = None
    for _ in range(limits.retry + 1):
        part = folder.part(case.name)
        process = CaseProcess(limits.threads) if processes is None else processes.next()
        reason = process.run({**request, "part": str(part)}, part, timeout=limits.seconds)
        if not part.is_dir():
            return CaseResult(case.name, TAKEN_OVER)
        if reason is None:
            folder.keep(case.name, part)
            return CaseResult(case.name, None)
    folder.fail(case, part, str(reason))
    return CaseResult(case.name, reason)
