"""The table of messages from pages: one handler for each type, and where it runs.

The module of each subject adds its rows. ``MessageTable.check`` refuses a table that lacks a member
of ``protocol.FromPage``, so that no message can be ignored.
"""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum
from typing import Any, Generic, Protocol, TypeVar, get_args

from palpate import protocol
from palpate.server.messages.outbox import Outbox

__all__ = ["MessageTable", "Row", "Runs", "Subject"]

Handled = TypeVar("Handled", bound=protocol.Message)


class Runs(Enum):
    """Where a handler runs."""

    ON_LOOP = "on loop"
    """On the event loop: it returns at once and never waits."""
    BESIDE = "beside"
    """On the event loop, and only begins its work: later messages do not wait for that to end."""
    IN_ORDER = "in order"
    """In a worker thread: the next message of the same page waits until it returns."""


@dataclass(frozen=True)
class Row(Generic[Handled]):
    """The handler of one type of message; it is given the message and the page's outbox."""

    handle: Callable[[Handled, Outbox], None]
    runs: Runs


class Subject(Protocol):
    """Handles the messages of one subject."""

    def add_to(self, table: MessageTable) -> None:
        """Adds a row for each message of the subject."""


class MessageTable:
    """The handler of each type of message."""

    def __init__(self, *subjects: Subject) -> None:
        """Takes the rows of these subjects."""
        self._rows: dict[type[protocol.Message], Row[Any]] = {}
        for subject in subjects:
            subject.add_to(self)

    def add(
        self, kind: type[Handled], handle: Callable[[Handled, Outbox], None], *, runs: Runs
    ) -> None:
        """Adds the handler of a type.

        Raises:
            ValueError: The type has a handler already, or is no message of pages.
        """
        if kind in self._rows:
            raise ValueError(f"{kind.__name__} given twice; allowed: one handler for each message")
        if kind not in get_args(protocol.FromPage):
            raise ValueError(f"{kind.__name__} given; allowed: members of protocol.FromPage")
        self._rows[kind] = Row(handle, runs)

    def check(self) -> None:
        """Refuses a table that is not complete.

        Raises:
            ValueError: A message of pages has no handler.
        """
        missing = [kind.__name__ for kind in get_args(protocol.FromPage) if kind not in self._rows]
        if missing:
            raise ValueError(f"no handler for {', '.join(missing)}; needed: one for each message")

    async def handle(self, message: protocol.FromPage, page: Outbox) -> None:
        """Has a message of a page handled.

        Raises:
            PalpateError: It cannot be done.
            RuntimeError: The session has ended.
        """
        row = self._rows[type(message)]
        if row.runs is Runs.IN_ORDER:
            await asyncio.to_thread(row.handle, message, page)
        else:
            row.handle(message, page)
