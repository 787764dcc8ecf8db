"""Files of DICOM that other programs were reported to read wrongly, beside the real scans."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from palpate.volumes.volume import Volume


def case(data_folder: Path, number: int) -> Path:
    """Returns the input of a case; it fails where there is none."""
    return next((data_folder.parent / "cases").glob(f"{number:02}-*")) / "input"


def marker(volume: Volume) -> list[float]:
    """Returns the centre of the voxels above half of the highest value, in LPS [mm]."""
    values = values_of(volume)
    place = np.argwhere(values > values.max() / 2).mean(axis=0)[::-1]
    patient = volume.direction @ (place * volume.spacing) + volume.origin
    return [round(float(number), 3) for number in patient]


def values_of(volume: Volume) -> NDArray[Any]:
    """Returns the values of a scan, shape [z, y, x]."""
    return volume.array * volume.slope + volume.intercept
