"""Limits are closed in the values that the file holds, whoever compares them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import nibabel
import numpy as np
import palpate
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from made_dose import write_dose
from numpy.typing import NDArray
from palpate import Scene, Session, SessionOptions, Volume, protocol
from palpate.cli.commands import run
from palpate.segmentation.brush import Brush, covered
from palpate.segmentation.multi_otsu import otsu
from palpate.segmentation.operations import Growing, grown
from palpate.segmentation.request import SegmentRequest
from palpate.server.messages.segment_list import SegmentList

QUARTERS = np.array([0.0, 0.25, 0.5, 0.75, 1.0], np.float32)
SLOPES = [0.1, 0.001, 0.3, 1.7, float(np.float32(0.1)), float(np.float32(0.001)), -0.1]


def volume_of(values: NDArray[Any], **more: Any) -> Volume:
    return Volume(values, spacing=(1.0, 1.5, 2.5), **more)


def quarters() -> NDArray[np.float32]:
    return np.random.default_rng(3).choice(QUARTERS, (6, 7, 8))


def everywhere(volume: Volume, low: float, high: float) -> list[NDArray[np.bool_]]:
    """Returns the voxels from low to high as all that compare values tell them."""
    brush = Brush(radius=50.0, values=(low, high))
    z, y, x = volume.shape
    middle = (0.5 * x, 0.75 * y, 1.25 * z)
    box, painted = covered(volume, brush, (middle, middle))
    assert painted.shape == volume.shape, box
    (made,), _ = SegmentRequest(threshold=f"{low!r},{high!r}").make(volume)
    return [
        volume.threshold(low, high).mask() != 0,
        volume.between(low, high),
        painted,
        made.mask() != 0,
    ]


@pytest.mark.parametrize("slope", SLOPES)
def test_a_decimal_limit_is_the_step_that_it_names(slope: float) -> None:
    rng = np.random.default_rng(7)
    stored = rng.integers(-3000, 3000, (4, 5, 6)).astype(np.int16)
    volume = volume_of(stored, slope=slope, intercept=5.0)
    for number in rng.choice(stored.ravel(), 20):
        # as a person reads it in a table
        limit = round(float(number) * round(slope, 6) + 5.0, 6)
        above = stored >= number if slope > 0 else stored <= number
        below = stored <= number if slope > 0 else stored >= number
        for inside in everywhere(volume, limit, 1e5):
            np.testing.assert_array_equal(inside, above)
        for inside in everywhere(volume, -1e5, limit):
            np.testing.assert_array_equal(inside, below)
        for inside in everywhere(volume, limit, limit):
            np.testing.assert_array_equal(inside, above & below)


@pytest.mark.parametrize("kind", ["f4", "f8", "i4", "u2", "u4"])
def test_limits_select_what_numpy_selects(kind: str) -> None:
    values = np.random.default_rng(8).integers(0, 5, (4, 5, 6)).astype(kind)
    if kind[0] == "f":
        values /= 4.0
    else:
        values *= values.dtype.type(16_001 if kind == "u2" else 99_991)
    volume = volume_of(values)
    for limit in np.unique(values):
        for inside in everywhere(volume, float(limit), float(values.max())):
            np.testing.assert_array_equal(inside, values >= limit)
        for inside in everywhere(volume, float(values.min()), float(limit)):
            np.testing.assert_array_equal(inside, values <= limit)


# the number of the highest value is rounded to a little more than the last one
@example(numbers=[0.0, -237.2962188720703], limit=-4.396715022654145e-26)
@settings(max_examples=60, deadline=None)
@given(
    st.lists(st.floats(-1e3, 1e3, width=32), min_size=2, max_size=30),
    st.floats(-1e3, 1e3, width=32),
)
def test_what_touch_and_the_picture_compare_selects_the_same_where_it_can(
    numbers: list[float], limit: float
) -> None:
    values = np.array(numbers, np.float32).reshape(1, 1, -1)
    volume = volume_of(values)
    if volume.exact is None or not values.min() < limit < values.max():
        return
    made = volume.threshold(limit)
    assert made.range is not None
    mask = made.mask() != 0
    np.testing.assert_array_equal(values >= made.range[0], mask)
    stored = volume.array * volume.slope + volume.intercept
    # a step can hold values of both sides
    mixed = np.isin(volume.array, volume.array[mask]) & np.isin(volume.array, volume.array[~mask])
    shown = (stored >= made.range[0]) & (stored <= made.range[1])
    np.testing.assert_array_equal(shown[~mixed], mask[~mixed])


@pytest.mark.parametrize("limit", [0.25, 0.5, 0.75])
def test_no_quarter_is_lost_to_the_page_or_touch_by_rounding(limit: float) -> None:
    values = quarters()
    volume = volume_of(values)
    for low, high in ((limit, 1.0), (0.0, limit), (limit, limit)):
        with Session(Scene(volume), options=SessionOptions(real_time=False)) as session:
            # as a page asks for it
            wanted = protocol.Threshold(id=None, name="quarters", low=low, high=high)
            SegmentList(session).threshold(wanted)
            (state,) = session.segments()
            np.testing.assert_array_equal(
                session.segment(1).mask() != 0, (values >= low) & (values <= high)
            )
        assert state["range"] is not None
        first, last = state["range"]
        stored = volume.array * volume.slope + volume.intercept
        shown = (stored >= first) & (stored <= last)
        np.testing.assert_array_equal(shown, (values >= low) & (values <= high))
        # and asked for again by the page it is the same
        np.testing.assert_array_equal(volume.between(first, last), shown)


def test_commands_and_recipes_select_what_numpy_selects(tmp_path: Path, write_image: Any) -> None:
    values = quarters()
    scan = write_image(values, "map.nii.gz")
    out = tmp_path / "out.nii.gz"
    assert run(["segment", str(scan), "--threshold", "0.75", "-o", str(out)]) == 0
    np.testing.assert_array_equal(palpate.read(out).values() != 0, values >= 0.75)
    recipe = tmp_path / "r.yaml"
    recipe.write_text(
        "import:\n  path: map.nii.gz\nsegment:\n  - threshold: 0.25,0.5\n    name: middle\n"
        "export:\n  - out: by-recipe.nii.gz\n"
    )
    assert run(["run", str(recipe)]) == 0
    made = palpate.read(tmp_path / "by-recipe.nii.gz").values() != 0
    np.testing.assert_array_equal(made, (values >= 0.25) & (values <= 0.5))


@pytest.mark.parametrize(("scaling", "most"), [(0.001, 60_000), (0.0001, 600_000), (0.1, 600)])
def test_a_dose_is_the_decimal_that_its_scaling_makes(
    tmp_path: Path, scaling: float, most: int
) -> None:
    stored = np.random.default_rng(4).integers(0, most, (5, 4, 6))
    volume = palpate.read(write_dose(tmp_path / "dose.dcm", stored * scaling, scaling=scaling))
    for number in stored.ravel():
        limit = round(float(number) * scaling, 4)
        for inside in everywhere(volume, limit, limit):
            np.testing.assert_array_equal(inside, stored == number)


def test_slopes_of_nifti_are_taken_for_the_decimals_that_they_round(tmp_path: Path) -> None:
    stored = np.arange(400, dtype=np.int16).reshape(4, 10, 10)
    image = nibabel.Nifti1Image(stored.T, np.eye(4))
    image.header.set_slope_inter(0.1, 0.0)
    nibabel.save(image, tmp_path / "a.nii")
    volume = palpate.read(tmp_path / "a.nii")
    for high, last in ((0.3, 3), (0.7, 7), (30.7, 307)):
        for inside in everywhere(volume, 0.0, high):
            np.testing.assert_array_equal(inside, stored.reshape(inside.shape) <= last)


def test_limits_beyond_what_values_can_be_are_no_limits() -> None:
    for volume in (volume_of(quarters()), volume_of(np.ones((2, 2, 2), np.int16), slope=0.1)):
        assert volume.threshold(-1e300, 1.7e308).voxel_count == volume.array.size


def test_grown_regions_end_with_the_value_that_is_their_limit() -> None:
    stored = np.full((20, 20, 20), -3000, np.int16)
    stored[5:15, 5:15, 5:15] = 1000
    stored[5:15, 5:15, 14] = 1001
    slope = float(np.float32(0.1))
    volume = Volume(stored, spacing=(1.0, 1.0, 1.0), slope=slope)
    how = Growing(range=(-100.0, 100.1), passage=0.0, fill=False)
    assert grown(volume, [(10.0, 10.0, 10.0)], growing=how).voxel_count == 1000


@pytest.mark.parametrize(("kind", "scale"), [("i4", 1), ("i8", 1000), ("f4", 0.1), ("f8", 1e40)])
def test_each_value_is_in_one_class_of_otsu(kind: str, scale: float) -> None:
    # single precision holds every second of these
    values = (np.arange(200_000).reshape(20, 100, 100) + 20_000_001) * scale
    volume = volume_of(values.astype(kind))
    assert volume.exact is not None
    classes = [one.mask() != 0 for one in otsu(volume, classes=3)]
    assert not (classes[0] & classes[1]).any()
    lowest = volume.values() < volume.values()[classes[0] | classes[1]].min()
    assert (lowest | classes[0] | classes[1]).all()
    assert 50_000 < np.count_nonzero(lowest) < 80_000
