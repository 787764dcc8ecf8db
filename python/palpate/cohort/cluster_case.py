"""One case on a worker of a Dask cluster, within what that worker may take."""

from __future__ import annotations

from dataclasses import replace

from distributed import get_worker

from palpate.cohort.case import Case
from palpate.cohort.case_process import CaseProcesses
from palpate.cohort.limits import Limits
from palpate.cohort.one_case import CaseResult, run_case

__all__ = ["case_on_worker", "end_waiting"]

_WAITING: dict[int, CaseProcesses] = {}
"""Processes that wait for the next case, by their number of threads; they end with the worker."""


def case_on_worker(case: Case, *, recipe: str, output: str, limits: Limits) -> CaseResult:
    """Runs a case with the threads and the memory of the worker that it is on.

    Raises:
        OptionError: The output folder holds something else.
        OSError: The output folder cannot be written.
    """
    worker = get_worker()
    threads = limits.threads or worker.state.nthreads
    rooms = [room for room in (limits.memory, worker.memory_manager.memory_limit) if room]
    within = replace(limits, threads=threads, memory=min(rooms, default=None))
    if threads not in _WAITING:
        _WAITING[threads] = CaseProcesses(threads)
    return run_case(case, recipe=recipe, output=output, limits=within, processes=_WAITING[threads])


def end_waiting() -> None:
    """Ends processes that no case will take."""
    while _WAITING:
        _WAITING.popitem()[1].end()
