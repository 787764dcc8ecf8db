"""What all Python tests share: where the real scans are, and what happens without them.

The folder is ``PALPATE_DATA``, by default the data folder beside the project. Tests marked
``data`` fail at once where it is absent, unless ``PALPATE_NO_DATA=1``: then they are left
out, and the summary says how many.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from xdist.workermanage import WorkerController

DEFAULT_FOLDER = Path(__file__).parent.parent / "shared" / "data"
LEFT_OUT = pytest.StashKey[int]()


def find_data_folder() -> Path:
    """Returns the folder of the real scans, whether or not it is there."""
    return Path(os.environ.get("PALPATE_DATA") or DEFAULT_FOLDER)


@pytest.fixture(scope="session")
def data_folder() -> Path:
    """The folder of the real scans; only for tests marked ``data``."""
    return find_data_folder()


@pytest.fixture(scope="session", autouse=True)
def state_of_its_own(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """Keeps the journals of tests, and of what they start, away from those of the user."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("PALPATE_STATE", str(tmp_path_factory.mktemp("state")))
        yield


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Leaves out the tests on real data where that was asked for."""
    with_data = [item for item in items if item.get_closest_marker("data")]
    if os.environ.get("PALPATE_NO_DATA") == "1":
        config.stash[LEFT_OUT] = len(with_data)
        if hasattr(config, "workeroutput"):
            config.workeroutput["left_out"] = len(with_data)
        config.hook.pytest_deselected(items=with_data)
        items[:] = [item for item in items if not item.get_closest_marker("data")]
    elif with_data and not find_data_folder().is_dir() and not hasattr(config, "workeroutput"):
        raise pytest.UsageError(
            f"{no_scans()}, or PALPATE_NO_DATA=1 to leave out {len(with_data)} tests"
        )


def no_scans() -> str:
    """Says that the scans are missing and how to give them."""
    return f"no real scans in {find_data_folder()}: set PALPATE_DATA to their folder"


def pytest_runtest_setup(item: pytest.Item) -> None:
    """Fails tests on real data where it is absent: processes of pytest-xdist cannot end all."""
    if item.get_closest_marker("data") and not find_data_folder().is_dir():
        pytest.fail(no_scans(), pytrace=False)


@pytest.hookimpl(optionalhook=True)
def pytest_testnodedown(node: WorkerController, error: object) -> None:
    """Takes the number over from a process of pytest-xdist: each of them finds all tests."""
    del error
    node.config.stash[LEFT_OUT] = node.workeroutput.get("left_out", 0)


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Says how many tests were left out for want of data."""
    left_out = terminalreporter.config.stash.get(LEFT_OUT, 0)
    if left_out:
        terminalreporter.write_line(f"PALPATE_NO_DATA=1: {left_out} tests on real scans left out")
