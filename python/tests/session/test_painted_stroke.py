"""Strokes of the brush in slices: what they cover, and that each is one step of undo."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from palpate.base.errors import OptionError
from palpate.segmentation.brush import Brush, boxes_of, covered
from palpate.session.painted_stroke import PaintedStroke
from palpate.session.session import Session, SessionOptions
from palpate.volumes.scene import Scene
from palpate.volumes.volume import Volume

SPACING = (1.0, 1.5, 2.0)
"""x, y, z [mm]: no axis stands for another."""
SHAPE = (30, 40, 60)
STRAIGHT = np.eye(3)
TURNED = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]])
"""An orientation in which no axis of the grid is the patient's own."""


def scan(direction: NDArray[np.float64] = STRAIGHT) -> Volume:
    values = np.arange(np.prod(SHAPE)).reshape(SHAPE) % 500
    return Volume(
        values.astype(np.int16),
        spacing=SPACING,
        origin=(5.0, -7.0, 11.0),
        direction=direction,
        slope=2.0,
        intercept=-100.0,
    )


def centres(volume: Volume) -> NDArray[np.float64]:
    """Returns the centre of each voxel [patient], shape [z, y, x, 3]."""
    z, y, x = np.indices(SHAPE)
    grid = np.stack([x, y, z], axis=-1) + 0.5
    return grid @ volume.patient_from_grid[:3, :3].T + volume.patient_from_grid[:3, 3]


def middle(volume: Volume) -> NDArray[np.float64]:
    grid = np.array([30.3, 20.4, 15.2, 1.0])
    point: NDArray[np.float64] = (volume.patient_from_grid @ grid)[:3]
    return point


def mask_of(volume: Volume, brush: Brush, *ends: Any) -> NDArray[np.bool_]:
    mask = np.zeros(SHAPE, bool)
    box, part = covered(volume, brush, (ends[0], ends[-1]))
    mask[box] = part
    return mask


def to_way(points: NDArray[np.float64], start: Any, end: Any) -> NDArray[np.float64]:
    """Returns distances to a straight way."""
    way = np.asarray(end) - start
    share = np.clip((points - start) @ way / max(way @ way, 1e-12), 0.0, 1.0)
    off: NDArray[np.float64] = np.linalg.norm(points - start - share[..., None] * way, axis=-1)
    return off


@pytest.mark.parametrize("direction", [np.eye(3), TURNED])
def test_a_ball_covers_all_centres_near_its_way(direction: NDArray[np.float64]) -> None:
    volume = scan(direction)
    start = middle(volume)
    end = start + np.array([9.0, -6.0, 4.0])
    mask = mask_of(volume, Brush(radius=7.0), start, end)
    np.testing.assert_array_equal(mask, to_way(centres(volume), start, end) <= 7.0)


@pytest.mark.parametrize("direction", [np.eye(3), TURNED])
@pytest.mark.parametrize("normal", [(0.0, 0.0, 1.0), (0.0, -1.0, 0.0), (1.0, 0.0, 0.0)])
def test_a_disc_lies_in_one_layer_of_voxels(
    direction: NDArray[np.float64], normal: tuple[float, float, float]
) -> None:
    volume = scan(direction)
    start = middle(volume)
    flat = np.eye(3)[np.abs(normal).argmax()] == 0.0
    end = start + np.array([8.0, 5.0, -7.0]) * flat
    mask = mask_of(volume, Brush(radius=6.1, normal=normal), start, end)
    off = (centres(volume) - start) @ np.array(normal)
    # those voxels that the slice cuts, seen along its normal
    edge = np.abs(np.array(normal) @ volume.direction) @ SPACING
    layer = np.abs(off) < 0.5 * edge
    seen = to_way(centres(volume) - off[..., None] * normal, start, end) <= 6.1
    np.testing.assert_array_equal(mask, layer & seen)
    assert sum(len(set(places)) == 1 for places in np.nonzero(mask)) == 1
    area = np.count_nonzero(mask) * volume.voxel_volume / edge
    expected = np.pi * 6.1**2 + 12.2 * float(np.linalg.norm(end - start))
    assert area == pytest.approx(expected, rel=0.05)


def test_an_oblique_disc_has_all_voxels_that_its_slice_cuts() -> None:
    volume = scan()
    start = middle(volume)
    normal = np.array([1.0, 2.0, -1.5])
    normal /= np.linalg.norm(normal)
    mask = mask_of(volume, Brush(radius=8.0, normal=tuple(normal)), start)
    across = np.cross(normal, (0.0, 0.0, 1.0))
    across /= np.linalg.norm(across)
    turns = np.random.default_rng(7).uniform(size=(2, 5000))
    reach, angle = 6.0 * np.sqrt(turns[0]), 2.0 * np.pi * turns[1]
    points = (
        start
        + (reach * np.cos(angle))[:, None] * across
        + (reach * np.sin(angle))[:, None] * np.cross(normal, across)
    )
    # where one looks inside of the circle, one sees painted voxels
    assert volume.segment(mask, name="disc").contains(points).all()


def test_a_slice_between_two_layers_paints_one_of_them() -> None:
    volume = scan()
    border = (volume.patient_from_grid @ (30.0, 20.0, 15.0, 1.0))[:3]
    for sign in (1.0, -1.0):
        mask = mask_of(volume, Brush(radius=5.0, normal=(0.0, 0.0, sign)), border)
        # the same that is seen: the voxel that holds the point
        assert set(np.nonzero(mask)[0]) == {15}


def test_only_values_that_are_asked_for_are_covered() -> None:
    volume = scan()
    start = middle(volume)
    brush = Brush(radius=9.0, values=(100.0, 300.0))
    values = volume.array * 2.0 - 100.0
    within = (values >= 100.0) & (values <= 300.0)
    all_of_it = mask_of(volume, Brush(radius=9.0), start)
    np.testing.assert_array_equal(mask_of(volume, brush, start), all_of_it & within)
    assert not mask_of(volume, Brush(radius=9.0), (500.0, 0.0, 0.0)).any()


def test_boxes_are_the_mask_and_never_overlap() -> None:
    mask = np.random.default_rng(3).uniform(size=(6, 7, 8)) < 0.6
    count = np.zeros(mask.shape, int)
    for low, high in boxes_of(mask):
        count[low[2] : high[2], low[1] : high[1], low[0] : high[0]] += 1
    np.testing.assert_array_equal(count, mask.astype(int))
    assert len(list(boxes_of(np.ones((4, 5, 6), bool)))) == 1


@pytest.fixture
def session() -> Any:
    volume = scan()
    scene = Scene(volume)
    scene.add(volume.segment(np.zeros(SHAPE, bool), name="painted"))
    scene.add(volume.threshold(0.0, 300.0, name="range"))
    with Session(scene, options=SessionOptions(real_time=False)) as opened:
        yield opened


def solid(session: Session, segment_id: int = 1) -> NDArray[np.bool_]:
    mask: NDArray[np.bool_] = session.segment(segment_id).mask() != 0
    return mask


def test_a_stroke_is_one_step_of_undo_among_others(session: Session) -> None:
    volume = session.scene.volume
    start = middle(volume)
    ways = [start + offset for offset in np.array([[0, 0, 0], [10, 0, 0], [10, 8, 0]])]
    states = [solid(session)]
    session.fill_box(1, low=(0, 0, 0), high=(3, 3, 3), solid=True)
    states.append(solid(session))
    for erases, radius in ((False, 6.0), (True, 3.0)):
        stroke = PaintedStroke(session, 1, erases=erases)
        stroke.along(Brush(radius=radius), ways[:2])
        stroke.along(Brush(radius=radius, normal=(0.0, 0.0, 1.0)), ways[1:])
        stroke.finish()
        assert stroke.changed == 0, "it begins anew after its end"
        states.append(solid(session))
    session.fill_box(1, low=(50, 30, 20), high=(53, 33, 23), solid=True)
    states.append(solid(session))
    expected = states[1].copy()
    expected |= mask_of(volume, Brush(radius=6.0), *ways[:2])
    expected |= mask_of(volume, Brush(radius=6.0, normal=(0.0, 0.0, 1.0)), *ways[1:])
    np.testing.assert_array_equal(states[2], expected)
    assert states[3].sum() < states[2].sum()
    for state in reversed(states[:-1]):
        assert session.undo()
        np.testing.assert_array_equal(solid(session), state)
    assert not session.undo()
    for state in states[1:]:
        assert session.redo()
        np.testing.assert_array_equal(solid(session), state)
    assert not session.redo()


def test_a_cancelled_stroke_leaves_nothing_and_a_range_comes_back(session: Session) -> None:
    before = solid(session, 2)
    stroke = PaintedStroke(session, 2, erases=True)
    stroke.along(Brush(radius=5.0), [middle(session.scene.volume)])
    assert stroke.changed > 0
    assert session.segments()[1]["range"] is None
    stroke.cancel()
    np.testing.assert_array_equal(solid(session, 2), before)
    assert session.segments()[1]["range"] == (0.0, 300.0)
    # nothing was painted: nothing is taken back
    PaintedStroke(session, 2).cancel()
    assert session.segments()[1]["range"] == (0.0, 300.0)


@pytest.mark.parametrize(
    "brush",
    [
        Brush(radius=0.0),
        Brush(radius=51.0),
        Brush(normal=(0.0, 0.0, 0.0)),
        Brush(values=(3.0, 1.0)),
    ],
)
def test_a_brush_out_of_range_is_refused(session: Session, brush: Brush) -> None:
    with pytest.raises(OptionError, match="given; allowed"):
        PaintedStroke(session, 1).along(brush, [middle(session.scene.volume)])
    assert not session.undo()


def test_what_was_moved_is_not_painted(session: Session) -> None:
    pose = np.eye(4)
    pose[0, 3] = 5.0
    session.move_segment(1, pose)
    with pytest.raises(OptionError, match="does not stand where the scan has it"):
        PaintedStroke(session, 1)


def test_a_page_paints_and_its_stroke_ends_with_undo_or_with_it(server: Any) -> None:
    paint = {"type": "paint", "id": 2, "erases": False, "radius": 4.0, "values": None}
    with server.page() as page:
        page.send({"type": "new_segment", "name": "Painted 1"})
        page.receive("segments", until=lambda m: len(m["segments"]) == 2)
        page.send(paint | {"points": [[10.0, 10.0, 10.0]], "normal": [0.0, 0.0, 1.0]})
        page.send(paint | {"points": [[10.0, 10.0, 10.0], [20.0, 10.0, 10.0]], "normal": None})
        page.receive("segments", until=lambda m: m["segments"][1]["voxels"] > 500)
        # a stroke that is on is whole before anything is taken back
        page.send({"type": "undo"})
        page.receive("segments", until=lambda m: m["segments"][1]["voxels"] == 0)
        page.send(paint | {"points": [[10.0, 10.0, 10.0]], "normal": None})
        page.receive("segments", until=lambda m: m["segments"][1]["voxels"] > 100)
        page.send({"type": "end_paint", "keep": False})
        page.receive("segments", until=lambda m: m["segments"][1]["voxels"] == 0)
        page.send(paint | {"points": [[10.0, 10.0, 10.0]], "normal": None, "id": 9})
        assert "9" in page.receive("notice")["text"]
        page.send(paint | {"points": [[10.0, 10.0, 10.0]], "normal": None})
        page.receive("segments", until=lambda m: m["segments"][1]["voxels"] > 100)
    # the page is gone: its stroke is whole
    with server.page() as page:
        page.send({"type": "undo"})
        page.receive("segments", until=lambda m: m["segments"][1]["voxels"] == 0)
