"""A scan: values on a grid with a place in the patient.

Frames: ``patient`` is LPS [mm]; ``grid`` is in voxels, voxel (i, j, k) covers [i, i+1) on each
axis. Points are (x, y, z); arrays are [z, y, x], x fastest in memory.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from palpate import _core
from palpate.base.errors import EmptySegmentError, OptionError, VolumeFormatError
from palpate.volumes.histogram import Anchors, Histogram, anchors
from palpate.volumes.orientation import letters_of
from palpate.volumes.segment import Segment

__all__ = ["Source", "Volume", "VolumeTraits"]

HISTOGRAM_BINS = 512
UNKNOWN_SIDES = (
    "nothing tells the orientation, so left and right may be swapped; give it with --orientation, "
    "such as LPS"
)


@dataclass(frozen=True, kw_only=True)
class VolumeTraits:
    """Properties of a scan beside its values and its geometry."""

    name: str = "scan"
    """Name to display: its description, or the name of its file or folder."""
    description: str = ""
    """Description in its files; "" where there is none."""
    given: bool = True
    """Whether a user typed the path that gave the name, and did not pick or drop it."""
    modality: str = ""
    """Modality as in DICOM, such as "CT"; "" where it is not known."""
    unit: str = ""
    """Unit of the values, such as "HU", "SUVbw", "Bq/ml" or "Gy"; "" where it is not known."""
    series: str = ""
    """SeriesInstanceUID, for DICOM."""
    frame: str = ""
    """FrameOfReferenceUID of DICOM; scans that share it have the same patient coordinates."""
    study: str = field(default="", repr=False)
    """StudyInstanceUID, for DICOM."""
    patient_id: str = field(default="", repr=False)
    """Of DICOM; only compared, and neither shown nor saved."""
    patient_name: str = field(default="", repr=False)
    """Of DICOM; only compared, and neither shown nor saved."""
    orientation_known: bool = True
    warnings: tuple[str, ...] = ()
    """Sentences on what was assumed or lost in reading."""


@dataclass(frozen=True)
class Source:
    """Where a scan was read from, and with which options of ``palpate.read``."""

    path: Path
    options: Mapping[str, Any]


class Volume:
    """Values of a scan, stored as int16 with ``value = slope * stored + intercept``."""

    def __init__(
        self,
        values: NDArray[np.int16],
        *,
        spacing: Sequence[float],
        origin: Sequence[float] = (0.0, 0.0, 0.0),
        direction: ArrayLike = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)),
        slope: float = 1.0,
        intercept: float = 0.0,
        traits: VolumeTraits | None = None,
    ) -> None:
        """Places values in the patient.

        Args:
            values: Stored values, shape [depth, height, width].
            spacing: Distance of the centres of voxels along x, y, z [mm].
            origin: Centre of the first voxel in the patient, LPS [mm].
            direction: Axes of the grid in the patient as columns, shape [3, 3].
            slope: Value of a step of the stored numbers [unit of the scan].
            intercept: Value of a stored 0 [unit of the scan].
            traits: Other properties of the scan.

        Raises:
            VolumeFormatError: The numbers do not describe a grid.
        """
        self.traits = traits or VolumeTraits()
        self.source: Source | None = None
        """Where it was read from; None where it was made."""
        self.edited = False
        """Whether its values differ from those that were read."""
        self.spacing = _triple(spacing)
        self.origin = _triple(origin)
        self.direction = np.array(direction, dtype=np.float64)
        self.slope = float(slope)
        self.intercept = float(intercept)
        try:
            self._internal = _core.Volume(
                np.ascontiguousarray(values, dtype=np.int16),
                self.spacing,
                self.origin,
                tuple(float(cosine) for cosine in self.direction.ravel()),
                self.slope,
                self.intercept,
            )
        except ValueError as error:
            raise VolumeFormatError(str(error)) from None

    def __repr__(self) -> str:
        unit = f" {self.unit}" if self.unit else ""
        low, high = self.range
        size = " x ".join(map(str, self.dimensions))
        return f"<Volume {self.name!r}: {size} voxels, {low:g} to {high:g}{unit}>"

    # --- what it is -----------------------------------------------------------------------

    @property
    def name(self) -> str:
        """Name of the scan to display."""
        return self.traits.name

    @property
    def title(self) -> str:
        """Name for window titles and new files.

        File names that no user typed may be names of patients; they are left out.
        """
        if self.traits.given and not self.traits.description:
            return self.name
        return " ".join(filter(None, (self.modality, self.traits.description))) or "scan"

    @property
    def modality(self) -> str:
        """Modality as in DICOM, such as "CT"; "" where it is not known."""
        return self.traits.modality

    @property
    def unit(self) -> str:
        """Unit of the values, such as "HU", "SUVbw", "Bq/ml" or "Gy"; "" where it is not known."""
        return self.traits.unit

    @property
    def warnings(self) -> tuple[str, ...]:
        """Sentences on what was assumed or lost in reading, and on an unknown orientation."""
        sides = () if self.traits.orientation_known else (UNKNOWN_SIDES,)
        return self.traits.warnings + sides

    @property
    def dimensions(self) -> tuple[int, int, int]:
        """Number of voxels along x, y, z."""
        return self._internal.dimensions

    @property
    def shape(self) -> tuple[int, int, int]:
        """Shape of the arrays: [depth, height, width]."""
        width, height, depth = self.dimensions
        return depth, height, width

    @property
    def orientation(self) -> str:
        """Sides toward which x, y, z run, such as "LPS"; "unknown" where the file does not tell."""
        return letters_of(self.direction) if self.traits.orientation_known else "unknown"

    @property
    def patient_from_grid(self) -> NDArray[np.float64]:
        """Transform from the grid [voxels] to the patient, LPS [mm], homogeneous, shape [4, 4]."""
        return self._internal.patient_from_grid

    @property
    def voxel_volume(self) -> float:
        """Volume of one voxel [mm³]."""
        x, y, z = self.spacing
        return x * y * z

    @property
    def memory_bytes(self) -> int:
        """Memory that the values take [bytes]."""
        return self.array.nbytes

    # --- what it holds --------------------------------------------------------------------

    @property
    def array(self) -> NDArray[np.int16]:
        """The stored values, read-only, shape [depth, height, width]."""
        return self._internal.values()

    @cached_property
    def range(self) -> tuple[float, float]:
        """Lowest and highest value [unit of the scan]."""
        ends = (self.value_of(stored) for stored in self._internal.stored_range())
        low, high = sorted(ends)
        return low, high

    def value_of(self, stored: float) -> float:
        """Returns the value of a stored number [unit of the scan]."""
        return self.slope * stored + self.intercept

    @cached_property
    def histogram(self) -> Histogram:
        """Counts of all values in equal bins over their range."""
        return Histogram(*self._internal.histogram(HISTOGRAM_BINS))

    @cached_property
    def anchors(self) -> Anchors:
        """Values of soft tissue and of the lower end of bone [unit of the scan]."""
        return anchors(self.histogram, unit=self.unit)

    # --- what can be made of it -----------------------------------------------------------

    def with_values(self, values: NDArray[np.int16]) -> Volume:
        """Returns the same scan with other stored values, of the same shape."""
        other = Volume(
            values,
            spacing=self.spacing,
            origin=self.origin,
            direction=self.direction,
            slope=self.slope,
            intercept=self.intercept,
            traits=self.traits,
        )
        other.source = self.source
        other.edited = self.edited or not np.array_equal(values, self.array)
        return other

    def threshold(self, low: float, high: float | None = None, *, name: str = "bone") -> Segment:
        """Returns the segment of all voxels with low <= value <= high.

        Args:
            low: Lowest value [unit of the scan].
            high: Highest value [unit of the scan]; the default is the highest of the scan.
            name: Name of the segment.

        Raises:
            OptionError: The values are not finite, or not in order.
            EmptySegmentError: No voxel has such a value.
        """
        upper = max(self.range[1], low) if high is None else high
        unit = f" {self.unit}" if self.unit else ""
        if not (np.isfinite(low) and np.isfinite(upper) and low <= upper):
            raise OptionError(
                f"threshold {low:g} to {upper:g}{unit} is no range; allowed: two finite values, "
                "the lower first"
            )
        internal = self._internal.threshold(float(low), float(upper))
        if internal.voxel_count == 0:
            raise EmptySegmentError(
                f"threshold {low:g} to {upper:g}{unit} selects no voxel; allowed: a range within "
                f"{self.range[0]:g} to {self.range[1]:g}{unit}"
            )
        return Segment(internal, name=name, volume=self, range=(float(low), float(upper)))

    def offered_bone(self) -> Segment:
        """Returns bone by a default threshold: 250 HU, or one estimated from the histogram."""
        return self.threshold(self.anchors.bone, name="bone")

    def segment(self, mask: ArrayLike, *, name: str) -> Segment:
        """Returns the segment of the voxels where a mask is not 0.

        Args:
            mask: Of the scan's ``shape``.
            name: Name of the segment.

        Raises:
            OptionError: The mask has another shape.
        """
        array = np.asarray(mask)
        if array.shape != self.shape:
            raise OptionError(
                f"mask of {name!r} has shape {list(array.shape)}; allowed: {list(self.shape)}"
            )
        bits = np.ascontiguousarray(array != 0, dtype=np.uint8)
        return Segment(_core.Segment.from_mask(bits), name=name, volume=self, range=None)


def _triple(numbers: Sequence[float]) -> tuple[float, float, float]:
    x, y, z = (float(number) for number in numbers)
    return x, y, z
