"""What is kept with the scan is the same on all pages, whoever changed it first."""

from __future__ import annotations

import asyncio
from typing import Any

import msgspec
import numpy as np
import pytest
from palpate import protocol
from palpate.saved.kept_with_scan import KeptWithScan
from palpate.server.messages.kept import KeptMessages
from palpate.server.messages.outbox import Outbox
from palpate.volumes.scene import Scene
from palpate.volumes.volume import Volume


class Pages:
    """Two pages of one scan."""

    def __init__(self) -> None:
        """Opens them."""
        volume = Volume(np.zeros((4, 4, 4), np.int16), spacing=(1.0, 1.0, 1.0))
        self.kept = KeptWithScan(Scene(volume))
        self.one, self.other = Outbox(), Outbox()
        self.messages = KeptMessages(self.kept, {self.one, self.other})

    def keep(self, page: Outbox, name: str, value: str | None, *, after: int) -> None:
        """Has a page change a part."""
        self.messages._keep(protocol.Keep(name=name, value=value, after=after), page)

    def values(self) -> dict[str, str | None]:
        """Returns what holds."""
        return {name: part.value for name, part in self.kept.now().items()}


async def told(page: Outbox) -> list[Any]:
    """Returns what a page was told."""
    decoder = msgspec.msgpack.Decoder(protocol.ToPage)
    found = []
    while page._messages:
        packed = await page.next()
        assert isinstance(packed, bytes)
        found.append(decoder.decode(packed))
    return found


@pytest.fixture
def pages() -> Pages:
    return Pages()


def test_five_marks_of_one_page_and_one_of_another_are_six(pages: Pages) -> None:
    for number in range(5):
        pages.keep(pages.one, f"mark.{number}", "1", after=0)
    pages.keep(pages.other, "mark.f", "2", after=0)
    assert len(pages.values()) == 6
    assert len(pages.messages.message) == 6
    heard = asyncio.run(told(pages.other))
    assert [(each.part.name, each.answers) for each in heard] == [
        *((f"mark.{number}", False) for number in range(5)),
        ("mark.f", True),
    ]


def test_what_another_page_has_changed_is_not_overwritten_blindly(pages: Pages) -> None:
    pages.keep(pages.one, "clip", "1", after=0)
    # it has not heard of that yet
    pages.keep(pages.other, "clip", "2", after=0)
    assert pages.values() == {"clip": "1"}
    heard = asyncio.run(told(pages.other))
    assert [type(each).__name__ for each in heard] == ["Kept", "Notice", "Kept"]
    assert heard[-1] == protocol.Kept(protocol.KeptPart("clip", 1, "1"), answers=True)
    # now it has
    pages.keep(pages.other, "clip", "2", after=1)
    assert pages.values() == {"clip": "2"}


def test_a_page_that_drags_goes_on_before_it_is_answered(pages: Pages) -> None:
    for value in ("1", "2", "3"):
        pages.keep(pages.one, "clip", value, after=0)
    assert pages.values() == {"clip": "3"}
    pages.keep(pages.other, "clip", "9", after=3)
    pages.keep(pages.one, "clip", "4", after=0)
    assert pages.values() == {"clip": "9"}


def test_a_removed_part_is_told_as_such(pages: Pages) -> None:
    pages.keep(pages.one, "mark.1", "1", after=0)
    pages.keep(pages.one, "mark.1", None, after=1)
    heard = asyncio.run(told(pages.other))
    assert heard[-1].part == protocol.KeptPart("mark.1", 2, None)


def test_what_is_no_json_is_answered_by_what_holds(pages: Pages) -> None:
    pages.keep(pages.one, "clip", "{", after=0)
    notice, answer = asyncio.run(told(pages.one))
    assert "JSON" in notice.text
    assert answer.part == protocol.KeptPart("clip", 0, None)
