"""Segments of another patient, study or frame of reference are taken only where asked for."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import palpate
import pytest
from dicom_cases import case
from palpate.base.errors import OptionError
from palpate.volumes.volume import Volume
from pydicom import dcmread


@pytest.mark.data
def test_segments_of_another_patient_are_refused(data_folder: Path) -> None:
    name = "seg.dcm"
    folder = case(data_folder, 12)
    volume = palpate.read(folder / "ct")
    with pytest.raises(
        OptionError, match=r"\(other .*\); allowed: .*`another_patient=True`"
    ) as told:
        palpate.read_labels(folder / name, volume)
    assert volume.traits.patient_id not in str(told.value).replace(str(folder), "")
    # that the grid may be another does not mean that the patient may
    with pytest.raises(OptionError, match="is not of this scan"):
        palpate.read_labels(folder / name, volume, resample=True)
    found = palpate.read_labels(folder / name, volume, another_patient=True)
    assert len(found.labels) == 1
    assert any("another patient" in warning for warning in found.warnings)


@pytest.mark.data
def test_structures_of_another_frame_of_reference_are_refused(data_folder: Path) -> None:
    folder = case(data_folder, 12)
    volume = palpate.read(folder / "ct")
    with pytest.raises(OptionError, match="is drawn in frame of reference"):
        palpate.read_labels(folder / "rt.dcm", volume)
    resampled = palpate.read_labels(folder / "rt.dcm", volume, resample=True)
    assert any("another frame of reference" in warning for warning in resampled.warnings)
    found = palpate.read_labels(folder / "rt.dcm", volume, another_patient=True)
    assert any("frame of reference" in warning for warning in found.warnings)


@pytest.fixture
def of_scan(data_folder: Path) -> tuple[Path, Volume]:
    """A segmentation, and a scan that is said to be what it tells itself."""
    folder = case(data_folder, 12)
    told = dcmread(folder / "seg.dcm", stop_before_pixels=True)
    volume = palpate.read(folder / "ct")
    volume.traits = replace(
        volume.traits,
        frame=str(told.FrameOfReferenceUID),
        study=str(told.StudyInstanceUID),
        series=str(told.ReferencedSeriesSequence[0].SeriesInstanceUID),
        patient_id=str(told.PatientID),
        patient_name=str(told.PatientName),
    )
    return folder / "seg.dcm", volume


@pytest.mark.data
@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({}, None),
        ({"frame": "1.2.3"}, "frame of reference"),
        ({"frame": ""}, None),
        ({"patient_id": "someone"}, "other Patient ID"),
        ({"patient_id": "", "patient_name": "Some^One"}, "other patient's name"),
        # one number, written with another name
        ({"patient_name": "Some^One"}, None),
        ({"patient_id": "", "patient_name": "", "study": ""}, None),
        ({"study": "1.2.3", "series": "1.2.4"}, "other study"),
        # it refers to the scan from a study of its own
        ({"study": "1.2.3"}, None),
        ({"series": "1.2.4"}, None),
    ],
)
def test_each_thing_that_differs_is_told(
    of_scan: tuple[Path, Volume], changes: dict[str, Any], said: str | None
) -> None:
    path, volume = of_scan
    volume.traits = replace(volume.traits, **changes)
    if said is None:
        found = palpate.read_labels(path, volume)
        assert (len(found.labels), found.warnings) == (1, ())
        return
    with pytest.raises(OptionError, match=f"{said}.*allowed"):
        palpate.read_labels(path, volume)
    assert len(palpate.read_labels(path, volume, another_patient=True).labels) == 1


def test_what_a_scan_keeps_of_its_patient_is_not_shown(write_series: Any) -> None:
    volume = palpate.read(write_series(PatientID="778899", PatientName="Quixote^Alonso"))
    assert (volume.traits.patient_id, volume.traits.patient_name) == ("778899", "Quixote^Alonso")
    assert "Quixote" not in repr(volume.traits) + repr(volume)
    assert "778899" not in repr(volume.traits)
