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

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from palpate.base.errors import OptionError, VolumeFormatError
from palpate.base.progress import Progress
from palpate.io.dicom.header import damage_told
from palpate.labels.belonging import check_belonging
from palpate.labels.contour_fill import fill_contours
from palpate.labels.contour_stack import MOST_SLICES, ContourStack, planes_of
from palpate.labels.dicom_objects import dataset_of
from palpate.labels.filled import Filled
from palpate.labels.grid import RESAMPLED, Colour, Label, Labels
from palpate.labels.oblique_contours import NotFlatError, filled_aslant
from palpate.labels.structures_told import StructuresTold, cut_share
from palpate.volumes.volume import Volume

if TYPE_CHECKING:
    from pydicom.dataset import Dataset

__all__ = ["filled", "read_rtstruct"]

EXCLUSIVE = "CLOSEDPLANAR_XOR"
CLOSED = ("CLOSED_PLANAR", EXCLUSIVE)
LEAST_CORNERS = 3
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
    told = StructuresTold()
    for done, roi in enumerate(rois):
        progress(f"filling {len(rois)} structures", done / len(rois))
        name = names.get(int(roi.ReferencedROINumber), f"structure {roi.ReferencedROINumber}")
        what = f"structure {name!r} of {path}"
        polygons = _polygons(what, roi)
        found = (
            filled(what, polygons, volume, free=free, exclusive=_is_exclusive(roi))
            if polygons
            else None
        )
        aslant = aslant or (found is not None and _axis_of(polygons, volume) is None)
        told.add(name, found)
        if found is not None and found.mask.any():
            part = volume.segment(found.mask, name=name)
            part.number = int(roi.ReferencedROINumber)
            made.append(Label(part, _colour(roi)))
    said = [*foreign, *told.sentences()]
    said += [RESAMPLED] if aslant else []
    return Labels(tuple(made), tuple(said))


def _frames(dataset: Dataset) -> set[str]:
    """Returns the frames of reference that structures are told in, as far as they say."""
    told = (
        roi.get("ReferencedFrameOfReferenceUID")
        for roi in dataset.get("StructureSetROISequence") or []
    )
    return {str(uid) for uid in told if uid}


def _polygons(what: str, roi: Dataset) -> list[Polygon]:
    """Returns the closed contours of a structure.

    Raises:
        VolumeFormatError: Coordinates are no points, or no numbers.
    """
    closed = [
        np.array(contour.get("ContourData") or [], float)
        for contour in roi.get("ContourSequence") or []
        if contour.get("ContourGeometricType") in CLOSED
    ]
    for numbers in closed:
        if numbers.size % 3:
            raise VolumeFormatError(
                f"{what} has a contour of {numbers.size} coordinates; allowed: three for each point"
            )
        if not np.isfinite(numbers).all():
            raise VolumeFormatError(
                f"{what} has contours with coordinates that are no numbers; allowed: finite ones"
            )
    return [numbers.reshape(-1, 3) for numbers in closed if numbers.size >= 3 * LEAST_CORNERS]


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
) -> Filled:
    """Fills the voxels whose middles contours enclose.

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
            "slices of the scan, or others with `resample=True`"
        )
    if axis is None:
        try:
            found = filled_aslant(polygons, volume, exclusive=exclusive)
            return replace(found, cut=cut_share(_placed(polygons, volume), volume))
        except NotFlatError:
            raise OptionError(
                f"{what} has contours that lie in no plane; allowed: contours drawn on slices of "
                "one scan"
            ) from None
    return _filled_upright(_placed(polygons, volume), axis, volume, exclusive=exclusive)


def _filled_upright(placed: list[Polygon], axis: int, volume: Volume, *, exclusive: bool) -> Filled:
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
    bridged, left = stack.missing()
    return Filled(mask=mask, cut=cut_share(placed, volume), bridged=bridged, left=left)


def _placed(polygons: list[Polygon], volume: Volume) -> list[Polygon]:
    """Returns polygons in indices of the scan, whole at the middles of voxels."""
    index_from_patient = np.linalg.inv(volume.patient_from_grid)
    return [
        corners @ index_from_patient[:3, :3].T + index_from_patient[:3, 3] - 0.5
        for corners in polygons
    ]


def _axis_of(polygons: list[Polygon], volume: Volume) -> int | None:
    """Returns the axis of the scan along which each contour is flat; None where there is none."""
    placed = _placed(polygons, volume)
    extents = np.max([np.ptp(corners, axis=0) for corners in placed], axis=0)
    axis = int(np.argmin(extents))
    return axis if extents[axis] <= FLAT else None
