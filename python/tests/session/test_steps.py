"""Steps of segments: a list that makes the voxels, and follows them through undo and by hand."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest
from msgspec.structs import replace
from numpy.typing import NDArray
from palpate import PaintedCut, Scene, Session, SessionOptions, Volume
from palpate.base.errors import EmptySegmentError, OptionError
from palpate.segmentation import HandEdit, SegmentSteps, ShapeStep, changed_shape
from palpate.segmentation.request import SegmentRequest
from palpate.segmentation.segment_steps import Step
from palpate.segmentation.voxel_set import VoxelSet, digest_of
from palpate.volumes.segment import Segment
from scipy.ndimage import gaussian_filter

STILL = SessionOptions(real_time=False)
LARGEST = ShapeStep(kind="keep-largest", amount=1.0)
SMOOTH = ShapeStep(kind="smooth", amount=1.5)
GROW = ShapeStep(kind="grow", amount=2.0)
LOW = 120.0


@pytest.fixture(scope="module")
def volume() -> Volume:
    """Islands of all sizes: smoothed noise, on voxels that are no cubes."""
    noise = np.random.default_rng(11).normal(size=(28, 32, 36))
    values = gaussian_filter(noise, 2.0)
    whole = (400.0 * values / values.std()).astype(np.int16)
    return Volume(whole, spacing=(0.8, 0.9, 1.5))


@pytest.fixture
def session(volume: Volume) -> Iterator[Session]:
    with Session(Scene(volume, [volume.threshold(LOW)]), options=STILL) as opened:
        yield opened


def mask(session: Session, number: int = 1) -> NDArray[np.uint8]:
    return session.segment(number).mask()


def from_scratch(source: Segment, *steps: ShapeStep) -> NDArray[np.uint8]:
    """Returns what operations make, one after another."""
    for step in steps:
        source = changed_shape(source, step.kind, amount=step.amount)
    return source.mask()


def high(session: Session) -> float:
    return session.scene.volume.range[1]


def test_a_threshold_that_is_changed_is_followed_by_its_steps_bit_for_bit(
    session: Session, volume: Volume
) -> None:
    for step in (LARGEST, SMOOTH, GROW):
        assert session.change_shape(1, step).changed
    assert np.array_equal(mask(session), from_scratch(volume.threshold(LOW), LARGEST, SMOOTH, GROW))
    before = mask(session)

    session.set_threshold(1, 200.0, high(session))
    wanted = from_scratch(volume.threshold(200.0), LARGEST, SMOOTH, GROW)
    assert np.array_equal(mask(session), wanted)
    assert session.steps(1) == SegmentSteps((200.0, high(session)), (LARGEST, SMOOTH, GROW))

    # one step of undo for the segment and its list
    assert session.undo()
    assert np.array_equal(mask(session), before)
    assert session.steps(1) == SegmentSteps((LOW, high(session)), (LARGEST, SMOOTH, GROW))
    assert session.redo()
    assert np.array_equal(mask(session), wanted)
    assert session.steps(1) == SegmentSteps((200.0, high(session)), (LARGEST, SMOOTH, GROW))


def test_steps_change_their_values_their_order_and_can_be_off_or_gone(
    session: Session, volume: Volume
) -> None:
    source = (LOW, high(session))
    for step in (GROW, LARGEST):
        session.change_shape(1, step)
    more = ShapeStep(kind="grow", amount=3.5)
    off = ShapeStep(kind="grow", amount=2.0, on=False)
    threshold = volume.threshold(LOW)
    for steps, made in (
        ((more, LARGEST), from_scratch(threshold, more, LARGEST)),
        ((LARGEST, GROW), from_scratch(threshold, LARGEST, GROW)),
        ((LARGEST, off), from_scratch(threshold, LARGEST)),
        ((GROW,), from_scratch(threshold, GROW)),
        ((), threshold.mask()),
    ):
        assert session.set_steps(1, SegmentSteps(source, steps)).changed
        assert np.array_equal(mask(session), made)
        assert session.steps(1) == SegmentSteps(source, steps)
    # the threshold alone is one again for the engine: it shows it from the scan's values
    assert session.segments()[0]["range"] == source


def test_undo_and_redo_bring_back_each_list_also_of_equal_voxels(session: Session) -> None:
    source = (LOW, high(session))
    off = ShapeStep(kind="smooth", amount=1.5, on=False)
    lists = [(), (LARGEST,), (LARGEST, SMOOTH), (LARGEST, off), (LARGEST, SMOOTH), ()]
    for steps in lists[1:]:
        session.set_steps(1, SegmentSteps(source, steps))
    for steps in lists[-2::-1]:
        assert session.undo()
        assert session.steps(1) == SegmentSteps(source, steps)
    for steps in lists[1:]:
        assert session.redo()
        assert session.steps(1) == SegmentSteps(source, steps)


def test_what_was_done_by_hand_is_a_step_and_stays_on_top(session: Session, volume: Volume) -> None:
    session.change_shape(1, LARGEST)
    made = mask(session)
    session.fill_box(1, low=(0, 0, 0), high=(3, 3, 3), solid=True)
    session.fill_box(1, low=(14, 14, 10), high=(24, 24, 18), solid=False)
    painted = mask(session)
    assert session.listed(session.segments()[0]).by_hand
    steps = session.steps(1)
    assert steps is not None
    assert [type(step) for step in steps.steps] == [ShapeStep, HandEdit]

    session.set_threshold(1, 60.0, high(session))
    wanted = from_scratch(volume.threshold(60.0), LARGEST) != 0
    wanted |= (painted != 0) & (made == 0)
    wanted &= ~((painted == 0) & (made != 0))
    assert np.array_equal(mask(session) != 0, wanted)
    # what was painted twice is one step still
    session.fill_box(1, low=(0, 0, 0), high=(5, 5, 5), solid=True)
    again = session.steps(1)
    assert again is not None
    assert [type(step) for step in again.steps] == [ShapeStep, HandEdit]
    # and can be switched off
    session.set_steps(1, with_step(again, 1, replace(again.steps[1], on=False)))
    assert np.array_equal(mask(session), from_scratch(volume.threshold(60.0), LARGEST))
    for _ in range(3):
        session.undo()
    assert np.array_equal(mask(session), painted)
    assert session.steps(1) == steps


def with_step(steps: SegmentSteps, place: int, step: Step) -> SegmentSteps:
    listed = list(steps.steps)
    listed[place] = step
    return SegmentSteps(steps.source, tuple(listed))


def test_painting_between_undo_and_redo_belongs_to_the_list_that_was_there(
    session: Session,
) -> None:
    source = (LOW, high(session))
    session.change_shape(1, LARGEST)
    session.change_shape(1, SMOOTH)
    session.undo()
    session.fill_box(1, low=(0, 0, 0), high=(3, 3, 3), solid=True)
    steps = session.steps(1)
    assert steps is not None
    assert (steps.source, steps.steps[0]) == (source, LARGEST)
    assert [type(step) for step in steps.steps] == [ShapeStep, HandEdit]
    session.undo()
    assert session.steps(1) == SegmentSteps(source, (LARGEST,))


def test_a_threshold_that_was_only_painted_keeps_its_threshold_too(
    session: Session, volume: Volume
) -> None:
    session.fill_box(1, low=(0, 0, 0), high=(3, 3, 3), solid=True)
    session.set_threshold(1, 200.0, high(session))
    wanted = volume.threshold(200.0).mask()
    wanted[:3, :3, :3] = 1
    # of the box, what the first threshold had already was not painted
    wanted[:3, :3, :3] &= (volume.threshold(LOW).mask()[:3, :3, :3] == 0) | (
        volume.threshold(200.0).mask()[:3, :3, :3] != 0
    )
    assert np.array_equal(mask(session), wanted)


def test_a_drawn_segment_has_what_it_was_as_its_source(session: Session, volume: Volume) -> None:
    drawn = np.zeros(volume.shape, np.uint8)
    drawn[8:16, 8:16, 8:16] = 1
    number = session.add_segment(volume.segment(drawn, name="drawn"))
    assert session.steps(number) is None
    session.change_shape(number, GROW)
    session.change_shape(number, ShapeStep.with_other("subtract", session.segment(1)))
    steps = session.steps(number)
    assert steps is not None
    assert np.array_equal(steps.source.mask(), drawn != 0)  # type: ignore[union-attr]
    # the other segment is taken as it was
    taken = mask(session)
    session.set_threshold(1, 300.0, high(session))
    less = ShapeStep(kind="grow", amount=1.0)
    session.set_steps(number, SegmentSteps(steps.source, (less, steps.steps[1])))
    grown = from_scratch(volume.segment(drawn, name="drawn"), less)
    assert np.array_equal(mask(session, number), grown & (1 - taken))
    for _ in range(4):
        session.undo()
    assert np.array_equal(mask(session, number), drawn)
    assert session.steps(number) is None


def test_a_segment_on_a_grid_of_its_own_has_steps_there(session: Session) -> None:
    fine = np.zeros((20, 20, 20), np.uint8)
    fine[5:15, 5:15, 5:15] = 1
    grid = Volume(np.zeros(fine.shape, np.int16), spacing=(0.3, 0.3, 0.3), origin=(1.0, 2.0, 3.0))
    number = session.add_segment(grid.segment(fine, name="plate").as_object())
    little = ShapeStep(kind="grow", amount=0.6)
    session.change_shape(number, little)
    steps = session.steps(number)
    assert steps is not None
    session.set_steps(number, with_step(steps, 0, ShapeStep(kind="smooth", amount=0.5)))
    wanted = changed_shape(grid.segment(fine, name="plate"), "smooth", amount=0.5).mask()
    assert np.array_equal(mask(session, number), wanted)
    assert session.segment(number).has_own_grid


def test_a_cut_and_other_voxels_end_the_list_and_undo_brings_it_back(
    session: Session, volume: Volume
) -> None:
    session.change_shape(1, GROW)
    steps = session.steps(1)
    part = session.cut(1, (14.0, 14.0, 20.0), (1.0, 0.0, 0.0))
    assert session.steps(1) is None
    assert session.steps(part) is None
    session.fill_box(1, low=(0, 0, 0), high=(36, 32, 28), solid=True)
    assert session.steps(1) is None
    assert session.undo()
    assert session.undo()
    assert session.steps(1) == steps
    drawn = np.zeros(volume.shape, np.uint8)
    drawn[4:9, 4:9, 4:9] = 1
    session.replace_segment(1, volume.segment(drawn, name="other"))
    assert session.steps(1) is None
    assert session.undo()
    assert session.steps(1) == steps


def test_a_threshold_that_was_cut_along_a_line_does_not_grow_back(session: Session) -> None:
    line = [(0.0, 14.0, -50.0), (30.0, 14.0, -50.0)]
    cut = PaintedCut(line=line, eye=(14.0, 14.0, -300.0), view=(0.0, 0.0, 1.0), closed=False)
    session.cut_along(1, cut)
    assert session.steps(1) is None


def test_what_cannot_be_done_changes_nothing(session: Session) -> None:
    session.change_shape(1, LARGEST)
    before, steps = mask(session), session.steps(1)
    assert steps is not None
    with pytest.raises(OptionError, match="nothing is left of bone after step 2, shrink"):
        session.set_steps(1, steps.then(ShapeStep(kind="shrink", amount=50.0)), name="bone")
    with pytest.raises(EmptySegmentError, match="selects no voxel"):
        session.set_threshold(1, 30000.0, 31000.0)
    with pytest.raises(OptionError, match="'joint' given as a step"):
        session.set_steps(1, steps.then(ShapeStep(kind="joint", amount=2.0)))
    with pytest.raises(OptionError, match="segment 9"):
        session.steps(9)

    def stop(_: str, __: float | None, /) -> None:
        raise InterruptedError

    with pytest.raises(InterruptedError):
        session.set_steps(1, steps.then(GROW), progress=stop)
    session.set_locked(1, locked=True)
    with pytest.raises(OptionError, match="locked"):
        session.set_steps(1, steps.then(GROW))
    with pytest.raises(OptionError, match="locked"):
        session.set_threshold(1, 200.0, high(session))
    assert np.array_equal(mask(session), before)
    assert session.steps(1) == steps
    session.undo()
    assert not session.frame()["can_undo"]


def test_a_change_without_an_effect_is_no_step_of_undo(session: Session) -> None:
    session.change_shape(1, LARGEST)
    steps = session.steps(1)
    assert steps is not None
    assert not session.change_shape(1, LARGEST).changed
    assert session.steps(1) == steps
    more = steps.then(LARGEST)
    assert not session.set_steps(1, more).changed
    assert session.steps(1) == more
    assert session.undo()
    assert not session.frame()["can_undo"]


def test_progress_names_each_step(session: Session) -> None:
    told: list[str] = []
    session.set_steps(
        1,
        SegmentSteps((LOW, high(session)), (LARGEST, replace(SMOOTH, amount=1.0))),
        name="bone",
        progress=lambda what, _: told.append(what),
    )
    assert "step 1 of 2, keep largest" in told
    assert "step 2 of 2, smooth" in told


def test_a_command_and_a_session_make_the_same_of_one_request(
    session: Session, volume: Volume
) -> None:
    request = SegmentRequest(threshold="180", keep_largest=True, fill=True, smooth=1.0, margin=-0.5)
    made, _ = request.make(volume)
    session.set_steps(1, request.steps(volume))
    assert np.array_equal(mask(session), made[0].mask())
    with pytest.raises(OptionError, match="allowed: a threshold"):
        SegmentRequest(otsu=2).steps(volume)


def test_lists_come_back_with_those_that_undo_brings_back(volume: Volume, session: Session) -> None:
    session.change_shape(1, LARGEST)
    session.change_shape(1, SMOOTH)
    session.fill_box(1, low=(0, 0, 0), high=(3, 3, 3), solid=True)
    steps = session.steps(1)
    kept = session.kept_steps(all_of_them=True)
    assert kept is not None
    with Session(Scene(volume, [volume.threshold(LOW)]), options=STILL) as again:
        again.restore_steps(kept)
        assert again.steps(1) == SegmentSteps((LOW, high(session)))
        # as a journal does
        again.replace_segment(1, session.segment(1))
        again.restore_steps(kept)
        assert again.steps(1) == steps
        with pytest.raises(OptionError, match="cannot be read"):
            again.restore_steps(b"damaged")


@pytest.mark.parametrize("share", [0.0, 0.02, 0.5, 1.0])
def test_voxel_sets_hold_what_they_were_given(share: float) -> None:
    voxels = np.random.default_rng(3).random((7, 9, 13)) < share
    kept = VoxelSet.of(voxels)
    assert np.array_equal(kept.mask(), voxels)
    assert kept.is_empty == (not voxels.any())
    moved = np.roll(voxels, 1, axis=2)
    assert (digest_of(moved) == digest_of(voxels)) == np.array_equal(moved, voxels)


def test_damaged_voxel_sets_are_refused() -> None:
    kept = VoxelSet.of(np.ones((4, 4, 4), bool))
    far = VoxelSet(kept.shape, (3, 0, 0), kept.size, kept.bits)
    large = VoxelSet(kept.shape, kept.low, (4, 4, 400000), kept.bits)
    for damaged in (far, large, VoxelSet(kept.shape, kept.low, kept.size, b"nothing")):
        with pytest.raises(OptionError, match="damaged"):
            damaged.mask()


def test_voxels_of_another_grid_are_refused(session: Session) -> None:
    other = VoxelSet.of(np.ones((2, 2, 2), bool))
    steps = session.steps(1)
    assert steps is not None
    for wrong in (
        SegmentSteps(other),
        steps.then(HandEdit(added=other, removed=other)),
        steps.then(ShapeStep(kind="unite", other=other)),
    ):
        with pytest.raises(OptionError, match=r"voxels of a grid of \[2, 2, 2\] given"):
            session.set_steps(1, wrong)
