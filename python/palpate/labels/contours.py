"""Structures of radiotherapy (RTSTRUCT): closed contours, filled slice by slice.

A voxel belongs to a structure if contours enclose its middle (``contour_fill``). Slices between
planes take a shape between theirs, as long as planes are as far apart as they usually are
(``contour_stack``). Contours of a scan whose slices lie aslant to this one's are filled in their
own planes, where both are known to have one frame of reference: each voxel of the scan takes what
is at its centre.

Frame: contours in LPS [mm]; work is done in indices of the scan, whole at the middles of voxels.
Source: DICOM PS3.3, C.8.8.5 (structure set), C.8.8.6 (ROI contour), C.7.4.1 (frame of reference).
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from palpate.base.errors import OptionError
from palpate.base.progress import Progress
from palpate.io.dicom.header import damage_told
from palpate.labels.belonging import check_belonging
from palpate.labels.contour_fill import fill_contours
from palpate.labels.contour_stack import MOST_SLICES, ContourStack, planes_of
from palpate.labels.dicom_objects import dataset_of
from palpate.labels.grid import RESAMPLED, Colour, Label, Labels
from palpate.labels.oblique_contours import NotFlatError, filled_aslant
from palpate.volumes.volume import Volume

if TYPE_CHECKING:
    from pydicom.dataset import Dataset

__all__ = ["filled", "read_rtstruct"]

EXCLUSIVE = "CLOSEDPLANAR_XOR"
CLOSED = ("CLOSED_PLANAR", EXCLUSIVE)
ONE_PLANE = 0.02
"""Contours nearer than this lie in one plane [slice]."""
FLAT = 0.1
"""By how much a contour may leave its plane [voxel]."""

Polygon = NDArray[np.float64]
"""Corners, shape [corners, 3]."""


def read_rtstruct(
    path: Path,
    volume: Volume,
    *,
    resample: bool = False,
    another_patient: bool = False,
    progress: Progress,
) -> Labels:
    """Reads the structures of a file, each as a part of the scan.

    Where ``resample`` is asked for, coordinates count whatever frame of reference they are told in.

    Raises:
        OptionError: They are another patient's, or told in another frame of reference than the
            scan's, or contours lie in no plane of the scan's voxels and neither says what frame it
            has.
    """
    with damage_told(path):
        dataset = dataset_of(path)
        names = {
            int(roi.ROINumber): str(roi.get("ROIName") or f"structure {roi.ROINumber}")
            for roi in dataset.get("StructureSetROISequence") or []
        }
        rois = list(dataset.get("ROIContourSequence") or [])
        frames = _frames(dataset)
    foreign = check_belonging(
        path,
        dataset,
        volume,
        frames=frames,
        resample=resample,
        another_patient=another_patient,
    )
    # any grid will do where both have the same coordinates
    free = resample or another_patient or frames == {volume.traits.frame}
    made: list[Label] = []
    aslant = False
    left_out: list[str] = []
    for done, roi in enumerate(rois):
        progress(f"filling {len(rois)} structures", done / len(rois))
        name = names.get(int(roi.ReferencedROINumber), f"structure {roi.ReferencedROINumber}")
        polygons = _polygons(roi)
        what = f"structure {name!r} of {path}"
        mask = (
            filled(what, polygons, volume, free=free, exclusive=_is_exclusive(roi))
            if polygons
            else None
        )
        aslant = aslant or (mask is not None and _axis_of(polygons, volume) is None)
        if mask is None or not mask.any():
            left_out.append(name)
        else:
            part = volume.segment(mask, name=name)
            part.number = int(roi.ReferencedROINumber)
            made.append(Label(part, _colour(roi)))
    said = foreign
    said += [f"no closed contours on the scan: {', '.join(left_out)}"] if left_out else []
    said += [RESAMPLED] if aslant else []
    return Labels(tuple(made), tuple(said))


def _frames(dataset: Dataset) -> set[str]:
    """Returns the frames of reference that structures are told in, as far as they say."""
    told = (
        roi.get("ReferencedFrameOfReferenceUID")
        for roi in dataset.get("StructureSetROISequence") or []
    )
    return {str(uid) for uid in told if uid}


def _polygons(roi: Dataset) -> list[Polygon]:
    return [
        np.array(contour.ContourData, float).reshape(-1, 3)
        for contour in roi.get("ContourSequence") or []
        if contour.get("ContourGeometricType") in CLOSED and len(contour.ContourData) >= 9
    ]


def _is_exclusive(roi: Dataset) -> bool:
    """Says whether what lies in an even number of contours is outside."""
    return any(
        contour.get("ContourGeometricType") == EXCLUSIVE
        for contour in roi.get("ContourSequence") or []
    )


def _colour(roi: Dataset) -> Colour | None:
    told = roi.get("ROIDisplayColor")
    if told is None or len(told) != 3:
        return None
    red, green, blue = (min(255.0, max(0.0, float(part))) / 255.0 for part in told)
    return red, green, blue


def filled(
    what: str,
    polygons: list[Polygon],
    volume: Volume,
    *,
    free: bool = False,
    exclusive: bool = False,
) -> NDArray[np.uint8]:
    """Returns 1 for the voxels whose middles contours enclose, shape as the scan's.

    Args:
        what: What it is, for the message.
        polygons: Corners in the patient [mm].
        volume: The scan.
        free: Whether contours may lie aslant to the scan's slices.
        exclusive: Whether what lies in an even number of contours is outside (CLOSEDPLANAR_XOR).

    Raises:
        OptionError: A contour lies in no plane of the scan's voxels.
    """
    axis = _axis_of(polygons, volume)
    if axis is None and not free:
        raise OptionError(
            f"{what} has contours that lie across the scan's slices; allowed: contours drawn on "
            "slices of the scan, or others where they are asked to be resampled (--resample)"
        )
    if axis is None:
        try:
            return filled_aslant(polygons, volume, exclusive=exclusive)
        except NotFlatError:
            raise OptionError(
                f"{what} has contours that lie in no plane; allowed: contours drawn on slices of "
                "one scan"
            ) from None
    return _filled_upright(_placed(polygons, volume), axis, volume, exclusive=exclusive)


def _filled_upright(
    placed: list[Polygon], axis: int, volume: Volume, *, exclusive: bool
) -> NDArray[np.uint8]:
    """Fills contours that lie in slices along one axis of the scan, in indices of the scan."""
    # the array's axes come the other way around
    mask = np.zeros(volume.shape, np.uint8)
    slices = np.moveaxis(mask, 2 - axis, 0)
    rest = [other for other in (0, 1, 2) if other != axis]
    heights = np.array([corners[:, axis].mean() for corners in placed])
    planes, of_plane = planes_of(heights, least=ONE_PLANE)

    # where contours reach in a slice
    corners = np.concatenate(placed)[:, rest]
    first = np.clip(np.floor(corners.min(axis=0)), 0, slices.shape[:0:-1]).astype(int)
    last = np.clip(np.ceil(corners.max(axis=0)) + 1, first, slices.shape[:0:-1]).astype(int)
    sheets = np.stack(
        [
            fill_contours(
                [placed[one][:, rest] - first for one in np.flatnonzero(of_plane == number)],
                (last - first)[::-1],
                exclusive=exclusive,
            )
            for number in range(len(planes))
        ]
    )
    across, down = (volume.spacing[other] for other in rest)
    stack = ContourStack(planes, sheets, pixel=(down, across), thickness=1.0, widest=MOST_SLICES)
    low, high = stack.ends
    there = np.arange(max(0, int(np.floor(low))), min(len(slices), int(np.ceil(high)) + 1))
    found = {int(at): sheet for at in there if (sheet := stack.at(float(at))) is not None}
    if not found and 0 <= (nearest := round(float(planes.mean()))) < len(slices):
        # thinner than a slice, and between the middles of two
        found = {nearest: sheets[len(planes) // 2]}
    for number, sheet in found.items():
        slices[number, first[1] : last[1], first[0] : last[0]] = sheet
    return mask


def _placed(polygons: list[Polygon], volume: Volume) -> list[Polygon]:
    """Returns polygons in indices of the scan, whole at the middles of voxels."""
    index_from_patient = np.linalg.inv(volume.patient_from_grid)
    return [
        corners @ index_from_patient[:3, :3].T + index_from_patient[:3, 3] - 0.5
        for corners in polygons
    ]


def _axis_of(polygons: list[Polygon], volume: Volume) -> int | None:
    """Returns the axis of the scan along which each contour is flat; None where there is none."""
    extents = np.array([np.ptp(corners, axis=0) for corners in _placed(polygons, volume)])
    axis = int(np.argmin(extents.max(axis=0)))
    return axis if extents[:, axis].max() <= FLAT else None
