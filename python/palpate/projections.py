"""Projections as files: stacks of line integrals, or of what a detector counted.

Layout: arrays are [angle, v, u].
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from palpate.errors import OptionError, VolumeFormatError
from palpate.progress import Progress, silent
from palpate.simpleitk import reason_of, simpleitk

__all__ = ["integrals_of", "read_projections"]

Values = NDArray[np.float32]

TIFFS = (".tif", ".tiff")


def read_projections(path: Path, *, sinograms: bool = False, progress: Progress = silent) -> Values:
    """Reads an image of three axes, or a folder of TIFFs in the order of their names.

    Args:
        path: What ITK reads: NRRD, NIfTI, MetaImage, a TIFF of many pages, or such a folder.
        sinograms: Each image is one row of the detector at all angles.
        progress: Told what is read.

    Raises:
        FileNotFoundError: ``path`` does not exist.
        VolumeFormatError: It holds no stack of images.
    """
    if not path.exists():
        raise FileNotFoundError(f"{path} does not exist; allowed: an existing file or folder")
    progress(f"reading {path.name}", None)
    files: Any = str(path)
    if path.is_dir():
        files = sorted(str(one) for one in path.iterdir() if one.suffix.lower() in TIFFS)
    try:
        array = simpleitk().GetArrayFromImage(simpleitk().ReadImage(files))
    except RuntimeError as error:
        raise VolumeFormatError(
            f"{path} cannot be read ({reason_of(error)}); allowed: a stack as NRRD, NIfTI, "
            "MetaImage or TIFF, or a folder of TIFFs"
        ) from None
    if array.ndim != 3:
        raise VolumeFormatError(
            f"{path} holds an array of shape {list(array.shape)}; allowed: [angles, rows, columns]"
        )
    stacked = array.transpose(1, 0, 2) if sinograms else array
    return np.ascontiguousarray(stacked, np.float32)


def integrals_of(counts: Values, unattenuated: float) -> Values:
    """Returns line integrals of attenuation from what a detector counted (Beer and Lambert).

    Raises:
        OptionError: Without a patient it counts nothing.
    """
    if not 0.0 < unattenuated < np.inf:
        raise OptionError(f"intensities of {unattenuated:g} given; allowed: above 0")
    # a pixel that counted nothing is taken as one that counted a half
    least = min(0.5, 1e-6 * unattenuated)
    integrals: Values = np.log(unattenuated / np.maximum(counts, least)).astype(np.float32)
    return integrals
