"""A page that reads slowly is told the newest state, and every message once."""

from __future__ import annotations

import asyncio
from typing import Any

import msgspec
import pytest
from palpate import protocol
from palpate.server.messages import outbox as server_outbox
from palpate.server.messages.outbox import MOST_NOTICES, MOST_SAMPLES, Box, Missed, Outbox

RATE = protocol.Rate(asked_hz=1000.0, hz=1000.0, ticks=1, late=0, worst_late_ms=0.0)
ZERO = (0.0, 0.0, 0.0)


NO_TOOL = protocol.ToolState("none", 0.0, False, 0, 0.0, 0.0, 0.0, 0.0, 0, 1)  # noqa: FBT003

USUAL = protocol.ModelOptions(
    None,
    None,
    walls=False,
    prony=None,
    yield_strain=None,
    layers=None,
    calibration=None,
    motion=None,
    whole_segment=False,
)
NO_NEEDLE = protocol.NeedleState(
    inside=False,
    depth=0.0,
    entry=(0.0, 0.0, 0.0),
    direction=(0.0, 0.0, 0.0),
    segment=0,
    tip=0.0,
    friction=0.0,
    wall=0.0,
    events=0,
    set_direction=None,
)


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
        step=0,
        steps_made=0,
        tool=NO_TOOL,
        needle=NO_NEEDLE,
        matter=protocol.MatterState(
            None,
            USUAL,
            "matter",
            ZERO,
            0,
            late=False,
            settling=False,
            small_box=False,
            nodes=0,
            bonds_broken=0,
            work_broken=0.0,
        ),
        rates=protocol.Rates(RATE, RATE, RATE, RATE, real_time=False),
        safety=protocol.Safety(0, 0, 0, 0, 0, 0, 0, 0, 0, "on", None),
        recording=None,
        samples=[(tick + i / 1000, 0.0, 0.0, 0.0) for i in range(samples)],
    )


def told(outbox: Outbox, count: int) -> list[Any]:
    async def receive() -> list[bytes | Missed]:
        async with asyncio.timeout(60.0):
            return [await outbox.next() for _ in range(count)]

    return [
        told if isinstance(told, Missed) else msgspec.msgpack.decode(told)
        for told in asyncio.run(receive())
    ]


def test_states_never_queue_up_and_keep_their_samples() -> None:
    outbox = Outbox()
    for tick in range(10):
        outbox.put(state(tick))
    (only,) = told(outbox, 1)
    assert only["tick"] == 9
    assert [sample[0] for sample in only["samples"]][::4] == list(range(10))


def test_samples_of_a_page_that_sleeps_are_those_of_the_last_second() -> None:
    outbox = Outbox()
    for tick in range(1000):
        outbox.put(state(tick))
    (only,) = told(outbox, 1)
    assert len(only["samples"]) == MOST_SAMPLES
    assert only["samples"][-1][0] == state(999).samples[-1][0]


def test_messages_come_in_order_and_before_states() -> None:
    outbox = Outbox()
    outbox.put(state(1))
    outbox.put(protocol.Notice("info", "first"))
    outbox.put(protocol.Segments([], labels=1))
    outbox.put(protocol.Notice("info", "second"))
    outbox.put(protocol.Segments([], labels=2))
    kinds = [(message["type"], message.get("labels")) for message in told(outbox, 4)]
    assert kinds == [("notice", None), ("notice", None), ("segments", 2), ("state", None)]


def test_notices_do_not_pile_up() -> None:
    outbox = Outbox()
    for number in range(1000):
        outbox.put(protocol.Notice("error", str(number)))
    outbox.put(state(1))
    assert [message["type"] for message in told(outbox, MOST_NOTICES + 1)][-1] == "state"


def changed(edit: int, *, low: protocol.GridPlace, values: bool) -> protocol.Changed:
    """An edit of a box of 10 x 10 x 10 voxels: 2000 bytes of values, or 1000 of labels."""
    high = (low[0] + 10, low[1] + 10, low[2] + 10)
    stored, labels = (bytes(2000), None) if values else (None, bytes(1000))
    box = protocol.ChangedVoxels(low, high, stored, labels)
    return protocol.Changed(edit=edit, applied=None, voxels=[box], surfaces=[])


def test_changes_wait_in_order_up_to_a_number_of_bytes(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(server_outbox, "MOST_BYTES", 5000)
    outbox = Outbox()
    for edit in (1, 2, 3):
        outbox.put(changed(edit, low=(0, 0, 0), values=False))
    assert (outbox.waiting_bytes, outbox.is_behind) == (3000, False)
    assert [message["edit"] for message in told(outbox, 3)] == [1, 2, 3]
    assert outbox.waiting_bytes == 0


def test_of_a_page_that_falls_behind_only_boxes_and_the_other_messages_are_kept(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(server_outbox, "MOST_BYTES", 5000)
    outbox = Outbox()
    outbox.put(state(1))
    outbox.put(protocol.Notice("info", "first"))
    for edit in range(100):
        outbox.put(changed(edit, low=(edit, 7, 9), values=edit < 50))
        assert outbox.waiting_bytes <= 5000
    outbox.put(protocol.Segments([], labels=1))
    notice, segments, missed, newest = told(outbox, 4)
    kinds = [message["type"] for message in (notice, segments, newest)]
    assert kinds == ["notice", "segments", "state"]
    assert missed.stored == Box((0, 7, 9), (59, 17, 19))
    assert missed.labels == Box((50, 7, 9), (109, 17, 19))
    # from then on changes wait again, and come after what was missed
    outbox.put(changed(100, low=(0, 0, 0), values=False))
    assert not outbox.is_behind
    assert told(outbox, 1)[0]["edit"] == 100


def test_a_page_that_is_new_is_told_all_surfaces_after_what_it_begins_with() -> None:
    outbox = Outbox(missed=Missed())
    outbox.put(changed(1, low=(0, 0, 0), values=False))
    outbox.put(protocol.Segments([], labels=1))
    segments, missed = told(outbox, 2)
    assert segments["type"] == "segments"
    assert not missed.labels.is_empty


def displaced(edit: int, *, applied: float | None = None) -> protocol.Changed:
    """Where matter stands after an edit: 800 bytes."""
    box = protocol.Displaced(ZERO, (1.0, 1.0, 1.0), (10, 10, 1), bytes(800))
    return protocol.Changed(edit=edit, applied=applied, voxels=[], surfaces=[], displaced=[box])


def test_of_where_matter_stands_only_the_newest_waits() -> None:
    outbox = Outbox()
    box = changed(2, low=(0, 0, 0), values=False)
    with_edit = msgspec.structs.replace(box, displaced=displaced(2).displaced)
    for message in (displaced(1), with_edit, displaced(2), displaced(3, applied=1.0), displaced(3)):
        outbox.put(message)
    assert outbox.waiting_bytes == 1000 + 800
    messages = told(outbox, 3)
    # what has nothing else in it is forgotten; the edits stay
    assert [message["edit"] for message in messages] == [2, 3, 3]
    assert [message["displaced"] is None for message in messages] == [True, True, False]
    assert outbox.waiting_bytes == 0


def test_of_the_parts_of_a_model_only_the_newest_wait() -> None:
    outbox = Outbox()
    for count in (1, 2, 3):
        outbox.put(protocol.MatterParts(ZERO, ZERO, 1.0, bytes(6 * count), bytes(count)))
    outbox.put(state(1))
    parts, newest = told(outbox, 2)
    assert (parts["type"], len(parts["strains"]), newest["type"]) == ("matter_parts", 3, "state")


def test_states_go_before_pictures_and_pictures_come_all_the_same() -> None:
    async def run() -> list[str]:
        outbox = Outbox()
        outbox.put_picture(1, bytes(5_000_000))
        kinds = []
        for tick in range(6):
            # one state after another waits, and the page acknowledges no part
            outbox.put(state(tick))
            packed = await outbox.next()
            assert isinstance(packed, bytes)
            kinds.append(msgspec.msgpack.decode(packed)["type"])
        return kinds

    assert asyncio.run(run()) == [
        "state",
        "picture_part",
        "state",
        "picture_part",
        "state",
        "state",
    ]
