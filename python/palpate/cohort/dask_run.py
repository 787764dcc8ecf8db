"""Runs cases on a Dask cluster.

Dask says which worker runs which case, and gives those of a lost worker to another one.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Sequence
from pathlib import Path
from queue import Empty, SimpleQueue
from time import monotonic
from uuid import uuid4

import cloudpickle
from distributed import Client, Future, KilledWorker

from palpate.base.errors import OptionError
from palpate.base.package_version import package_version
from palpate.cohort import cluster_worker
from palpate.cohort.case import Case
from palpate.cohort.cluster_case import case_on_worker
from palpate.cohort.cluster_worker import CaseWorkers
from palpate.cohort.limits import Limits
from palpate.cohort.one_case import CaseResult
from palpate.cohort.output_folder import CohortFolder
from palpate.cohort.run import Outcome

__all__ = ["run_on_cluster"]

LOOK_SECONDS = 1.0
"""How often it is looked which workers there are [s]."""


def run_on_cluster(
    recipe: Path,
    cases: Sequence[Case],
    folder: CohortFolder,
    *,
    client: Client,
    limits: Limits,
    told: Callable[[Outcome, CaseResult], None],
    warned: Callable[[str], None],
    stop: Callable[[], bool],
    run: Callable[..., CaseResult] = case_on_worker,
) -> Outcome:
    """Runs cases, as many at a time as there are workers; each worker has one.

    Args:
        recipe: The recipe, which all workers must see under its path, as they do the folder.
        cases: What to run.
        folder: Where to.
        client: The cluster.
        limits: What each case may take; of a worker's own threads and memory the less.
        told: Takes what became of each case, beside what became of all so far.
        warned: Takes what a person should know of the workers.
        stop: Says whether to begin no further case.
        run: What a worker does with a case; benchmarks have another one.

    Raises:
        OptionError: There are workers, but none of them can run cases.
        OSError: The output folder cannot be written, or the scheduler is gone.
    """
    outcome = Outcome()
    folder.begin()
    crew = _Crew(client, folder, warned)
    waiting = deque(cases)
    running: dict[Future, Case] = {}
    ended: SimpleQueue[Future] = SimpleQueue()
    try:
        while True:
            if stop():
                outcome.stopped = outcome.stopped or bool(waiting)
                waiting.clear()
            if crew.lost():
                # Dask would leave them to a worker that was there when they came
                waiting.extendleft(reversed(running.values()))
                client.cancel(list(running), force=True)
                running.clear()
            while waiting and len(running) < crew.size():
                case = waiting.popleft()
                future = client.submit(
                    run,
                    case,
                    recipe=str(recipe.absolute()),
                    output=str(folder.of()),
                    limits=limits,
                    key=f"{case.name}-{uuid4().hex}",
                    resources={crew.name: 1},
                    pure=False,
                )
                running[future] = case
                future.add_done_callback(ended.put)
            if not running and not waiting:
                return outcome
            try:
                future = ended.get(timeout=LOOK_SECONDS)
            except Empty:
                crew.look()
                continue
            if future not in running:
                continue
            result = _result(future, running.pop(future), folder)
            outcome.add(result)
            told(outcome, result)
    finally:
        client.cancel(list(running), force=True)
        crew.dismiss()


class _Crew:
    """The workers that run cases."""

    def __init__(self, client: Client, folder: CohortFolder, warned: Callable[[str], None]) -> None:
        self.name = f"palpate-{uuid4().hex[:8]}"
        self._client = client
        self._warned = warned
        self._told: set[str] = set()
        self._workers: set[str] = set()
        self._lost = False
        self._looked = 0.0
        # a worker without Palpate could not import it
        cloudpickle.register_pickle_by_value(cluster_worker)
        client.register_plugin(CaseWorkers(self.name, package_version(), str(folder.mark)))
        self.look()
        if self._told and not self._workers:
            raise OptionError(
                "no worker can run cases; allowed: workers with this version of Palpate that "
                f"see {folder.of()}"
            )
        if not self._workers:
            warned("no worker yet; cases begin once there is one")

    def size(self) -> int:
        """Returns how many there are, as of late."""
        if monotonic() - self._looked > LOOK_SECONDS:
            self.look()
        return len(self._workers)

    def lost(self) -> bool:
        """Says, once, whether none is left of those that were there."""
        lost, self._lost = self._lost, False
        return lost

    def look(self) -> None:
        """Looks which there are, and tells those that are not used."""
        if self._client.status != "running":
            raise OSError("the scheduler is gone; the same command goes on once there is one")
        known = self._client.scheduler_info()["workers"].items()
        now = {where for where, each in known if each["resources"].get(self.name, 0) > 0}
        if self._workers and not now:
            self._warned("no worker is left; cases go on once there is one")
        self._lost = self._lost or (bool(self._workers) and not now & self._workers)
        self._workers, self._looked = now, monotonic()
        for _, event in self._client.get_events(self.name):
            line = f"worker {event['worker']} is not used: {event['reason']}"
            if line not in self._told:
                self._told.add(line)
                self._warned(line)

    def dismiss(self) -> None:
        """Leaves the workers as they were."""
        if self._client.status == "running":
            self._client.unregister_worker_plugin(self.name)


def _result(future: Future, case: Case, folder: CohortFolder) -> CaseResult:
    if future.status == "finished":
        result = future.result()
        assert isinstance(result, CaseResult)  # noqa: S101  # it is what the task returns
        return result
    error = future.exception() if future.status == "error" else None
    if error is None:
        raise OSError("the scheduler is gone; the same command goes on once there is one")
    reason = str(error)
    if isinstance(error, KilledWorker):
        reason = "each worker that ran it was lost; its machine's memory may run out"
    folder.fail(case, None, reason)
    return CaseResult(case.name, reason)
