"""A threshold up to the highest value of a scan is felt as one without an upper limit."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from palpate import Scene, ScriptedPath, Segment, Session, SessionOptions, TouchSettings, Volume

DEEP = 1.5
"""How far it is pressed [mm]."""
TOP = 31.5
"""Where the slab ends, between the middles of two voxels."""


def slab(value: float, kind: str) -> Volume:
    values = np.zeros((64, 64, 64), kind)
    values[:32] = value
    return Volume(values, spacing=(1.0, 1.0, 1.0))


def force_on(segment: Segment) -> NDArray[np.float64]:
    """The force in the end on what is pressed from above, at 1 N/mm."""
    path = ScriptedPath((32.0, 32.0, TOP + 3.0)).move((32.0, 32.0, TOP - DEEP), seconds=0.6)
    path = path.move((32.0, 32.0, TOP - DEEP), seconds=0.4)
    options = SessionOptions(real_time=False, touch=TouchSettings(stiffness=1.0, damping=0.0))
    scene = Scene(segment.volume, [segment])
    with Session(scene, device=path, options=options) as session:
        forces: NDArray[np.float64] = session.run(0.9).forces
    last: NDArray[np.float64] = forces[-1]
    return last


@pytest.mark.parametrize(("value", "kind"), [(1000, "i2"), (1000, "u2"), (0.0007, "f4")])
def test_metal_at_the_end_of_the_range_pushes_as_hard_as_its_stiffness_says(
    value: float, kind: str
) -> None:
    scan = slab(value, kind)
    mask = scan.segment(scan.values() > 0, name="mask")
    open_end = force_on(scan.threshold(0.5 * value))
    np.testing.assert_allclose(open_end, [0.0, 0.0, DEEP], atol=0.02)
    np.testing.assert_array_equal(open_end, force_on(scan.threshold(0.5 * value, 2.0 * value)))
    np.testing.assert_allclose(open_end, force_on(mask), atol=0.02)


@pytest.mark.parametrize("slope", [0.1, float(np.float32(0.1))])
def test_the_highest_value_as_it_is_typed_is_the_end_of_the_range(slope: float) -> None:
    stored = np.zeros((64, 64, 64), np.int16)
    stored[:32] = 307
    scan = Volume(stored, spacing=(1.0, 1.0, 1.0), slope=slope)
    typed = force_on(scan.threshold(15.35, 30.7))
    np.testing.assert_allclose(typed, [0.0, 0.0, DEEP], atol=0.02)
    np.testing.assert_array_equal(typed, force_on(scan.threshold(15.35)))


@pytest.mark.parametrize("value", [0.0007, 0.1, 0.3, 1.7, 123.4567, 1e-9])
def test_the_highest_value_ends_the_range_beyond_all_stored_ones(value: float) -> None:
    values = np.random.default_rng(1).uniform(0.0, value, (5, 6, 7)).astype(np.float32)
    volume = Volume(values, spacing=(1.0, 1.0, 1.0))
    made = volume.threshold(float(values.min()))
    assert made.range is not None
    stored = [volume.value_of(int(end)) for end in (volume.array.min(), volume.array.max())]
    assert made.range[0] <= min(stored) < max(stored) <= made.range[1]
    np.testing.assert_allclose(made.range, volume.range, rtol=1e-6)
