"""Image files that other programs were reported to read wrongly, and ones made for tests."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import nibabel
import numpy as np
from numpy.typing import NDArray
from palpate.volumes.volume import Volume


def case_input(data_folder: Path, number: int) -> Path:
    """Returns the folder of a case's files; it fails where there is none."""
    return next((data_folder.parent / "cases").glob(f"{number:02}-*")) / "input"


def values_of(volume: Volume) -> NDArray[Any]:
    """Returns the values of a scan, shape [z, y, x]."""
    return volume.array * volume.slope + volume.intercept


def bright_middle(volume: Volume) -> NDArray[np.float64]:
    """Returns the centre of the voxels above half of the highest value, LPS [mm]."""
    values = values_of(volume)
    place = np.argwhere(values > values.max() / 2).mean(axis=0)[::-1]
    middle: NDArray[np.float64] = volume.direction @ (place * volume.spacing) + volume.origin
    return middle


def write_nifti(
    path: Path, values: NDArray[Any], affine: NDArray[Any], *, kind: type = nibabel.Nifti1Image
) -> Any:
    """Writes an array [x, y, z, …] with millimetres and an sform, and returns the image."""
    image = kind(values, affine)
    image.header.set_xyzt_units("mm")
    image.header.set_sform(affine, 1)
    image.header.set_qform(None, 0)
    nibabel.save(image, path)
    return image


def places_differ(volume: Volume, affine: NDArray[Any]) -> float:
    """Returns by how much a scan's corners lie off those of a transform to RAS [mm]."""
    ends = np.array(np.meshgrid(*([0.0, n - 1.0] for n in volume.dimensions))).reshape(3, -1)
    lies = volume.patient_from_grid @ np.vstack([ends + 0.5, np.ones(8)])
    meant = np.diag([-1.0, -1.0, 1.0, 1.0]) @ affine @ np.vstack([ends, np.ones(8)])
    return float(np.abs(lies - meant).max())
