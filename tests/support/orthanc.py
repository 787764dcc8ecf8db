"""Orthanc, Debian's DICOM server, with its DICOMweb plugin: on this machine, for a test."""

from __future__ import annotations

import json
import subprocess
import time
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import httpx
import pytest
from browser import END_LIMIT, ROOT, START_LIMIT, free_port

PLUGIN = Path("/usr/share/orthanc/plugins/libOrthancDicomWeb.so")


@dataclass(frozen=True)
class Orthanc:
    """A server that answers."""

    port: int
    login: tuple[str, str] | None

    @property
    def dicomweb(self) -> str:
        """Address of its DICOMweb service."""
        return f"http://127.0.0.1:{self.port}/dicom-web"

    def store(self, files: Iterable[Path]) -> None:
        """Puts DICOM files on it, by its own interface."""
        with self._client() as client:
            for file in files:
                client.post("/instances", content=file.read_bytes()).raise_for_status()

    def answers(self) -> bool:
        """Says whether it is ready."""
        try:
            with self._client() as client:
                return client.get("/dicom-web/studies").status_code == 200
        except httpx.TransportError:
            return False

    def _client(self) -> httpx.Client:
        base = f"http://127.0.0.1:{self.port}"
        return httpx.Client(base_url=base, auth=self.login, trust_env=False, timeout=START_LIMIT)


@contextmanager
def orthanc(*, login: tuple[str, str] | None = None) -> Iterator[Orthanc]:
    """Runs it with nothing in it; the test is left out, and says so, where there is none."""
    found = subprocess.run(
        [ROOT / "scripts" / "orthanc.sh"], check=False, capture_output=True, text=True
    )
    if found.returncode != 0:
        pytest.skip(f"no Orthanc: {' '.join(found.stderr.split())[-300:]}")
    with TemporaryDirectory() as folder:
        server = Orthanc(free_port(), login)
        settings = Path(folder) / "orthanc.json"
        settings.write_text(json.dumps(_settings(Path(folder), server)))
        with subprocess.Popen(
            [found.stdout.strip(), str(settings)],
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        ) as process:
            try:
                _wait(server, process)
                yield server
            finally:
                process.kill()


def _settings(folder: Path, server: Orthanc) -> dict[str, object]:
    return {
        "StorageDirectory": str(folder),
        "IndexDirectory": str(folder),
        "DicomServerEnabled": False,
        "HttpPort": server.port,
        "RemoteAccessAllowed": False,
        "AuthenticationEnabled": server.login is not None,
        "RegisteredUsers": dict([server.login] if server.login else []),
        "Plugins": [str(PLUGIN)],
        "DicomWeb": {"Enable": True, "Root": "/dicom-web/"},
    }


def _wait(server: Orthanc, process: subprocess.Popen[str]) -> None:
    ends = time.monotonic() + START_LIMIT
    while not server.answers():
        assert process.poll() is None, process.communicate(timeout=END_LIMIT)[0]
        assert time.monotonic() < ends, f"Orthanc does not answer within {START_LIMIT} s"
        time.sleep(0.1)
