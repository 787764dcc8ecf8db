"""Segments between painted slices and from seeds: against bodies whose shape is known."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import SimpleITK
from numpy.typing import NDArray
from palpate.base.errors import OptionError
from palpate.cli.commands import run
from palpate.io.reading import read
from palpate.labels.labels import read_labels
from palpate.segmentation.operations import changed_shape, grown_from_seeds
from palpate.segmentation.slice_interpolation import between_slices
from palpate.volumes.volume import Volume

SPACING = (1.0, 1.5, 2.0)
"""x, y, z [mm]: no axis stands for another."""
SHAPE = (40, 52, 70)
Mask = NDArray[np.bool_]


def places() -> NDArray[np.float64]:
    """Returns the centre of each voxel, x, y, z [mm]."""
    z, y, x = np.indices(SHAPE)
    return np.stack([x, y, z], axis=-1) * SPACING


def ball(middle: tuple[float, float, float], radius: float) -> Mask:
    inside: Mask = np.linalg.norm(places() - middle, axis=-1) <= radius
    return inside


def dice(first: Mask, second: Mask) -> float:
    both = int(np.count_nonzero(first & second))
    return 2.0 * both / (int(np.count_nonzero(first)) + int(np.count_nonzero(second)))


MIDDLE = (35.0, 38.0, 40.0)
BALL = ball(MIDDLE, 24.0)


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_a_ball_painted_in_every_fourth_slice_is_filled_between(axis: int) -> None:
    drawn = np.zeros(SHAPE, bool)
    painted = np.flatnonzero(BALL.any(axis=tuple(a for a in range(3) if a != axis)))[::4]
    slices = np.moveaxis(drawn, axis, 0)
    slices[painted] = np.moveaxis(BALL, axis, 0)[painted]
    # what lies beyond the last painted slice is nobody's guess
    within = np.zeros(SHAPE, bool)
    np.moveaxis(within, axis, 0)[painted[0] : painted[-1] + 1] = True
    filled = between_slices(drawn, SPACING)
    np.testing.assert_array_equal(np.moveaxis(filled, axis, 0)[painted], slices[painted])
    assert not (filled & ~within).any()
    assert dice(filled, BALL & within) > 0.97


def test_a_hole_stays_a_hole_and_a_middle_slice_is_as_wide_as_its_share() -> None:
    off = np.linalg.norm(((places() - MIDDLE) * (1.0, 1.0, 0.0)), axis=-1)
    drawn = np.zeros(SHAPE, bool)
    drawn[10] = (off[10] <= 10.0) & (off[10] > 4.0)
    drawn[30] = (off[30] <= 20.0) & (off[30] > 8.0)
    middle = between_slices(drawn, SPACING)[20]
    area = np.count_nonzero(middle) * SPACING[0] * SPACING[1]
    assert area == pytest.approx(np.pi * (15.0**2 - 6.0**2), rel=0.05)
    assert not middle[off[20] <= 5.0].any()


def test_nothing_lies_between_where_no_slice_is_empty() -> None:
    np.testing.assert_array_equal(between_slices(BALL, SPACING), BALL)
    none = np.zeros(SHAPE, bool)
    np.testing.assert_array_equal(between_slices(none, SPACING), none)
    scan = Volume(np.zeros(SHAPE, np.int16), spacing=SPACING)
    changed = changed_shape(scan.segment(BALL, name="ball"), "between-slices")
    np.testing.assert_array_equal(changed.mask() != 0, BALL)


def noisy() -> tuple[Volume, Mask, Mask]:
    """Two bodies of slightly different values that touch each other, in air, with noise."""
    left = ball((24.0, 38.0, 40.0), 16.0)
    right = ball((46.0, 38.0, 40.0), 16.0) & ~left
    values = np.zeros(SHAPE)
    values[left], values[right] = 100.0, 160.0
    values += np.random.default_rng(5).normal(scale=6.0, size=SHAPE)
    return Volume(values.astype(np.int16), spacing=SPACING), left, right


def seeds_of(scan: Volume) -> list[Any]:
    air = np.zeros(SHAPE, bool)
    air[:, :4] = True
    return [
        scan.segment(ball((22.0, 38.0, 40.0), 4.0), name="left"),
        scan.segment(ball((50.0, 38.0, 40.0), 4.0), name="right"),
        scan.segment(air, name="air"),
    ]


def test_seeds_grow_until_they_meet_where_values_change() -> None:
    scan, left, right = noisy()
    first, second, around = grown_from_seeds(scan, seeds_of(scan), smoothing=1.5)
    assert [first.name, second.name] == ["left, grown", "right, grown"]
    assert dice(first.mask() != 0, left) > 0.9
    assert dice(second.mask() != 0, right) > 0.9
    shared = first.mask() + second.mask() + around.mask()
    assert shared.max() == 1
    # together they fill the box of all seeds and what is near it
    assert shared[20, :30].all()


def test_growing_from_seeds_is_stopped_between_two_steps() -> None:
    class StoppedError(Exception):
        pass

    told: list[float | None] = []

    def stop(_: str, share: float | None) -> None:
        told.append(share)
        if share is not None:
            raise StoppedError

    scan, _, _ = noisy()
    with pytest.raises(StoppedError):
        grown_from_seeds(scan, seeds_of(scan), progress=stop)
    assert told[0] is None


def test_seeds_that_cannot_be_are_refused() -> None:
    scan, left, _ = noisy()
    good = seeds_of(scan)
    empty = scan.segment(np.zeros(SHAPE, bool), name="none")
    over = scan.segment(left, name="over")
    own = good[0].as_object()
    cases: tuple[tuple[Any, dict[str, Any], str], ...] = (
        (good[:1], {}, "1 seeds given"),
        ([good[0], empty], {}, "'none' is empty"),
        ([good[0], over], {}, "'over' shares voxels"),
        ([good[1], own], {}, "another grid"),
        (good, {"smoothing": 0.0}, "smoothing 0 mm given"),
        (good, {"around": -1.0}, "around -1 mm given"),
    )
    for seeds, options, said in cases:
        with pytest.raises(OptionError, match=said):
            grown_from_seeds(scan, seeds, **options)


def test_the_command_line_grows_from_a_file_of_seeds(tmp_path: Path, capsys: Any) -> None:
    scan, left, _ = noisy()
    path, seeds, out = tmp_path / "scan.mha", tmp_path / "seeds.mha", tmp_path / "out.seg.nrrd"
    numbers = np.zeros(SHAPE, np.uint8)
    for number, seed in enumerate(seeds_of(scan), start=1):
        numbers[seed.mask() != 0] = number
    for array, target in ((scan.array, path), (numbers, seeds)):
        image = SimpleITK.GetImageFromArray(array)
        image.SetSpacing(SPACING)
        SimpleITK.WriteImage(image, str(target))
    assert run(["segment", str(path), "--seeds", str(seeds), "-o", str(out)]) == 0
    found = {one.segment.name: one.segment.mask() for one in read_labels(out, read(path)).labels}
    assert dice(found["label 1, grown"] != 0, left) > 0.9
    assert len(found) == 3
    capsys.readouterr()


def test_a_page_grows_from_seeds_and_undo_takes_them_away(server: Any) -> None:
    with server.page() as page:
        page.send({"type": "new_segment", "name": "around"})
        page.receive("segments", until=lambda m: len(m["segments"]) == 2)
        paint = {"type": "paint", "id": 2, "erases": False, "radius": 1.5, "values": None}
        page.send(paint | {"points": [[2.0, 2.0, 2.0]], "normal": None})
        page.send({"type": "end_paint", "keep": True})
        page.receive("segments", until=lambda m: m["segments"][1]["voxels"] > 0)
        page.send({"type": "grow_seeds", "ids": [1, 2], "smoothing": 1.0})
        # the list is sent while they are still being named too
        names = ["ball, grown", "around, grown"]
        named = page.receive(
            "segments", until=lambda m: [one["name"] for one in m["segments"][2:]] == names
        )
        grown = named["segments"]
        assert grown[2]["voxels"] == pytest.approx(grown[0]["voxels"], rel=0.3)
        for left in (3, 2):
            page.send({"type": "undo"})
            page.receive("segments", until=lambda m, left=left: len(m["segments"]) == left)
        page.send({"type": "grow_seeds", "ids": [1, 1], "smoothing": 1.0})
        assert "shares voxels" in page.receive("notice")["text"]
