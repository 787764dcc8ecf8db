"""A ball comes back where it was: its projections are made from the words of the docs alone.

``docs/understand/reconstruction.md``: at angle 0 the source is behind the patient (or in front) and
moves toward the patient's left; columns of the detector run to the left, rows to the head. In LPS,
x is left, y is back, z is the head. Nothing here is taken from the code.
"""

from __future__ import annotations

from importlib.util import find_spec

import numpy as np
import pytest
from numpy.typing import NDArray
from palpate.base.errors import OptionError
from palpate.reconstruction.beams import Beam, Zero
from palpate.reconstruction.reconstruction import reconstruct
from palpate.reconstruction.scanner import Scanner

BALL, RADIUS = np.array([20.0, 30.0, 10.0]), 6.0
ANGLES = np.arange(60) * 6.0
PIXEL, COLUMNS, ROWS = 2.0, 64, 24
NEAR, FAR = 400.0, 600.0
LEFT, BACK, HEAD = np.eye(3)

CASES = [
    pytest.param("parallel", id="parallel"),
    pytest.param(
        "cone", id="cone", marks=pytest.mark.skipif(find_spec("itk") is None, reason="no RTK")
    ),
]


def images(beam: Beam, zero: Zero) -> NDArray[np.float64]:
    """Lengths of rays in the ball, times the attenuation of water."""
    start = BACK if zero == "back" else -BACK
    u = PIXEL * (np.arange(COLUMNS) - 0.5 * (COLUMNS - 1))
    v = PIXEL * (np.arange(ROWS) - 0.5 * (ROWS - 1))
    found = []
    for angle in np.radians(ANGLES):
        # from its start to the left; columns turn with it, from left away from the start
        source = np.cos(angle) * start + np.sin(angle) * LEFT
        columns = np.cos(angle) * LEFT - np.sin(angle) * start
        pixels = u[None, :, None] * columns + v[:, None, None] * HEAD
        if beam == "cone":
            way = pixels + (NEAR - FAR) * source - NEAR * source
            place = NEAR * source - BALL
        else:
            way, place = np.broadcast_to(-source, pixels.shape), pixels - BALL
        way = way / np.linalg.norm(way, axis=-1, keepdims=True)
        along = (place * way).sum(-1)
        missed = (place * place).sum(-1) - along**2
        found.append(0.0206 * 2.0 * np.sqrt(np.maximum(RADIUS**2 - missed, 0.0)))
    return np.array(found)


@pytest.mark.parametrize("zero", ["back", "front"])
@pytest.mark.parametrize("beam", CASES)
def test_a_ball_comes_back_where_it_was(beam: Beam, zero: Zero) -> None:
    scanner = Scanner(
        beam=beam,
        angles=ANGLES.tolist(),
        pixel=(PIXEL, PIXEL),
        source_to_axis=NEAR,
        source_to_detector=FAR,
        zero=zero,
    )
    scan = reconstruct(images(beam, zero), scanner, size=(48, 48, 20), voxel=(2.0, 2.0, 2.0))
    z, y, x = np.nonzero(scan.slope * scan.array + scan.intercept > -500.0)
    middle = scan.patient_from_grid @ [x.mean() + 0.5, y.mean() + 0.5, z.mean() + 0.5, 1.0]
    # half of a voxel
    np.testing.assert_allclose(middle[:3], BALL, atol=1.0)


def test_what_no_side_is_is_refused() -> None:
    with pytest.raises(OptionError, match="zero 'top' given; allowed: back, front"):
        Scanner(beam="parallel", angles=ANGLES.tolist(), pixel=(1.0, 1.0), zero="top").check(  # type: ignore[arg-type]
            (60, 24, 64)
        )
