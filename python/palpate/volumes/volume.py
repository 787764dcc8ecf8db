"""A scan: values on a grid with a place in the patient.

Frames: ``patient`` is LPS [mm]; ``grid`` is in voxels, voxel (i, j, k) covers [i, i+1) on each
axis. Points are (x, y, z); arrays are [z, y, x], x fastest in memory.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from palpate import _core
from palpate.base.counted import counted
from palpate.base.errors import EmptySegmentError, OptionError, VolumeFormatError
from palpate.base.given import given_text, number
from palpate.volumes.closed_limits import as_stored, between, limits_on_stored
from palpate.volumes.histogram import Anchors, Histogram, anchors
from palpate.volumes.orientation import letters_of
from palpate.volumes.segment import Segment
from palpate.volumes.siblings import Siblings
from palpate.volumes.stored_values import Scale, to_stored

__all__ = ["Source", "Volume", "VolumeTraits"]

AXES = 3
HISTOGRAM_BINS = 512
Region = Any
"""Part of an array [z, y, x] as NumPy's indices take it, such as a tuple of slices."""
UNKNOWN_SIDES = (
    "nothing tells the orientation, so left and right may be swapped; give it, such "
    "as `orientation=LPS`"
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
    """Of DICOM; shown on the page and compared, and never saved."""
    patient_name: str = field(default="", repr=False)
    """Of DICOM; shown on the page and compared, and never saved."""
    siblings: Siblings | None = field(default=None, repr=False)
    """Volumes of its file or series, such as times; None where it is alone."""
    orientation_known: bool = True
    warnings: tuple[str, ...] = ()
    """Sentences on what was assumed or lost in reading."""
    notes: tuple[str, ...] = ()
    """Sentences on what was assumed or changed as it nearly always is, and is hardly ever wrong."""

    @property
    def patient(self) -> str:
        """Whose scan it is, by name and number; "" where its files do not say."""
        name = " ".join(self.patient_name.replace("^", " ").replace("=", " ").split())
        return ", ".join(filter(None, (name, self.patient_id.strip())))


@dataclass(frozen=True)
class Source:
    """Where a scan was read from, and with which options of ``palpate.read``."""

    path: Path
    options: Mapping[str, Any]


class Volume:
    """Values of a scan on a grid.

    Touch and the picture use them as int16, with ``value = slope * stored + intercept``. Where
    these are rounded, the values themselves are kept beside them, for all that is read, compared
    and written.
    """

    def __init__(
        self,
        values: NDArray[Any],
        *,
        spacing: Sequence[float],
        origin: Sequence[float] = (0.0, 0.0, 0.0),
        direction: ArrayLike = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)),
        slope: float = 1.0,
        intercept: float = 0.0,
        exact: NDArray[Any] | None = None,
        traits: VolumeTraits | None = None,
    ) -> None:
        """Places values in the patient.

        Args:
            values: Numbers of any real type, shape [depth, height, width]. NaN and infinite ones
                are no values: such voxels are transparent and cannot be touched.
            spacing: Distance of the centres of voxels along x, y, z [mm].
            origin: Centre of the first voxel in the patient, LPS [mm].
            direction: Axes of the grid in the patient as columns, shape [3, 3].
            slope: Value of a step of the given numbers [unit of the scan].
            intercept: Value of a given 0 [unit of the scan].
            exact: Values [unit of the scan] that ``values`` of int16 are rounded from, NaN where
                there is none, of the same shape.
            traits: Other properties of the scan.

        Raises:
            VolumeFormatError: The numbers do not describe a grid.
        """
        self.traits = traits or VolumeTraits()
        self.source: Source | None = None
        """Where it was read from; None where it was made."""
        self.edited = False
        """Whether its values differ from those that were read."""
        self.spacing = _triple("spacing", spacing)
        self.origin = _triple("origin", origin)
        self.direction = _matrix(direction)
        array = _checked(values)
        slope, intercept = number("slope", slope), number("intercept", intercept)
        if array.dtype != np.int16:
            scaled = _scaled(array, slope, intercept)
            stored = to_stored(scaled, file_scale=Scale(slope, intercept))
            array, slope, intercept = stored.values, stored.scale.slope, stored.scale.intercept
            exact = stored.exact
            if exact is not None and np.may_share_memory(exact, values):
                # whoever gave the array may go on changing it
                exact = exact.copy()
        self.slope = float(slope)
        self.intercept = float(intercept)
        if exact is not None and not isinstance(exact, np.ndarray):
            raise VolumeFormatError(
                f"exact {given_text(exact)} given; allowed: an array, shaped as the values"
            )
        self._exact = None if exact is None else exact.view()
        if self._exact is not None:
            self._exact.flags.writeable = False
        try:
            self._internal = _core.Volume(
                np.ascontiguousarray(array),
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
        """Sentences on what was assumed or lost in reading, on missing values and unknown sides."""
        some = counted(self.missing, "values is", "values are", of=self.array.size)
        missing = (
            f"{some} NaN or infinite: taken as no value "
            "(transparent, not touched, left out of thresholds and statistics)"
        )
        sides = () if self.traits.orientation_known else (UNKNOWN_SIDES,)
        return self.traits.warnings + ((missing,) if self.missing else ()) + sides

    @property
    def notes(self) -> tuple[str, ...]:
        """Sentences on what was assumed or changed in reading, and is hardly ever wrong."""
        return self.traits.notes

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
        return self.array.nbytes + (0 if self._exact is None else self._exact.nbytes)

    # --- what it holds --------------------------------------------------------------------

    @property
    def array(self) -> NDArray[np.int16]:
        """The stored values, read-only, shape [depth, height, width]; see ``values``."""
        return self._internal.values()

    @property
    def exact(self) -> NDArray[Any] | None:
        """The values, read-only, NaN where there is none; None where ``array`` holds them all."""
        return self._exact

    def values(self, region: Region = ...) -> NDArray[Any]:
        """Returns values [unit of the scan], NaN where there is none.

        Args:
            region: Part of the array [z, y, x], as NumPy's indices; the default is all of it.

        Returns:
            As they were read; whole ones that are stored as integers are integers, others floats.
        """
        if self._exact is not None:
            return self._exact[region]
        stored = self.array[region]
        if not (self.slope.is_integer() and self.intercept.is_integer()):
            return (stored * self.slope + self.intercept).astype(np.float32)
        if (self.slope, self.intercept) == (1.0, 0.0):
            return stored
        ends = (abs(self.slope) * 2.0**15 + abs(self.intercept)) < 2.0**31
        whole: NDArray[Any] = stored.astype(np.int32 if ends else np.int64)
        whole *= int(self.slope)
        whole += int(self.intercept)
        return whole

    def intensities(self, region: Region = ...) -> NDArray[np.float32]:
        """Returns values for filters, which know no NaN: voxels without one are below all others.

        Args:
            region: Part of the array [z, y, x], as NumPy's indices; the default is all of it.
        """
        values = self.values(region).astype(np.float32)
        if self.missing:
            none = np.isnan(values)
            values[none] = self.array[region][none] * self.slope + self.intercept
        return values

    @property
    def scale(self) -> Scale:
        """How stored numbers become values."""
        return Scale(self.slope, self.intercept)

    @cached_property
    def missing(self) -> int:
        """Number of voxels without a value."""
        if self._exact is None or self._exact.dtype.kind != "f":
            return 0
        return sum(int(np.count_nonzero(np.isnan(slab))) for slab in self._exact)

    @cached_property
    def range(self) -> tuple[float, float]:
        """Lowest and highest value [unit of the scan]."""
        if self._exact is not None:
            return float(np.nanmin(self._exact)), float(np.nanmax(self._exact))
        ends = (self.value_of(stored) for stored in self._internal.stored_range())
        low, high = sorted(ends)
        return low, high

    def value_of(self, stored: float) -> float:
        """Returns the value of a stored number [unit of the scan], as far as that tells it."""
        return self.slope * stored + self.intercept

    @cached_property
    def histogram(self) -> Histogram:
        """Counts of all values in equal bins over their range."""
        low, high, counts = self._internal.histogram(HISTOGRAM_BINS)
        # they are stored as the lowest number
        counts[0] -= np.uint64(self.missing)
        return Histogram(low, high, counts)

    @cached_property
    def anchors(self) -> Anchors:
        """Values of soft tissue and of the lower end of bone [unit of the scan]."""
        return anchors(self.histogram, unit=self.unit)

    # --- what can be made of it -----------------------------------------------------------

    def with_values(self, values: NDArray[np.int16]) -> Volume:
        """Returns the same scan with other stored values, of the same shape."""
        changed = np.asarray(values) != self.array
        exact = self._exact
        if exact is not None and changed.any():
            exact = exact.copy()
            new = values[changed] * self.slope + self.intercept
            exact[changed] = np.rint(new) if exact.dtype.kind in "iu" else new
        other = Volume(
            values,
            spacing=self.spacing,
            origin=self.origin,
            direction=self.direction,
            slope=self.slope,
            intercept=self.intercept,
            exact=exact,
            traits=self.traits,
        )
        other.source = self.source
        other.edited = self.edited or bool(changed.any())
        return other

    def threshold(self, low: float, high: float | None = None, *, name: str = "bone") -> Segment:
        """Returns the segment of all voxels with low <= value <= high.

        Args:
            low: Lowest value [unit of the scan].
            high: Highest value [unit of the scan]; the default is the highest of the scan.
            name: Name of the segment.

        Raises:
            OptionError: The values are no finite numbers, or not in order.
            EmptySegmentError: No voxel has such a value.
        """
        low = number("low of a threshold", low)
        upper = max(self.range[1], low) if high is None else number("high of a threshold", high)
        unit = f" {self.unit}" if self.unit else ""
        if not (np.isfinite(low) and np.isfinite(upper) and low <= upper):
            raise OptionError(
                f"threshold {low:g} to {upper:g}{unit} is no range; allowed: two finite values, "
                "the lower first"
            )
        internal = self._between(low, upper)
        if internal.voxel_count == 0:
            asked = f"from {low:g}" if high is None else f"{low:g} to {upper:g}"
            raise EmptySegmentError(
                f"threshold {asked}{unit} selects no voxel; allowed: a range within "
                f"{self.range[0]:g} to {self.range[1]:g}{unit}"
            )
        limits = limits_on_stored(self, float(low), float(upper))
        return Segment(internal, name=name, volume=self, range=limits)

    def between(self, low: float, high: float, region: Region = ...) -> NDArray[np.bool_]:
        """Returns which voxels have low <= value <= high, in the values that the file holds.

        A limit is a value where it is that but for rounding: 0.3 is 3 steps of 0.1, and what 0.3
        is in single precision. Voxels without a value are never among them.

        Args:
            low: Lowest value [unit of the scan].
            high: Highest value [unit of the scan].
            region: Part of the array [z, y, x], as NumPy's indices; the default is all of it.
        """
        return between(self, low, high, region=region)

    def _between(self, low: float, high: float) -> _core.Segment:
        """Returns the voxels that ``between`` tells."""
        if self._exact is None:
            return self._internal.threshold(as_stored(self, low), as_stored(self, high))
        mask = np.empty(self.shape, np.uint8)
        for index, inside in enumerate(mask):
            inside[...] = between(self, low, high, region=index)
        return _core.Segment.from_mask(mask)

    def offered_bone(self) -> Segment:
        """Returns bone by a default threshold: 250 HU, or one estimated from the histogram."""
        return self.threshold(self.anchors.bone, name="bone")

    def segment(self, mask: ArrayLike, *, name: str) -> Segment:
        """Returns the segment of the voxels where a mask is not 0.

        Args:
            mask: Of the scan's ``shape``.
            name: Name of the segment.

        Raises:
            OptionError: The mask has another shape, or NaN, or other things than numbers.
        """
        array = np.asarray(mask)
        if not array.ndim:
            raise OptionError(
                f"mask of {name!r} is {given_text(mask)}; allowed: an array of shape "
                f"{list(self.shape)}"
            )
        if array.shape != self.shape:
            raise OptionError(
                f"mask of {name!r} has shape {list(array.shape)}; allowed: {list(self.shape)}"
            )
        if array.dtype.kind not in "biuf":
            raise OptionError(
                f"mask of {name!r} is of type {array.dtype}; allowed: numbers or bool"
            )
        nan = int(np.count_nonzero(np.isnan(array))) if array.dtype.kind == "f" else 0
        if nan:
            raise OptionError(
                f"mask of {name!r} is NaN in {nan} voxels; allowed: numbers, 0 outside of it"
            )
        bits = np.ascontiguousarray(array != 0, dtype=np.uint8)
        return Segment(_core.Segment.from_mask(bits), name=name, volume=self, range=None)


def _triple(name: str, numbers: Sequence[float]) -> tuple[float, float, float]:
    try:
        x, y, z = (float(length) for length in numbers)
    except (TypeError, ValueError):
        raise VolumeFormatError(
            f"{name} {given_text(numbers)} given; allowed: three numbers, along x, y, z"
        ) from None
    return x, y, z


def _matrix(direction: ArrayLike) -> NDArray[np.float64]:
    try:
        matrix = np.array(direction, dtype=np.float64)
    except (TypeError, ValueError):
        raise VolumeFormatError(
            f"direction {given_text(direction)} given; allowed: numbers of shape [3, 3], axes as "
            "columns"
        ) from None
    if matrix.shape != (3, 3):
        raise VolumeFormatError(
            f"direction of shape {list(matrix.shape)} given; allowed: [3, 3], axes as columns"
        )
    return matrix


def _scaled(array: NDArray[Any], slope: float, intercept: float) -> NDArray[Any]:
    """Returns the values of given numbers; integers would wrap around in their own type."""
    if (slope, intercept) == (1.0, 0.0):
        return array
    if not (np.isfinite(slope) and np.isfinite(intercept) and slope != 0.0):
        raise VolumeFormatError(
            f"slope {slope:g} and intercept {intercept:g} given; allowed: finite numbers, and a "
            "slope other than 0"
        )
    return slope * array.astype(np.float64) + intercept


def _checked(values: ArrayLike) -> NDArray[Any]:
    """Returns values as an array of numbers with three axes; masked ones are NaN."""
    array = np.asarray(values)
    if not array.ndim:
        raise VolumeFormatError(
            f"values {given_text(values)} given; allowed: an array [depth, height, width]"
        )
    # whoever has a masked array has its module; numpy would import it here for all others
    masked = sys.modules.get("numpy.ma")
    if masked is not None and isinstance(values, masked.MaskedArray) and values.mask.any():
        array = np.where(values.mask, np.nan, array)
    if array.ndim != AXES or not array.size:
        raise VolumeFormatError(
            f"values of shape {list(array.shape)} given; allowed: [depth, height, width]"
        )
    if array.dtype.kind not in "biuf":
        raise VolumeFormatError(
            f"values of type {array.dtype} given; allowed: bool, integers and floats"
        )
    return array.astype(np.uint8) if array.dtype.kind == "b" else array
