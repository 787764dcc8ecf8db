"""Messages on segments: their properties, their surfaces and their labels."""

from __future__ import annotations

from typing import Any

import numpy as np
from running_server import voxels

SURFACE_LOOK = {
    "shown_as": "volume",
    "opacity": 1.0,
    "smoothing": 3,
    "surface_from": "intensities",
    "wireframe": False,
    "ambient": 1.0,
    "specular": 1.0,
    "touched_while_hidden": False,
}
"""How a surface looks as long as nobody says otherwise."""


def test_removing_a_segment_is_undone_with_its_name_and_colour(server: Any) -> None:
    with server.page() as page:
        (ball,) = page.receive("hello")["segments"]
        page.send({"type": "remove_segment", "id": 1})
        page.receive("segments", until=lambda m: m["segments"] == [])
        page.send({"type": "undo"})
        (back,) = page.receive("segments", until=lambda m: m["segments"] != [])["segments"]
        assert (back["name"], back["colour"]) == (ball["name"], ball["colour"])
        assert back["voxels"] == ball["voxels"]


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
        "touched_while_hidden": False,
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


def test_a_new_segment_is_shown_from_its_voxels(server: Any) -> None:
    with server.page() as page:
        segment = page.receive("hello")["segments"][0]
    assert {name: segment[name] for name in SURFACE_LOOK} == SURFACE_LOOK


def test_labels_hold_no_thresholds(shared_server: Any) -> None:
    assert not voxels(shared_server, "/api/labels", "u1").any()


def test_labels_hold_edited_segments_also_while_they_are_hidden(server: Any) -> None:
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
        told = page.receive("segments", until=lambda m: not m["segments"][0]["visible"])
        assert told["labels"] == after["labels"], "nothing is fetched anew"
        np.testing.assert_array_equal(voxels(server, "/api/labels", "u1"), expected)


def test_what_is_hidden_on_a_page_is_not_felt_unless_it_is_pinned(server: Any) -> None:
    look = {"type": "segment_properties", "id": 1, "name": "ball", "colour": [1, 0, 0]}
    look |= SURFACE_LOOK | {"visible": True, "touchable": True, "locked": False}
    hidden = look | {"visible": False}
    pinned = hidden | {"touched_while_hidden": True}
    for sent, felt in (
        (hidden, False),
        (pinned, True),
        (pinned | {"touchable": False}, False),
        (hidden, False),
        (look, True),
        # both at once, as a step of undo may
        (hidden | {"touchable": False}, False),
        (look, True),
    ):
        with server.page() as page:
            page.receive("hello")
            page.send(sent)
            page.receive(
                "segments",
                # a list may be told between the wish and what touch makes of it
                until=lambda m, wanted=sent | {"felt": felt}: all(
                    m["segments"][0][name] == wanted[name]
                    for name in ("visible", "touchable", "touched_while_hidden", "felt")
                ),
            )
            (state,) = server.session.segments()
            assert (state["touchable"], state["felt"]) == (sent["touchable"], felt)
            # whoever comes later is told the same
            with server.page() as later:
                assert later.receive("hello")["segments"][0]["felt"] == felt


def test_many_segments_are_shown_and_hidden_by_one_message(server: Any) -> None:
    with server.page() as page:
        page.receive("hello")
        page.send({"type": "new_segment", "name": "second"})
        page.receive("segments", until=lambda m: len(m["segments"]) == 2)
        for visible in (False, True):
            alike = {"ids": [1, 2], "visible": visible, "shown_as": None}
            other = {"ids": [2], "visible": None, "shown_as": "surface" if visible else "both"}
            page.send({"type": "show_segments", "changes": [alike, other]})
            told = page.receive(
                "segments",
                until=lambda m, wanted=visible: all(s["felt"] is wanted for s in m["segments"]),
            )["segments"]
            assert [each["visible"] for each in told] == [visible, visible]
            assert told[1]["shown_as"] == other["shown_as"]
            assert told[0]["shown_as"] == SURFACE_LOOK["shown_as"]


def test_a_segment_that_is_not_there_leaves_the_others_as_they_are(server: Any) -> None:
    with server.page() as page:
        page.receive("hello")
        change = {"ids": [1, 9], "visible": False, "shown_as": None}
        page.send({"type": "show_segments", "changes": [change]})
        assert "segment 9" in page.receive("notice")["text"]
    assert server.session.segments()[0]["touchable"]
