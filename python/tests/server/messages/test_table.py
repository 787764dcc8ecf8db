"""The table of messages from pages: complete, each message once, and each where it belongs."""

from __future__ import annotations

import asyncio
import threading
from typing import Any, get_args

import pytest
from palpate import protocol
from palpate.server.messages.outbox import Outbox
from palpate.server.messages.table import MessageTable, Runs

ALL: tuple[type[protocol.Message], ...] = get_args(protocol.FromPage)


def ignore(_message: protocol.Message, _page: Outbox) -> None:
    """Does nothing with a message."""


class AllBut:
    """A subject with a row for every message but one."""

    def __init__(self, left_out: type[protocol.Message] | None) -> None:
        self.left_out = left_out

    def add_to(self, table: MessageTable) -> None:
        for kind in ALL:
            if kind is not self.left_out:
                table.add(kind, ignore, runs=Runs.ON_LOOP)


def test_a_session_handles_every_message_of_pages(shared_server: Any) -> None:
    table = shared_server.live.table
    table.check()
    assert set(table._rows) == set(ALL)


@pytest.mark.parametrize("left_out", ALL)
def test_a_message_without_a_handler_is_found(left_out: type[protocol.Message]) -> None:
    with pytest.raises(ValueError, match=f"no handler for {left_out.__name__};"):
        MessageTable(AllBut(left_out)).check()


def test_a_complete_table_passes_the_check() -> None:
    MessageTable(AllBut(None)).check()


def test_a_second_handler_of_a_message_is_refused() -> None:
    with pytest.raises(ValueError, match="given twice"):
        MessageTable(AllBut(None), AllBut(protocol.Hand))


def test_a_message_that_pages_do_not_send_is_refused() -> None:
    with pytest.raises(ValueError, match="Passed given"):
        MessageTable().add(protocol.Passed, ignore, runs=Runs.ON_LOOP)


@pytest.mark.parametrize(
    ("runs", "on_loop"), [(Runs.ON_LOOP, True), (Runs.BESIDE, True), (Runs.IN_ORDER, False)]
)
def test_a_handler_runs_where_its_row_says(*, runs: Runs, on_loop: bool) -> None:
    threads: list[threading.Thread] = []
    table = MessageTable()
    table.add(protocol.Undo, lambda _, __: threads.append(threading.current_thread()), runs=runs)

    async def send() -> None:
        await table.handle(protocol.Undo(), Outbox())

    asyncio.run(send())
    # what was handled is done when the next message is taken
    assert [each is threading.current_thread() for each in threads] == [on_loop]


def test_the_hand_never_waits(shared_server: Any) -> None:
    rows = shared_server.live.table._rows
    # the most frequent message: a thread for each would cost more than the message does
    assert rows[protocol.Hand].runs is Runs.ON_LOOP
    work = (protocol.Threshold, protocol.Otsu, protocol.ChangeShape, protocol.Register)
    assert {rows[kind].runs for kind in work} == {Runs.BESIDE}
