"""Messages on the picture: scans, and changes of voxels and surfaces."""

from __future__ import annotations

from typing import Annotated

import msgspec

from palpate.protocol.soft_tissue import Displaced
from palpate.protocol.types import GridPlace, Message, SegmentId, Value, Vector

__all__ = [
    "Changed",
    "ChangedVoxels",
    "FollowEdits",
    "Histogram",
    "Scan",
    "SecondScan",
    "SegmentSurface",
    "SurfacePatch",
    "ThresholdPreset",
]


class Histogram(msgspec.Struct, frozen=True):
    """Counts of the scan's values in equal bins from ``low`` to ``high``."""

    low: Value
    high: Value
    counts: list[int]


class ThresholdPreset(msgspec.Struct, frozen=True):
    """A range of values of a tissue."""

    name: str
    low: Value
    high: Value


class Scan(msgspec.Struct, frozen=True):
    """The displayed scan; its values are at ``/api/volume``.

    ``value = slope * stored + intercept``. ``patient_from_grid`` is row-major, shape [4, 4]; grid
    coordinates are in voxels, voxel (i, j, k) covers [i, i+1) on each axis. ``unit`` is such
    as "HU" or "SUVbw", "" where it is not known. ``title`` is for windows: it contains no file
    name that the user did not type. ``identity`` is the same wherever the same scan lies
    and however it is named. ``patient`` is whose scan it is, by name and number, "" where the file
    does not say. ``volume`` is which of how many volumes of its file or series it is, such as
    times, from 1; null where others cannot be opened. A ``rereadable`` scan can be
    read again with what its files do not tell. ``no_dicom`` is why nothing in DICOM can refer to
    it; null where something may. ``notes`` are no warnings: what was assumed or
    changed in reading, and is hardly ever wrong.
    """

    name: str
    title: str
    identity: str
    patient: str
    modality: str
    unit: str
    dimensions: tuple[int, int, int]
    spacing: Vector
    patient_from_grid: list[float]
    slope: float
    intercept: float
    range: tuple[Value, Value]
    histogram: Histogram
    soft_tissue: Value
    bone: Value
    presets: list[ThresholdPreset]
    volume: tuple[int, int] | None
    rereadable: bool
    no_dicom: str | None
    orientation_known: bool
    warnings: list[str]
    notes: list[str]


class SurfacePatch(msgspec.Struct, frozen=True):
    """A patch of a segment's surface, at the segment's place in the scan (before its pose).

    ``index`` is its place in the grid of patches. ``origin`` is the lower corner and ``size`` the
    edges of the box of its vertices: position = origin + u16 / 65535 * size.

    ``vertices`` are x, y, z as little-endian uint16 each; ``normals`` x, y, z and an unused byte as
    int8 each, unit vector = int8 / 127; ``triangles`` three vertex numbers each, little-endian
    uint16, or uint32 where there are more than 65536 vertices, counter-clockwise seen from outside.
    """

    index: GridPlace
    origin: Vector
    size: Vector
    vertices: bytes
    normals: bytes
    triangles: bytes


class SegmentSurface(msgspec.Struct, frozen=True):
    """Changes of the surface of a segment: patches that are new or ``dropped``.

    ``whole`` discards all earlier patches.
    """

    id: SegmentId
    whole: bool
    dropped: list[GridPlace]
    patches: list[SurfacePatch]


class ChangedVoxels(msgspec.Struct, frozen=True):
    """Current content of a box of voxels, from ``low`` up to, but without, ``high``.

    ``stored`` are their stored values as little-endian int16, ``labels`` the number of each voxel's
    segment as uint8, both with x fastest; null where they did not change.
    """

    low: GridPlace
    high: GridPlace
    stored: bytes | None
    labels: bytes | None


class Changed(Message, frozen=True, tag="changed"):
    """Changes of the picture by edits up to number ``edit``, to be shown in one frame.

    Boxes of voxels are in the order of their edits: where two overlap, the later one counts.
    ``applied`` is when the oldest of these edits was applied [s since 1970]; null without one.
    ``displaced`` belongs to the voxels after the change: boxes of nodes whose displacements add up,
    at most two; null where it did not change.
    """

    edit: int
    applied: float | None
    voxels: list[ChangedVoxels]
    surfaces: list[SegmentSurface]
    displaced: list[Displaced] | None = None


class SecondScan(Message, frozen=True, tag="second_scan"):
    """The second scan; null where there is none any more.

    ``second_from_first`` maps points of the first scan to the second, row-major, shape [4, 4],
    patient of each [mm]; its values are at ``/api/second`` and change with each ``version``. It
    ``is_moved`` where a transform places it elsewhere than its own geometry does.
    """

    scan: Scan | None
    second_from_first: list[float]
    is_moved: bool
    version: int


class FollowEdits(Message, frozen=True, tag="follow_edits"):
    """Sets how often the picture follows edits: every so many of its 60 frames a second.

    Edits in between are shown together. The slowest of several pages sets the pace.
    """

    every: Annotated[int, msgspec.Meta(ge=1, le=4)]
