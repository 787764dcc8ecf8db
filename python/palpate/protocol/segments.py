"""Messages on segments: their state, and adding, changing, painting, moving and splitting them."""

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
    StepKind,
    Stiffness,
    Value,
    Vector,
)
from palpate.volumes.appearance import SegmentAppearance

__all__ = [
    "ChangeGrown",
    "ChangeShape",
    "ChangeSteps",
    "CropScan",
    "CutAlong",
    "CutPreview",
    "EndGoing",
    "EndGrown",
    "EndPaint",
    "Feel",
    "FindTable",
    "Gap",
    "Grab",
    "GrowSeeds",
    "GrowSegment",
    "Grown",
    "Islands",
    "MoveSegment",
    "MovedPose",
    "NewSegment",
    "Otsu",
    "Paint",
    "RemoveFromScan",
    "RemoveSegment",
    "RemoveTable",
    "Scissors",
    "Segment",
    "SegmentFeel",
    "SegmentProperties",
    "SegmentStep",
    "SegmentSteps",
    "SegmentWork",
    "Segments",
    "ShowIslands",
    "ShowScissors",
    "StopSegmentWork",
    "SuggestTable",
    "TableFound",
    "TableSuggested",
    "Threshold",
    "TurnGrabbed",
    "WantedStep",
    "WatchGap",
]


class Feel(msgspec.Struct, frozen=True):
    """Touch settings of a segment; null where the settings of the session apply.

    Without friction of its own, that of the segment's material applies, where it has one.
    """

    stiffness: Stiffness | None
    friction_static: Friction | None
    friction_kinetic: Friction | None


StepAmount = Annotated[float, msgspec.Meta(ge=0.0, le=1e5)]


class SegmentStep(msgspec.Struct, frozen=True):
    """A step of a segment; ``amount`` as in ``ChangeShape``.

    ``other`` is the name of the segment that was united, subtracted or intersected; its voxels are
    those that it had then. A step that is not ``on`` is passed over.
    """

    kind: StepKind
    amount: float
    other: str | None
    on: bool


class SegmentSteps(msgspec.Struct, frozen=True):
    """How a segment is made: its source, and steps in order.

    ``range`` is the threshold of the source; null where the source is voxels that were drawn, grown
    or read.
    """

    range: tuple[Value, Value] | None
    steps: list[SegmentStep]


class Segment(SegmentAppearance, frozen=True):
    """A segment of the scan.

    ``range`` is the threshold (low, high) as long as the segment is exactly that threshold; null
    where its voxels come from elsewhere: they are in ``/api/labels`` then, under the segment's
    ``id`` (1..255). ``made_by`` is the threshold that made it, whatever edits did since; null where
    none did. ``pose`` is the transform from its place in the scan to its current place; null where
    it was not moved. ``bounds`` are the voxels of its bounding box, half open; null where it is
    empty. ``material`` is null where it is rigid; ``regions`` are its regions that deform
    differently. ``grid`` is the ``patient_from_grid`` of its voxels where they are not on the
    scan's grid. ``opacity``, ``smoothing``, ``surface_from`` and ``wireframe`` are those of its
    surface; ``ambient`` and ``specular`` are factors of its light. The voxels of a ``locked``
    segment cannot change. ``touchable`` is what is wanted; ``felt`` is whether the probe collides
    with it: touchable, and visible or ``touched_while_hidden``. ``steps`` is how it is made; null
    where nothing is known but its voxels.
    """

    id: SegmentId
    name: Name
    touchable: bool
    felt: bool
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
    steps: SegmentSteps | None


class MovedPose(msgspec.Struct, frozen=True):
    """Current pose of a moved segment; ``Segment.pose`` is the requested one."""

    id: SegmentId
    pose: Pose


class Segments(Message, frozen=True, tag="segments"):
    """The list of segments after a change; ``labels`` is the version of ``/api/labels``."""

    segments: list[Segment]
    labels: int


class Gap(Message, frozen=True, tag="gap"):
    """The gap from the surface of segment ``id`` to segment ``other``, at their current poses.

    ``minimum`` and ``mean`` [mm], ``overlap`` [mm³]; null where one of them is gone or empty.
    """

    id: SegmentId
    other: SegmentId
    minimum: float | None
    mean: float | None
    overlap: float | None


class CutPreview(Message, frozen=True, tag="cut_preview"):
    """Volumes of the parts that a painted cut would make of segment ``id`` [ml], larger first.

    Both are null where the whole segment would be on one side.
    """

    id: SegmentId
    larger_ml: float | None
    smaller_ml: float | None


class SegmentWork(Message, frozen=True, tag="segment_work"):
    """What is being done to segments in the background; null where nothing is."""

    what: str | None


class Threshold(Message, frozen=True, tag="threshold"):
    """Makes a segment of all voxels with low <= value <= high, or changes segment ``id``."""

    id: SegmentId | None
    name: Name
    low: Value
    high: Value


class Otsu(Message, frozen=True, tag="otsu"):
    """Makes a segment of each class of values except the lowest, by Otsu's thresholds."""

    classes: Annotated[int, msgspec.Meta(ge=2, le=4)]


class GrowSegment(Message, frozen=True, tag="grow_segment"):
    """Shows a region of the connected voxels with values like those at ``seed``: ``Grown`` answers.

    ``spread`` is half of the range of values, in standard deviations around the seed. Passages
    narrower than ``passage`` [mm] are not entered, and the segment becomes no larger than
    ``most_ml``. Where neither is given, both are found: those whose segment ends at an edge.
    """

    seed: Vector
    spread: Annotated[float, msgspec.Meta(ge=0.1, le=20.0)] | None
    passage: Annotated[float, msgspec.Meta(ge=0.0, le=40.0)] | None
    most_ml: Annotated[float, msgspec.Meta(ge=0.001, le=1e5)]


GrowLevel = Annotated[int, msgspec.Meta(ge=0, le=255)]


class Grown(Message, frozen=True, tag="grown"):
    """Tells of a region that is shown as segment ``id`` until a person keeps it or not.

    ``level`` is how wide its range of values is, from ``least`` to ``most``; ``usual`` is the one
    that was found.
    """

    id: SegmentId
    level: GrowLevel
    usual: GrowLevel
    least: GrowLevel
    most: GrowLevel
    volume_ml: float


class ChangeGrown(Message, frozen=True, tag="change_grown"):
    """Shows the region of a narrower or wider range: ``Grown`` answers, if one is shown."""

    level: GrowLevel


class EndGrown(Message, frozen=True, tag="end_grown"):
    """Makes the region that is shown a segment, as one step of undo, or shows it no more."""

    keeps: bool


class GrowSeeds(Message, frozen=True, tag="grow_seeds"):
    """Grows a segment from each seed; they meet where values change most.

    Values are smoothed by a Gaussian with this standard deviation [mm].
    """

    ids: Annotated[list[SegmentId], msgspec.Meta(min_length=2, max_length=50)]
    smoothing: Annotated[float, msgspec.Meta(ge=0.1, le=20.0)]


class FindTable(Message, frozen=True, tag="find_table"):
    """Makes a segment of what lies outside of the body and does not touch it: ``TableFound``."""


class TableFound(Message, frozen=True, tag="table_found"):
    """Tells which segment a table has become, for a person to decide on."""

    id: SegmentId


class SuggestTable(Message, frozen=True, tag="suggest_table"):
    """Looks for a table beside all else: ``TableSuggested`` where there is one, else nothing.

    It gives way to other work on segments, and is not begun while there is some.
    """


class TableSuggested(Message, frozen=True, tag="table_suggested"):
    """Tells that the scan has a table in it, which is not shown as a segment."""


class RemoveTable(Message, frozen=True, tag="remove_table"):
    """Takes the table that was suggested out of the scan; undo brings it back."""


class RemoveFromScan(Message, frozen=True, tag="remove_from_scan"):
    """Takes the voxels of a segment out of the scan, and removes the segment: one step of undo."""

    id: SegmentId


class CropScan(Message, frozen=True, tag="crop_scan"):
    """Takes what lies outside of a box out of the scan; undo brings it back.

    ``low`` and ``high`` are how much goes from the low and high faces of the scan, along its own
    axes [mm]; voxels whose centre lies in the box stay.
    """

    low: Vector
    high: Vector


class ChangeShape(Message, frozen=True, tag="change_shape"):
    """Changes the shape of a segment; undo takes it back.

    ``amount`` is a number of islands to keep, the least volume of islands to keep [ml], or a length
    [mm]; ``other`` is the segment to unite, subtract or intersect with.
    """

    id: SegmentId
    kind: ShapeKind
    amount: StepAmount
    other: SegmentId | None


class ShowIslands(Message, frozen=True, tag="show_islands"):
    """Shows which islands of a segment would go: ``Islands`` answers, and nothing is changed yet.

    At most ``most`` stay, the largest ones, and none that is smaller than ``least_ml``.
    """

    id: SegmentId
    most: Annotated[int, msgspec.Meta(ge=1, le=1_000_000)]
    least_ml: Annotated[float, msgspec.Meta(ge=0.0, le=1e5)]


class Islands(Message, frozen=True, tag="islands"):
    """Tells how many islands segment ``id`` has, and which of them would go.

    ``preview`` is a segment of those that would; null where all stay. ``largest_ml`` are the
    volumes of the largest ones, in that order.
    """

    id: SegmentId
    preview: SegmentId | None
    count: int
    stays: int
    goes_ml: float
    largest_ml: list[float]


class ShowScissors(Message, frozen=True, tag="show_scissors"):
    """Shows what a loop on the picture would cut out: ``Scissors`` answers, and nothing is changed.

    It is cut out of segment ``id``, or of the scan without one. ``line`` are points below the loop
    in front of the eye; ``view`` is the direction of view. What lies inside goes, or ``outside``,
    right through, or less than ``depth`` [mm] behind the first surface: of the segment, or of all
    that are shown.
    """

    id: SegmentId | None
    line: Annotated[list[Vector], msgspec.Meta(min_length=3, max_length=1000)]
    eye: Vector
    view: Vector
    outside: bool
    depth: Annotated[float, msgspec.Meta(gt=0.0, le=1000.0)] | None


class Scissors(Message, frozen=True, tag="scissors"):
    """Tells what would be cut out: ``preview`` is a segment of it; null where nothing is."""

    preview: SegmentId | None
    goes_ml: float


class EndGoing(Message, frozen=True, tag="end_going"):
    """Removes what ``ShowIslands`` or ``ShowScissors`` has shown, as one step of undo, or not."""

    removes: bool


class WantedStep(msgspec.Struct, frozen=True):
    """A step of ``Segment.steps`` as it is wanted: ``index`` is where it is there, from 0 on."""

    index: Annotated[int, msgspec.Meta(ge=0, le=10_000)]
    kind: StepKind
    amount: StepAmount
    on: bool


class ChangeSteps(Message, frozen=True, tag="change_steps"):
    """Makes a segment anew by steps of its list, in another order, with other values, or fewer."""

    id: SegmentId
    steps: Annotated[list[WantedStep], msgspec.Meta(max_length=10_000)]


class NewSegment(Message, frozen=True, tag="new_segment"):
    """Adds a segment without voxels, to be painted; undo removes it."""

    name: Name


class Paint(Message, frozen=True, tag="paint"):
    """Paints voxels of a segment along points, or erases them: a stroke until ``EndPaint``.

    The brush has a radius [mm]. It is a disc in the slice with this ``normal``, or a ball without
    one. Where ``values`` is given, only voxels with such values are changed.
    """

    id: SegmentId
    erases: bool
    points: Annotated[list[Vector], msgspec.Meta(min_length=1, max_length=64)]
    radius: Annotated[float, msgspec.Meta(gt=0.0, le=50.0)]
    normal: Vector | None
    values: tuple[Value, Value] | None


class EndPaint(Message, frozen=True, tag="end_paint"):
    """Ends a stroke of the brush as one step of undo, or undoes it where it is not kept."""

    keep: bool


class StopSegmentWork(Message, frozen=True, tag="stop_segment_work"):
    """Stops what ``SegmentWork`` reports and drops what is queued."""


class SegmentProperties(SegmentAppearance, Message, frozen=True, tag="segment_properties"):
    """Changes the appearance of a segment, and whether it is touchable and locked."""

    id: SegmentId
    name: Name
    touchable: bool
    locked: bool


class SegmentFeel(Message, frozen=True, tag="segment_feel"):
    """Changes the touch settings of a segment."""

    id: SegmentId
    feel: Feel


class MoveSegment(Message, frozen=True, tag="move_segment"):
    """Moves a segment to a pose; latest wins, and the servo moves it there smoothly.

    Moves of a drag that ``goes_on`` and the one that ends it are one step of undo.
    """

    id: SegmentId
    pose: Pose
    goes_on: bool


class Grab(Message, frozen=True, tag="grab"):
    """Attaches a segment to the probe, null releases it; others stop it where it ``collides``."""

    id: SegmentId | None
    collides: bool


class TurnGrabbed(Message, frozen=True, tag="turn_grabbed"):
    """Rotates the attached segment about the probe by a rotation vector [rad]."""

    rotation: Vector


class CutAlong(Message, frozen=True, tag="cut_along"):
    """Splits a segment along a line drawn on the picture, extruded away from the eye.

    ``line`` are points below it in front of the eye; ``view`` is the direction of view. A
    ``closed`` line connects its ends, an open one continues straight. The smaller part is a new
    segment; with ``preview`` nothing is changed, and ``CutPreview`` answers.
    """

    id: SegmentId
    line: Annotated[list[Vector], msgspec.Meta(min_length=2, max_length=1000)]
    eye: Vector
    view: Vector
    closed: bool
    preview: bool


class WatchGap(Message, frozen=True, tag="watch_gap"):
    """Starts measuring the gap between two segments while they move; null stops it."""

    pair: tuple[SegmentId, SegmentId] | None


class RemoveSegment(Message, frozen=True, tag="remove_segment"):
    """Removes a segment; undo restores it."""

    id: SegmentId
