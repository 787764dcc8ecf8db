"""A Dask cluster that runs cases: one of this machine, or one that exists.

Which worker runs which case, and what becomes of those of a lost worker, is for Dask to say.
"""

from __future__ import annotations

import logging
import os
import signal
from collections.abc import Iterator
from contextlib import contextmanager
from importlib.util import find_spec
from multiprocessing import resource_tracker

from distributed import Client, LocalCluster

from palpate.base.errors import OptionError

__all__ = ["cluster_client", "workers_page"]


@contextmanager
def cluster_client(*, workers: int | None, scheduler: str | None) -> Iterator[Client]:
    """Yields a client of a cluster; one of this machine ends with it.

    Args:
        workers: How many workers this machine starts, which share its cores.
        scheduler: Address of a cluster's scheduler, in the place of workers here.

    Raises:
        OptionError: No scheduler answers there.
    """
    if scheduler is not None:
        with _joined(scheduler) as client:
            yield client
        return
    count = workers or 1
    with _no_interrupt_for_workers():
        cluster = LocalCluster(
            n_workers=count,
            threads_per_worker=max(1, (os.cpu_count() or 1) // count),
            processes=True,
            memory_limit=0,
            dashboard_address="127.0.0.1:0",
            # keys of this run alone: else any user of the machine could have it run programs
            security=True,
            silence_logs=logging.CRITICAL,
        )
    with cluster, Client(cluster) as client:
        yield client


def _joined(scheduler: str) -> Client:
    try:
        return Client(scheduler)
    except (OSError, ValueError) as error:
        raise OptionError(
            f"no scheduler answers at {scheduler} ({error}); allowed: the address that "
            "`dask scheduler` prints, such as tcp://10.0.0.1:8786"
        ) from error


def workers_page(client: Client) -> str:
    """Returns the address of the page that shows what workers do."""
    address: str = client.dashboard_link
    # the full one needs Bokeh; without it, the scheduler has a plain one
    if find_spec("bokeh") is None:
        return address.removesuffix("/status") + "/info/main/workers.html"
    return address


@contextmanager
def _no_interrupt_for_workers() -> Iterator[None]:
    """Within it, Ctrl-C reaches no process that is started, also not those started again later.

    Threads take over what is blocked from the one that starts them, and so do processes.
    """
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    # where this starts later, it lets them through again
    resource_tracker.ensure_running()
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
