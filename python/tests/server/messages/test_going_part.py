"""Islands and what scissors cut out: they are shown before they go."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from asked_work import asked_of
from palpate import protocol
from palpate.base.errors import OptionError
from palpate.base.progress import silent
from palpate.segmentation.segment_steps import ShapeStep
from palpate.server.messages.going_part import GoingPart
from palpate.server.messages.segment_list import SegmentList
from palpate.server.messages.shown_islands import show_islands
from palpate.server.messages.shown_scissors import show_scissors
from palpate.session.session import Session, SessionOptions
from palpate.volumes.scene import Scene
from palpate.volumes.volume import Volume


def parts() -> Scene:
    """Three boxes of 512, 64 and 8 voxels of 1 mm³, as one segment."""
    values = np.zeros((20, 20, 40), np.int16)
    for first, edge in ((2, 8), (16, 4), (30, 2)):
        values[2 : 2 + edge, 2 : 2 + edge, first : first + edge] = 100
    volume = Volume(values, spacing=(1.0, 1.0, 1.0))
    scene = Scene(volume)
    scene.add(volume.threshold(50.0, 100.0, name="boxes"))
    return scene


def shown_of(told: list[protocol.ToPage]) -> list[protocol.Islands]:
    return [one for one in told if isinstance(one, protocol.Islands)]


def test_islands_that_would_go_are_shown_before_and_go_in_one_step_of_undo() -> None:
    look = protocol.ShowIslands(id=1, most=2, least_ml=0.0)
    told, voxels = asked_of(parts(), look, protocol.EndGoing(removes=True))
    (shown,) = shown_of(told)
    assert (shown.count, shown.stays) == (3, 2)
    assert shown.largest_ml == [0.512, 0.064, 0.008]
    assert shown.goes_ml == pytest.approx(0.008)
    # nothing changes while they are shown, and one undo brings all of it back
    assert voxels == [584, 576, 584]


def test_islands_and_scissors_keep_the_threshold_of_a_segment() -> None:
    with Session(parts(), options=SessionOptions(real_time=False)) as session:
        going = GoingPart(session, SegmentList(session))
        cuts = protocol.ShowScissors(id=1, outside=False, depth=None, **LOOP)
        show_scissors(cuts, going, silent)
        going.end(removes=True)
        show_islands(protocol.ShowIslands(id=1, most=1, least_ml=0.0), going, silent)
        going.end(removes=True)
        listed = session.steps(1)
        assert listed is not None
        assert listed.threshold == (50.0, 100.0)
        kinds = [step.kind for step in listed.steps if isinstance(step, ShapeStep)]
        assert kinds == ["subtract", "keep-largest"]
        assert [each["voxels"] for each in session.segments()] == [64]


def test_another_choice_takes_the_place_of_what_was_shown() -> None:
    most = protocol.ShowIslands(id=1, most=1, least_ml=0.0)
    least = protocol.ShowIslands(id=1, most=9, least_ml=0.05)
    counts: list[int] = []
    with Session(parts(), options=SessionOptions(real_time=False)) as session:
        going = GoingPart(session, SegmentList(session))
        for wanted in (most, least):
            told = show_islands(wanted, going, silent)
            assert told.preview is not None
            counts.append(session.segment(told.preview).voxel_count)
            assert len(session.segments()) == 2
        assert counts == [72, 8]
        going.end(removes=False)
        assert [each["voxels"] for each in session.segments()] == [584]
        assert not session.undo()


def test_a_step_that_was_made_meanwhile_is_not_undone_with_what_was_shown() -> None:
    with Session(parts(), options=SessionOptions(real_time=False)) as session:
        going = GoingPart(session, SegmentList(session))
        wanted = protocol.ShowIslands(id=1, most=1, least_ml=0.0)
        show_islands(wanted, going, silent)
        session.fill_box(1, low=(0, 0, 0), high=(1, 1, 1), solid=True)
        with pytest.raises(OptionError, match="was changed meanwhile"):
            going.end(removes=True)
        assert [each["voxels"] for each in session.segments()] == [585]


def test_islands_that_all_stay_or_all_would_go_are_told() -> None:
    all_stay = protocol.ShowIslands(id=1, most=3, least_ml=0.0)
    all_go = protocol.ShowIslands(id=1, most=3, least_ml=1.0)
    told, voxels = asked_of(parts(), all_stay, all_go)
    assert [one.preview for one in shown_of(told)] == [None]
    (notice,) = [one for one in told if isinstance(one, protocol.Notice)]
    assert "nothing would be left of boxes" in notice.text
    assert voxels[0] == voxels[1] == 584


LOOP: dict[str, Any] = {
    "line": [(0.0, -5.0, 0.0), (12.0, -5.0, 0.0), (12.0, -5.0, 19.0), (0.0, -5.0, 19.0)],
    "eye": (10.0, -1e6, 10.0),
    "view": (0.0, 1.0, 0.0),
}
"""Around the largest of the three boxes, seen from before."""


@pytest.mark.parametrize(
    ("id_", "outside", "depth", "gone"),
    [(1, False, None, 512), (1, True, None, 72), (1, False, 2.5, 3 * 64), (None, False, None, 512)],
)
def test_scissors_show_what_they_cut_out_and_do_so_in_one_step_of_undo(
    id_: int | None,
    outside: bool,  # noqa: FBT001  # a parameter of the test
    depth: float | None,
    gone: int,
) -> None:
    look = protocol.ShowScissors(id=id_, outside=outside, depth=depth, **LOOP)
    told, voxels = asked_of(parts(), look, protocol.EndGoing(removes=True))
    (shown,) = [one for one in told if isinstance(one, protocol.Scissors)]
    assert shown.goes_ml == pytest.approx(gone / 1000.0)
    assert voxels == [584, 584 - gone, 584]


def test_scissors_that_meet_nothing_show_nothing() -> None:
    beside = LOOP | {"line": [(30.0, -5.0, 15.0), (39.0, -5.0, 15.0), (39.0, -5.0, 19.0)]}
    told, voxels = asked_of(
        parts(), protocol.ShowScissors(id=1, outside=False, depth=None, **beside)
    )
    assert protocol.Scissors(preview=None, goes_ml=0.0) in told
    assert voxels == [584, 584]
