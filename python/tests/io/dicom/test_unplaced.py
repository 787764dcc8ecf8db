"""Slices without positions come in the order of their numbers, with the spacing they tell."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import palpate
import pytest
from dicom_cases import case, values_of
from pydicom.dataset import FileDataset


@pytest.mark.data
def test_slices_without_positions_are_ordered_by_their_numbers(data_folder: Path) -> None:
    volume = palpate.read(case(data_folder, 11))
    assert np.flatnonzero((values_of(volume) > 500).any((1, 2))).tolist() == [5, 6, 7]
    assert volume.spacing == (1.0, 1.5, 2.5)
    assert volume.orientation == "unknown"


def unplaced(write_series: Any, count: int = 12, **told: Any) -> Path:
    """Returns a series whose slices lie in the order of their values, named IM1 to IM12."""

    def change(number: int, dataset: FileDataset) -> None:
        del dataset.ImagePositionPatient
        for name, value in told.items():
            setattr(dataset, name, value(number) if callable(value) else value)

    folder: Path = write_series(positions=[(0.0, 0.0, 0.0)] * count, each=change)
    for path in list(folder.iterdir()):
        number = next(k for k in range(count) if f"{97 * k % 101:03}" == path.name)
        path.rename(folder / f"IM{number + 1}.dcm")
    return folder


def order_of(folder: Path) -> list[int]:
    return [int(value) // 100 for value in values_of(palpate.read(folder))[:, 0, 0] + 1024]


def test_positions_count_without_a_pixel_spacing(write_series: Any) -> None:
    def change(number: int, dataset: FileDataset) -> None:
        # against the positions
        dataset.InstanceNumber = 90 - number
        del dataset.PixelSpacing

    volume = palpate.read(write_series(each=change))
    (told,) = volume.warnings
    assert told == "the files tell no pixel spacing: pixels of 1 mm are assumed"
    assert volume.spacing == (1.0, 1.0, 2.5)
    assert volume.orientation == "LPS"
    assert (np.diff(values_of(volume)[:, 0, 0]) > 0).all()


def test_numbers_count_before_names(write_series: Any) -> None:
    # more than ten, so that text would order them otherwise
    folder = unplaced(write_series, InstanceNumber=lambda number: 40 - 3 * number)
    assert order_of(folder) == list(range(11, -1, -1))


@pytest.mark.parametrize("number", [lambda _: 1, lambda number: None if number == 3 else number])
def test_names_with_numbers_count_as_numbers(write_series: Any, number: Any) -> None:
    folder = unplaced(write_series, InstanceNumber=number)
    assert order_of(folder) == list(range(12))
    assert "order of their files' names" in palpate.read(folder).warnings[0]


@pytest.mark.parametrize(
    ("told", "spacing", "said"),
    [
        ({"SpacingBetweenSlices": 2.5}, (0.75, 0.5, 2.5), ""),
        ({"SpacingBetweenSlices": -2.5, "SliceThickness": 4}, (0.75, 0.5, 2.5), ""),
        ({"SliceThickness": 4}, (0.75, 0.5, 4.0), "; slices 4 mm apart are assumed"),
        ({"PixelSpacing": [0, 0]}, (1, 1, 1), "; pixels of 1 mm and slices 1 mm apart are assumed"),
        (
            {"SpacingBetweenSlices": lambda number: 1 + number},
            (0.75, 0.5, 1.0),
            "; slices 1 mm apart are assumed",
        ),
    ],
)
def test_spacing_is_kept_as_far_as_it_is_told(
    write_series: Any, told: dict[str, Any], spacing: tuple[float, ...], said: str
) -> None:
    folder = unplaced(write_series, InstanceNumber=lambda number: number, **told)
    volume = palpate.read(folder)
    assert volume.spacing == spacing
    assert volume.warnings[0] == (
        f"the files tell no positions: slices are in the order of their Instance Numbers{said}"
    )
