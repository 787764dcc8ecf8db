"""Pictures for files: in strips, at any size, of one moment, after those of the live view."""

from __future__ import annotations

import math
import struct
from collections.abc import Callable
from threading import Thread
from typing import Any

import msgspec
import numpy as np
import pytest
from made_scans import make_ball
from numpy.typing import NDArray
from palpate.base.errors import OptionError
from palpate.pictures.appearance import Appearance, ShownSegment
from palpate.pictures.camera import Camera
from palpate.pictures.live_view import LiveView
from palpate.pictures.session_pictures import Fineness, SessionPictures
from palpate.pictures.still_pictures import StillPictures
from palpate.pictures.strips import MOST_RAYS, Strip, strips_of
from palpate.session.session import Session

FRONT = Camera(
    target=(20.0, 20.0, 20.0),
    distance=100.0,
    right=(1.0, 0.0, 0.0),
    up=(0.0, 0.0, 1.0),
    back=(0.0, -1.0, 0.0),
    field=0.35,
)
BALL = Appearance(
    transfer=((0.0, (0.0, 0.0, 0.0), 0.0), (1.0, (1.0, 1.0, 1.0), 0.0)),
    edge_gradient=1.0,
    window=(400.0, 40.0),
    iso_value=250.0,
    iso_colour=(1.0, 1.0, 1.0),
    tissue_from=-300.0,
    segments=(ShownSegment(id=1, range=None, colour=(1.0, 1.0, 1.0)),),
)
ONCE = Fineness()
PARALLEL = msgspec.structs.replace(FRONT, parallel=150.0)
ONE_EYE = msgspec.structs.replace(FRONT, aside=0.1)


@pytest.mark.parametrize("camera", [FRONT, PARALLEL, ONE_EYE])
def test_strips_side_by_side_are_the_whole_picture(camera: Camera) -> None:
    size = (200, 90)
    with Session(make_ball()) as session:
        pictures = SessionPictures(session)
        whole = pictures.draw(BALL, camera, size, fineness=ONCE, number=None)
        # so many rays that a strip has few columns
        strips = strips_of(camera, size, samples=MOST_RAYS // (48 * size[1]))
        assert [strip.size for strip in strips] == [(48, 90)] * 4 + [(8, 90)]
        parts = [
            pictures.draw(BALL, strip.camera, strip.size, fineness=ONCE, number=None)
            for strip in strips
        ]
    assert whole is not None
    drawn = [part for part in parts if part is not None]
    colours = np.concatenate([part.colours for part in drawn], axis=1)
    depths = np.concatenate([part.depths for part in drawn], axis=1)
    assert whole.colours[..., 3].max() == 1.0
    assert np.abs(colours - whole.colours).mean() < 1e-3
    assert (np.isfinite(depths) == np.isfinite(whole.depths)).mean() > 0.999
    both = np.isfinite(depths) & np.isfinite(whole.depths)
    assert np.abs(depths[both] - whole.depths[both]).max() < 0.5


def test_a_picture_wider_than_a_camera_can_look_aside_stays_whole_or_is_refused() -> None:
    assert strips_of(FRONT, (2000, 100), samples=4) == [Strip(FRONT, (2000, 100))]
    with pytest.raises(OptionError, match="16000 × 1100 pixels given; allowed"):
        strips_of(FRONT, (16_000, 1_100), samples=1)


def test_edits_meanwhile_are_not_seen_in_a_picture_that_was_begun() -> None:
    with Session(make_ball()) as session:
        still = StillPictures(session, LiveView())
        before = still.draw_at_rest(BALL, FRONT, (40, 40), fineness=ONCE)
        session.fill_box(1, low=(0, 0, 0), high=(41, 41, 41), solid=False)
        after = still.draw_at_rest(BALL, FRONT, (40, 40), fineness=ONCE)
    assert before.colours.max() > 0.1
    assert np.array_equal(before.colours, after.colours)


def test_a_request_of_the_live_view_goes_first_and_the_picture_comes_all_the_same() -> None:
    with Session(make_ball()) as session:
        live = LiveView()
        still = StillPictures(session, live)
        still.draw_at_rest(BALL, FRONT, (40, 40), fineness=ONCE)
        given_up: list[int | None] = []
        usual = still.draw

        def draw(*given: Any, number: int | None, **more: Any) -> Any:
            if not given_up:
                live.request()
            picture = usual(*given, number=number, **more)
            given_up.append(number if picture is None else None)
            return picture

        still.draw = draw  # type: ignore[method-assign]
        picture = still.draw_at_rest(BALL, FRONT, (40, 40), fineness=ONCE)
        assert given_up[0] is not None
        assert given_up[-1] is None
        assert picture.colours.max() > 0.1
        still.close()
        given_up.clear()
        still.draw_at_rest(BALL, FRONT, (40, 40), fineness=ONCE)
        assert given_up == [None]


def test_a_live_view_that_never_rests_does_not_hold_a_picture_up_for_ever() -> None:
    with Session(make_ball()) as session:
        live = LiveView()
        still = StillPictures(session, live)
        ended = False

        def turn() -> None:
            while not ended:
                live.request()

        thread = Thread(target=turn)
        thread.start()
        try:
            assert still.draw_at_rest(BALL, FRONT, (40, 40), fineness=ONCE).colours.max() > 0.1
        finally:
            ended = True
            thread.join()


Ask = Callable[..., Any]


def wish(**changes: Any) -> bytes:
    """What a page asks for."""
    look = msgspec.to_builtins(BALL) | {"type": "picture_look"}
    usual = {
        "look": look,
        "cameras": [msgspec.to_builtins(FRONT)],
        "size": (3000, 40),
        "steps_per_voxel": 1.0,
        "samples": 4,
        "jitter": False,
    }
    return msgspec.json.encode(usual | changes)


def strips_in(content: bytes) -> list[dict[str, Any]]:
    """Returns the messages of an answer."""
    strips = []
    while content:
        (size,) = struct.unpack_from("<I", content)
        strips.append(msgspec.msgpack.decode(content[4 : 4 + size]))
        content = content[4 + size :]
    return strips


def colours_of(strip: dict[str, Any]) -> NDArray[np.float32]:
    columns, rows = strip["size"]
    flat = np.frombuffer(strip["colours"], "<f2").astype(np.float32)
    return flat.reshape(rows, columns, 4)


def test_a_page_gets_all_pictures_of_a_film_in_strips(server: Any) -> None:
    behind = msgspec.to_builtins(FRONT) | {"right": (-1, 0, 0), "back": (0, 1, 0)}
    cameras = [msgspec.to_builtins(FRONT), behind]
    answer = server.ask("POST", "/api/picture", content=wish(cameras=cameras, size=(150, 600)))
    assert answer.status_code == 200
    strips = strips_in(answer.content)
    assert {strip["type"] for strip in strips} == {"drawn_picture"}
    for number in (0, 1):
        own = [strip for strip in strips if strip["number"] == number]
        assert sum(strip["size"][0] for strip in own) == 150
        assert len(own) == math.ceil(150 / 96)
        picture = np.concatenate([colours_of(strip) for strip in own], axis=1)
        assert picture.shape == (600, 150, 4)
        assert picture[..., 3].max() == 1.0


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"size": (0, 5)}, "this is not understood"),
        ({"size": (20_000, 5)}, "this is not understood"),
        ({"cameras": []}, "this is not understood"),
        ({"size": (16_000, 1_100)}, "16000 × 1100 pixels given; allowed"),
        ({"cameras": [msgspec.to_builtins(FRONT) | {"up": (1, 0, 0)}]}, "camera axes"),
    ],
)
def test_what_cannot_be_drawn_is_told(server: Any, changes: dict[str, Any], said: str) -> None:
    answer = server.ask("POST", "/api/picture", content=wish(**changes))
    assert answer.status_code == 400
    assert said in answer.text
