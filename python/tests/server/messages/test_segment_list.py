"""The list of segments, changed by several threads."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from made_gel import gel_scene
from msgspec.structs import replace
from palpate.server.messages.segment_list import SegmentList
from palpate.session.session import Session, SessionOptions


def test_a_part_that_is_named_while_the_list_is_made_keeps_its_name(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    with Session(gel_scene(), options=SessionOptions(real_time=False)) as session:
        segments = SegmentList(session)
        aside = np.eye(4)
        aside[0, 3] = 5.0
        session.move_segment(1, aside)
        show, named = segments._show, list[int]()

        def show_and_name(segment_id: int, look: Any) -> None:
            show(segment_id, look)
            if not named:
                # as another thread, which has just cut it off
                named.append(segment_id)
                segments._remember(
                    segment_id, replace(segments._appearance_of(segment_id), name="gel, left part")
                )

        monkeypatch.setattr(segments, "_show", show_and_name)
        segments.refresh(1, voxels_version=0, pending=0, edit=0)
        segments.refresh(2, voxels_version=0, pending=0, edit=0)
        (told,) = segments.message.segments
    assert (told.name, told.shown_as) == ("gel, left part", "surface")


def test_a_part_is_told_of_once_it_has_its_name() -> None:
    with Session(gel_scene(), options=SessionOptions(real_time=False)) as session:
        segments = SegmentList(session)
        # as a program beside the page: pages know it without a name
        session.add_segment(session.segment(1))
        seen = list[list[str]]()

        def look() -> None:
            segments.refresh(len(seen), voxels_version=0, pending=0, edit=0)
            seen.append([each.name for each in segments.message.segments])

        def cut() -> int:
            part = session.add_segment(session.segment(1))
            # as another thread, before the part has its name
            look()
            return part

        look()
        segments.cut(1, cut)
        look()
    assert seen[0] == seen[1] == ["gel", "segment 2"]
    assert len(seen[2]) == 3
    assert seen[2][2].startswith("gel, ")
