"""Whether values are those of a label map, as far as values tell.

A label map has 0 around its structures, few whole numbers, and areas of one number: two voxels
beside one another mostly have the same. In scans noise makes them differ.
"""

from __future__ import annotations

import re
from typing import Any

import numpy as np
from numpy.typing import NDArray

from palpate.volumes.volume import Volume

__all__ = ["MOST_LABELS", "are_labels", "is_named_so", "may_be_labels"]

MOST_LABELS = 255
"""More values than this are intensities, not labels."""
NAMED = re.compile(r"(?i)(?:^|[^a-z])(?:seg|segmentation|labels?|labelmap|masks?|aseg)(?:[^a-z]|$)")
HIGHEST = 255
"""Label that is usual, where no name says that it is one."""
MOST_EDGES = 0.25
"""Of pairs of voxels beside one another that differ."""


def is_named_so(name: str) -> bool:
    """Says whether a file's name is that of labels, such as ``head_seg.nii.gz``."""
    return NAMED.search(name) is not None


def may_be_labels(values: NDArray[Any], *, named: bool) -> bool:
    """Says whether values are those of labels, shape [..., rows, columns]."""
    if min(values.shape[-2:]) < 2:
        return False
    if not np.isfinite(values).all() or values.min() != 0 or (values != np.rint(values)).any():
        return False
    if values.max() > HIGHEST and not named:
        return False
    edges = [np.mean(np.diff(values, axis=axis) != 0) for axis in (-1, -2)]
    return float(np.mean(edges)) < MOST_EDGES and len(np.unique(values)) <= MOST_LABELS + 1


def are_labels(volume: Volume) -> bool:
    """Says whether a scan is a label map: by its modality, else by its values and its name."""
    if volume.modality not in ("", "SEG") or volume.range[0] != 0.0:
        return False
    path = None if volume.source is None else volume.source.path
    named = is_named_so(volume.name if path is None else path.name)
    if volume.range[1] > HIGHEST and not named:
        return False
    middle = volume.values((volume.shape[0] // 2,))
    if not middle.any():
        # what there is may lie anywhere
        middle = volume.values()
    return bool(middle.any()) and may_be_labels(middle, named=named)
