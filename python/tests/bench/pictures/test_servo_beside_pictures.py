"""The servo is watched with pictures beside it and without, in pairs."""

from __future__ import annotations

import numpy as np
import palpate
from palpate.bench.goals.seen import LATE_CASE, SEEN_ROWS
from palpate.bench.pictures.servo_beside_pictures import late_beside_pictures
from palpate.saved.opening import opening_of


def test_late_ticks_are_counted_with_pictures_and_without() -> None:
    z, y, x = np.mgrid[0:40, 0:40, 0:40] - 20.0
    values = np.where(x * x + y * y + z * z <= 15.0**2, 900, -1000).astype(np.int16)
    scene = opening_of(palpate.Volume(values, spacing=(1.0, 1.0, 1.0))).scene
    found = late_beside_pictures(scene, pairs=2, seconds=0.2)
    assert found["pictures"] > 0.0
    assert 0.0 <= found["with"] <= 1.0
    assert 0.0 <= found["without"] <= 1.0
    assert {row.key for row in SEEN_ROWS if row.case == LATE_CASE} == set(found) - {"real time"}
