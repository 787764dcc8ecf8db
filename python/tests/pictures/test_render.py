"""Pictures of scenes: sides, segments, backgrounds, and what is refused."""

from __future__ import annotations

from typing import Any, get_args

import msgspec
import numpy as np
import palpate
import pytest
from numpy.typing import NDArray
from palpate.pictures.appearance import Mode
from palpate.pictures.render import DrawnScene
from palpate.pictures.shown_segments import bodies_of
from palpate.volumes.scene import Scene
from palpate.volumes.volume import Volume, VolumeTraits

SIZE = (64, 48)
COLOURS = {"left": (1.0, 0.0, 0.0), "anterior": (0.0, 1.0, 0.0), "superior": (0.0, 0.0, 1.0)}
TOWARD = {"left": (1.0, 0.0, 0.0), "anterior": (0.0, -1.0, 0.0), "superior": (0.0, 0.0, 1.0)}


def rotation() -> NDArray[np.float64]:
    turned, _ = np.linalg.qr(np.array([[2.0, 0.3, -0.5], [0.1, 1.5, 0.8], [0.4, -0.7, 1.1]]))
    return np.asarray(turned if np.linalg.det(turned) > 0 else -turned)


GRIDS = {
    "straight": np.eye(3),
    "oblique": rotation(),
    "left-handed": np.diag([-1.0, 1.0, 1.0]),
    "oblique and left-handed": rotation() @ np.diag([1.0, 1.0, -1.0]),
}


def marked_scene(direction: NDArray[np.float64]) -> Scene:
    """Returns a scan with balls to the left, the front and the head of its middle, in colours."""
    shape, spacing = (36, 40, 44), (1.1, 1.2, 1.3)
    empty = Volume(
        np.full(shape, -1000, np.int16),
        spacing=spacing,
        origin=(13.0, -40.0, 7.0),
        direction=direction,
        traits=VolumeTraits(unit="HU"),
    )
    grid = np.stack(np.meshgrid(*(np.arange(n) + 0.5 for n in shape[::-1]), indexing="ij"), -1)
    matrix = empty.patient_from_grid
    places = grid.transpose(2, 1, 0, 3) @ matrix[:3, :3].T + matrix[:3, 3]
    middle = places.reshape(-1, 3).mean(axis=0)
    balls = {
        name: np.linalg.norm(places - middle - 12.0 * np.array(toward), axis=-1) < 5.0
        for name, toward in TOWARD.items()
    }
    solid = np.any(list(balls.values()), axis=0)
    volume = empty.with_values(np.where(solid, 40, -1000).astype(np.int16))
    scene = Scene(volume)
    for name, mask in balls.items():
        scene.add(volume.segment(mask, name=name), colour=COLOURS[name])
    return scene


def place_of(picture: NDArray[np.uint8], name: str) -> tuple[float, float]:
    """Returns the middle column and row of the pixels that have the colour of a ball most."""
    colour = picture[..., :3].astype(float)
    channel = int(np.argmax(COLOURS[name]))
    others = np.delete(colour, channel, axis=-1).max(axis=-1)
    rows, columns = np.nonzero((colour[..., channel] > 2.0 * others) & (picture[..., 3] > 200))
    assert len(rows) > 5, f"{name} is not seen"
    return float(columns.mean()), float(rows.mean())


SIDES: list[tuple[Any, str, str, str]] = [
    # view, ball, and where it is seen from another one
    ("anterior", "left", "superior", "right"),
    ("anterior", "superior", "left", "above"),
    ("posterior", "left", "superior", "left"),
    ("posterior", "superior", "left", "above"),
    ("left", "anterior", "superior", "left"),
    ("left", "superior", "anterior", "above"),
    ("right", "anterior", "superior", "right"),
    ("right", "superior", "anterior", "above"),
    ("superior", "left", "anterior", "left"),
    ("superior", "anterior", "left", "above"),
    ("inferior", "left", "anterior", "right"),
    ("inferior", "anterior", "left", "above"),
    ("first", "left", "superior", "right"),
    ("first", "superior", "left", "above"),
]


@pytest.mark.parametrize("grid", GRIDS)
def test_sides_are_right_whatever_the_grid(grid: str) -> None:
    drawn = DrawnScene(marked_scene(GRIDS[grid]))
    for orthographic in (False, True):
        pictures = {
            view: drawn.draw(
                drawn.camera(view, (90, 90), orthographic=orthographic),
                (90, 90),
                quality="fast",
                background="transparent",
            )
            for view in {row[0] for row in SIDES}
        }
        for view, ball, other, where in SIDES:
            column, row = place_of(pictures[view], ball)
            other_column, other_row = place_of(pictures[view], other)
            apart = {"right": column - other_column, "left": other_column - column}
            assert {**apart, "above": other_row - row}[where] > 5.0, (view, ball)


def body(value: int = 1000) -> Volume:
    """Returns a ball of bone in soft tissue in air [HU]."""
    z, y, x = np.ogrid[-20:20, -20:20, -20:20]
    away = np.sqrt(x**2 + y**2 + z**2)
    values = np.where(away < 9, value, np.where(away < 16, 40, -1000)).astype(np.int16)
    return Volume(values, spacing=(1.0, 1.0, 1.0), traits=VolumeTraits(unit="HU"))


def middle(picture: NDArray[np.uint8]) -> NDArray[np.float64]:
    rows, columns = picture.shape[:2]
    return np.asarray(picture[rows // 2, columns // 2, :3].astype(float))


def test_a_picture_has_the_size_that_is_asked_for() -> None:
    picture = palpate.render(body(), size=SIZE)
    assert picture.shape == (SIZE[1], SIZE[0], 4)
    assert picture.dtype == np.uint8
    assert (picture[..., 3] == 255).all()


def test_backgrounds() -> None:
    dark, white, clear = (
        palpate.render(body(), size=SIZE, background=each)
        for each in ("dark", "white", "transparent")
    )
    assert dark[0, 0, :3].max() < 40
    assert (white[0, 0] == 255).all()
    assert clear[0, 0, 3] == 0
    assert clear[SIZE[1] // 2, SIZE[0] // 2, 3] == 255


@pytest.mark.parametrize("mode", get_args(Mode))
def test_every_mode_shows_the_body(mode: Mode) -> None:
    picture = palpate.render(body(), size=SIZE, mode=mode, quality="fast")
    assert np.abs(middle(picture) - picture[2, 2, :3]).max() > 15


def test_modes_and_presets_look_different() -> None:
    drawn = {
        palpate.render(body(), size=SIZE, mode=mode, preset=preset, quality="fast").tobytes()
        for mode, preset in (
            ("shaded", "bone-in-tissue"), ("composite", "bone-in-tissue"), ("shaded", "CT-Bone"),
            ("shaded", "ct-soft-tissue"), ("mip", "ct-bone"), ("iso", "ct-bone"),
        )
    }  # fmt: skip
    assert len(drawn) == 6


def test_a_visible_segment_is_solid_in_its_colour_and_a_hidden_one_is_left_out() -> None:
    volume = body()
    plain = middle(palpate.render(volume, size=SIZE))
    visible, hidden = Scene(volume), Scene(volume)
    visible.add(volume.threshold(500), colour=(0.0, 1.0, 0.0))
    hidden.add(volume.threshold(500), colour=(0.0, 1.0, 0.0), visible=False)
    red, green, blue = middle(palpate.render(visible, size=SIZE))
    assert green > 1.5 * max(red, blue)
    # without the bone the picture is darker, and not green
    left_out = middle(palpate.render(hidden, size=SIZE))
    assert left_out.sum() < 0.8 * plain.sum()
    assert left_out[1] < left_out[0]


def test_what_a_picture_takes_of_segments() -> None:
    volume = body()
    scene = Scene(volume)
    by_range = volume.threshold(500)
    edited = volume.segment(volume.threshold(500).mask(), name="edited")
    edited.made_by = (500.0, 1200.0)
    drawn = volume.segment(volume.threshold(0).mask(), name="drawn")
    scene.add(by_range, visible=False)
    scene.add(edited)
    scene.add(drawn)
    # hidden, and nothing but voxels tells of it: it looks as the scan does
    scene.add(volume.segment(drawn.mask(), name="hidden"), visible=False)
    bodies = bodies_of(scene)
    assert [number for number, _ in bodies.voxels] == [1, 2, 3]
    told = {each.id: (each.range, each.edited, each.shown) for each in bodies.shown}
    assert told == {
        1: (by_range.range, False, "hidden"),
        2: ((500.0, 1200.0), True, "solid"),
        3: (None, False, "solid"),
    }
    # visible ones win where several claim a value
    assert [each.shown for each in bodies.shown] == ["solid", "solid", "hidden"]


def test_an_edited_segment_is_drawn_by_its_voxels() -> None:
    volume = body()
    mask = volume.threshold(500).mask()
    mask[:, :, :20] = 0
    edited = volume.segment(mask, name="half")
    edited.made_by = (500.0, 1200.0)
    scene = Scene(volume)
    scene.add(edited, colour=(0.0, 1.0, 0.0))
    picture = palpate.render(scene, view="anterior", size=(64, 64), background="white")
    green = picture[..., 1] > 1.2 * picture[..., 0].astype(float)
    # the half at the patient's left is seen at the right
    assert green[:, 36:].sum() > 100
    assert green[:, :28].sum() == 0


def half_of_bone(**changes: Any) -> Scene:
    """Returns a ball of bone of which the half at the patient's left is a segment."""
    volume = body()
    mask = volume.threshold(500).mask()
    mask[:, :, :20] = 0
    half = volume.segment(mask, name="half")
    half.made_by = (500.0, 1200.0)
    scene = Scene(volume)
    scene.add(half, colour=(0.0, 1.0, 0.0), **changes)
    return scene


def seen(scene: Scene | Volume, **options: Any) -> NDArray[np.float64]:
    """Returns how opaque the pixels are before the bone, at the patient's right and left."""
    picture = palpate.render(
        scene, view="anterior", size=(64, 64), background="transparent", **options
    )
    opacity = picture[28:36, :, 3].astype(float) / 255.0
    return np.array([opacity[:, 27:30].mean(), opacity[:, 34:37].mean()])


def test_bone_that_is_not_felt_is_hinted_at() -> None:
    right, left = seen(half_of_bone())
    assert left == pytest.approx(1.0, abs=0.01)
    assert right < 0.8 * seen(body())[0]
    # a segment that the probe passes through hints at nothing
    assert seen(half_of_bone(touchable=False))[0] > 1.2 * right
    # where all are values, segments tell nothing of them
    assert seen(half_of_bone(), mode="mip") == pytest.approx(seen(body(), mode="mip"))


def test_only_what_can_be_touched() -> None:
    right, left = seen(half_of_bone(), touchable_only=True)
    assert right == 0.0
    assert left == pytest.approx(1.0, abs=0.01)
    assert seen(half_of_bone(touchable=False), touchable_only=True).max() == 0.0
    assert seen(half_of_bone(), mode="iso", touchable_only=True)[0] == 0.0
    everything = seen(half_of_bone(), mode="mip")
    assert seen(half_of_bone(), mode="mip", touchable_only=True) == pytest.approx(everything)


def test_an_object_with_voxels_of_its_own_is_drawn_where_it_stands() -> None:
    volume = body()
    # beyond the scan, which ends at 40 mm
    fine = Volume(
        np.ones((20, 20, 20), np.int16), spacing=(0.6, 0.6, 0.6), origin=(36.0, 14.0, 14.0)
    )
    scene = Scene(volume)
    plate = fine.segment(np.ones(fine.shape, np.uint8), name="plate").as_object()
    scene.add(plate, colour=(0.0, 0.0, 1.0))
    picture = palpate.render(scene, view="anterior", size=(64, 64)).astype(float)
    blue = picture[..., 2] > 2.0 * picture[..., 0]
    assert blue[:, 48:].sum() > 50
    assert blue[:, :40].sum() == 0


def test_a_surface_is_seen_through_as_its_opacity_says() -> None:
    volume = body()
    green = {}
    for opacity in (0.0, 0.5, 1.0):
        scene = Scene(volume)
        scene.add(volume.threshold(500), colour=(0.0, 1.0, 0.0), shown_as="surface")
        (one,) = scene
        one.appearance = msgspec.structs.replace(one.appearance, opacity=opacity)
        red, green[opacity], _ = middle(palpate.render(scene, size=SIZE))
        green[opacity] = green[opacity] - red
    assert green[0.0] + 5 < green[0.5] < green[1.0] - 5


def test_an_opaque_surface_is_where_the_body_of_its_voxels_is() -> None:
    volume = body()
    ball = {}
    for shown_as in ("volume", "surface"):
        scene = Scene(volume)
        scene.add(volume.threshold(500), colour=(0.0, 1.0, 0.0), shown_as=shown_as)
        picture = palpate.render(scene, size=SIZE, background="white", quality="fast")
        # clear tissue and what is behind are white
        ball[shown_as] = picture[..., 2] < 200
    assert ball["volume"].sum() > 100
    assert (ball["surface"] != ball["volume"]).sum() < 0.15 * ball["volume"].sum()


@pytest.mark.parametrize("shape", [(1, 1, 1), (1, 30, 30), (3, 3, 40), (40, 40, 40)])
@pytest.mark.parametrize("value", [0, 700])
def test_scans_without_content_are_drawn_too(shape: tuple[int, ...], value: int) -> None:
    volume = Volume(np.full(shape, value, np.int16), spacing=(1.0, 1.0, 1.0))
    for mode, preset in (("shaded", "ct-bone"), ("mip", "mr-default"), ("iso", "bone-in-tissue")):
        picture = palpate.render(volume, size=(20, 16), mode=mode, preset=preset)
        assert picture.shape == (16, 20, 4)


def test_a_turn_begins_with_the_view_and_keeps_its_distance() -> None:
    drawn = DrawnScene(body())
    first = drawn.camera("anterior", SIZE)
    cameras = drawn.around(first, SIZE, 4)
    assert cameras[0].back == pytest.approx(first.back)
    # content turns as if dragged to the right: then the patient's right side is seen
    assert cameras[1].back == pytest.approx((-1.0, 0.0, 0.0), abs=1e-12)
    assert len({each.distance for each in cameras}) == 1


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"view": "lefft"}, "view 'lefft' given (did you mean 'left'?); allowed: first, anterior"),
        ({"preset": "ct-bones"}, "preset 'ct-bones' given (did you mean 'ct-bone'?); allowed: "),
        ({"mode": "mipp"}, "mode 'mipp' given (did you mean 'mip'?); allowed: shaded, "),
        ({"quality": "fines"}, "quality 'fines' given (did you mean 'fine'?); allowed: fast, "),
        ({"background": "black"}, "background 'black' given; allowed: dark, white, transparent"),
        ({"size": (0, 10)}, "size (0, 10) given; allowed: columns and rows, each 1 to 16384"),
        ({"size": 100}, "size 100 given; allowed: columns and rows, each 1 to 16384"),
        ({"size": (10.5, 10)}, "size (10.5, 10) given; allowed: columns and rows, each 1 to"),
        ({"samples": 0}, "samples 0 given; allowed: 1 to 64"),
        ({"samples": 1.5}, "samples 1.5 given; allowed: 1 to 64"),
    ],
)
def test_what_cannot_be_drawn_is_refused(given: dict[str, Any], said: str) -> None:
    with pytest.raises(palpate.OptionError) as refused:
        palpate.render(body(), **given)
    assert str(refused.value).startswith(said)


def test_what_is_no_scan_is_refused() -> None:
    nothing: Any = "head.mha"
    with pytest.raises(palpate.OptionError, match="scene of type str given; allowed: a Scene or"):
        palpate.render(nothing)
