"""Segments take the colour by which their name is known, unless somebody chose one."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import count
from typing import Any

import msgspec
import pytest
from palpate import protocol
from palpate.server.messages.segment_list import SegmentList
from palpate.session.session import Session, SessionOptions
from palpate.volumes.anatomical_colour import colour_of_name
from palpate.volumes.scene import PALETTE, Scene

VERSIONS = count(1)
GREEN = (0.1, 0.9, 0.2)


@pytest.fixture
def shown(ball_scene: Scene) -> Iterator[SegmentList]:
    """A ball as pages see it."""
    with Session(ball_scene, options=SessionOptions(real_time=False)) as session:
        yield SegmentList(session)


def now(shown: SegmentList, number: int) -> protocol.Segment:
    """A segment as pages are told."""
    shown.refresh(next(VERSIONS), voxels_version=0, pending=0, edit=0)
    return next(one for one in shown.message.segments if one.id == number)


def change(shown: SegmentList, number: int, **wanted: Any) -> protocol.Segment:
    """Changes a segment as a page does; returns what it is then."""
    segment = now(shown, number)
    fields = {
        field: getattr(segment, field) for field in protocol.SegmentProperties.__struct_fields__
    }
    shown.change(protocol.SegmentProperties(**fields | wanted))
    return now(shown, number)


@pytest.mark.parametrize(
    ("name", "like"),
    [("Liver, left lobe", "liver"), ("rib_left_3", "bone"), ("Skull", "bone"), ("hip", "bone")],
)
def test_names_of_the_body_have_a_colour(name: str, like: str) -> None:
    assert colour_of_name(name) == colour_of_name(like) is not None


@pytest.mark.parametrize("name", ["threshold", "Otsu 2 of 3", "tribe", "chips", "sliver", "x"])
def test_other_names_have_none(name: str) -> None:
    assert colour_of_name(name) is None


def test_a_segment_that_is_made_has_the_colour_of_its_name(shown: SegmentList) -> None:
    shown.threshold(protocol.Threshold(id=None, low=0.0, high=200.0, name="Spleen"))
    assert now(shown, 2).colour == colour_of_name("spleen")
    shown.add_empty("painted")
    assert now(shown, 3).colour == PALETTE[2]
    # a range that is called otherwise by now
    shown.threshold(protocol.Threshold(id=2, low=0.0, high=200.0, name="Liver"))
    assert now(shown, 2).colour == colour_of_name("liver")


def test_of_two_that_are_called_the_same_the_second_has_another_colour(
    shown: SegmentList,
) -> None:
    for number in (2, 3):
        shown.add_empty("Bone")
        assert now(shown, number).colour == (colour_of_name("bone") if number == 2 else PALETTE[2])
    # left and right are two names of one colour
    assert change(shown, 2, name="left kidney").colour == colour_of_name("kidney")
    assert change(shown, 3, name="right kidney").colour == colour_of_name("kidney")


def test_a_new_name_brings_its_colour_and_an_old_one_takes_it_back(shown: SegmentList) -> None:
    before = now(shown, 1).colour
    assert change(shown, 1, name="kidney").colour == colour_of_name("kidney")
    assert change(shown, 1, name="aorta").colour == colour_of_name("aorta")
    assert change(shown, 1, name="ball").colour == before
    # as undo does it: the name before with the colour before, and nothing was chosen by that
    change(shown, 1, name="liver")
    assert change(shown, 1, name="ball", colour=before).colour == before
    assert change(shown, 1, name="liver").colour == colour_of_name("liver")


def test_a_colour_that_was_chosen_stays(shown: SegmentList) -> None:
    assert change(shown, 1, colour=GREEN).colour == GREEN
    assert change(shown, 1, name="liver").colour == GREEN
    # also after it was kept and brought back
    kept = shown.kept()
    shown.restore(kept)
    assert change(shown, 1, name="spleen").colour == GREEN


def test_looks_of_before_keep_their_colours(shown: SegmentList) -> None:
    kept = msgspec.json.decode(shown.kept())
    for each in kept:
        del each["look"]["chosen"]
    shown.restore(msgspec.json.encode(kept))
    assert change(shown, 1, name="liver").colour == PALETTE[0]


def test_segments_of_a_scene_have_the_colour_of_their_name(ball_scene: Scene) -> None:
    volume = ball_scene.volume
    assert ball_scene.add(volume.threshold(0.0, name="liver")).colour == colour_of_name("liver")
    assert ball_scene.add(volume.threshold(0.0, name="liver"), colour=GREEN).colour == GREEN
    assert ball_scene.add(volume.threshold(0.0, name="other")).colour == PALETTE[3]
