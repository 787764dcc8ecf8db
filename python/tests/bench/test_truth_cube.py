"""The Truth Cube: what is read of it, and how far the lattice is from where its beads went."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from palpate import OptionError
from palpate.bench.goals.soft_tissue import truth_case
from palpate.bench.plots import plot_truth_cube
from palpate.bench.truth_cube import Cube, beads_of, errors_of, lattice_displacements, measure


def test_a_file_without_points_is_told(tmp_path: Path) -> None:
    path = tmp_path / "empty.pml"
    path.write_text("<physicalModel/>")
    with pytest.raises(OptionError, match="allowed: a PML file"):
        beads_of(path)


@pytest.mark.data
def test_the_data_set_is_read_as_it_is_told() -> None:
    cube = Cube.load()
    assert cube.mesh.shape == (9, 9, 9, 3)
    assert cube.beads.shape == (343, 3)
    assert cube.sides == pytest.approx([80.0, 80.0, 80.0])
    assert cube.stroke(12.5) == pytest.approx(10.0)
    # all 343 beads rise with the lower plate, those near it the most
    for level, moved in cube.measured.items():
        assert (moved[:, 2] > 0.0).all()
        low, high = cube.beads[:, 2] < -40.0, cube.beads[:, 2] > 10.0
        assert moved[low, 2].mean() > 0.9 * cube.stroke(level) > 5.0 * moved[high, 2].mean()


@pytest.mark.data
def test_drift_that_is_linear_in_height_is_no_error_without_it() -> None:
    cube = Cube.load()
    height = 1.0 - (cube.beads[:, 2] - cube.low[2]) / cube.sides[2]
    drifted = cube.measured[5.0] + np.outer(height, [1.0, -2.0, 0.5])
    errors = errors_of(cube, 5.0, drifted)
    assert errors["without_drift"] == pytest.approx(0.0, abs=1e-9)
    assert errors["rmse"] == pytest.approx(np.sqrt(5.25 * (height**2).mean()))


@pytest.mark.data
def test_the_lattice_is_as_near_to_the_measurement_as_the_fem(tmp_path: Path) -> None:
    rows, moved = measure()
    figures = {(row.case, row.metric): row for row in rows}
    for level in (5.0, 12.5, 18.25):
        for nodes in ("9³", "33³"):
            case = truth_case(f"lattice, ν 0.45, {nodes} nodes", level)
            assert figures[case, "residual"].met
            assert figures[case, "RMSE by that of the FEM with its ν"].met
            # the FEM of the silicone's own ratio of 0.49
            assert figures[case, "RMSE by that of the best FEM"].value < 1.05
    picture = tmp_path / "cube.png"
    plot_truth_cube(Cube.load(), moved, picture)
    assert picture.stat().st_size > 10_000


@pytest.mark.data
def test_a_lattice_of_another_size_is_told() -> None:
    with pytest.raises(OptionError, match="nodes 2 given"):
        lattice_displacements(Cube.load(), 5.0, 0.45, nodes=2)
