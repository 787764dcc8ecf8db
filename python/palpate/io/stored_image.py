"""Image files whose voxels stand as plain numbers behind a header: NIfTI, Analyze, FreeSurfer.

nibabel says what the header means; here its promises are held against the file, and the numbers
are read as they are stored.

Frame: LPS [mm]; arrays of files are [x, y, z, …] with x fastest, those of scans [z, y, x].
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

from palpate.base.errors import VolumeFormatError
from palpate.base.nibabel import nibabel
from palpate.base.progress import Progress
from palpate.io.packed_file import MOST_RATIO, check_rest, is_packed, unpacked_file
from palpate.io.raw_scan import RawScan, kind_of, refuse_components, stem_of
from palpate.volumes.stored_values import Scale

__all__ = ["Place", "StoredImage"]

HEADER_ROOM = 1 << 20
"""Bytes of a compressed file that may hold no voxels."""


@dataclass(frozen=True, kw_only=True)
class Place:
    """Where a grid lies in the patient."""

    affine: NDArray[np.float64]
    """From indices of voxels to LPS [mm], shape [4, 4]."""
    known: bool = True
    """Whether the file tells it; else only the size of voxels is right."""
    told: tuple[str, ...] = ()
    """What is not as it should be, in words."""
    notes: tuple[str, ...] = ()
    """What is assumed and hardly ever wrong."""

    @property
    def spacing(self) -> tuple[float, float, float]:
        """Along x, y, z [mm]."""
        x, y, z = (float(length) for length in np.linalg.norm(self.affine[:3, :3], axis=0))
        return x, y, z

    def scan(self, values: NDArray[Any], path: Path, scale: Scale | None = None) -> RawScan:
        """Returns values at this place."""
        origin = self.affine[:3, 3]
        return RawScan(
            values=values,
            spacing=self.spacing,
            origin=(float(origin[0]), float(origin[1]), float(origin[2])),
            direction=self.affine[:3, :3] / self.spacing,
            name=stem_of(path),
            orientation_known=self.known,
            file_scale=scale,
            warnings=list(self.told),
            notes=list(self.notes),
        )


@dataclass(frozen=True, kw_only=True)
class StoredImage:
    """An image file by its header; see ``palpate.io.open_image.OpenImage``."""

    path: Path
    voxels: Path
    """The file that holds them: itself, or one beside."""
    size: tuple[int, ...]
    number: np.dtype[Any]
    """What each voxel is."""
    start: int
    """Bytes before the voxels."""
    scale: Scale | None
    """How numbers become values; None where they are values."""
    place: Place
    vectors: bool = False
    """Whether the last axis counts numbers of one voxel."""

    @property
    def spacing(self) -> tuple[float, ...]:
        """Along x, y, z [mm]."""
        return self.place.spacing

    @property
    def kind(self) -> str:
        """Of its numbers."""
        return kind_of(self.number)

    def check(self) -> None:
        """Refuses numbers that are no intensities."""
        if self.number.names is not None:
            refuse_components(self.path, len(self.number.names), "colours")
        if self.number.kind == "c":
            refuse_components(self.path, 2, "complex numbers")
        if self.vectors:
            refuse_components(self.path, self.size[-1], "vectors")

    def scan(self, frame: int, progress: Progress) -> RawScan:
        """Reads one of its volumes, counted from 0."""
        volume = math.prod(self.size[:3]) * self.number.itemsize
        self._check_length()
        progress(f"reading {self.path.name}, {volume / 2**20:.0f} MiB", None)
        with unpacked_file(self.voxels) as file:
            stored = self._stored(file, start=self.start + frame * volume, size=self.size[:3])
            if is_packed(self.voxels):
                check_rest(file)
        return self.place.scan(_values(stored, self.scale), self.path, self.scale)

    def middle(self, frame: int) -> NDArray[Any]:
        """Returns the values of a volume's middle slice along z, shape [y, x]."""
        x, y, z = self.size[:3]
        slices = frame * z + z // 2
        start = self.start + slices * x * y * self.number.itemsize
        self._check_length()
        with unpacked_file(self.voxels) as file:
            stored = self._stored(file, start=start, size=(x, y, 1))
        middle: NDArray[Any] = _values(stored, self.scale)[0]
        return middle

    def _stored(self, file: IO[bytes], *, start: int, size: tuple[int, ...]) -> NDArray[Any]:
        """Returns stored numbers, shape [z, y, x]."""
        proxy = nibabel().arrayproxy.ArrayProxy(file, (size, self.number, start), mmap=False)
        try:
            stored: NDArray[Any] = proxy.get_unscaled().T
        except OSError as error:
            # of what is too short; damage has errors of its own
            if type(error) is not OSError:
                raise
            raise VolumeFormatError(self._truncated("its bytes end early")) from None
        return stored

    def _check_length(self) -> None:
        """Holds what the header promises against the file, before room is made for it."""
        if not self.voxels.is_file():
            raise VolumeFormatError(
                f"{self.path} names {self.voxels.name} as the file of its voxels, which does not "
                "exist; allowed: both files in one folder"
            )
        promised = math.prod(self.size) * self.number.itemsize
        held = self.voxels.stat().st_size
        if is_packed(self.voxels):
            if promised > held * MOST_RATIO + HEADER_ROOM:
                raise VolumeFormatError(self._truncated(f"{held} compressed ones are there"))
        elif held < self.start + promised:
            raise VolumeFormatError(self._truncated(f"{max(held - self.start, 0)} are there"))

    def _truncated(self, held: str) -> str:
        promised = math.prod(self.size) * self.number.itemsize
        return (
            f"{self.voxels} is truncated: its header announces {promised} bytes of voxels, {held}; "
            "allowed: complete files"
        )


def _values(stored: NDArray[Any], scale: Scale | None) -> NDArray[Any]:
    """Returns values of stored numbers: whole ones where they are, else floats that suffice."""
    if scale is None:
        return stored.astype(stored.dtype.newbyteorder("="), copy=False)
    values = np.empty(stored.shape, _kind_of_values(stored, scale))
    for part, target in zip(stored, values, strict=True):
        if values.dtype.kind == "i":
            slope = values.dtype.type(int(scale.slope))
            np.multiply(part, slope, out=target, dtype=values.dtype, casting="unsafe")
            np.add(target, values.dtype.type(int(scale.intercept)), out=target)
        else:
            target[...] = part * np.float64(scale.slope) + scale.intercept
    return values


def _kind_of_values(stored: NDArray[Any], scale: Scale) -> type[np.generic]:
    whole = stored.dtype.kind in "iu" and all(
        float(number).is_integer() for number in (scale.slope, scale.intercept)
    )
    if whole:
        ends = [int(end) for end in (stored.min(), stored.max())]
        # the product comes first, and has to fit too
        steps = [int(scale.slope) * end for end in ends]
        reached = [*ends, *steps, *(step + int(scale.intercept) for step in steps)]
        reached += [int(scale.slope), int(scale.intercept)]
        for kind in (np.int16, np.int32):
            if np.iinfo(kind).min <= min(reached) and max(reached) <= np.iinfo(kind).max:
                return kind
    # float32 holds values of 16 bits exactly enough
    wide = stored.dtype.itemsize > (4 if stored.dtype.kind == "f" else 2)
    return np.float64 if wide else np.float32
