"""The schema lets through what it describes, and nothing else."""

from __future__ import annotations

from typing import Any

import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st
from palpate import protocol

COORDINATE = st.floats(-1e6, 1e6)
VECTOR = st.tuples(COORDINATE, COORDINATE, COORDINATE)


@given(VECTOR)
def test_a_hand_arrives_as_it_was_sent(target: tuple[float, float, float]) -> None:
    packed = msgspec.msgpack.encode({"type": "hand", "target": list(target)})
    assert protocol.decode_from_page(packed) == protocol.Hand(target)


def test_whole_numbers_of_a_browser_are_numbers() -> None:
    packed = msgspec.msgpack.encode({"type": "place", "point": [1, -2, 3.5]})
    assert protocol.decode_from_page(packed) == protocol.Place((1.0, -2.0, 3.5))


SETTINGS = {
    "model": "exact",
    "stiffness": 1.0,
    "damping": 0.0,
    "friction_static": 0.2,
    "friction_kinetic": 0.1,
    "smoothing": "intensities",
    "probe_radius": 0.0,
    "force_limit": 3.0,
}


PROPERTIES = {
    "type": "segment_properties",
    "id": 1,
    "name": "bone",
    "colour": [1, 1, 1],
    "visible": True,
    "touched_while_hidden": False,
    "touchable": True,
    "locked": False,
    "shown_as": "both",
    "opacity": 0.5,
    "smoothing": 12,
    "surface_from": "bits",
    "wireframe": True,
    "ambient": 1.0,
    "specular": 3.0,
}


@pytest.mark.parametrize(
    "message",
    [
        {},
        [],
        "hand",
        {"type": "hand"},
        {"type": "hand", "target": [1.0, 2.0]},
        {"type": "hand", "target": [1.0, 2.0, float("nan")]},
        {"type": "hand", "target": [1.0, 2.0, float("inf")]},
        {"type": "hand", "target": [1.0, 2.0, 1e9]},
        {"type": "hand", "target": [1.0, 2.0, "3"]},
        {"type": "hand", "target": [1.0, 2.0, 3.0], "more": 1},
        {"type": "unknown"},
        {"type": "state"},
        {"type": "threshold", "id": 0, "name": "bone", "low": 1.0, "high": 2.0},
        {"type": "threshold", "id": 256, "name": "bone", "low": 1.0, "high": 2.0},
        {"type": "threshold", "id": None, "name": "", "low": 1.0, "high": 2.0},
        {"type": "threshold", "id": None, "name": "x" * 101, "low": 1.0, "high": 2.0},
        {"type": "threshold", "id": None, "name": "bone", "low": float("nan"), "high": 2.0},
        {"type": "change_settings", "settings": SETTINGS | {"stiffness": 0.0}},
        {"type": "change_settings", "settings": SETTINGS | {"force_limit": 41.0}},
        {"type": "change_settings", "settings": SETTINGS | {"damping": -0.1}},
        {"type": "change_settings", "settings": SETTINGS | {"model": "chai3d"}},
        {"type": "change_settings", "settings": SETTINGS | {"probe_radius": -1.0}},
        {"type": "move_segment", "id": 1, "pose": [1.0] * 15, "goes_on": False},
        PROPERTIES | {"shown_as": "mesh"},
        PROPERTIES | {"opacity": 1.1},
        PROPERTIES | {"smoothing": 13},
        PROPERTIES | {"smoothing": 0.5},
        PROPERTIES | {"wireframe": 1},
        PROPERTIES | {"specular": 3.1},
    ],
)
def test_what_is_not_of_the_schema_is_refused(message: Any) -> None:
    with pytest.raises(msgspec.DecodeError):
        protocol.decode_from_page(msgspec.msgpack.encode(message))


@given(st.binary(max_size=64))
def test_bytes_that_are_no_message_never_pass(packed: bytes) -> None:
    try:
        message = protocol.decode_from_page(packed)
    except msgspec.DecodeError:
        return
    assert isinstance(message, (protocol.Undo, protocol.Redo))


def test_messages_to_the_page_carry_their_type() -> None:
    packed = protocol.encode_to_page(protocol.Notice(level="info", text="hello"))
    assert msgspec.msgpack.decode(packed) == {"type": "notice", "level": "info", "text": "hello"}


def test_the_looks_of_a_surface_pass() -> None:
    packed = msgspec.msgpack.encode(PROPERTIES)
    assert isinstance(protocol.decode_from_page(packed), protocol.SegmentProperties)


def test_the_bytes_of_a_patch_are_sent_as_they_are() -> None:
    patch = protocol.SurfacePatch(
        index=(0, -1, 2),
        origin=(0.0, 0.0, 0.0),
        size=(1.0, 1.0, 1.0),
        vertices=bytes(range(18)),
        normals=bytes(12),
        triangles=bytes([0, 0, 1, 0, 2, 0]),
    )
    surface = protocol.SegmentSurface(id=1, whole=True, dropped=[(1, 1, 1)], patches=[patch])
    box = protocol.ChangedVoxels(low=(1, 2, 3), high=(2, 3, 4), stored=b"\x05\xfc", labels=None)
    changed = protocol.Changed(edit=7, applied=None, voxels=[box, box], surfaces=[surface])
    sent = msgspec.msgpack.decode(protocol.encode_to_page(changed))
    assert sent["type"] == "changed"
    assert sent["surfaces"][0]["patches"][0]["vertices"] == bytes(range(18))
    assert [voxels["stored"] for voxels in sent["voxels"]] == 2 * [b"\x05\xfc"]
    assert sent["voxels"][0]["labels"] is None
