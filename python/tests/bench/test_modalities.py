"""The stand-in for MR: what it is like, and that mutual information finds where it lies."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from palpate import SearchOptions
from palpate.bench.goals.registration import METRICS
from palpate.bench.modalities import Pair, apart_from, coarser, head_of, like_mr
from palpate.registration.options import Kind
from palpate.volumes.volume import Volume

pytestmark = pytest.mark.data

QUICK = SearchOptions(samples=60_000)
OFF = (15.0, 10.0)
MOST = 3.0
"""Of corners 220 mm from the middle, where voxels are 4 mm: 1.1 and 0.8 mm were reached."""


@pytest.fixture(scope="module")
def head(data_folder: Path) -> Volume:
    return coarser(head_of(data_folder / "cthead_stanford" / "CThead.mha"), (2, 2, 2))


@pytest.fixture(scope="module")
def pair(head: Volume) -> Pair:
    return like_mr(head, "rigid")


def test_values_of_the_stand_in_do_not_follow_those_of_ct(pair: Pair) -> None:
    found = pair.moving
    assert found.modality == "MR"
    assert found.dimensions != pair.fixed.dimensions
    # where voxels of the stand-in lie in the CT
    z, y, x = np.indices(found.array.shape)
    points = np.stack([x, y, z], axis=-1) * found.spacing + found.origin
    back = np.linalg.inv(pair.fixed.patient_from_grid) @ np.linalg.inv(pair.matrix)
    places = np.floor(points @ back[:3, :3].T + back[:3, 3]).astype(int)
    inside = ((places >= 0) & (places < pair.fixed.dimensions)).all(axis=-1)
    i, j, k = places[inside].T
    hu = pair.fixed.slope * pair.fixed.array[k, j, i] + pair.fixed.intercept
    bright = found.array[inside]
    air, soft, bone = (
        float(np.median(bright[(hu > low) & (hu < high)]))
        for low, high in ((-1100.0, -900.0), (0.0, 60.0), (600.0, 2000.0))
    )
    assert soft > 2.0 * bone > 0.0
    assert soft > 5.0 * air


@pytest.mark.parametrize("kind", ["rigid", "affine"])
def test_mutual_information_finds_it_and_correlation_does_not(head: Volume, kind: Kind) -> None:
    pair = like_mr(head, kind)
    found, other = (
        apart_from(pair, kind=kind, metric=metric, off=OFF, direction=1, options=QUICK)
        for metric in METRICS
    )
    assert found.before > 40.0
    assert found.after < MOST
    # it brings bright to bright: skull to fat
    assert other.after > 10.0 * MOST
