"""Numbers that people need of segments: volume, values, place and size.

Points are patient, LPS [mm]; arrays are [z, y, x]. What each number means exactly:
docs/understand/segmentation.md, "Statistics".
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from palpate.base.progress import Progress, silent
from palpate.segmentation.measures.centroid import centroid_of
from palpate.segmentation.measures.diameters import axial_axis, largest_diameters
from palpate.volumes.scene import Scene, require_scene
from palpate.volumes.segment import Segment
from palpate.volumes.surface import Surface
from palpate.volumes.volume import Volume

__all__ = ["SegmentStatistics", "ValueStatistics", "statistics"]

Box = tuple[slice, slice, slice]

AT_ONCE = 1 << 20
"""Values that are summed at once, which bounds the memory that it takes."""


@dataclass(frozen=True, kw_only=True)
class ValueStatistics:
    """Values of a scan in a segment [unit of the scan]; voxels without a value are left out."""

    count: int
    """Number of voxels with a value."""
    mean: float
    standard_deviation: float
    """Root of the mean squared distance to the mean: of these voxels, not of a sample (IBSI)."""
    minimum: float
    percentile_5: float
    """Percentiles are interpolated between values (Hyndman and Fan 1996, 7), as NumPy does."""
    percentile_25: float
    median: float
    percentile_75: float
    percentile_95: float
    maximum: float


@dataclass(frozen=True, kw_only=True)
class SegmentStatistics:
    """Numbers of one segment; what an empty one does not have is None."""

    name: str
    unit: str
    """Unit of the values, such as "HU"; "" where it is not known."""
    voxels: int
    """Number of voxels."""
    volume: float
    """Volume of the voxels [mm³]."""
    surface_area: float | None
    """Area of the surface that ``palpate.Surface`` makes of it by default [mm²]."""
    diameter: float | None
    """Largest distance between two corners of voxels [mm]."""
    axial_diameter: float | None
    """The same within one slice, of the scan's slices that are nearest to axial [mm]."""
    centroid: tuple[float, float, float] | None
    """Mean of the centres of voxels, patient, LPS [mm]."""
    without_value: int
    """Number of voxels where the scan has no value."""
    values: ValueStatistics | None
    """None where no voxel has a value, or the segment has a grid of its own."""
    note: str
    """Why numbers are missing: "empty", "no values", "own grid: no values"; "" where all are."""


def statistics(scene: Scene, *, progress: Progress = silent) -> list[SegmentStatistics]:
    """Measures the segments of a scene, each by itself.

    Args:
        scene: The scan, whose values are taken as its file holds them, and its segments.
        progress: Reports progress; what it raises ends the work.

    Raises:
        OptionError: What is given is no scene.
    """
    require_scene(scene)
    measured = []
    for number, one in enumerate(scene):
        progress(f"measuring {one.name}", number / len(scene))
        measured.append(_measured(one.segment, scene.volume, name=one.name))
    return measured


def _measured(segment: Segment, volume: Volume, *, name: str) -> SegmentStatistics:
    bounds = segment.bounding_box
    if bounds is None:
        return _empty(name, volume.unit)
    box = tuple(slice(low, past) for low, past in zip(*bounds, strict=True))[::-1]
    mask = segment.mask()[box].view(np.bool_)
    grid = segment.volume
    diameter, axial_diameter = largest_diameters(
        mask, grid.spacing, axial=axial_axis(grid.direction)
    )
    values, without = None, 0
    if not segment.has_own_grid:
        values, without = _values_in(volume, (box[0], box[1], box[2]), mask)
    return SegmentStatistics(
        name=name,
        unit=volume.unit,
        voxels=segment.voxel_count,
        volume=segment.voxel_count * grid.voxel_volume,
        surface_area=Surface(segment).area,
        diameter=diameter,
        axial_diameter=axial_diameter,
        centroid=centroid_of(mask, grid, low=bounds[0]),
        without_value=without,
        values=values,
        note=_note(segment, values),
    )


def _empty(name: str, unit: str) -> SegmentStatistics:
    return SegmentStatistics(
        name=name,
        unit=unit,
        voxels=0,
        volume=0.0,
        surface_area=None,
        diameter=None,
        axial_diameter=None,
        centroid=None,
        without_value=0,
        values=None,
        note="empty",
    )


def _note(segment: Segment, values: ValueStatistics | None) -> str:
    if segment.has_own_grid:
        return "own grid: no values"
    return "no values" if values is None else ""


def _values_in(
    volume: Volume, box: Box, mask: NDArray[np.bool_]
) -> tuple[ValueStatistics | None, int]:
    """Returns the statistics of values in a mask, and how many of its voxels have none."""
    values = _gathered(volume, box, mask)
    # NaN comes last
    values.sort()
    missing = int(np.count_nonzero(np.isnan(values))) if values.dtype.kind == "f" else 0
    known = values[: len(values) - missing]
    if not len(known):
        return None, missing
    mean, deviation = _mean_and_deviation(known)
    low, quarter, median, three_quarters, high = (
        _percentile(known, percent) for percent in (5, 25, 50, 75, 95)
    )
    found = ValueStatistics(
        count=len(known),
        mean=mean,
        standard_deviation=deviation,
        minimum=float(known[0]),
        percentile_5=low,
        percentile_25=quarter,
        median=median,
        percentile_75=three_quarters,
        percentile_95=high,
        maximum=float(known[-1]),
    )
    return found, missing


def _gathered(volume: Volume, box: Box, mask: NDArray[np.bool_]) -> NDArray[Any]:
    """Returns the values in a mask, slice by slice: of a whole box they may take much memory."""
    slices, rows, columns = box
    kind = volume.values((slice(0, 0), rows, columns)).dtype
    values, filled = np.empty(int(np.count_nonzero(mask)), kind), 0
    for index, inside in enumerate(mask, slices.start):
        found = volume.values((index, rows, columns))[inside]
        values[filled : filled + len(found)] = found
        filled += len(found)
    return values


def _mean_and_deviation(values: NDArray[Any]) -> tuple[float, float]:
    parts = [values[begin : begin + AT_ONCE] for begin in range(0, len(values), AT_ONCE)]
    mean = sum(float(part.sum(dtype=np.float64)) for part in parts) / len(values)
    squares = sum(float(np.square(part - mean, dtype=np.float64).sum()) for part in parts)
    return mean, float(np.sqrt(squares / len(values)))


def _percentile(ordered: NDArray[Any], percent: float) -> float:
    """Returns a percentile of sorted values, linear between the two nearest."""
    at = percent / 100.0 * (len(ordered) - 1)
    below = int(at)
    low, high = (float(ordered[min(index, len(ordered) - 1)]) for index in (below, below + 1))
    return low + (at - below) * (high - low)
