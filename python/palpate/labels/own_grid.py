"""The grid that a file of segments has by itself."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from palpate.base.errors import OptionError
from palpate.base.progress import Progress
from palpate.base.reader_process import apart
from palpate.io.dicom.mark import is_dicom
from palpate.io.image_file import is_beside
from palpate.io.reading import read
from palpate.labels.label_map import ENDINGS
from palpate.labels.seg_nrrd import is_segmentation, segmentation_grid
from palpate.volumes.volume import Volume

__all__ = ["has_own_grid", "own_grid"]


def has_own_grid(path: Path) -> bool:
    """Says whether segments lie on a grid that their file tells whole: DICOM tells slices only."""
    return path.is_dir() or not is_dicom(path)


def own_grid(path: Path, *, progress: Progress) -> Volume:
    """Returns a scan on the grid of a label map, ``.seg.nrrd`` or folder of masks.

    Raises:
        OptionError: It is DICOM, or a folder without masks.
        VolumeFormatError: It cannot be read.
    """
    if not has_own_grid(path):
        raise OptionError(
            f"{path.name} does not tell the grid of its scan; allowed: `of=SCAN`, the scan that "
            "these segments belong to"
        )
    if path.is_dir():
        masks = sorted(
            one
            for one in path.iterdir()
            if one.name.lower().endswith(ENDINGS) and not is_beside(one.name)
        )
        if not masks:
            raise OptionError(f"{path} holds no masks; allowed: a folder with a mask for each")
        return read(masks[0], progress=progress)
    if is_segmentation(path):
        grid = apart(segmentation_grid, path, path=path, progress=progress)
        return Volume(
            np.zeros(grid.shape, np.int16),
            spacing=grid.spacing,
            origin=grid.origin,
            direction=grid.direction,
        )
    return read(path, progress=progress)
