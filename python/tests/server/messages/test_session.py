"""Messages on the session: the first ones, fences, and what is refused."""

from __future__ import annotations

from typing import Any

import msgspec
import numpy as np
import pytest
from palpate import protocol
from running_server import PATIENCE


def test_a_page_is_told_first_what_it_shows(shared_server: Any) -> None:
    with shared_server.page() as page:
        first = msgspec.msgpack.decode(
            page.socket.recv(timeout=PATIENCE, decode=False), type=protocol.Hello
        )
    assert first.protocol == protocol.PROTOCOL_VERSION
    assert first.scan.name == "ball"
    assert first.scan.unit == "HU"
    assert first.scan.dimensions == (41, 41, 41)
    assert first.scan.range == (-1000.0, 100.0)
    assert sum(first.scan.histogram.counts) == 41**3
    assert np.reshape(first.scan.patient_from_grid, (4, 4)) @ (0.5, 0.5, 0.5, 1.0) == pytest.approx(
        (0.0, 0.0, 0.0, 1.0)
    )
    (ball,) = first.segments
    assert ball.name == "ball"
    assert ball.range == (0.0, 100.0)
    assert ball.voxels == int((shared_server.session.scene.volume.array == 100).sum())
    assert ball.volume_ml == pytest.approx(ball.voxels / 1000.0)


def test_every_message_of_the_server_is_of_the_schema(shared_server: Any) -> None:
    decoder = msgspec.msgpack.Decoder(protocol.ToPage)
    kinds: list[type] = []
    with shared_server.page() as page:
        while kinds.count(protocol.State) < 8:
            kinds.append(type(decoder.decode(page.socket.recv(timeout=PATIENCE, decode=False))))
    assert kinds[:2] == [protocol.Hello, protocol.Segments]


def test_a_fence_is_passed_when_all_before_it_is_done_and_told(server: Any) -> None:
    with server.page() as page:
        settings = page.receive("hello")["settings"] | {"stiffness": 0.25}
        for number, z in enumerate((34.0, 36.0, 32.0)):
            page.send({"type": "change_settings", "settings": settings})
            page.send({"type": "place", "point": [20.0, 20.0, z]})
            page.send({"type": "hand", "target": [21.0, 20.0, z]})
            page.send({"type": "fence", "number": number})
            kinds: list[str] = []
            while "passed" not in kinds:
                message = page.next()
                kinds.append(message["type"])
            assert message["number"] == number
            assert "settings_changed" in kinds
            tick = message["tick"]
            state = page.receive("state", until=lambda m, tick=tick: m["tick"] >= tick)
            assert state["hand"] == [21.0, 20.0, z]


@pytest.mark.parametrize(
    ("message", "said"),
    [
        ({"type": "hand", "target": [0.0, 0.0, float("nan")]}, "not understood"),
        ({"type": "nonsense"}, "not understood"),
        ({"type": "remove_segment", "id": 77}, "77"),
        ({"type": "view", "right": [1.0, 0.0, 0.0], "up": [1.0, 0.0, 0.0]}, "Use two directions"),
        ({"type": "threshold", "id": None, "name": "none", "low": 5000, "high": 6000}, "no voxel"),
        ({"type": "threshold", "id": None, "name": "none", "low": 50, "high": 40}, "no range"),
    ],
)
def test_what_cannot_be_done_is_a_notice_and_nothing_else(
    shared_server: Any, message: dict[str, Any], said: str
) -> None:
    with shared_server.page() as page:
        page.send(message)
        notice = page.receive("notice", until=lambda m: said in m["text"])
        assert notice["level"] == "error"
        page.receive("state")


@pytest.mark.parametrize("packed", [b"", b"\xc1", b"\xff" * 100, b"\x81\xa4type\xa1\xff"])
def test_bytes_that_are_no_message_are_a_notice(shared_server: Any, packed: bytes) -> None:
    with shared_server.page() as page:
        page.socket.send(packed)
        page.receive("notice", until=lambda m: "not understood" in m["text"])
        page.receive("state")


def test_a_text_is_no_message(shared_server: Any) -> None:
    with shared_server.page() as page:
        page.socket.send("hello")
        page.receive("notice", until=lambda m: "not understood" in m["text"])
        page.receive("state")
