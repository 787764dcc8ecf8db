"""The server as a page meets it: data over HTTP, and the session over the WebSocket."""

from __future__ import annotations

import socket
from typing import Any

import msgspec
import numpy as np
import pytest
from palpate import protocol
from palpate.base.errors import OptionError
from palpate.server.app import bind
from running_server import PATIENCE, voxels

SURFACE_LOOK = {
    "shown_as": "volume",
    "opacity": 1.0,
    "smoothing": 3,
    "surface_from": "intensities",
    "wireframe": False,
    "ambient": 1.0,
    "specular": 1.0,
}
"""How a surface looks as long as nobody says otherwise."""

# --- http -------------------------------------------------------------------------------


@pytest.mark.parametrize("step", [1, 2, 3, 7, 41, 64])
def test_the_volume_arrives_with_every_step_th_voxel(shared_server: Any, step: int) -> None:
    array = shared_server.session.scene.volume.array
    got = voxels(shared_server, f"/api/volume?step={step}", "<i2")
    np.testing.assert_array_equal(got, array[::step, ::step, ::step])


@pytest.mark.parametrize("step", ["0", "-1", "65", "1.5", "x", "", "1" * 5000, "٣"])
@pytest.mark.parametrize("route", ["/api/volume", "/api/labels"])
def test_another_step_is_refused_with_what_is_allowed(
    shared_server: Any, route: str, step: str
) -> None:
    answer = shared_server.get(f"{route}?step={step}")
    assert answer.status_code == 400
    assert "allowed: a whole number 1 to 64" in answer.text


def test_labels_hold_no_thresholds(shared_server: Any) -> None:
    assert not voxels(shared_server, "/api/labels", "u1").any()


def test_labels_hold_edited_segments_while_they_are_visible(server: Any) -> None:
    with server.page() as page:
        before = page.receive("segments")
        server.session.fill_box(1, low=(18, 18, 18), high=(22, 22, 22), solid=False)
        after = page.receive("segments", until=lambda m: m["segments"][0]["range"] is None)
        assert after["labels"] > before["labels"]
        expected = server.session.segment(1).mask()
        assert expected[20, 20, 20] == 0
        np.testing.assert_array_equal(voxels(server, "/api/labels", "u1"), expected)

        hidden = {"type": "segment_properties", "id": 1, "name": "ball", "colour": [1, 0, 0]}
        page.send(hidden | SURFACE_LOOK | {"visible": False, "touchable": True, "locked": False})
        page.receive("segments", until=lambda m: m["labels"] > after["labels"])
        assert not voxels(server, "/api/labels", "u1").any()


# --- messages ---------------------------------------------------------------------------


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


def test_the_hand_presses_the_probe_against_the_ball(server: Any) -> None:
    with server.page() as page:
        # above the ball: free, with the device there
        page.send({"type": "place", "point": [20.0, 20.0, 34.0]})
        page.receive("state", until=lambda m: abs(m["proxy"][2] - 34.0) < 0.5)
        page.send({"type": "hand", "target": [20.0, 20.0, 24.0]})
        state = page.receive("state", until=lambda m: m["touched"] == 1 and m["force"][2] > 0.5)

        # on the ball's top step or the next, never in it; the spring pushes up
        assert state["contact"]
        assert state["depth"] > 0.5
        assert state["proxy"][2] == pytest.approx(28.0, abs=0.51)
        assert not server.session.segment(1).contains(state["proxy"])[0]

        # away again: no force
        page.send({"type": "hand", "target": [20.0, 20.0, 34.0]})
        state = page.receive("state", until=lambda m: not m["contact"])
        state = page.receive("state", until=lambda m: m["force"] == [0.0, 0.0, 0.0])
        assert state["safety"]["violations"] == 0


def test_samples_of_the_force_are_told_once_and_in_order(shared_server: Any) -> None:
    times: list[float] = []
    with shared_server.page() as page:
        page.receive("state")
        while len(times) < 100:
            times += [sample[0] for sample in page.receive("state")["samples"]]
    steps = np.diff(times)
    # by the servo's clock, which runs on where a thread is late: no sample told twice or out of
    # order. That none is left out is tested in lock-step (crates/engine/tests/session/offline.rs)
    assert steps.min() > 0.0


def test_a_threshold_makes_a_segment_and_changes_it(server: Any) -> None:
    with server.page() as page:
        new = {"type": "threshold", "id": None, "name": "air", "low": -1000.0, "high": -900.0}
        page.send(new)
        both = page.receive("segments", until=lambda m: len(m["segments"]) == 2)["segments"]
        assert both[1]["name"] == "air"
        assert both[1]["voxels"] == 41**3 - both[0]["voxels"]
        assert both[0]["colour"] != both[1]["colour"]

        page.send(new | {"id": 2, "name": "all", "high": 100.0})
        both = page.receive("segments", until=lambda m: m["segments"][1]["name"] == "all")[
            "segments"
        ]
        assert both[1]["voxels"] == 41**3
        assert both[1]["range"] == [-1000.0, 100.0]


def test_removing_a_segment_is_undone_with_its_name_and_colour(server: Any) -> None:
    with server.page() as page:
        (ball,) = page.receive("hello")["segments"]
        page.send({"type": "remove_segment", "id": 1})
        page.receive("segments", until=lambda m: m["segments"] == [])
        page.send({"type": "undo"})
        (back,) = page.receive("segments", until=lambda m: m["segments"] != [])["segments"]
        assert (back["name"], back["colour"]) == (ball["name"], ball["colour"])
        assert back["voxels"] == ball["voxels"]


def test_a_drag_of_a_threshold_ends_at_its_last_position(server: Any) -> None:
    with server.page() as page:
        page.receive("hello")
        for low in range(-1000, 0, 2):
            message = {"type": "threshold", "id": 1, "name": "ball", "low": low, "high": 100.0}
            page.send(message)
        last = page.receive("segments", until=lambda m: m["segments"][0]["range"][0] == -2.0)
        assert last["segments"][0]["voxels"] == int(
            (server.session.scene.volume.array == 100).sum()
        )


def test_properties_are_told_to_all_pages(server: Any) -> None:
    with server.page() as first, server.page() as second:
        change = {"type": "segment_properties", "id": 1, "name": "stone", "colour": [0, 0.5, 1]}
        first.send(change | SURFACE_LOOK | {"visible": True, "touchable": False, "locked": False})
        for page in (first, second):
            told = page.receive("segments", until=lambda m: m["segments"][0]["name"] == "stone")
            assert told["segments"][0]["colour"] == [0.0, 0.5, 1.0]
            assert told["segments"][0]["touchable"] is False


def test_how_a_surface_looks_is_kept_with_its_segment(server: Any) -> None:
    wanted = {
        "shown_as": "both",
        "opacity": 0.4,
        "smoothing": 5,
        "surface_from": "bits",
        "wireframe": True,
        "ambient": 0.5,
        "specular": 0.0,
    }
    change = {"type": "segment_properties", "id": 1, "name": "ball", "colour": [1, 0, 0]}
    with server.page() as page:
        page.send(change | wanted | {"visible": True, "touchable": True, "locked": False})
        page.receive("segments", until=lambda m: m["segments"][0]["shown_as"] == "both")
        # another threshold is still the same segment
        threshold = {"type": "threshold", "id": 1, "name": "stone", "low": 50.0, "high": 200.0}
        page.send(threshold)
        told = page.receive("segments", until=lambda m: m["segments"][0]["name"] == "stone")
    with server.page() as later:
        hello = later.receive("hello")
    for segment in (told["segments"][0], hello["segments"][0]):
        assert {name: segment[name] for name in wanted} == wanted


def test_a_surface_is_made_from_what_its_segment_says(server: Any) -> None:
    change = {"type": "segment_properties", "id": 1, "name": "ball", "colour": [1, 0, 0]}
    change |= SURFACE_LOOK | {"visible": True, "touchable": True, "locked": False}
    change |= {"shown_as": "surface"}
    found: dict[str, list[Any]] = {}
    with server.page() as page:
        for source in ("intensities", "bits", "intensities"):
            page.send(change | {"surface_from": source})
            made = page.receive("changed", until=lambda m: m["surfaces"])
            found.setdefault(source, []).append(made["surfaces"][0])
    assert all(surface["whole"] for surfaces in found.values() for surface in surfaces)
    first, again = found["intensities"]
    assert first == again
    (of_bits,) = found["bits"]
    # the ball has 100 HU in -1000 HU, from 0 on: so its surface lies beyond the middle of edges
    assert first["patches"] != of_bits["patches"]


def test_a_new_segment_under_the_number_of_a_surface_is_none(server: Any) -> None:
    """Undo can bring a removed segment back only as long as nothing new was done."""
    change = {"type": "segment_properties", "id": 2, "name": "old", "colour": [1, 0, 0]}
    change |= SURFACE_LOOK | {"visible": True, "touchable": True, "locked": False}
    change |= {"shown_as": "surface"}
    threshold = {"type": "threshold", "id": None, "name": "old", "low": 0.0, "high": 200.0}
    with server.page() as page:
        page.send(threshold)
        page.receive("segments", until=lambda m: len(m["segments"]) == 2)
        page.send(change)
        page.receive("changed", until=lambda m: m["surfaces"])
        page.send({"type": "undo"})
        page.receive("segments", until=lambda m: len(m["segments"]) == 1)
        # another change ends what redo could bring back: the number is free
        server.session.fill_box(1, low=(18, 18, 18), high=(22, 22, 22), solid=False)
        page.send(threshold | {"name": "new"})
        told = page.receive("segments", until=lambda m: len(m["segments"]) == 2)
    new = told["segments"][1]
    assert (new["id"], new["name"], new["shown_as"]) == (2, "new", "volume")
    # nothing is made that nobody sees
    assert server.session.whole_surfaces()["surfaces"] == []


def test_the_slowest_page_says_how_often_surfaces_follow(server: Any) -> None:
    asked: list[int] = []
    follow = server.session.follow_edits

    def noted(every: int) -> None:
        asked.append(every)
        follow(every)

    server.session.follow_edits = noted
    with server.page() as quick:
        with server.page() as slow:
            slow.send({"type": "follow_edits", "every": 4})
            quick.receive("state", until=lambda _: asked == [4])
            quick.send({"type": "follow_edits", "every": 2})
            quick.receive("state", until=lambda _: asked == [4, 4])
        # the slow one leaves
        quick.receive("state", until=lambda _: asked[-1] == 2)
        quick.send({"type": "follow_edits", "every": 5})
        refused = quick.receive("notice", until=lambda m: m["level"] == "error")
        assert "<= 4" in refused["text"]


def test_a_new_segment_is_shown_from_its_voxels(server: Any) -> None:
    with server.page() as page:
        segment = page.receive("hello")["segments"][0]
    assert {name: segment[name] for name in SURFACE_LOOK} == SURFACE_LOOK


def test_settings_are_told_as_the_engine_holds_them(server: Any) -> None:
    wanted = {
        "model": "exact",
        "stiffness": 0.5,
        "damping": 0.0,
        "friction_static": 0.3,
        "friction_kinetic": 0.2,
        "smoothing": "off",
        "probe_radius": 1.5,
        "force_limit": 2.0,
        "gain": 2.0,
    }
    with server.page() as page:
        page.send({"type": "change_settings", "settings": wanted})
        assert page.receive("settings_changed")["settings"] == wanted
        # there is room for the ball where the probe is
        page.receive("state", until=lambda m: m["probe_radius"] == 1.5)
        # where the servo is late the force is off for a moment, and comes back
        page.receive("state", until=lambda m: m["safety"]["off"] in {None, "waiting"})
    with server.page() as page:
        assert page.receive("hello")["settings"] == wanted


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
        ({"type": "view", "right": [1.0, 0.0, 0.0], "up": [1.0, 0.0, 0.0]}, "allowed"),
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


def test_pages_are_told_that_the_session_has_ended(server: Any) -> None:
    with server.page() as page:
        page.receive("state")
        server.session.stop()
        page.receive("notice", until=lambda m: "the session has ended" in m["text"])
    # data is still there
    assert server.get("/api/volume?step=8").status_code == 200


# --- ports ------------------------------------------------------------------------------


def test_a_port_in_use_is_refused() -> None:
    with socket.create_server(("127.0.0.1", 0)) as other:
        port = other.getsockname()[1]
        with pytest.raises(
            OptionError, match=f"port {port} cannot be used .* allowed: a free port"
        ):
            bind(port)


@pytest.mark.parametrize("port", [-1, 70000])
def test_what_is_no_port_is_refused(port: int) -> None:
    with pytest.raises(OptionError, match="allowed: a free port from 1 to 65535"):
        bind(port)


def test_the_server_listens_on_this_machine_only(server: Any) -> None:
    addresses = {str(info[4][0]) for info in socket.getaddrinfo(socket.gethostname(), None)}
    for address in addresses - {"127.0.0.1", "::1"}:
        family = socket.AF_INET6 if ":" in address else socket.AF_INET
        with socket.socket(family) as other:
            other.settimeout(1.0)
            assert other.connect_ex((address, server.access.port)) != 0
