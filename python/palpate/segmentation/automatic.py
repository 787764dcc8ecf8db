"""Segments by TotalSegmentator, where a person has installed it.

Source: J. Wasserthal et al., "TotalSegmentator: robust segmentation of 104 anatomic structures
in CT images", 2023 (github.com/wasserth/TotalSegmentator). It is a program of its own, with its own
licence and weights; it gets the scan as a NIfTI file and answers with a folder of masks.
"""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path
from tempfile import TemporaryDirectory

from palpate.base.errors import OptionError
from palpate.base.progress import Progress, silent
from palpate.export.image import write_scan
from palpate.labels.labels import Labels, read_labels
from palpate.volumes.volume import Volume

__all__ = ["found_automatically"]

PROGRAM = "TotalSegmentator"
TOLD = 300
"""Letters of what it says that are passed on where it fails."""


def found_automatically(
    volume: Volume, *, fast: bool = False, progress: Progress = silent
) -> Labels:
    """Returns the structures that TotalSegmentator finds in a scan.

    Args:
        volume: A CT.
        fast: Whether it works at 3 mm, which takes a machine without a graphics card minutes
            instead of an hour.
        progress: Told what is being done.

    Raises:
        OptionError: It is not installed, failed, or found nothing.
    """
    program = shutil.which(PROGRAM)
    if program is None:
        raise OptionError(
            f"{PROGRAM} is not installed; allowed: to install it with "
            "`pip install TotalSegmentator` (github.com/wasserth/TotalSegmentator tells its "
            "licence), or another way to make a segment"
        )
    with TemporaryDirectory(prefix="palpate-") as folder:
        scan, masks = Path(folder) / "scan.nii.gz", Path(folder) / "masks"
        progress("writing the scan for TotalSegmentator", None)
        write_scan(volume, scan)
        progress("waiting for TotalSegmentator", None)
        options = ["--fast"] if fast else []
        done = subprocess.run(  # noqa: S603  # the person's own program, no shell
            [program, "-i", scan, "-o", masks, *options],
            check=False,
            capture_output=True,
            text=True,
            errors="replace",
        )
        if done.returncode != 0 or not masks.is_dir():
            said = " ".join((done.stderr or done.stdout).split())[-TOLD:]
            raise OptionError(
                f"{PROGRAM} ended with {done.returncode} ({said or 'it said nothing'}); allowed: a "
                "CT that it takes, and weights that it can load"
            )
        progress("reading what was found", None)
        return read_labels(masks, volume, progress=progress)
