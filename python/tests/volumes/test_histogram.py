"""Bone is found from the peaks of air and soft tissue, whatever the unit."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from palpate.volumes.histogram import BONE_HU, SOFT_TISSUE_HU, Histogram, anchors


def body(scale: float, shift: float, *, padding: bool = False) -> Histogram:
    """A histogram of air, fat, muscle and bone in HU, then scaled and shifted."""
    random = np.random.default_rng(11)
    parts = [
        random.normal(-1000.0, 15.0, 400_000),
        random.normal(-100.0, 20.0, 150_000),
        random.normal(50.0, 20.0, 100_000),
        random.uniform(250.0, 1500.0, 15_000),
    ]
    if padding:
        parts.append(np.full(300_000, -2048.0))
    values = scale * np.concatenate(parts) + shift
    counts, edges = np.histogram(values, 512)
    return Histogram(float(edges[0]), float(edges[-1]), counts.astype(np.uint64))


def test_known_hu_needs_no_histogram() -> None:
    found = anchors(body(1.0, 0.0), unit="HU")
    assert (found.soft_tissue, found.bone) == (SOFT_TISSUE_HU, BONE_HU)


@pytest.mark.parametrize("padding", [False, True])
@pytest.mark.parametrize(("scale", "shift"), [(1.0, 0.0), (1.0, 1024.0), (0.01, -3.0), (7.0, 1e4)])
def test_the_unit_does_not_matter(scale: float, shift: float, *, padding: bool) -> None:
    found = anchors(body(scale, shift, padding=padding), unit="")
    # peaks are found to about two bins of 9 HU
    assert (found.soft_tissue - shift) / scale == pytest.approx(50.0, abs=20.0)
    assert (found.bone - shift) / scale == pytest.approx(260.0, abs=25.0)


@given(st.lists(st.integers(0, 1000), min_size=16, max_size=64), st.floats(-1e3, 1e3))
def test_every_histogram_gets_anchors_within_its_range(counts: list[int], low: float) -> None:
    counts[0] += 1
    histogram = Histogram(low, low + 100.0, np.array(counts, np.uint64))
    found = anchors(histogram, unit="")
    assert low <= found.soft_tissue <= low + 100.0
    assert low <= found.bone <= low + 100.0


def test_a_scan_of_one_value_gets_that_value() -> None:
    counts = np.zeros(512, np.uint64)
    counts[0] = 1000
    found = anchors(Histogram(7.0, 7.0, counts), unit="")
    assert (found.soft_tissue, found.bone) == (7.0, 7.0)
