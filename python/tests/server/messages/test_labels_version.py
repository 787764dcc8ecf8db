"""Pages are asked to fetch labels only where those that they have no longer hold."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import count

import numpy as np
import pytest
from palpate import protocol
from palpate.server.messages.labels_version import LabelsVersion
from palpate.server.messages.segment_list import SegmentList
from palpate.session.session import Session, SessionOptions
from palpate.volumes.scene import Scene

VERSIONS = count(1)


@pytest.fixture
def shown(ball_scene: Scene) -> Iterator[SegmentList]:
    """A scan with three boxes beside its ball: the first two overlap, the third lies apart."""
    with Session(ball_scene, options=SessionOptions(real_time=False)) as session:
        segments = SegmentList(session)
        volume = session.scene.volume
        for low in (0, 2, 8):
            mask = np.zeros(volume.shape, np.uint8)
            mask[0:4, 0:4, low : low + 4] = 1
            segments.add(volume.segment(mask, name=f"from {low}"))
        yield segments


def version(shown: SegmentList) -> int:
    """The version of labels that pages are told, once it is settled."""
    for _ in range(2):
        shown.refresh(next(VERSIONS), voxels_version=0, pending=0, edit=1)
        if shown.is_unsure_of_labels:
            shown.labels()
    assert not shown.is_unsure_of_labels
    return shown.message.labels


def labelled(shown: SegmentList) -> list[int]:
    """The numbers of the three boxes."""
    return [each.id for each in shown.message.segments if each.name.startswith("from")]


def show(shown: SegmentList, *ids: int, visible: bool) -> None:
    """Shows or hides segments as a page does."""
    shown.show([protocol.ShownSegments(ids=list(ids), visible=visible, shown_as=None)])


def test_a_segment_that_lies_apart_is_hidden_without_new_labels(shown: SegmentList) -> None:
    before = version(shown)
    first, second, apart = labelled(shown)
    show(shown, apart, visible=False)
    assert version(shown) == before
    assert (shown.labels() == apart).sum() == 64, "labels of hidden segments are there"
    show(shown, apart, visible=True)
    assert version(shown) == before
    # all at once: none of them comes before another by that
    show(shown, first, second, apart, visible=False)
    assert version(shown) == before
    show(shown, first, second, apart, visible=True)
    assert version(shown) == before


def test_a_segment_that_lies_over_another_gives_way_as_it_is_hidden(shown: SegmentList) -> None:
    before = version(shown)
    first, second, _ = labelled(shown)
    assert (shown.labels() == first).sum() == 32
    show(shown, second, visible=False)
    assert version(shown) > before
    labels = shown.labels()
    assert ((labels == first).sum(), (labels == second).sum()) == (64, 32)


def test_labels_are_fetched_only_where_they_may_be_others() -> None:
    labels = LabelsVersion()
    labels.follow([1, 2, 3], voxels_version=0, edit=0)
    labels.learn(frozenset({1, 2}), order=(1, 2, 3), edit=0)
    first = labels.number
    assert labels.follow([3, 1, 2], voxels_version=0, edit=0)
    assert (labels.number, labels.is_unsure) == (first, False)
    assert not labels.follow([3, 1, 2], voxels_version=0, edit=1)
    # what an edit changed was sent in one order, and is hidden in another: only a look tells
    labels.follow([1, 2, 3], voxels_version=0, edit=1)
    assert (labels.number, labels.is_unsure) == (first, True)
    labels.learn(frozenset({1, 2}), order=(1, 2, 3), edit=0)
    assert labels.is_unsure, "that was before the edit"
    labels.learn(frozenset({1, 2, 3}), order=(1, 2, 3), edit=1)
    assert (labels.number, labels.is_unsure) == (first + 1, False)
    # voxels of which pages were not told, and segments that come
    labels.follow([1, 2, 3], voxels_version=1, edit=2)
    assert labels.number == first + 2
    labels.follow([1, 2, 3, 4], voxels_version=1, edit=2)
    assert (labels.number, labels.is_unsure) == (first + 3, False)
