"""Runs a recipe over all cases, one after the other; a case that fails stops no other one."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from palpate.cohort.case import Case
from palpate.cohort.case_process import CaseProcess
from palpate.cohort.inputs import inputs_of, recipe_hash, same_inputs
from palpate.cohort.output_folder import CohortFolder
from palpate.recipes.filled import filled, placed
from palpate.recipes.recipe import recipe_of
from palpate.recipes.source import Source, read_source

__all__ = ["Limits", "Outcome", "run_cases", "wanted_cases"]


@dataclass(frozen=True)
class Limits:
    """What a case may take."""

    seconds: float | None = None
    memory: int | None = None
    """Of its process, for data [bytes]."""
    retry: int = 0
    """How often a case that failed is tried again."""


@dataclass
class Outcome:
    """What became of the cases."""

    done: list[str] = field(default_factory=list)
    failed: dict[str, str] = field(default_factory=dict)
    """Why, by case."""
    stopped: bool = False


def wanted_cases(
    recipe: Path, cases: Sequence[Case], folder: CohortFolder, *, only_failed: bool = False
) -> list[Case]:
    """Returns the cases that are to be run: new ones, failed ones, and those that changed.

    Raises:
        OptionError: The recipe is wrong for a case.
    """
    source = read_source(recipe)
    wanted = []
    for case in cases:
        of_case = filled(source, case.variables, scan=case.scan)
        # what is wrong with the recipe itself is told before the first case
        placed(recipe_of(of_case), of_case, folder.of(case.name))
        failed = folder.failed(case.name)
        if failed or not (only_failed or _unchanged(of_case, folder, case)):
            wanted.append(case)
    return wanted


def run_cases(
    recipe: Path,
    cases: Sequence[Case],
    folder: CohortFolder,
    *,
    limits: Limits,
    told: Callable[[Outcome, Case, str | None], None],
    stop: Callable[[], bool],
) -> Outcome:
    """Runs cases in order.

    Args:
        recipe: The recipe.
        cases: What to run.
        folder: Where to.
        limits: What each case may take.
        told: Takes each case once it is done, with why it failed.
        stop: Says, between two cases, whether to end.

    Raises:
        OSError: The output folder cannot be written.
    """
    outcome = Outcome()
    folder.begin()
    processes = _Processes()
    try:
        for case in cases:
            if stop():
                outcome.stopped = True
                break
            reason: str | None = None
            for _ in range(limits.retry + 1):
                reason = _run_case(recipe, case, folder, limits=limits, process=processes.next())
                if reason is None:
                    break
            if reason is None:
                folder.keep(case.name)
                outcome.done.append(case.name)
            else:
                folder.fail(case.name, reason)
                outcome.failed[case.name] = reason
            told(outcome, case, reason)
    finally:
        processes.end()
    return outcome


class _Processes:
    """Processes of cases: one runs, the next one starts meanwhile."""

    def __init__(self) -> None:
        self._waiting = CaseProcess()

    def next(self) -> CaseProcess:
        taken, self._waiting = self._waiting, CaseProcess()
        return taken

    def end(self) -> None:
        self._waiting.end()


def _run_case(
    recipe: Path, case: Case, folder: CohortFolder, *, limits: Limits, process: CaseProcess
) -> str | None:
    part = folder.part(case.name)
    request = {
        "recipe": str(recipe.absolute()),
        "variables": case.variables,
        "scan": None if case.scan is None else str(case.scan),
        "part": str(part),
        "memory": limits.memory,
    }
    return process.run(request, part, timeout=limits.seconds)


def _unchanged(source: Source, folder: CohortFolder, case: Case) -> bool:
    told = folder.told(case.name)
    return (
        told is not None
        and told.get("recipe_sha256") == recipe_hash(source)
        and same_inputs(inputs_of(source), told.get("inputs"))
    )
