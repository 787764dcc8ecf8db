"""What a clip cuts away is not felt, and the scan and its segments know nothing of it."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from made_scans import make_ball
from palpate.base.errors import OptionError
from palpate.session.session import Session, SessionOptions

ABOVE = (20.0, 20.0, 34.0)
STILL = SessionOptions(real_time=False, start=ABOVE)
UPPER_HALF = [((0.0, 0.0, 1.0), 20.0)]
"""Of the ball around (20, 20, 20), whose top is at 28 mm."""


def sink(session: Session, height: float) -> dict[str, Any]:
    """Moves the hand down from above the ball to a height and returns what is then."""
    session.place(ABOVE)
    session.hand((20.0, 20.0, height))
    session.let_pass(1.0)
    return dict(session.frame())


def test_the_cut_is_felt_where_it_is_and_the_ball_again_without_it() -> None:
    with Session(make_ball(), options=STILL) as session:
        whole = session.segment(1).mask()
        assert session.clip() == []
        assert sink(session, 25.0)["proxy"][2] == pytest.approx(28.0, abs=0.6)
        session.set_clip(UPPER_HALF)
        cut = sink(session, 17.0)
        # the voxel around z = 20 has its centre there, and is kept
        assert cut["contact"]
        assert cut["proxy"][2] == pytest.approx(20.5, abs=0.51)
        assert cut["force"][2] > 0.5
        assert session.clip() == UPPER_HALF
        assert np.array_equal(session.segment(1).mask(), whole)
        assert not cut["can_undo"]
        session.set_clip([])
        assert sink(session, 25.0)["proxy"][2] == pytest.approx(28.0, abs=0.6)


def test_a_recording_in_which_the_clip_changes_replays_to_the_bit() -> None:
    with Session(make_ball(), options=STILL) as session:
        session.start_recording()
        session.let_pass(0.05)
        session.hand((20.0, 20.0, 23.0))
        session.let_pass(0.4)
        for planes in [UPPER_HALF, [], [((0.6, 0.0, 0.8), 14.0), *UPPER_HALF]]:
            session.set_clip(planes)
            session.let_pass(0.2)
        recording = session.stop_recording()
    contacts = recording.contacts
    assert contacts.any()
    assert not contacts[-1], "the last clip leaves nothing there"
    assert recording.replay().is_equal


@pytest.mark.parametrize(
    "planes",
    [
        [((0.0, 0.0, 2.0), 1.0)],
        [((0.0, 0.0, 1.0), float("nan"))],
        [((0.0, 1.0), 3.0)],
        [(0.0, 0.0, 1.0, 3.0)],
        UPPER_HALF * 17,
    ],
)
def test_what_is_no_clip_is_refused_and_the_one_before_holds(planes: Any) -> None:
    with Session(make_ball(), options=STILL) as session:
        session.set_clip(UPPER_HALF)
        with pytest.raises(OptionError, match=r"given; allowed:"):
            session.set_clip(planes)
        assert session.clip() == UPPER_HALF
