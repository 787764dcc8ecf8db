"""Scans that tests write for themselves, and a server that runs."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from socket import SO_RCVBUF, SOL_SOCKET, socket
from threading import Event, Thread
from typing import Any

import httpx
import msgspec
import numpy as np
import pytest
import SimpleITK
from numpy.typing import NDArray
from palpate.saved.journal import Journal
from palpate.server.app import bind, make_app, make_server
from palpate.server.live import Live
from palpate.server.open_scan import OpenScan
from palpate.server.security import Access
from palpate.server.workbench import Workbench
from palpate.session.session import Session
from palpate.volumes.scene import Scene
from palpate.volumes.volume import Volume, VolumeTraits
from pydicom.dataset import FileDataset, FileMetaDataset
from pydicom.uid import CTImageStorage, ExplicitVRLittleEndian, generate_uid
from websockets.sync.client import ClientConnection, connect

PATIENCE = 60.0
"""Seconds until what is waited for counts as lost: however busy the machine is, it comes sooner."""

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


def series_writer(place: Path) -> Callable[..., Path]:
    """Returns what writes series into folders of a place."""

    def write(
        folder: str = "series",
        *,
        positions: list[tuple[float, float, float]] | None = None,
        orientation: tuple[float, ...] = (1, 0, 0, 0, 1, 0),
        uid: str | None = None,
        description: str = "abdomen",
        scale: tuple[float, float] = (1.0, -1024.0),
        prefix: str = "",
        each: Callable[[int, FileDataset], None] | None = None,
        **changes: Any,
    ) -> Path:
        target = place / folder
        target.mkdir(exist_ok=True)
        series = generate_uid() if uid is None else uid
        places = positions or [(-10.0, -20.0, 30.0 + 2.5 * k) for k in range(4)]
        for number, position in enumerate(places):
            dataset = _slice(number, position, orientation, series)
            dataset.SeriesDescription = description
            dataset.RescaleSlope, dataset.RescaleIntercept = scale
            for name, value in changes.items():
                setattr(dataset, name, value)
            if each is not None:
                each(number, dataset)
            # names in another order than places, and without an ending
            dataset.save_as(target / f"{prefix}{97 * number % 101:03}", enforce_file_format=True)
        return target

    return write


def _slice(
    number: int, position: tuple[float, ...], orientation: tuple[float, ...], series: str
) -> FileDataset:
    """Returns a slice of 3 rows and 4 columns whose values are 100 times its number and up."""
    meta = FileMetaDataset()
    meta.MediaStorageSOPClassUID = CTImageStorage
    meta.MediaStorageSOPInstanceUID = generate_uid()
    meta.TransferSyntaxUID = ExplicitVRLittleEndian
    dataset = FileDataset("", {}, file_meta=meta, preamble=b"\0" * 128)
    dataset.SOPClassUID, dataset.SOPInstanceUID = CTImageStorage, meta.MediaStorageSOPInstanceUID
    dataset.Modality, dataset.SeriesInstanceUID = "CT", series
    dataset.Rows, dataset.Columns, dataset.SamplesPerPixel = 3, 4, 1
    dataset.PhotometricInterpretation = "MONOCHROME2"
    dataset.BitsAllocated, dataset.BitsStored, dataset.HighBit = 16, 16, 15
    dataset.PixelRepresentation = 0
    dataset.PixelSpacing = [0.5, 0.75]
    dataset.ImagePositionPatient = list(position)
    dataset.ImageOrientationPatient = list(orientation)
    dataset.PixelData = (100 * number + np.arange(12, dtype="<u2")).tobytes()
    return dataset


def make_ball() -> Scene:
    z, y, x = np.mgrid[0:41, 0:41, 0:41] - 20.0
    values = np.where(x * x + y * y + z * z <= 64.0, 100, -1000).astype(np.int16)
    traits = VolumeTraits(name="ball", modality="CT", unit="HU")
    volume = Volume(values, spacing=(1.0, 1.0, 1.0), traits=traits)
    return Scene(volume, [volume.threshold(0.0, name="ball")])


@pytest.fixture
def ball_scene() -> Scene:
    """A ball of 100 HU with a radius of 8 mm in air, at (20, 20, 20), touchable; 41³ voxels."""
    return make_ball()


@dataclass(frozen=True)
class RunningServer:
    """A server that answers, in a thread of this process."""

    access: Access
    session: Session
    journal: Journal | None = None
    live: Live | None = None

    @property
    def base(self) -> str:
        return f"http://127.0.0.1:{self.access.port}"

    def ask(self, method: str, path: str, content: bytes | None = None) -> httpx.Response:
        """Asks in any way, with the token as a cookie."""
        sent = {"Cookie": f"{self.access.cookie}={self.access.token}"}
        return httpx.request(
            method,
            f"{self.base}{path}",
            headers=sent,
            content=content,
            trust_env=False,
            timeout=PATIENCE,
        )

    def get(self, path: str, **headers: str) -> httpx.Response:
        """Asks with the token as a cookie, unless headers say otherwise."""
        sent = {"Cookie": f"{self.access.cookie}={self.access.token}"}
        sent |= {name.replace("_", "-"): value for name, value in headers.items()}
        return httpx.get(f"{self.base}{path}", headers=sent, trust_env=False, timeout=PATIENCE)

    @contextmanager
    def page(self, *, host_name: str = "127.0.0.1", **options: Any) -> Iterator[Page]:
        """Connects as the page does."""
        address = f"{host_name}:{self.access.port}/api/live?token={self.access.token}"
        with page_at(address, self.access.port, **({"origin": self.base} | options)) as page:
            yield page


@contextmanager
def page_at(address: str, port: int, *, room: int | None = None, **options: Any) -> Iterator[Page]:
    """Connects to the live messages of any server on a port of this machine.

    The system keeps ``room`` bytes for a page that does not read; by default many.
    """
    settings = {"max_size": None, "open_timeout": PATIENCE} | options
    with socket() as plain:
        if room is not None:
            plain.setsockopt(SOL_SOCKET, SO_RCVBUF, room)
        plain.connect(("127.0.0.1", port))
        with connect(f"ws://{address}", sock=plain, **settings) as connection:
            yield Page(connection)


class Page:
    """The page's end of the connection."""

    def __init__(self, socket: ClientConnection) -> None:
        self.socket = socket

    def send(self, message: dict[str, Any]) -> None:
        self.socket.send(msgspec.msgpack.encode(message))

    def receive(self, kind: str, *, until: Callable[[Any], bool] = lambda _: True) -> Any:
        """Waits for a message of a kind that fits; others before it are left out."""
        ends = time.monotonic() + PATIENCE
        while time.monotonic() < ends:
            message = self.next()
            if message["type"] == kind and until(message):
                return message
        raise AssertionError(f"no {kind} message that fits within {PATIENCE} s")

    def next(self) -> Any:
        """Waits for the next message, of whatever kind."""
        return msgspec.msgpack.decode(self.socket.recv(timeout=PATIENCE, decode=False))


def write_page(folder: Path) -> Path:
    """Writes a stand-in for the built page: what it shows does not matter to the server."""
    (folder / "assets").mkdir(parents=True)
    (folder / "index.html").write_text("<!doctype html><title>Palpate</title>")
    (folder / "assets" / "page.js").write_text("export {};")
    (folder.parent / "beside.txt").write_text("not for the page")
    return folder


@contextmanager
def running(scene: Scene, page: Path, *, state: Path | None = None) -> Iterator[RunningServer]:
    """Runs the real server with a real session on a free port, with a journal in ``state``."""
    with Session(scene) as session:
        journal = None if state is None else Journal(session, folder=state, tell=lambda _: None)
        if journal is not None:
            journal.start()
        opened = OpenScan(session, journal=journal)
        with serving(Workbench(opened), page) as access:
            yield RunningServer(access, session, journal, opened.live)
        opened.recorder.close()


@contextmanager
def serving(workbench: Workbench, page: Path) -> Iterator[Access]:
    """Runs the real server with a workbench on a free port."""
    with bind(0) as listener:
        access = Access(port=listener.getsockname()[1])
        ready = Event()
        server = make_server(make_app(workbench, access=access, page=page), ready=ready.set)
        listener.listen()
        thread = Thread(target=server.run, kwargs={"sockets": [listener]})
        thread.start()
        assert ready.wait(PATIENCE)
        yield access
        server.should_exit = True
        thread.join(PATIENCE)
        assert not thread.is_alive()


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


@dataclass
class LibraryClient:
    """A page that opens scans."""

    access: Access
    workbench: Workbench

    def ask(self, method: str, route: str, body: Any = None) -> httpx.Response:
        content = body if isinstance(body, bytes) else json.dumps(body).encode()
        return httpx.request(
            method,
            f"http://127.0.0.1:{self.access.port}/api/{route}",
            headers={"Cookie": f"{self.access.cookie}={self.access.token}"},
            content=None if body is None else content,
            trust_env=False,
            timeout=PATIENCE,
        )

    def about(self) -> dict[str, Any]:
        told: dict[str, Any] = self.ask("GET", "library/").json()
        return told

    def job(self, route: str, body: Any) -> list[dict[str, Any]]:
        """Returns the lines of some work, without its progress."""
        answer = self.ask("POST", f"library/{route}", body)
        assert answer.status_code == 200, answer.text
        lines = [json.loads(line) for line in answer.text.splitlines()]
        return [line for line in lines if line["kind"] != "progress"]

    def upload(self, files: dict[str, bytes]) -> int:
        told = [{"name": name, "size": len(content)} for name, content in files.items()]
        number = int(self.ask("POST", "library/uploads", told).json()["upload"])
        for file, content in enumerate(files.values()):
            assert self.ask("PUT", f"library/uploads/{number}/{file}", content).status_code == 204
        return number


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
