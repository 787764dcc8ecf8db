"""A note on the second scan beside a journal, so that a crash does not lose it.

A JSON file with the path of the scan and its place relative to the first one. A scan that was not
read from a file, or was resampled by a deformable transform, cannot be read again; it is not noted.
"""

from __future__ import annotations

from pathlib import Path

import msgspec
import numpy as np
from numpy.typing import NDArray

from palpate.base.errors import SceneFormatError
from palpate.base.progress import silent
from palpate.base.whole_file import whole_file
from palpate.saved.scene_scan import SavedScan, check_same, linked_scan, saved_scan
from palpate.volumes.second_scan import SecondScan

__all__ = ["SavedSecond", "keep_second", "kept_second", "saved_second", "second_name"]


class SavedSecond(msgspec.Struct, frozen=True):
    """Reference to a second scan in a file."""

    scan: SavedScan
    second_from_first: list[float]
    """Transform from the first scan to the second, by rows, 16 numbers."""

    def matrix(self, path: Path) -> NDArray[np.float64]:
        """Returns the transform as an array, shape [4, 4]; ``path`` is the file that contains it.

        Raises:
            SceneFormatError: The numbers are not a transform.
        """
        numbers = np.array(self.second_from_first, np.float64)
        if numbers.shape != (16,) or not np.isfinite(numbers).all():
            raise SceneFormatError(f"{path}: the place of the second scan is no matrix of 4 × 4")
        return numbers.reshape(4, 4)


def saved_second(second: SecondScan, path: Path, *, copied: bool) -> SavedSecond:
    """Returns the reference to a second scan in the file at ``path``."""
    scan = saved_scan(second.volume, path, copied=copied)
    return SavedSecond(scan, [float(number) for number in second.second_from_first.ravel()])


def keep_second(path: Path, second: SecondScan | None) -> None:
    """Writes the note at ``path``, or removes it where the scan cannot be noted.

    Raises:
        OSError: The file cannot be written.
    """
    if second is None or second.volume.source is None:
        path.unlink(missing_ok=True)
        return
    with whole_file(path) as unfinished:
        unfinished.write_bytes(msgspec.json.encode(saved_second(second, path, copied=False)))


def second_name(path: Path) -> str | None:
    """Returns the name of the scan in a note; None where there is no valid note."""
    try:
        return _noted(path).scan.name
    except (OSError, SceneFormatError):
        return None


def kept_second(path: Path) -> SecondScan:
    """Reads the scan of a note.

    Raises:
        OSError: There is no note.
        PalpateError: The note is damaged, or the scan is missing.
    """
    noted = _noted(path)
    volume = linked_scan(path, noted.scan, silent)
    check_same(path, volume, noted.scan)
    return SecondScan(volume, noted.matrix(path))


def _noted(path: Path) -> SavedSecond:
    try:
        return msgspec.json.decode(path.read_bytes(), type=SavedSecond)
    except msgspec.DecodeError as error:
        raise SceneFormatError(f"{path} cannot be read: {error}") from None
