"""Fixtures: scans that tests write for themselves, and a server that runs."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import SimpleITK
from hypothesis import settings
from made_scans import make_ball, series_writer
from numpy.typing import NDArray
from palpate.server.workbench import Workbench
from palpate.volumes.scene import Scene
from running_server import LibraryClient, RunningServer, running, serving, write_page

# a busy machine is no fault of what is tested
settings.register_profile("untimed", deadline=None)
settings.load_profile("untimed")

SMALL = (5, 6, 7)
"""Depth, height, width of small scans: all different, so that no axis stands for another."""


@pytest.fixture
def small_values() -> NDArray[np.int16]:
    """Values of a small scan, all different."""
    return (np.arange(np.prod(SMALL)).reshape(SMALL) * 3 - 100).astype(np.int16)


WriteImage = Callable[..., Path]


@pytest.fixture
def write_image(tmp_path: Path) -> WriteImage:
    """Writes an array [z, y, x] as an image file and returns its path."""

    def write(
        values: NDArray[Any],
        name: str = "scan.nrrd",
        *,
        spacing: tuple[float, ...] | None = None,
        compressed: bool = False,
        vector: bool = False,
    ) -> Path:
        image = SimpleITK.GetImageFromArray(values, isVector=vector)
        if spacing is not None:
            image.SetSpacing(spacing)
        path = tmp_path / name
        SimpleITK.WriteImage(image, str(path), compressed)
        return path

    return write


@pytest.fixture
def write_series(tmp_path: Path) -> Callable[..., Path]:
    """Writes a CT series of small slices into a folder and returns the folder."""
    return series_writer(tmp_path)


@pytest.fixture
def ball_scene() -> Scene:
    """A ball of 100 HU with a radius of 8 mm in air, at (20, 20, 20), touchable; 41³ voxels."""
    return make_ball()


@pytest.fixture
def server(tmp_path: Path) -> Iterator[RunningServer]:
    """A server with a ball, of this test alone."""
    with running(make_ball(), write_page(tmp_path / "page")) as started:
        yield started


@pytest.fixture(scope="module")
def shared_server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[RunningServer]:
    """A server with a ball, for tests that leave it as it is."""
    with running(make_ball(), write_page(tmp_path_factory.mktemp("shared") / "page")) as started:
        yield started


@pytest.fixture
def client(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[LibraryClient]:
    """A page of a server without a scan, with a state and a temporary folder of its own."""
    room = tmp_path / "room"
    room.mkdir()
    monkeypatch.setattr("tempfile.tempdir", str(room))
    monkeypatch.setenv("PALPATE_STATE", str(tmp_path / "state"))
    workbench = Workbench()
    with serving(workbench, write_page(tmp_path / "page")) as access:
        yield LibraryClient(access, workbench)
    workbench.end()
    assert list(room.iterdir()) == []
