"""A file that ends the reader process, opened through the running server: nothing else ends.

Files that ended it once are refused by their headers now, so that here a real end of the process
stands for the next such file.
"""

from __future__ import annotations

import re
import signal
from collections.abc import Callable
from pathlib import Path
from typing import Any

import palpate
import pytest
from palpate.base.reader_process import apart
from running_server import LibraryClient, page_at


class Ends:
    """Ends the process that takes it up, as a decoder does that a damaged file leads astray."""

    def __init__(self, number: int) -> None:
        self.number = number

    def __reduce__(self) -> tuple[Any, tuple[int]]:
        return signal.raise_signal, (self.number,)


@pytest.mark.parametrize("number", [signal.SIGSEGV, signal.SIGABRT, signal.SIGKILL])
def test_a_file_that_ends_its_reader_leaves_the_open_scan_and_the_next_file_opens(
    client: LibraryClient,
    write_series: Any,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    number: signal.Signals,
) -> None:
    first = write_series("first", description="first")
    second = write_series("second", description="second")
    hostile = tmp_path / "hostile.nii"
    hostile.write_bytes(b"\0" * 400)

    def read_apart(function: Callable[..., Any], *given: Any, path: Path, **options: Any) -> Any:
        if path == hostile:
            return apart(Ends(int(number)), path=path)  # type: ignore[arg-type]
        return apart(function, *given, path=path, **options)

    monkeypatch.setattr("palpate.io.reading.apart", read_apart)
    assert client.job("open", {"path": str(first)}) == [{"kind": "done"}]
    voxels = client.ask("GET", "volume").content

    address = f"127.0.0.1:{client.access.port}/api/live?token={client.access.token}"
    base = f"http://127.0.0.1:{client.access.port}"
    with page_at(address, client.access.port, origin=base) as page:
        page.receive("hello")
        (failed,) = client.job("open", {"path": str(hostile)})
        assert failed["kind"] == "failed"
        assert f"hostile.nii ended its reader by {number.name}: it is damaged" in failed["reason"]
        assert "\n" not in failed["reason"]
        # the open scan is there, and its session answers on the same connection
        assert client.about()["scan"] == "first"
        assert client.ask("GET", "volume").content == voxels
        page.send({"type": "threshold", "id": None, "name": "later", "low": -900.0, "high": -700.0})
        page.receive("segments", until=lambda m: "later" in [one["name"] for one in m["segments"]])

    assert client.job("open", {"path": str(second)}) == [{"kind": "done"}]
    assert client.about()["scan"] == "second"


@pytest.mark.data
@pytest.mark.parametrize("name", ["meta/nd.mha", "nrrd/fw.nhdr", "dicom/jpegls_junk"])
def test_files_that_ended_the_reader_once_are_refused_through_the_server(
    client: LibraryClient, write_series: Any, data_folder: Path, name: str
) -> None:
    hostile = data_folder.parent / "cases" / "hostile" / name
    first = write_series("first", description="first")
    client.job("open", {"path": str(first)})
    (failed,) = client.job("open", {"path": str(hostile)})
    # its header is refused, or its decoder; nothing has ended, and what is allowed is told
    assert "ended its reader" not in failed["reason"]
    assert "allowed" not in failed["reason"]
    assert re.search(r"\. (Use|Choose|Open) \w", failed["reason"])
    assert client.about()["scan"] == "first"
    with pytest.raises(palpate.PalpateError):
        palpate.read(hostile)
    assert client.job("open", {"path": str(first)}) == [{"kind": "done"}]
