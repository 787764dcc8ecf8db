"""Pictures that the engine draws for pages: they come, newer requests win, edits are seen."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Awaitable, Callable, Iterator
from typing import Any

import msgspec
import numpy as np
import pytest
from made_scans import make_ball
from palpate import protocol
from palpate.pictures.session_pictures import DrawnArrays, SessionPictures
from palpate.server.messages import engine_pictures
from palpate.server.messages.engine_pictures import MOST_RENDERERS, EnginePictures
from palpate.server.messages.outbox import Outbox
from palpate.server.messages.picture_pace import COARSEST, FINEST, FIRST_DIVISOR, PicturePace
from palpate.session.session import Session
from palpate.volumes.second_scan import SecondScan
from picture_texels import colours_of, depths_of

Told = dict[str, Any]
Ask = Callable[[EnginePictures, Outbox], Awaitable[list[Told]]]


@pytest.fixture
def session() -> Iterator[Session]:
    with Session(make_ball()) as running:
        yield running


def look(**changes: Any) -> protocol.PictureLook:
    """Everything above the ball's threshold is opaque."""
    usual = protocol.PictureLook(
        mode="shaded",
        density=1.0,
        transfer=[(0.0, (0.0, 0.0, 0.0), 0.0), (1.0, (1.0, 1.0, 1.0), 0.0)],
        edge_gradient=1.0,
        window=(400.0, 40.0),
        iso_value=250.0,
        iso_colour=(1.0, 1.0, 1.0),
        tissue_from=-300.0,
        slab=None,
        lighting=protocol.LookLight(1.0, 1.0, 1.0, 1.0, 0.94, 0.0, 0.0),
        segments=[protocol.LookSegment(1, None, False, "solid", (1.0, 1.0, 1.0), 1.0, 1.0)],  # noqa: FBT003
        surfaces=[],
        clip=[],
        second=None,
    )
    return msgspec.structs.replace(usual, **changes)


def request(session: Session, number: int, *, moving: bool, **changes: Any) -> protocol.DrawPicture:
    """A view from the front of the middle of the scan."""
    volume = session.scene.volume
    middle = volume.patient_from_grid @ [*(np.array(volume.shape[::-1]) / 2), 1.0]
    x, y, z = middle[:3].tolist()
    camera = protocol.SeenFrom(
        (x, y, z), 400.0, (1.0, 0.0, 0.0), (0.0, 0.0, 1.0), (0.0, -1.0, 0.0), 0.3, None, 0.0
    )
    usual = protocol.DrawPicture(number, [camera], (60, 48), moving, None, 1.0, 2, jitter=False)
    return msgspec.structs.replace(usual, **changes)


def told(session: Session, ask: Ask) -> list[Told]:
    """Returns what a page is told by what it asks for."""

    async def run() -> list[Told]:
        pictures, page = EnginePictures(session), Outbox()
        async with asyncio.timeout(60.0):
            try:
                return await ask(pictures, page)
            finally:
                pictures.leave(page)

    return asyncio.run(run())


async def next_of(page: Outbox) -> Told:
    """Returns the next message; parts of a picture are acknowledged, and joined as pages do."""
    parts: list[Told] = []
    while True:
        packed = await page.next()
        assert isinstance(packed, bytes)
        message: Told = msgspec.msgpack.decode(packed)
        if message["type"] != "picture_part":
            return message
        page.picture_taken()
        parts = [each for each in parts if each["serial"] == message["serial"]] + [message]
        if message["last"]:
            joined: Told = msgspec.msgpack.decode(b"".join(each["packed"] for each in parts))
            return joined


async def until_finished(page: Outbox) -> list[Told]:
    messages = [await next_of(page)]
    while not messages[-1].get("finished", True):
        messages.append(await next_of(page))
    return messages


def test_a_view_at_rest_is_drawn_finer_and_finer(session: Session) -> None:
    async def ask(pictures: EnginePictures, page: Outbox) -> list[Told]:
        pictures.look(look(), page)
        pictures.draw(request(session, 7, moving=False), page)
        return await until_finished(page)

    pictures = told(session, ask)
    last = pictures[-1]
    assert (last["number"], last["divisor"], last["samples"]) == (7, 1.0, 2)
    assert last["size"] == [60, 48]
    # those before may have been replaced by it on their way
    assert [each["divisor"] for each in pictures] in (
        [2.0, 1.0, 1.0],
        [2.0, 1.0],
        [1.0, 1.0],
        [1.0],
    )
    depths, colours = depths_of(last), colours_of(last)
    assert colours[24, 30, 3] == pytest.approx(1.0, abs=0.02)
    assert colours[0, 0, 3] == pytest.approx(0.0, abs=0.02)
    assert np.isinf(depths[0, 0])
    # the middle of a ball is nearer than its rim
    assert depths[24, 30] < 400.0
    assert depths[24, 30] == pytest.approx(depths.min(), abs=0.5)


@pytest.mark.parametrize("moving", [True, False])
def test_two_eyes_get_their_pictures_one_below_the_other(session: Session, *, moving: bool) -> None:
    (camera,) = request(session, 1, moving=moving).cameras
    eyes = [msgspec.structs.replace(camera, aside=aside) for aside in (-0.1, 0.1)]

    def seen_by(cameras: list[protocol.SeenFrom]) -> Told:
        async def ask(pictures: EnginePictures, page: Outbox) -> list[Told]:
            pictures.look(look(), page)
            asked = request(session, 1, moving=moving, cameras=cameras, size=(61, 47))
            pictures.draw(asked, page)
            return [await next_of(page)] if moving else await until_finished(page)

        return told(session, ask)[-1]

    both, left, right = (seen_by(cameras) for cameras in (eyes, eyes[:1], eyes[1:]))
    assert both["eyes"] == 2
    assert both["size"] == left["size"]
    assert left["colours"] != right["colours"]
    assert both["colours"] == left["colours"] + right["colours"]
    assert len(both["depths"]) == 2 * len(left["depths"])


def test_a_view_that_moves_gets_one_picture_in_haste(session: Session) -> None:
    async def ask(pictures: EnginePictures, page: Outbox) -> list[Told]:
        pictures.look(look(), page)
        pictures.draw(request(session, 1, moving=True), page)
        return [await next_of(page)]

    (picture,) = told(session, ask)
    assert (picture["divisor"], picture["finished"]) == (FIRST_DIVISOR, False)
    assert picture["size"] == [20, 16]


def test_a_newer_request_wins_and_what_waited_is_forgotten(session: Session) -> None:
    async def ask(pictures: EnginePictures, page: Outbox) -> list[Told]:
        pictures.look(look(), page)
        pictures.draw(request(session, 1, moving=False, size=(900, 700), samples=64), page)
        first = await next_of(page)
        for number in range(2, 30):
            pictures.draw(request(session, number, moving=False), page)
        return [first, *await until_number(page, 29)]

    messages = told(session, ask)
    numbers = [message["number"] for message in messages]
    assert numbers[0] == 1
    assert not any(message["finished"] for message in messages if message["number"] == 1)
    assert len(set(numbers)) < 10, "most of those that waited were never drawn"


def test_pages_that_draw_at_once_give_up_only_their_own_pictures(
    session: Session, monkeypatch: pytest.MonkeyPatch
) -> None:
    given_up: list[str] = []
    draw = SessionPictures.draw

    def noted(*args: Any, **kwargs: Any) -> DrawnArrays | None:
        picture = draw(*args, **kwargs)
        if picture is None:
            given_up.append(threading.current_thread().name)
        return picture

    monkeypatch.setattr(SessionPictures, "draw", noted)

    async def ask(pictures: EnginePictures, page: Outbox) -> list[Told]:
        other = Outbox()
        for each in (page, other):
            pictures.look(look(density=1.0 if each is page else 2.0), each)
        pictures.draw(request(session, 1, moving=False, size=(700, 500), samples=8), page)
        finished = asyncio.create_task(until_finished(page))
        turns = 0
        while not finished.done():
            turns += 1
            pictures.draw(request(session, turns, moving=True), other)
            await next_of(other)
        pictures.leave(other)
        return [*(await finished), {"turns": turns}]

    messages = told(session, ask)
    assert messages[-2]["finished"]
    assert messages[-1]["turns"] > 3, "the other was drawn beside it"
    assert given_up == []


def test_few_renderers_are_kept_ready(session: Session) -> None:
    async def ask(pictures: EnginePictures, page: Outbox) -> list[Told]:
        pages = [page, *(Outbox() for _ in range(5))]
        for each in pages:
            pictures.look(look(), each)
            pictures.draw(request(session, 1, moving=True), each)
            await next_of(each)
        kept = [painter._own for painter in pictures._painters.values()]
        while sum(each._renderer is not None for each in kept) > MOST_RENDERERS:
            await asyncio.sleep(0.01)
        # one that was freed is made again
        pictures.draw(request(session, 2, moving=True), page)
        picture = await next_of(page)
        for each in pages[1:]:
            pictures.leave(each)
        return [picture]

    assert told(session, ask)[0]["number"] == 2


def test_a_failure_is_answered_and_the_next_picture_is_drawn(
    session: Session, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    class Panic(BaseException):
        """As that of the engine, which is no Exception."""

    def fail(*_: Any, **__: Any) -> None:
        raise Panic("a wall was met")

    async def ask(pictures: EnginePictures, page: Outbox) -> list[Told]:
        pictures.look(look(), page)
        with monkeypatch.context() as broken:
            broken.setattr(SessionPictures, "draw_eyes", fail)
            pictures.draw(request(session, 4, moving=True), page)
            failed = await next_of(page)
        pictures.draw(request(session, 5, moving=True), page)
        return [failed, await next_of(page)]

    failed, picture = told(session, ask)
    assert failed == {"type": "picture_failed", "number": 4, "text": "a wall was met"}
    assert picture["number"] == 5
    assert "a picture of the engine failed" in caplog.text


def test_a_picture_of_more_pixels_than_fit_is_drawn_more_coarsely(
    session: Session, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(engine_pictures, "MOST_PIXELS", 30 * 24)

    async def ask(pictures: EnginePictures, page: Outbox) -> list[Told]:
        pictures.look(look(), page)
        pictures.draw(request(session, 1, moving=False), page)
        return await until_finished(page)

    last = told(session, ask)[-1]
    assert (last["divisor"], last["size"], last["finished"]) == (2.0, [30, 24], True)


async def until_number(page: Outbox, number: int) -> list[Told]:
    messages = [await next_of(page)]
    while not (messages[-1]["number"] == number and messages[-1]["finished"]):
        messages.append(await next_of(page))
    return messages


def test_an_edit_is_seen_by_the_next_picture(session: Session) -> None:
    async def ask(pictures: EnginePictures, page: Outbox) -> list[Told]:
        pictures.look(look(), page)
        pictures.draw(request(session, 1, moving=False), page)
        before = (await until_finished(page))[-1]
        session.remove_segment(1)
        pictures.draw(request(session, 2, moving=False), page)
        return [before, (await until_number(page, 2))[-1]]

    before, after = told(session, ask)
    assert colours_of(before)[..., 3].max() > 0.9
    assert colours_of(after)[..., 3].max() == 0.0


def notched(session: Session) -> None:
    """Takes some voxels away from the ball, where it is seen."""
    volume = session.scene.volume
    mask = session.segment(1).mask().astype(np.uint8)
    depth, height, width = volume.shape
    mask[depth // 2 : depth // 2 + 3, : height // 2, width // 2 : width // 2 + 3] = 0
    session.replace_segment(1, volume.segment(mask, name="ball"))


def test_the_part_that_was_edited_comes_first_and_makes_the_picture_whole(session: Session) -> None:
    async def ask(pictures: EnginePictures, page: Outbox) -> list[Told]:
        pictures.look(look(), page)
        pictures.draw(request(session, 1, moving=False, samples=1), page)
        before = (await until_finished(page))[-1]
        notched(session)
        over = protocol.PictureOver(before["state"], before["divisor"])
        pictures.draw(request(session, 2, moving=False, samples=1, over=over), page)
        return [before, *await until_number(page, 2)]

    before, part, *_, after = told(session, ask)
    column, row = part["part"]
    columns, rows = part["size"]
    assert columns * rows < 60 * 48 // 4
    assert (part["over"], part["finished"], part["divisor"]) == (before["state"], False, 1.0)
    assert part["state"] > before["state"]
    assert after["part"] is None
    there = np.s_[row : row + rows, column : column + columns]
    for read, off in ((colours_of, 1e-3), (depths_of, 0.05)):
        joined = read(before).copy()
        assert not np.allclose(joined, read(after), atol=off)
        joined[there] = read(part)
        np.testing.assert_allclose(joined, read(after), atol=off)


@pytest.mark.parametrize("divisor", [1.0, 3.0])
def test_over_another_picture_all_of_it_is_drawn(session: Session, divisor: float) -> None:
    async def ask(pictures: EnginePictures, page: Outbox) -> list[Told]:
        pictures.look(look(), page)
        pictures.draw(request(session, 1, moving=False), page)
        before = (await until_finished(page))[-1]
        notched(session)
        unknown = before["state"] + (1000 if divisor == 1.0 else 0)
        over = protocol.PictureOver(unknown, divisor)
        pictures.draw(request(session, 2, moving=False, over=over), page)
        return await until_number(page, 2)

    assert all(each["part"] is None for each in told(session, ask))


def test_a_surface_is_seen_where_its_segment_was_moved(session: Session) -> None:
    toward_viewer = np.eye(4)
    toward_viewer[1, 3] = -8.0
    hidden = protocol.LookSegment(1, None, False, "hidden", (1.0, 1.0, 1.0), 1.0, 1.0)  # noqa: FBT003
    surface = protocol.LookSurface(1, (1.0, 1.0, 1.0), 1.0, False, 1.0, 1.0)  # noqa: FBT003

    async def ask(pictures: EnginePictures, page: Outbox) -> list[Told]:
        session.show_surface(1)
        while not session.whole_surfaces()["surfaces"]:
            await asyncio.sleep(0.01)
        pictures.look(look(segments=[hidden], surfaces=[surface]), page)
        pictures.draw(request(session, 1, moving=False), page)
        before = (await until_finished(page))[-1]
        session.move_segment(1, toward_viewer)
        # it goes there in some ticks
        for number in range(2, 100):
            pictures.draw(request(session, number, moving=False), page)
            after = (await until_number(page, number))[-1]
            if depth_of(before) - depth_of(after) > 7.9:
                break
        return [before, after]

    before, after = told(session, ask)
    assert depth_of(before) == pytest.approx(depths_of(before).min(), abs=0.5)
    assert depth_of(before) - depth_of(after) == pytest.approx(8.0, abs=0.05)


def depth_of(picture: Told) -> float:
    """Returns the depth in the middle of the picture [mm]."""
    return float(depths_of(picture)[24, 30])


def test_a_second_scan_is_seen_where_it_lies_and_moves(session: Session) -> None:
    first = session.scene.volume
    # nothing is seen of the first
    clear = look(segments=[])
    second = protocol.LookSecond(
        density=1.0,
        transfer=[(0.0, (1.0, 1.0, 1.0), 0.0), (100.0, (1.0, 1.0, 1.0), 5.0)],
        edge_gradient=1.0,
        window=(400.0, 40.0),
        iso_value=250.0,
        iso_colour=(1.0, 1.0, 1.0),
        tissue_from=-300.0,
        tint="warm",
        opacity=1.0,
        turns="together",
        cells=20.0,
    )

    async def ask(pictures: EnginePictures, page: Outbox) -> list[Told]:
        last = []
        for number, (shown, right) in enumerate([(None, 0.0), (second, 0.0), (second, 15.0)]):
            # points of the first to its own: it stands to the other side
            place = np.eye(4)
            place[0, 3] = -right
            session.scene.second = SecondScan(first, place)
            pictures.look(msgspec.structs.replace(clear, second=shown), page)
            pictures.draw(request(session, number, moving=False), page)
            last.append((await until_number(page, number))[-1])
        return last

    none, there, moved = (colours_of(each)[..., 3] for each in told(session, ask))
    assert none.max() == 0.0
    assert there[24, 30] > 0.9
    middles = [np.average(np.arange(60), weights=each.sum(axis=0)) for each in (there, moved)]
    # 48 rows show 400 mm times the angle of view at the ball
    pixels = 15.0 / (2 * 400.0 * np.tan(0.15) / 48)
    assert middles[1] - middles[0] == pytest.approx(pixels, abs=0.3)


@pytest.mark.parametrize(
    ("asked", "sentence"),
    [
        ({}, "picture requested before its look. Use picture_look first"),
        ({"cameras": {"up": (0.0, 0.0, 2.0)}}, "Use unit vectors at right angles"),
    ],
)
def test_what_cannot_be_drawn_is_refused_in_one_line(
    session: Session, asked: dict[str, Any], sentence: str
) -> None:
    async def ask(pictures: EnginePictures, page: Outbox) -> list[Told]:
        changes = dict(asked)
        if "cameras" in changes:
            (camera,) = request(session, 1, moving=False).cameras
            changes["cameras"] = [msgspec.structs.replace(camera, **changes["cameras"])]
        if changes:
            pictures.look(look(), page)
        wanted = request(session, 1, moving=False, **changes)
        pictures.draw(wanted, page)
        refused = await next_of(page)
        pictures.look(look(), page)
        pictures.draw(request(session, 2, moving=True), page)
        return [refused, await next_of(page)]

    refused, picture = told(session, ask)
    assert (refused["type"], refused["number"]) == ("picture_failed", 1)
    assert sentence in refused["text"]
    assert "\n" not in refused["text"]
    assert picture["type"] == "drawn_picture", "what follows is drawn as always"


def test_where_pictures_take_long_a_change_is_seen_by_a_coarser_one_at_first(
    session: Session, monkeypatch: pytest.MonkeyPatch
) -> None:
    pace = PicturePace()
    pace.learn(COARSEST, 2.0)
    assert pace.slows
    monkeypatch.setattr("palpate.server.messages.engine_pictures.PicturePace", lambda: pace)

    async def ask(pictures: EnginePictures, page: Outbox) -> list[Told]:
        pictures.look(look(), page)
        pictures.draw(request(session, 1, moving=False), page)
        first = await next_of(page)
        return [first, *await until_finished(page)]

    pictures = told(session, ask)
    # those between may have been replaced on their way
    assert (pictures[0]["divisor"], pictures[-1]["divisor"]) == (COARSEST, 1.0)
    assert pictures[-1]["finished"]


@pytest.mark.parametrize(("seconds", "divisor"), [(0.001, FINEST), (0.075, 3.0), (10.0, COARSEST)])
def test_pictures_become_coarser_where_they_take_longer(seconds: float, divisor: float) -> None:
    pace = PicturePace()
    assert pace.divisor == FIRST_DIVISOR
    assert not pace.slows, "nothing is known yet"
    for _ in range(20):
        pace.learn(3.0, seconds)
    assert pace.divisor == divisor
    assert pace.slows == (divisor > FINEST)
