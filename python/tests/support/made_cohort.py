"""Small scans in folders of their own, and a recipe over them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import SimpleITK

BLOCK_RECIPE = """\
segment:
  - threshold: 100
    name: block
surface:
  - out: block.stl
export:
  - out: labels.nii.gz
"""
"""What is made of a case whose only bright part is a block."""


def write_block(path: Path, length: int, *, edge: int = 12) -> None:
    """Writes a scan with a block of ``length`` × 6 × 6 voxels in ``edge``³."""
    values = np.zeros((edge, edge, edge), np.int16)
    values[2 : 2 + length, 2:8, 2:8] = 300
    path.parent.mkdir(parents=True, exist_ok=True)
    SimpleITK.WriteImage(SimpleITK.GetImageFromArray(values), str(path))


def write_outlier(folder: Path) -> None:
    """Writes five cases, of which p4 is much larger than the others, and a torn one."""
    for number, length in enumerate((4, 5, 6, 5, 24)):
        write_block(folder / "data" / f"p{number}" / "ct.nii.gz", length, edge=32)
    (folder / "data" / "torn").mkdir()
    (folder / "data" / "torn" / "ct.nii.gz").write_bytes(b"")
