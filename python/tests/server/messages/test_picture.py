"""Pages that do not read for a long time: the server keeps little, and they end up right."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from made_scans import make_ball
from palpate import protocol
from palpate.server import live as server_live
from palpate.server.messages import outbox as server_outbox
from palpate.server.messages.outbox import Box, Outbox
from palpate.server.messages.picture import PublishedPicture, label_messages, voxel_slabs
from palpate.session.picture_change import PictureChange
from palpate.session.session import Session
from running_server import PATIENCE, Page, RunningServer, running, write_page

MOST_BYTES = 100_000
"""What may wait for a page here: the changes of a few edits."""


class Watched(Outbox):
    """An outbox of which a test sees how full it was."""

    all: list[Watched]

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        self.fullest = 0
        self.fell_behind = 0
        Watched.all.append(self)

    def put(self, message: protocol.ToPage) -> None:
        was_behind = self.is_behind
        super().put(message)
        self.fullest = max(self.fullest, self.waiting_bytes)
        self.fell_behind += self.is_behind and not was_behind


class Picture:
    """What a page holds after the messages that it was told."""

    def __init__(self, labels: np.ndarray) -> None:
        self.labels = labels.copy()
        self.patches: dict[int, dict[Any, Any]] = {}

    def take(self, message: dict[str, Any]) -> None:
        if message["type"] != "changed":
            return
        for box in message["voxels"]:
            (x, y, z), (to_x, to_y, to_z) = box["low"], box["high"]
            if box["labels"] is not None:
                new = np.frombuffer(box["labels"], np.uint8)
                new = new.reshape(to_z - z, to_y - y, to_x - x)
                self.labels[z:to_z, y:to_y, x:to_x] = new
        for surface in message["surfaces"]:
            self.take_surface(surface)

    def take_surface(self, surface: Any) -> None:
        """Follows a change of a surface, of a message or of the engine."""
        patches = self.patches.setdefault(surface["id"], {})
        if surface["whole"]:
            patches.clear()
        for index in surface["dropped"]:
            patches.pop(tuple(index), None)
        patches.update({tuple(patch["index"]): patch for patch in surface["patches"]})

    def is_right(self, session: Session) -> bool:
        """Compares with what the engine holds by now."""
        true = Picture(session.segment(1).mask())
        whole = session.whole_surfaces()
        for surface in whole["surfaces"]:
            true.take_surface(surface)
        there = {number: patches for number, patches in self.patches.items() if patches}
        return np.array_equal(self.labels, true.labels) and _same(there, true.patches)


def _same(one: dict[int, dict[Any, Any]], other: dict[int, dict[Any, Any]]) -> bool:
    bodies = ("vertices", "normals", "triangles")
    packed = [
        {
            (number, index): tuple(patch[name] for name in bodies)
            for number, patches in surfaces.items()
            for index, patch in patches.items()
        }
        for surfaces in (one, other)
    ]
    return packed[0] == packed[1]


def edit(session: Session, number: int) -> None:
    """Opens or closes a box somewhere in the ball."""
    rng = np.random.default_rng(number)
    x, y, z = (int(n) for n in rng.integers(10, 24, size=3))
    session.fill_box(1, low=(x, y, z), high=(x + 8, y + 8, z + 8), solid=number % 2 == 1)


def show_surface(page: Page) -> None:
    look = {"shown_as": "both", "opacity": 1.0, "smoothing": 3, "wireframe": False}
    look |= {"ambient": 1.0, "specular": 1.0}
    look |= {"surface_from": "intensities", "touched_while_hidden": False}
    properties = {"type": "segment_properties", "id": 1, "name": "ball", "colour": [1, 0, 0]}
    page.send(properties | look | {"visible": True, "touchable": True, "locked": False})
    page.receive("changed", until=lambda m: m["surfaces"] != [])


@pytest.fixture
def server(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Any:
    monkeypatch.setattr(server_outbox, "MOST_BYTES", MOST_BYTES)
    monkeypatch.setattr(server_live, "Outbox", Watched)
    monkeypatch.setattr("palpate.server.app.PAGE_PATIENCE", None)
    Watched.all = []
    with running(make_ball(), write_page(tmp_path / "page")) as started:
        yield started


def test_a_page_that_does_not_read_while_edits_run_is_right_in_the_end_and_slows_nobody(
    server: RunningServer,
) -> None:
    session = server.session
    with server.page() as page:
        # edited, so that labels hold it
        edit(session, 0)
        show_surface(page)
        # little room at this end, and nothing that ends a connection which is not read
        with server.page(room=4096, max_queue=1, ping_interval=None, close_timeout=0.1) as lazy:
            lazy.receive("segments", until=lambda m: m["segments"][0]["range"] is None)
            # it asks for labels then
            late = Picture(session.segment(1).mask())
            slow = Watched.all[-1]
            number = 0
            while slow.fell_behind == 0 or number % 100 != 0:
                number += 1
                edit(session, number)
                # the other page is told what is all the while
                page.receive("state")
                assert number < 100_000, "a page that does not read never falls behind"
            assert slow.is_behind
            assert slow.fullest <= MOST_BYTES

            ends = time.monotonic() + PATIENCE
            while not late.is_right(session):
                assert time.monotonic() < ends, "the page never gets right"
                late.take(lazy.next())


# --- what is told anew ------------------------------------------------------------------


def test_a_box_is_told_in_slabs_of_whole_slices(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("palpate.server.messages.picture.MOST_VOXELS", 100)
    array = np.arange(10 * 11 * 12, dtype="<i2").reshape(10, 11, 12)
    box = Box((1, 2, 3), (7, 9, 10))
    slabs = list(voxel_slabs(box, array))
    # 6 x 7 voxels of a slice, two slices in 100
    assert [(low[2], high[2]) for low, high, _ in slabs] == [(3, 5), (5, 7), (7, 9), (9, 10)]
    assert b"".join(packed for *_, packed in slabs) == array[3:10, 2:9, 1:7].tobytes()
    assert list(voxel_slabs(Box(), array)) == []


def test_values_follow_edits_and_those_of_the_scan_stay() -> None:
    scan = np.zeros((4, 5, 6), np.int16)
    picture = PublishedPicture(scan)
    stored = np.arange(2 * 3 * 4, dtype="<i2")
    box = protocol.ChangedVoxels((1, 2, 1), (5, 5, 3), stored.tobytes(), None)
    picture.take(protocol.Changed(edit=7, applied=None, voxels=[box], surfaces=[]))
    np.testing.assert_array_equal(picture.values[1:3, 2:5, 1:5], stored.reshape(2, 3, 4))
    assert picture.values.sum() == stored.sum()
    assert not scan.any()
    (told,) = picture.value_messages(Box((1, 2, 1), (5, 5, 3)), edit=7)
    assert told.edit == 7
    assert told.voxels == [box]


def test_labels_of_a_box_are_told_as_they_are() -> None:
    labels = np.arange(4 * 5 * 6, dtype=np.uint8).reshape(4, 5, 6)
    (told,) = label_messages(Box((0, 1, 2), (6, 2, 3)), labels, edit=3)
    assert told.voxels[0].labels == labels[2:3, 1:2].tobytes()
    assert told.voxels[0].stored is None


def test_a_surface_that_is_gone_is_forgotten() -> None:
    picture = PublishedPicture(np.zeros((2, 2, 2), np.int16))
    gone = protocol.SegmentSurface(5, whole=True, dropped=[], patches=[])
    picture.take(protocol.Changed(edit=1, applied=None, voxels=[], surfaces=[gone]))
    whole: PictureChange = {
        "edit": 0,
        "applied": None,
        "voxels": [],
        "surfaces": [],
        "displaced": None,
    }
    (told,) = picture.surface_messages(whole, edit=1)
    assert told.surfaces == [gone]
    # a page that is new is told nothing where there never was a surface
    assert (
        list(PublishedPicture(np.zeros((2, 2, 2), np.int16)).surface_messages(whole, edit=1)) == []
    )


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
