"""Doses of radiotherapy: Gy at the right places, whichever way their planes are told."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import palpate
import pydicom
import pytest
from made_dose import write_dose
from numpy.typing import NDArray
from palpate.base.errors import VolumeFormatError
from palpate.io.reading import list_series
from palpate.volumes.volume import Volume
from pydicom.data import get_testdata_file
from scipy.ndimage import map_coordinates

GRAY = np.random.default_rng(4).integers(0, 60_000, (5, 4, 6)) / 1000.0
TURN = (0.8, 0.6, 0.0, -0.36, 0.48, 0.8)
"""Rows and columns of no axis: a turn by 37 degrees about z, then by 53."""

TABLE = pydicom.Dataset()
TABLE.LUTDescriptor, TABLE.ModalityLUTType = [2, 0, 16], "US"
TABLE.LUTData = np.array([7, 9], "<u2").tobytes()

Points = NDArray[np.float64]


def dose_by_ours(volume: Volume, points: Points) -> Points:
    """Doses at points of the patient, by a volume's own transform."""
    index_from_patient = np.linalg.inv(volume.patient_from_grid)
    index = points @ index_from_patient[:3, :3].T + index_from_patient[:3, 3] - 0.5
    values = volume.values().astype(float)
    found: Points = map_coordinates(values, index[:, ::-1].T, order=1)
    return found


def dose_by_tags(path: Path, normal: Points, points: Points) -> Points:
    """Doses at points, from the tags alone; ``normal`` leads from plane to plane [mm]."""
    dataset = pydicom.dcmread(path)
    rows_by, columns_by = map(float, dataset.PixelSpacing)
    row, column = np.array(dataset.ImageOrientationPatient, float).reshape(2, 3)
    patient_from_index = np.stack([normal, column * rows_by, row * columns_by], axis=1)
    away = points - np.array(dataset.ImagePositionPatient, float)
    index = np.linalg.solve(patient_from_index, away.T)
    gray = dataset.pixel_array * float(dataset.DoseGridScaling)
    found: Points = map_coordinates(gray, index, order=1)
    return found


def points_in(volume: Volume, count: int = 200) -> Points:
    """Points between the centres of a scan's outermost voxels."""
    share = np.random.default_rng(7).random((count, 3))
    grid = 0.5 + share * (np.array(volume.dimensions) - 1)
    transform = volume.patient_from_grid
    points: Points = grid @ transform[:3, :3].T + transform[:3, 3]
    return points


def check(path: Path, normal: Any) -> Volume:
    volume = palpate.read(path)
    points = points_in(volume)
    expected = dose_by_tags(path, np.array(normal, float), points)
    assert np.ptp(expected) > 0.3 * expected.max()
    # as exact as floats of 32 bits
    np.testing.assert_allclose(dose_by_ours(volume, points), expected, atol=5e-7 * expected.max())
    return volume


def test_offsets_from_the_first_plane(tmp_path: Path) -> None:
    volume = check(write_dose(tmp_path / "dose.dcm", GRAY), (0, 0, 2.5))
    assert (volume.unit, volume.modality, volume.warnings) == ("Gy", "RTDOSE", ())
    assert volume.dimensions == (6, 4, 5)
    assert volume.spacing == (2.0, 3.0, 2.5)
    assert volume.origin == (-10.0, -20.0, 30.0)
    np.testing.assert_allclose(volume.slope * volume.array + volume.intercept, GRAY, atol=1e-6)


def test_offsets_that_are_z_of_the_patient(tmp_path: Path) -> None:
    z = [30.0 + 2.5 * k for k in range(5)]
    assert check(write_dose(tmp_path / "up.dcm", GRAY, offsets=z), (0, 0, 2.5)).origin[2] == 30.0
    # from the head down
    z = [30.0 - 2.5 * k for k in range(5)]
    volume = check(write_dose(tmp_path / "down.dcm", GRAY, offsets=z), (0, 0, -2.5))
    assert volume.origin[2] == 20.0
    np.testing.assert_allclose(volume.slope * volume.array + volume.intercept, GRAY[::-1])


def test_a_first_plane_at_z_0_is_the_same_both_ways(tmp_path: Path) -> None:
    path = write_dose(tmp_path / "dose.dcm", GRAY, position=(-10.0, -20.0, 0.0))
    assert check(path, (0, 0, 2.5)).origin[2] == 0.0


def test_offsets_downward(tmp_path: Path) -> None:
    offsets = [-2.5 * k for k in range(5)]
    assert check(write_dose(tmp_path / "dose.dcm", GRAY, offsets=offsets), (0, 0, -2.5))


@pytest.mark.parametrize(
    ("orientation", "normal"),
    [
        # feet first, face down
        ((1, 0, 0, 0, -1, 0), (0, 0, -1)),
        ((-1, 0, 0, 0, -1, 0), (0, 0, 1)),
        # sagittal and coronal planes
        ((0, 1, 0, 0, 0, -1), (-1, 0, 0)),
        ((1, 0, 0, 0, 0, -1), (0, 1, 0)),
        (TURN, (0.48, -0.64, 0.6)),
    ],
)
def test_planes_of_any_orientation_follow_their_normal(
    tmp_path: Path, orientation: tuple[float, ...], normal: tuple[float, ...]
) -> None:
    path = write_dose(tmp_path / "dose.dcm", GRAY, orientation=orientation)
    check(path, 2.5 * np.array(normal))


def test_uneven_planes_are_laid_on_a_right_grid_and_told(tmp_path: Path) -> None:
    path = write_dose(tmp_path / "dose.dcm", GRAY, offsets=[0.0, 2.5, 5.0, 10.0, 12.5])
    volume = palpate.read(path)
    assert volume.dimensions == (6, 4, 6)
    assert "1 slice is missing" in volume.warnings[0]
    between = volume.slope * volume.array[3] + volume.intercept
    np.testing.assert_allclose(between, (GRAY[2] + GRAY[3]) / 2, atol=1e-3)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"offsets": [12.0 + 2.5 * k for k in range(5)]}, "GridFrameOffsetVector from 12 mm on"),
        # z of the patient along planes that are not across it
        ({"offsets": [30.0, 32.5, 35.0, 37.5, 40.0], "orientation": TURN}, "from 30 mm on"),
        ({"GridFrameOffsetVector": None}, "0 offsets in GridFrameOffsetVector for 5 planes"),
        ({"offsets": [0.0, 2.5]}, "2 offsets in GridFrameOffsetVector for 5 planes"),
        ({"ImagePositionPatient": None}, "no ImagePositionPatient"),
        ({"DoseGridScaling": None}, "no DoseGridScaling above 0"),
        ({"DoseGridScaling": "0"}, "no DoseGridScaling above 0"),
        ({"DoseUnits": None}, "DoseUnits missing; allowed: GY, RELATIVE"),
        ({"DoseUnits": "CGY"}, "DoseUnits CGY"),
        ({"ModalityLUTSequence": [TABLE]}, "has a ModalityLUTSequence"),
    ],
)
def test_what_cannot_be_known_is_refused(
    tmp_path: Path, changes: dict[str, Any], words: str
) -> None:
    path = write_dose(tmp_path / "dose.dcm", GRAY, **changes)
    with pytest.raises(VolumeFormatError) as caught:
        palpate.read(path)
    assert words in str(caught.value)
    assert "allowed" in str(caught.value)


def test_what_a_dose_is_of_is_told(tmp_path: Path) -> None:
    volume = palpate.read(write_dose(tmp_path / "1.dcm", GRAY, DoseSummationType="BEAM"))
    assert volume.warnings == ("the dose is not that of a whole plan (DoseSummationType BEAM)",)
    volume = palpate.read(write_dose(tmp_path / "2.dcm", GRAY, DoseUnits="RELATIVE"))
    assert volume.unit == "relative"
    assert "not in Gy" in volume.warnings[0]
    volume = palpate.read(write_dose(tmp_path / "3.dcm", GRAY, DoseType="EFFECTIVE"))
    assert "biological effect" in volume.warnings[0]


@pytest.mark.parametrize("name", ["rtdose.dcm", "rtdose_rle.dcm", "rtdose_expb.dcm"])
def test_real_doses_of_several_encodings(name: str) -> None:
    path = Path(str(get_testdata_file(name, download=False)))
    assert check(path, (0, 0, 5.0)).dimensions == (10, 10, 15)


def test_a_dose_beside_a_scan_is_no_choice_to_make(write_series: Any, tmp_path: Path) -> None:
    folder = write_series()
    write_dose(folder / "dose.dcm", np.repeat(GRAY, 2, axis=0))
    # last, though it has more planes
    assert [series.modality for series in list_series(folder)] == ["CT", "RTDOSE"]
    volume = palpate.read(folder)
    assert volume.modality == "CT"
    assert "left out series" in volume.warnings[0]
    assert palpate.read(folder, series="2").unit == "Gy"
    # alone it is the scan
    assert palpate.read(write_dose(tmp_path / "alone" / "dose.dcm", GRAY).parent).unit == "Gy"


def test_a_dose_that_is_refused_does_not_keep_its_scan_from_being_read(write_series: Any) -> None:
    folder = write_series()
    write_dose(folder / "dose.dcm", GRAY, GridFrameOffsetVector=None)
    assert palpate.read(folder).modality == "CT"
