"""A threshold up to the highest value of a scan is felt as one without an upper limit."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from palpate import Scene, ScriptedPath, Segment, Session, SessionOptions, TouchSettings, Volume

DEEP = 1.5
"""How far it is pressed [mm]."""
TOP = 31.5
"""Where the slab ends, between the middles of two voxels."""


def slab(high: int = 1000, low: int = 0) -> Volume:
    values = np.full((64, 64, 64), low, np.int16)
    values[:32] = high
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


def test_metal_at_the_end_of_the_range_pushes_as_hard_as_its_stiffness_says() -> None:
    scan = slab()
    mask = scan.segment(scan.array > 0, name="mask")
    open_end, beyond = force_on(scan.threshold(500)), force_on(scan.threshold(500, 2000))
    np.testing.assert_allclose(open_end, [0.0, 0.0, DEEP], atol=0.02)
    np.testing.assert_array_equal(open_end, beyond)
    np.testing.assert_allclose(open_end, force_on(mask), atol=0.02)
