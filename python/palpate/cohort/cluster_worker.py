"""Says of each worker of a Dask cluster whether it may run cases, and has it run one at a time.

Travels to the workers as code (``dask_run.py``): a worker without Palpate must be able to run it,
so it imports nothing of Palpate before it knows that it is there.

A worker that may run cases gets one unit of a resource that bears the run's name; a case takes
one. Workers that come later are asked too, and one that is not asked never gets a case.
"""

from __future__ import annotations

import socket
from importlib.metadata import PackageNotFoundError, version
from importlib.util import find_spec
from pathlib import Path

from distributed import Worker, WorkerPlugin

__all__ = ["CaseWorkers"]


class CaseWorkers(WorkerPlugin):  # type: ignore[misc]  # Dask is not typed
    """Asks each worker, and tells those that are not used under the run's name."""

    def __init__(self, run: str, palpate: str, mark: str) -> None:
        """Takes the name of the run, the version of Palpate, and a file that each must see."""
        self.name = run
        self._palpate = palpate
        self._mark = mark

    async def setup(self, worker: Worker) -> None:
        """Lets a worker run cases, or tells why not."""
        reason = self._why_not()
        if reason is None:
            await worker.set_resources(**{self.name: 1})
        else:
            where = f"{worker.address} on {socket.gethostname()}"
            worker.log_event(self.name, {"worker": where, "reason": reason})

    async def teardown(self, worker: Worker) -> None:
        """Takes it back."""
        if self.name in worker.state.total_resources:
            await worker.set_resources(**{self.name: 0})
            from palpate.cohort.cluster_case import end_waiting

            end_waiting()

    def _why_not(self) -> str | None:
        if find_spec("palpate") is None:
            return "it has no Palpate"
        try:
            found = version("palpate")
        except PackageNotFoundError:
            found = "unknown"
        if found != self._palpate:
            return f"it has Palpate {found}, not {self._palpate}"
        if not Path(self._mark).is_file():
            return f"it does not see {Path(self._mark).parent}"
        return None
