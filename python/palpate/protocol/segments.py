"""Messages on segments: what they are, how they are made, changed, painted, moved and cut."""

from __future__ import annotations

from typing import Annotated

import msgspec

from palpate.protocol.soft_tissue import MatterRegion, SegmentMaterial
from palpate.protocol.types import (
    Friction,
    GridPlace,
    Message,
    Name,
    Pose,
    SegmentId,
    ShapeKind,
    Stiffness,
    Value,
    Vector,
)
from palpate.volumes.appearance import SegmentAppearance

__all__ = [
    "ChangeShape",
    "CutAlong",
    "CutPreview",
    "CutSegment",
    "EndPaint",
    "Feel",
    "Gap",
    "Grab",
    "GrowSeeds",
    "GrowSegment",
    "MoveSegment",
    "MovedPose",
    "NewSegment",
    "Otsu",
    "Paint",
    "RemoveSegment",
    "Segment",
    "SegmentFeel",
    "SegmentProperties",
    "SegmentWork",
    "Segments",
    "StopSegmentWork",
    "Threshold",
    "TurnGrabbed",
    "WatchGap",
]


class Feel(msgspec.Struct, frozen=True):
    """How the surface of a segment feels; null is as the settings of touch say.

    Friction without one of its own is that of the segment's material, where it has one.
    """

    stiffness: Stiffness | None
    friction_static: Friction | None
    friction_kinetic: Friction | None


class Segment(SegmentAppearance, frozen=True):
    """A segment of the scan.

    ``range`` holds the threshold (low, high) while the segment is just that threshold;
    null where its voxels come from elsewhere: then they stand in ``/api/labels`` under
    the segment's ``id`` (1..255). ``made_by`` is the threshold that made it, whatever edits
    did since; null where none did. ``pose`` takes the segment from where the scan has it to
    where it stands; null where it was not moved. ``bounds`` are the voxels that hold it, half
    open; null where it is empty. ``material`` is null where it is hard; ``regions`` are those that
    take part in their own way. ``grid`` is the ``patient_from_grid`` of its voxels where they are
    not the scan's. ``opacity``, ``smoothing``, ``surface_from`` and ``wireframe`` are those of its
    surface; ``ambient`` and ``specular`` are factors on its light. The voxels of a ``locked`` one
    stay as they are.
    """

    id: SegmentId
    name: Name
    touchable: bool
    locked: bool
    range: tuple[Value, Value] | None
    made_by: tuple[Value, Value] | None
    voxels: int
    volume_ml: float
    pending: bool
    feel: Feel
    material: SegmentMaterial | None
    regions: list[MatterRegion]
    pose: Pose | None
    bounds: tuple[GridPlace, GridPlace] | None
    grid: Pose | None


class MovedPose(msgspec.Struct, frozen=True):
    """Where a moved segment stands by now: ``Segment.pose`` is where it was asked to go."""

    id: SegmentId
    pose: Pose


class Segments(Message, frozen=True, tag="segments"):
    """The segment list after a change; ``labels`` is the version of ``/api/labels``."""

    segments: list[Segment]
    labels: int


class Gap(Message, frozen=True, tag="gap"):
    """The gap from the surface of segment ``id`` to segment ``other``, as they stand by now.

    ``minimum`` and ``mean`` [mm], ``overlap`` [mm³]; null where one of them is gone or empty.
    """

    id: SegmentId
    other: SegmentId
    minimum: float | None
    mean: float | None
    overlap: float | None


class CutPreview(Message, frozen=True, tag="cut_preview"):
    """Volumes of the parts that a painted cut would make of segment ``id`` [ml], larger first.

    Both are null where it would leave all of it on one side.
    """

    id: SegmentId
    larger_ml: float | None
    smaller_ml: float | None


class SegmentWork(Message, frozen=True, tag="segment_work"):
    """What is being done to segments beside all else; null where nothing is."""

    what: str | None


class Threshold(Message, frozen=True, tag="threshold"):
    """Makes a segment of all voxels with low <= value <= high, or changes segment ``id``."""

    id: SegmentId | None
    name: Name
    low: Value
    high: Value


class Otsu(Message, frozen=True, tag="otsu"):
    """Makes a segment of each class of values but the lowest, by Otsu's thresholds."""

    classes: Annotated[int, msgspec.Meta(ge=2, le=4)]


class GrowSegment(Message, frozen=True, tag="grow_segment"):
    """Makes a segment of what has values like those at ``seed`` and hangs together with them.

    ``spread`` is half of the range of values, in standard deviations around the seed. Passages
    narrower than ``passage`` [mm] are not entered, and it becomes no larger than ``most_ml``.
    """

    seed: Vector
    spread: Annotated[float, msgspec.Meta(ge=0.1, le=20.0)]
    passage: Annotated[float, msgspec.Meta(ge=0.0, le=40.0)]
    most_ml: Annotated[float, msgspec.Meta(ge=0.001, le=1e5)]


class GrowSeeds(Message, frozen=True, tag="grow_seeds"):
    """Makes a segment of each of these: they grow until they meet where values change most.

    Values are smoothed by a Gaussian of this deviation [mm].
    """

    ids: Annotated[list[SegmentId], msgspec.Meta(min_length=2, max_length=50)]
    smoothing: Annotated[float, msgspec.Meta(ge=0.1, le=20.0)]


class ChangeShape(Message, frozen=True, tag="change_shape"):
    """Changes the shape of a segment; undo takes it back.

    ``amount`` counts islands to keep, is the volume from which on they stay [ml], or a length [mm];
    ``other`` is the segment that is united, subtracted or intersected.
    """

    id: SegmentId
    kind: ShapeKind
    amount: Annotated[float, msgspec.Meta(ge=0.0, le=1e5)]
    other: SegmentId | None


class NewSegment(Message, frozen=True, tag="new_segment"):
    """Makes a segment without voxels, to be painted; undo takes it away."""

    name: Name


class Paint(Message, frozen=True, tag="paint"):
    """Paints voxels of a segment along points, or takes them away: a stroke until ``EndPaint``.

    The brush has a radius [mm]. It is a disc in the slice with this ``normal``, or a ball without
    one, and changes only voxels with such ``values``, where these are given.
    """

    id: SegmentId
    erases: bool
    points: Annotated[list[Vector], msgspec.Meta(min_length=1, max_length=64)]
    radius: Annotated[float, msgspec.Meta(gt=0.0, le=50.0)]
    normal: Vector | None
    values: tuple[Value, Value] | None


class EndPaint(Message, frozen=True, tag="end_paint"):
    """Ends a stroke of the brush as one step of undo, or takes it back where it is not kept."""

    keep: bool


class StopSegmentWork(Message, frozen=True, tag="stop_segment_work"):
    """Stops what ``SegmentWork`` tells of and forgets what waits; what is not done is not begun."""


class SegmentProperties(SegmentAppearance, Message, frozen=True, tag="segment_properties"):
    """Changes how a segment looks and whether it can be touched, and its voxels changed."""

    id: SegmentId
    name: Name
    touchable: bool
    locked: bool


class SegmentFeel(Message, frozen=True, tag="segment_feel"):
    """Changes how the surface of a segment feels."""

    id: SegmentId
    feel: Feel


class MoveSegment(Message, frozen=True, tag="move_segment"):
    """Moves a segment to a pose; latest wins, and the servo goes there smoothly.

    Moves of a drag that ``goes_on`` and the one that ends it are one step of undo.
    """

    id: SegmentId
    pose: Pose
    goes_on: bool


class Grab(Message, frozen=True, tag="grab"):
    """Takes a segment in the hand, null lets go of it; ``collides`` stops it at the others."""

    id: SegmentId | None
    collides: bool


class TurnGrabbed(Message, frozen=True, tag="turn_grabbed"):
    """Turns the segment in the hand about the probe by a rotation vector [rad]."""

    rotation: Vector


class CutSegment(Message, frozen=True, tag="cut_segment"):
    """Parts a segment by the plane through a point; what lies before it is a new segment."""

    id: SegmentId
    point: Vector
    normal: Vector


class CutAlong(Message, frozen=True, tag="cut_along"):
    """Parts a segment along a line painted on the picture, extruded away from the eye.

    ``line`` are points under it before the eye; ``view`` is where the eye looks. A ``closed`` line
    joins its ends, an open one goes on straight. The smaller part is a new segment; with
    ``preview`` nothing is cut, and ``CutPreview`` answers.
    """

    id: SegmentId
    line: Annotated[list[Vector], msgspec.Meta(min_length=2, max_length=1000)]
    eye: Vector
    view: Vector
    closed: bool
    preview: bool


class WatchGap(Message, frozen=True, tag="watch_gap"):
    """Has the gap between two segments measured while they move; null ends that."""

    pair: tuple[SegmentId, SegmentId] | None


class RemoveSegment(Message, frozen=True, tag="remove_segment"):
    """Removes a segment; undo brings it back."""

    id: SegmentId
