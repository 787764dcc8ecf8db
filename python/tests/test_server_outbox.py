"""A page that reads slowly is told the newest state, and every message once."""

from __future__ import annotations

import asyncio
from typing import Any

import msgspec
from palpate import protocol
from palpate.server_outbox import MOST_NOTICES, MOST_SAMPLES, Outbox

RATE = protocol.Rate(asked_hz=1000.0, hz=1000.0, ticks=1, late=0, worst_late_ms=0.0)
ZERO = (0.0, 0.0, 0.0)


NO_TOOL = protocol.ToolState("none", 0.0, False, 0, 0.0, 0.0, 0.0, 0.0, 0, 1)  # noqa: FBT003


def state(tick: int, samples: int = 4) -> protocol.State:
    return protocol.State(
        tick=tick,
        time=tick / 60,
        edit=0,
        device=ZERO,
        hand=ZERO,
        proxy=ZERO,
        contact_point=ZERO,
        normal=ZERO,
        force=ZERO,
        contact=False,
        depth=0.0,
        touched=0,
        probe_radius=0.0,
        poses=[],
        grabbed=0,
        clutched=False,
        device_origin=ZERO,
        pending=0,
        can_undo=False,
        can_redo=False,
        tool=NO_TOOL,
        rates=protocol.Rates(RATE, RATE, RATE, RATE, real_time=False),
        safety=protocol.Safety(0, 0, 0, 0, 0, 0, 0, 0, 0, "on", None),
        recording=None,
        samples=[(tick + i / 1000, 0.0, 0.0, 0.0) for i in range(samples)],
    )


def told(outbox: Outbox, count: int) -> list[Any]:
    async def receive() -> list[bytes]:
        return [await asyncio.wait_for(outbox.next(), 60.0) for _ in range(count)]

    return [msgspec.msgpack.decode(packed) for packed in asyncio.run(receive())]


def test_states_never_queue_up_and_keep_their_samples() -> None:
    outbox = Outbox()
    for tick in range(10):
        outbox.tell(state(tick))
    (only,) = told(outbox, 1)
    assert only["tick"] == 9
    assert [sample[0] for sample in only["samples"]][::4] == list(range(10))


def test_samples_of_a_page_that_sleeps_are_those_of_the_last_second() -> None:
    outbox = Outbox()
    for tick in range(1000):
        outbox.tell(state(tick))
    (only,) = told(outbox, 1)
    assert len(only["samples"]) == MOST_SAMPLES
    assert only["samples"][-1][0] == state(999).samples[-1][0]


def test_messages_come_in_order_and_before_states() -> None:
    outbox = Outbox()
    outbox.tell(state(1))
    outbox.tell(protocol.Notice("info", "first"))
    outbox.tell(protocol.Segments([], labels=1))
    outbox.tell(protocol.Notice("info", "second"))
    outbox.tell(protocol.Segments([], labels=2))
    kinds = [(message["type"], message.get("labels")) for message in told(outbox, 4)]
    assert kinds == [("notice", None), ("notice", None), ("segments", 2), ("state", None)]


def test_notices_do_not_pile_up() -> None:
    outbox = Outbox()
    for number in range(1000):
        outbox.tell(protocol.Notice("error", str(number)))
    outbox.tell(state(1))
    assert [message["type"] for message in told(outbox, MOST_NOTICES + 1)][-1] == "state"
