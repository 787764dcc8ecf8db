"""Runs a recipe over all cases, one after the other; a case that fails stops no other one."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from palpate.cohort.case import Case
from palpate.cohort.case_process import CaseProcesses
from palpate.cohort.inputs import inputs_of, recipe_hash, same_inputs
from palpate.cohort.limits import Limits
from palpate.cohort.one_case import CaseResult, run_case
from palpate.cohort.output_folder import CohortFolder
from palpate.recipes.filled import filled, placed
from palpate.recipes.recipe import recipe_of
from palpate.recipes.source import Source, read_source

__all__ = ["Outcome", "run_cases", "wanted_cases"]


@dataclass
class Outcome:
    """What became of the cases."""

    done: list[str] = field(default_factory=list)
    failed: dict[str, str] = field(default_factory=dict)
    """Why, by case."""
    stopped: bool = False

    def add(self, result: CaseResult) -> None:
        """Takes what became of a case."""
        if result.reason is None:
            self.done.append(result.name)
        else:
            self.failed[result.name] = result.reason


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
    told: Callable[[Outcome, CaseResult], None],
    stop: Callable[[], bool],
) -> Outcome:
    """Runs cases in order.

    Args:
        recipe: The recipe.
        cases: What to run.
        folder: Where to.
        limits: What each case may take.
        told: Takes what became of each case, beside what became of all so far.
        stop: Says, between two cases, whether to end.

    Raises:
        OSError: The output folder cannot be written.
    """
    outcome = Outcome()
    folder.begin()
    processes = CaseProcesses(limits.threads)
    try:
        for case in cases:
            if stop():
                outcome.stopped = True
                break
            result = run_case(
                case, recipe=recipe, output=folder.of(), limits=limits, processes=processes
            )
            outcome.add(result)
            told(outcome, result)
    finally:
        processes.end()
    return outcome


def _unchanged(source: Source, folder: CohortFolder, case: Case) -> bool:
    told = folder.told(case.name)
    return (
        told is not None
        and told.get("recipe_sha256") == recipe_hash(source)
        and same_inputs(inputs_of(source), told.get("inputs"))
    )
