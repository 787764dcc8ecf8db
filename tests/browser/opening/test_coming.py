"""A real browser is there before its scan, and tells how far that is or why there is none."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from threading import Event, Thread

import pytest
from browser import ROOT, browser
from palpate.base.progress import Progress
from palpate.saved.opening import opening
from palpate.server.app import bind, make_app, make_server
from palpate.server.loading_scan import LoadingScan
from palpate.server.open_scan import OpenScan
from palpate.server.security import Access
from palpate.server.workbench import Workbench

pytestmark = [pytest.mark.browser, pytest.mark.data]

OUTPUT = ROOT / "tests" / "output"
PATIENCE = 120.0


@contextmanager
def reading(path: Path, go: Event) -> Iterator[str]:
    """Serves a scan that is read once it may; gives the address."""

    def begin(progress: Progress) -> OpenScan:
        progress(f"reading {path.name}", 0.4)
        assert go.wait(PATIENCE)
        return OpenScan.begin(opening(path, progress=progress).scene, notify=lambda _: None)

    workbench = Workbench(loading=LoadingScan(path.name, begin))
    workbench.page_seconds = PATIENCE
    with bind(0) as listener:
        listener.listen()
        access = Access(port=listener.getsockname()[1])
        server = make_server(make_app(workbench, access=access))
        workbench.given_up = server.end
        thread = Thread(target=server.run, kwargs={"sockets": [listener]})
        thread.start()
        try:
            yield access.url
        finally:
            go.set()
            server.end()
            thread.join(PATIENCE)
            workbench.end()
    assert not thread.is_alive()


def test_the_page_waits_for_its_scan(data_folder: Path, tmp_path: Path) -> None:
    head = data_folder / "cthead_stanford" / "CThead.mha"
    cut = tmp_path / "cut.mha"
    cut.write_bytes(head.read_bytes()[:5000])
    told = "document.body.innerText.includes({!r})"
    with browser() as page:
        go = Event()
        with reading(head, go) as url:
            page.do("open", url=url, width=900, height=700, seconds=1)
            page.wait(told.format("Reading CThead.mha"))
            page.wait("Math.abs(document.querySelector('progress')?.value - 0.4) < 1e-6")
            page.do("screenshot", path=str(OUTPUT / "coming.png"))
            go.set()
            page.wait("window.palpate?.ready === true", seconds=PATIENCE)
            assert page.read("window.palpate.scan.dimensions") == [256, 256, 113]
            assert page.complaints == []
        go = Event()
        with reading(cut, go) as url:
            page.do("open", url=url, width=900, height=700, seconds=1)
            page.wait(told.format("Reading cut.mha"))
            go.set()
            page.wait(told.format("cut.mha is truncated"))
            assert "The scan cannot be shown" in page.text("message")
