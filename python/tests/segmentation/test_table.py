"""A table is found where it does not touch the body, and nothing of the body with it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from palpate.base.errors import EmptySegmentError, OptionError
from palpate.io.reading import read
from palpate.segmentation.crop import outside
from palpate.segmentation.table import table
from palpate.volumes.volume import Volume, VolumeTraits

SPACING = (2.0, 2.0, 3.0)
SHAPE = (20, 110, 120)
GAP = 3
"""Rows between the back and the table, 6 mm."""


def lying(
    *, gap: int = GAP, unit: str = "HU", faced: bool = True
) -> tuple[Volume, NDArray[np.bool_]]:
    """Returns a body with lungs and an open mouth on the shell of a table, and where that is."""
    z, y, x = np.indices(SHAPE, sparse=True)
    body = ((x - 60) / 40.0) ** 2 + ((y - 45) / 25.0) ** 2 + 0.0 * z < 1.0
    lung = ((x - 45) / 12.0) ** 2 + ((y - 45) / 14.0) ** 2 + 0.0 * z < 1.0
    arm = ((x - 110) / 7.0) ** 2 + ((y - 45) / 7.0) ** 2 + 0.0 * z < 1.0
    values = np.full(SHAPE, -1000, np.int16)
    values[body | arm] = 40
    values[lung] = -850
    # a lobe of tissue in the lung, and one in a cavity that is open to the front
    values[8:12, 44:47, 44:47] = 30
    if faced:
        values[:, 15:35, 66:74] = -1000
        values[8:12, 24:27, 69:71] = 30
    shell = np.zeros(SHAPE, bool)
    shell[:, 70 + gap : 71 + gap, 10:110] = True
    shell[:, 80 + gap : 81 + gap, 10:110] = True
    values[shell] = 100
    return Volume(values, spacing=SPACING, traits=VolumeTraits(unit=unit)), shell


@pytest.mark.parametrize("unit", ["HU", ""])
def test_a_table_is_found_and_the_body_is_left_alone(unit: str) -> None:
    volume, shell = lying(unit=unit)
    found = table(volume).mask() != 0
    assert found[shell].all()
    tissue = (volume.array > -900) & ~shell
    assert not (found & tissue).any()


def test_a_table_that_touches_the_body_is_no_part_to_be_removed() -> None:
    volume, _ = lying(gap=-1)
    values = volume.array.copy()
    values[:, 60:80, 20:100] = 40  # the back lies on it
    with pytest.raises(EmptySegmentError, match="does not touch the body"):
        table(volume.with_values(values))


def test_without_a_table_it_is_said_that_there_is_none() -> None:
    volume, shell = lying()
    values = volume.array.copy()
    values[shell] = -1000
    with pytest.raises(EmptySegmentError, match="nothing that is no part of the body"):
        table(volume.with_values(values))


def test_slices_may_lie_along_another_axis_of_the_patient() -> None:
    volume, shell = lying()
    turned = Volume(
        np.moveaxis(volume.array, 0, 2).copy(),
        spacing=(3.0, 2.0, 2.0),
        direction=((0.0, 1.0, 0.0), (0.0, 0.0, 1.0), (1.0, 0.0, 0.0)),
        traits=volume.traits,
    )
    found = table(turned).mask() != 0
    assert found[np.moveaxis(shell, 0, 2)].all()
    assert not (found & (turned.array > -900) & ~np.moveaxis(shell, 0, 2)).any()


@pytest.mark.data
def test_the_table_of_an_abdomen_is_found_and_no_voxel_of_its_organs(data_folder: Path) -> None:
    folder = data_folder / "amos_0336"
    volume = read(folder / "amos_0336.mhd")
    found = table(volume).mask() != 0
    organs = read(folder / "labels_from_meshes.nii.gz").array != 0
    assert not (found & organs).any()
    # the two shells of the table run through all slices behind the back
    behind = found[:, 190:, :] & (volume.array[:, 190:, :] > -300)
    assert behind.any(axis=(1, 2)).all()
    left = (volume.array > -300) & ~found
    assert left[:, 200:, :].sum() < 0.02 * behind.sum()


def test_outside_of_a_box_is_what_its_faces_leave() -> None:
    volume, _ = lying()
    mask = outside(volume, (10.0, 0.0, 6.0), (0.0, 20.0, 0.0)).mask() != 0
    kept = np.zeros(SHAPE, bool)
    kept[2:, :100, 5:] = True
    assert np.array_equal(~mask, kept)
    with pytest.raises(OptionError, match="holds all of the scan"):
        outside(volume, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    with pytest.raises(OptionError, match="holds no voxel"):
        outside(volume, (240.0, 0.0, 0.0), (0.0, 0.0, 0.0))
