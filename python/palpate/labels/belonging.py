"""Whether segments of DICOM belong to a scan: to its patient, study and frame of reference.

Messages say what differs, and no names or numbers of patients.

Source: DICOM PS3.3, C.7.1.1 (patient), C.7.2.1 (study), C.7.4.1 (frame of reference).
"""

from __future__ import annotations

from collections.abc import Set
from pathlib import Path
from typing import TYPE_CHECKING

from palpate.base.errors import OptionError
from palpate.volumes.volume import Volume, VolumeTraits

if TYPE_CHECKING:
    from pydicom.dataset import Dataset

__all__ = ["ANOTHER", "check_belonging"]

ANOTHER = "of another patient, study or frame of reference than the scan, as was asked for"
"""Said where it is so."""

FOREIGN = "told in another frame of reference than the scan: coordinates are taken as they are"
"""Said where segments are resampled so."""


def check_belonging(
    path: Path,
    dataset: Dataset,
    volume: Volume,
    *,
    frames: Set[str],
    resample: bool,
    another_patient: bool,
) -> list[str]:
    """Returns what to say of segments that are taken though they are another's.

    Args:
        path: Of the file.
        dataset: Its header.
        volume: The scan.
        frames: Frames of reference that its segments are told in.
        resample: Whether coordinates count in whatever frame of reference they are told.
        another_patient: Whether segments of another patient or study are asked for.

    Raises:
        OptionError: They are another's, or told in another frame of reference than the scan's, and
            that was not asked for.
    """
    others = _others(dataset, volume.traits)
    if others and not another_patient:
        raise OptionError(
            f"{path} is not of this scan (other {' and '.join(others)}); allowed: the scan's "
            "own segments, or those of another patient with `another_patient=True`"
        )
    scan = volume.traits.frame
    foreign = frames - {scan}
    if scan and foreign and not (resample or another_patient):
        raise OptionError(
            f"{path} is drawn in frame of reference {min(foreign)}, the scan has {scan}: one place "
            "in the patient may have other coordinates there; allowed: structures of the scan's "
            "frame, or of others resampled as they are with `resample=True`"
        )
    if others or (scan and foreign and another_patient):
        return [ANOTHER]
    return [FOREIGN] if scan and foreign else []


def _others(dataset: Dataset, scan: VolumeTraits) -> list[str]:
    """Returns what is told by both and is not the same."""
    told = (
        ("Patient ID", _plain(dataset.get("PatientID")), _plain(scan.patient_id)),
        ("study", str(dataset.get("StudyInstanceUID") or ""), scan.study),
    )
    differ = [what for what, one, other in told if one and other and one != other]
    # a study of its own is no other one where it refers to the scan
    if "study" in differ and scan.series and scan.series in _series_of(dataset):
        differ.remove("study")
    # one number may be written with several names, and none with none
    numbered = _plain(dataset.get("PatientID")) and _plain(scan.patient_id)
    name, other = _name(dataset.get("PatientName")), _name(scan.patient_name)
    if not numbered and name and other and name != other:
        differ.insert(0, "patient's name")
    return differ


def _series_of(dataset: Dataset) -> set[str]:
    """Returns the series that segments refer to."""
    items = list(dataset.get("ReferencedSeriesSequence") or [])
    for frame in dataset.get("ReferencedFrameOfReferenceSequence") or []:
        for study in frame.get("RTReferencedStudySequence") or []:
            items += study.get("RTReferencedSeriesSequence") or []
    return {str(item.get("SeriesInstanceUID")) for item in items}


def _plain(told: object) -> str:
    return str(told or "").strip().casefold()


def _name(told: object) -> str:
    """Returns a name without case and empty parts."""
    return " ".join(_plain(told).replace("^", " ").split())
