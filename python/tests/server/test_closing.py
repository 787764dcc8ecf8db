"""How connections of pages end, and tasks of the server: one that fails holds up none."""

from __future__ import annotations

import asyncio
import logging
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import pytest
from made_scans import make_ball
from palpate.server.closing import ENDED, close_all, end_all
from palpate.server.messages.segment_work import SegmentWork
from running_server import running, write_page
from starlette.websockets import WebSocket, WebSocketDisconnect
from websockets.exceptions import ConnectionClosed


def connection(sent: list[Any], failure: Exception | None = None) -> WebSocket:
    """Returns the connection of a page that notes what it is sent, or that fails."""

    async def receive() -> Any:
        return {"type": "websocket.connect"}

    async def send(message: Any) -> None:
        if failure is not None and message["type"] == "websocket.close":
            raise failure
        sent.append(message)

    return WebSocket({"type": "websocket", "headers": []}, receive, send)


@pytest.mark.parametrize(
    "failure", [OSError("gone"), RuntimeError("gone"), WebSocketDisconnect(1006)]
)
def test_a_connection_that_is_gone_keeps_none_of_the_others_open(failure: Exception) -> None:
    sent: list[Any] = []

    async def close() -> None:
        pages = [connection(sent), connection([], failure), connection(sent)]
        for page in pages:
            await page.accept()
        sent.clear()
        await close_all(pages, ENDED, "why")

    asyncio.run(close())
    assert sent == [{"type": "websocket.close", "code": ENDED, "reason": "why"}] * 2


def test_tasks_all_end_and_what_went_wrong_is_logged(caplog: pytest.LogCaptureFixture) -> None:
    async def fail() -> None:
        raise ValueError("lost its way")

    async def wait_on() -> None:
        try:
            await asyncio.sleep(1000)
        finally:
            await asyncio.sleep(0)
            ended.append("the second")

    ended: list[str] = []

    async def run() -> None:
        tasks = [
            asyncio.create_task(fail(), name="the first"),
            asyncio.create_task(wait_on(), name="the second"),
        ]
        await asyncio.sleep(0)
        await end_all(tasks)
        assert all(task.done() for task in tasks)

    with caplog.at_level(logging.ERROR, logger="palpate.server.closing"):
        asyncio.run(run())
    assert ended == ["the second"]
    assert [record.message for record in caplog.records] == ["the first failed"]
    assert "lost its way" in caplog.text


def test_pages_are_told_that_a_session_has_ended_also_those_that_come_later(server: Any) -> None:
    with server.page() as page:
        page.receive("state")
        server.session.stop()
        with pytest.raises(ConnectionClosed) as closed:
            page.receive("never")
        assert closed.value.rcvd is not None
        assert closed.value.rcvd.code == ENDED
    with server.page() as page:
        with pytest.raises(ConnectionClosed) as closed:
            page.next()
        assert closed.value.rcvd is not None
        assert closed.value.rcvd.code == ENDED
    # data is still there
    assert server.get("/api/volume?step=8").status_code == 200


def test_pages_are_told_where_what_is_done_beside_them_fails(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    async def fail(_: SegmentWork) -> None:
        await asyncio.sleep(0.2)
        raise ValueError("lost its way")

    monkeypatch.setattr(SegmentWork, "run", fail)
    with running(make_ball(), write_page(tmp_path / "page")) as server, server.page() as page:
        told = page.receive("notice", until=lambda m: "lost its way" in m["text"])
        assert told["text"] == "Working on segments has failed (lost its way). Restart Palpate"
        assert told["level"] == "error"


def test_pages_are_told_where_the_server_is_stopped(tmp_path: Path) -> None:
    with ExitStack() as looking:
        with running(make_ball(), write_page(tmp_path / "page")) as server:
            page = looking.enter_context(server.page())
            page.receive("state")
        with pytest.raises(ConnectionClosed) as closed:
            page.receive("never")
        assert closed.value.rcvd is not None
        assert closed.value.rcvd.code == ENDED
