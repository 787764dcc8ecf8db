"""Messages between engine and page: the one schema that both sides check.

Each message is one msgpack map with a ``type``. Points and vectors are (x, y, z) in the
scene frame, LPS [mm]; forces [N]; stiffness [N/mm]; times [s]. The TypeScript side
(``viewer/src/core/protocol.ts``) is generated from this module; a test fails where the
two differ.
"""

from __future__ import annotations

from typing import Annotated, Literal

import msgspec

__all__ = [
    "PROTOCOL_VERSION",
    "FromPage",
    "ToPage",
    "decode_from_page",
    "encode_to_page",
]

PROTOCOL_VERSION = 1

Coordinate = Annotated[float, msgspec.Meta(ge=-1e6, le=1e6)]
"""A number of a vector; the bounds keep NaN, infinity and absurd distances out."""

Vector = tuple[Coordinate, Coordinate, Coordinate]
"""x, y, z in the scene frame, LPS [mm]; forces [N]."""

Value = Annotated[float, msgspec.Meta(ge=-1e9, le=1e9)]
"""A value of the scan, in its unit; the bounds keep NaN and infinity out."""

Name = Annotated[str, msgspec.Meta(min_length=1, max_length=100)]
"""What a person calls a segment."""

SegmentId = Annotated[int, msgspec.Meta(ge=1, le=255)]
"""A segment's number; also its value in ``/api/labels``."""

Share = Annotated[float, msgspec.Meta(ge=0.0, le=1.0)]
"""A part of a whole, 0..1."""

Colour = tuple[Share, Share, Share]
"""Red, green, blue, sRGB, each 0..1."""

Stiffness = Annotated[float, msgspec.Meta(gt=0.0, le=10.0)]
"""Of the spring between probe and device [N/mm]."""

Friction = Annotated[float, msgspec.Meta(ge=0.0, le=2.0)]
"""A Coulomb coefficient."""

ShownAs = Literal["volume", "surface", "both"]
"""Whether a segment is drawn from its voxels, as a surface, or in both ways."""

SurfaceSource = Literal["intensities", "bits"]
"""What a surface is made from: the scan's values where a threshold made the segment, or bits."""

SmoothingDegree = Annotated[int, msgspec.Meta(ge=0, le=12)]
"""How often the vertices of a surface are moved to the mean of their neighbours."""

ShapeKind = Literal[
    "keep-largest",
    "drop-small",
    "fill-holes",
    "between-slices",
    "grow",
    "shrink",
    "smooth",
    "median",
    "open",
    "close",
    "hollow-inside",
    "hollow-outside",
    "unite",
    "subtract",
    "intersect",
]
"""How the shape of a segment is changed; see ``segmentation.changed_shape``."""

ToolKind = Literal["none", "eraser", "adder", "drill", "needle", "painter"]
"""What the probe does to voxels while it is pressed; none leaves them as they are."""

TissueName = Literal["skin", "fat", "muscle", "liver"]
"""What a segment is for a needle; bone is none of them, since no needle punctures it."""

NeedleEventKind = Literal["punctured", "crossed", "stopped", "withdrawn"]
"""What happens to a needle: it goes into a segment, comes into one that it has punctured or out of
all, comes to one that stops it, or is out."""

ModelName = Annotated[str, msgspec.Meta(min_length=1, max_length=40)]
"""A model of deformation."""

Index = Annotated[int, msgspec.Meta(ge=-(2**31), lt=2**31)]
"""A voxel's or a patch's place along one axis."""

NodeCount = Annotated[int, msgspec.Meta(ge=0, le=1024)]
"""Nodes of a box along one axis."""

GridPlace = tuple[Index, Index, Index]
"""A voxel or a patch of a grid, along x, y, z."""

Pose = Annotated[list[Coordinate], msgspec.Meta(min_length=16, max_length=16)]
"""A rigid transform of the scene, row-major, shape [4, 4], translation in mm."""


class Message(msgspec.Struct, frozen=True, forbid_unknown_fields=True, tag_field="type"):
    """Base of all messages: a map with its type's name under ``type``."""


# --- engine -> page -------------------------------------------------------------------


class Histogram(msgspec.Struct, frozen=True):
    """Counts of the scan's values in equal bins from ``low`` to ``high``."""

    low: Value
    high: Value
    counts: list[int]


class Scan(msgspec.Struct, frozen=True):
    """The scan on display; its values come by HTTP from ``/api/volume``.

    ``value = slope * stored + intercept``. ``patient_from_grid`` is row-major, shape
    [4, 4]; grid coordinates are in voxels, voxel (i, j, k) covers [i, i+1) on each axis.
    ``unit`` is "HU" only where it is known, else "".
    """

    name: str
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
    orientation_known: bool
    warnings: list[str]


class Feel(msgspec.Struct, frozen=True):
    """How the surface of a segment feels; null is as the settings of touch say."""

    stiffness: Stiffness | None
    friction_static: Friction | None
    friction_kinetic: Friction | None


class Constants(msgspec.Struct, frozen=True):
    """What matter is: ``young`` [Pa], ``poisson``, ``density`` [kg/m³], Coulomb ``friction``.

    Bonds break at ``breaking_strain``; null where none does.
    """

    young: Annotated[float, msgspec.Meta(ge=1.0, le=2e12)]
    poisson: Annotated[float, msgspec.Meta(gt=-1.0, lt=0.5)]
    density: Annotated[float, msgspec.Meta(ge=0.1, le=23_000.0)]
    breaking_strain: Annotated[float, msgspec.Meta(gt=0.0, le=1e6)] | None
    friction: Annotated[float, msgspec.Meta(ge=0.0, le=10.0)]


class SegmentMaterial(msgspec.Struct, frozen=True):
    """What a segment is made of: constants from ``low`` to ``high`` as they follow HU, or both.

    ``preset`` is its name; null where somebody chose the constants.
    """

    preset: Name | None
    low: Constants
    high: Constants


class Segment(msgspec.Struct, frozen=True):
    """A segment of the scan.

    ``range`` holds the threshold (low, high) while the segment is just that threshold;
    null where its voxels come from elsewhere: then they stand in ``/api/labels`` under
    the segment's ``id`` (1..255). ``made_by`` is the threshold that made it, whatever edits
    did since; null where none did. ``pose`` takes the segment from where the scan has it to
    where it stands; null where it was not moved. ``bounds`` are the voxels that hold it, half
    open; null where it is empty. ``material`` is null where it is hard. ``grid`` is the
    ``patient_from_grid`` of its voxels where they are not the scan's. ``opacity``,
    ``smoothing``, ``surface_from`` and ``wireframe`` are those of its surface.
    """

    id: SegmentId
    name: Name
    colour: Colour
    visible: bool
    touchable: bool
    range: tuple[Value, Value] | None
    made_by: tuple[Value, Value] | None
    voxels: int
    volume_ml: float
    pending: bool
    feel: Feel
    material: SegmentMaterial | None
    pose: Pose | None
    bounds: tuple[GridPlace, GridPlace] | None
    grid: Pose | None
    shown_as: ShownAs
    opacity: Share
    smoothing: SmoothingDegree
    surface_from: SurfaceSource
    wireframe: bool


class MovedPose(msgspec.Struct, frozen=True):
    """Where a moved segment stands by now: ``Segment.pose`` is where it was asked to go."""

    id: SegmentId
    pose: Pose


class Settings(msgspec.Struct, frozen=True):
    """What a person can set about touch; ``gain`` is scene mm per mm of the device."""

    model: Literal["exact", "thesis-original", "thesis-improved"]
    stiffness: Stiffness
    damping: Annotated[float, msgspec.Meta(ge=0.0, le=0.1)]
    friction_static: Friction
    friction_kinetic: Friction
    smoothing: Literal["intensities", "bits", "off"]
    probe_radius: Annotated[float, msgspec.Meta(ge=0.0, le=20.0)]
    force_limit: Annotated[float, msgspec.Meta(gt=0.0, le=40.0)]
    gain: Annotated[float, msgspec.Meta(ge=0.1, le=10.0)]


class Rate(msgspec.Struct, frozen=True):
    """How a thread keeps its pace over the last second.

    ``late`` counts ticks since the start that began more than 2 ms after their time.
    """

    asked_hz: float
    hz: float
    ticks: int
    late: int
    worst_late_ms: float


class Rates(msgspec.Struct, frozen=True):
    """One rate per thread; ``real_time`` says whether the priority was granted."""

    device: Rate
    servo: Rate
    simulation: Rate
    picture: Rate
    real_time: bool


class Safety(msgspec.Struct, frozen=True):
    """Interventions of the safety stage and violations of the guarantees since start.

    ``force`` says what stands between the contact and the hand now: "on" where nothing does;
    ``off`` why no force is sent, and nothing while forces are.
    """

    clamped: int
    slewed: int
    not_finite: int
    ramped: int
    waited: int
    eased: int
    damped: int
    watchdog: int
    violations: int
    force: Literal["on", "waiting", "ramping", "easing", "off"]
    off: Literal["not-started", "waiting", "servo-late", "stopped", "not-finite"] | None


class ToolState(msgspec.Struct, frozen=True):
    """The tool in the hand, and what it did in the stroke that is on, or in the last one.

    ``radius`` is that of its ball [mm]; ``voxels`` and ``volume`` [mm³] are what it changed,
    ``time`` how long it was at work [s], ``energy`` the work done on matter [mJ], ``load`` the
    power of this moment [mW]. Undo and redo hold on to ``undo_bytes``, at most ``undo_budget``.
    """

    kind: ToolKind
    radius: float
    on: bool
    voxels: int
    volume: float
    time: float
    energy: float
    load: float
    undo_bytes: int
    undo_budget: int


class NeedleState(msgspec.Struct, frozen=True):
    """A needle, where it is the tool in the hand or still in.

    ``depth`` is how far its tip is from where it went in [mm], ``segment`` the one at the tip, 0
    for none. ``tip`` and ``friction`` are the forces at tip and shaft, ``wall`` that of what no
    needle punctures [N]. ``events`` counts what ``NeedleEvents`` tells.
    """

    inside: bool
    depth: float
    segment: int
    tip: float
    friction: float
    wall: float
    events: int


class MaterialPreset(msgspec.Struct, frozen=True):
    """A material with a name, and where its constants are from.

    One that ``needs_hounsfield`` is for CT only: its constants go from ``low`` to ``high``.
    """

    name: Name
    source: str
    needs_hounsfield: bool
    low: Constants
    high: Constants


class Boxes(msgspec.Struct, frozen=True):
    """Boxes that a model can have, by the nodes or cells along each edge; these are odd."""

    least: int
    usual: int
    most: int


class DeformationModel(msgspec.Struct, frozen=True):
    """A model by which matter gives way; ``boxes`` is null where it takes all matter."""

    name: ModelName
    boxes: Boxes | None


class MatterState(msgspec.Struct, frozen=True):
    """Matter that gives way: ``model`` is the one at work, null where all is hard.

    ``edge`` counts nodes or cells along each edge of its box, null for as many as usual.
    ``force`` is that of the matter on the tool [N, scene], ``answers`` counts the model's answers.
    While the next one is ``late``, matter is as hard as its voxels. ``nodes`` take part in the
    last answer; since the start ``bonds_broken`` bonds broke, which took ``work_broken`` [mJ].
    """

    model: ModelName | None
    edge: int | None
    force: Vector
    answers: int
    late: bool
    nodes: int
    bonds_broken: int
    work_broken: Annotated[float, msgspec.Meta(ge=0.0)]


class DeviceLimits(msgspec.Struct, frozen=True):
    """What a device bears: settings that ask for more are cut to it.

    ``reach`` is how far it comes from the middle of its workspace [device mm].
    """

    stiffness: Stiffness
    force: float
    reach: float


class Hello(Message, frozen=True, tag="hello"):
    """First message of the engine: everything the page needs to draw.

    ``defaults`` are the settings that the session was started with.
    """

    protocol: int
    version: str
    scan: Scan
    segments: list[Segment]
    settings: Settings
    defaults: Settings
    device: str
    device_limits: DeviceLimits
    presets: list[MaterialPreset]
    models: list[DeformationModel]


class State(Message, frozen=True, tag="state"):
    """What is now, some 60 times a second, latest wins.

    ``samples`` holds the ticks since the last state, thinned to at most 250 a second:
    rows (time, force x, force y, force z). ``contact_point`` is where the force comes from:
    on the smooth surface, beside ``proxy``, which no solid voxel holds; ``normal`` points out
    of the surface there, and is zero without contact. ``probe_radius`` is what the probe has
    [mm]: less than the settings' where there is no room for it. ``poses`` says where moved
    segments stand by now, ``grabbed`` which segment is in the hand, 0 for none.
    ``clutched`` says that the device moves without the probe, ``device_origin`` is the middle of
    its workspace. ``recording`` says since how
    long every input of the servo is kept [s].
    """

    tick: int
    time: float
    edit: int
    device: Vector
    hand: Vector
    proxy: Vector
    contact_point: Vector
    normal: Vector
    force: Vector
    contact: bool
    depth: float
    touched: int
    probe_radius: float
    poses: list[MovedPose]
    grabbed: int
    clutched: bool
    device_origin: Vector
    pending: int
    can_undo: bool
    can_redo: bool
    tool: ToolState
    needle: NeedleState
    matter: MatterState
    rates: Rates
    safety: Safety
    recording: float | None
    samples: list[tuple[float, float, float, float]]


class Segments(Message, frozen=True, tag="segments"):
    """The segment list after a change; ``labels`` is the version of ``/api/labels``."""

    segments: list[Segment]
    labels: int


class NeedleEvent(msgspec.Struct, frozen=True):
    """What happened to a needle at a time [s], in a segment, 0 for none.

    ``depth`` is from where it went in [mm], ``force`` that at its tip [N].
    """

    kind: NeedleEventKind
    segment: int
    time: float
    depth: float
    force: float


class NeedleEvents(Message, frozen=True, tag="needle_events"):
    """What happened to the needle since it was taken in the hand, oldest first, the newest 100."""

    events: list[NeedleEvent]


class SurfacePatch(msgspec.Struct, frozen=True):
    """One patch of a segment's surface, where the scan has the segment (before its pose).

    ``index`` is its place in the grid of patches. ``origin`` is the lower corner and ``size``
    the edges of the box that its vertices lie in: position = origin + u16 / 65535 * size.

    ``vertices`` are x, y, z as little-endian uint16 each; ``normals`` x, y, z and a byte that
    means nothing as int8 each, unit = int8 / 127; ``triangles`` three vertex numbers each,
    little-endian uint16, or uint32 where there are more than 65536 vertices, counter-clockwise
    as seen from outside.
    """

    index: GridPlace
    origin: Vector
    size: Vector
    vertices: bytes
    normals: bytes
    triangles: bytes


class SegmentSurface(msgspec.Struct, frozen=True):
    """What changes in the surface of a segment: patches that are new or gone.

    ``whole`` forgets all patches that were sent before.
    """

    id: SegmentId
    whole: bool
    dropped: list[GridPlace]
    patches: list[SurfacePatch]


class ChangedVoxels(msgspec.Struct, frozen=True):
    """A box of voxels, from ``low`` up to, but without, ``high``, as they are now.

    ``stored`` holds their stored values as little-endian int16, ``labels`` the number of each
    voxel's segment as uint8, both with x fastest; null where they stay as they are.
    """

    low: GridPlace
    high: GridPlace
    stored: bytes | None
    labels: bytes | None


class Displaced(msgspec.Struct, frozen=True):
    """Where matter stands beside the voxels that show it, at the nodes of a box.

    Node (i, j, k) is at ``origin + step * (i, j, k)`` [grid], and ``size`` counts nodes along each
    axis, 0 where all matter stands in its voxels. ``moved`` holds how far the matter of each node
    stands from it as little-endian float16: x, y, z along the axes of the grid [mm] and a zero,
    nodes with x fastest.
    """

    origin: Vector
    step: Vector
    size: tuple[NodeCount, NodeCount, NodeCount]
    moved: bytes


class Changed(Message, frozen=True, tag="changed"):
    """All that edits up to number ``edit`` change in the picture, shown in one and the same frame.

    Boxes of voxels are in the order of their edits: of two that overlap, the later one holds.
    ``applied`` is when the oldest of these edits was applied [s since 1970]; null without one.
    ``displaced`` goes with the voxels as they are then; null where it is as before.
    """

    edit: int
    applied: float | None
    voxels: list[ChangedVoxels]
    surfaces: list[SegmentSurface]
    displaced: Displaced | None = None


class MatterParts(Message, frozen=True, tag="matter_parts"):
    """The nodes or particles of the model at work, where this page asked for them; latest wins.

    ``places`` are x, y, z as little-endian uint16 each: place = origin + number / 65535 * size
    [scene]. ``strains`` are an int8 each: strain = number / 127 * 0.5, less than zero where matter
    is pressed. ``apart`` is the distance of neighbours at rest [mm].
    """

    origin: Vector
    size: Vector
    apart: Annotated[float, msgspec.Meta(gt=0.0)]
    places: bytes
    strains: bytes


class SettingsChanged(Message, frozen=True, tag="settings_changed"):
    """The settings as the engine holds them."""

    settings: Settings


class Notice(Message, frozen=True, tag="notice"):
    """A sentence for the person at the page."""

    level: Literal["info", "warning", "error"]
    text: str


class Offer(msgspec.Struct, frozen=True):
    """Changes of this scan that an earlier session left: how many, when the last (ISO 8601).

    ``lost_bytes`` at the end of their file are not whole.
    """

    steps: int
    when: str
    lost_bytes: int


class Recovery(Message, frozen=True, tag="recovery"):
    """What can be brought back; null once somebody has decided, or where there is nothing."""

    offer: Offer | None


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


class SecondScan(Message, frozen=True, tag="second_scan"):
    """A scan that is shown with the first; null where there is none any more.

    ``second_from_first`` maps points of the first scan to the second's, row-major, shape [4, 4],
    patient of each [mm]; its values come from ``/api/second`` and are others with each ``version``.
    """

    scan: Scan | None
    second_from_first: list[float]
    version: int


class Outline(Message, frozen=True, tag="outline"):
    """The answer to a ``Wire`` or ``TraceLevel`` of this number, to the page that asked.

    A level's outline is closed, its last point joined to the first. Without points there is none,
    for the reason that ``problem`` tells.
    """

    number: int
    points: list[Vector]
    problem: str | None


class Passed(Message, frozen=True, tag="passed"):
    """The answer to a ``Fence``: all that this page asked for before it is done.

    Touch follows it from ``tick`` on. Thresholds, growing and changes of shape are made beside all
    others: they may come later.
    """

    number: int
    tick: int


ToPage = (
    Hello
    | State
    | Segments
    | Changed
    | MatterParts
    | SettingsChanged
    | Recovery
    | Notice
    | Gap
    | Outline
    | CutPreview
    | NeedleEvents
    | SegmentWork
    | SecondScan
    | Passed
)

# --- page -> engine -------------------------------------------------------------------


class Hand(Message, frozen=True, tag="hand"):
    """Where the hand pulls the device to [scene]; latest wins."""

    target: Vector


class Place(Message, frozen=True, tag="place"):
    """Puts probe, device and hand at a point, or at the free voxel next to it."""

    point: Vector


class View(Message, frozen=True, tag="view"):
    """Axes of the view in the scene: the movement frame follows them (thesis 4.7)."""

    right: Vector
    up: Vector


class Clutch(Message, frozen=True, tag="clutch"):
    """Has the device move without the probe, or with it again."""

    on: bool


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


class Wire(Message, frozen=True, tag="wire"):
    """Asks for the path along edges of a slice from one point to another; see ``Outline``."""

    number: Annotated[int, msgspec.Meta(ge=0)]
    begin: Vector
    end: Vector
    normal: Vector


class TraceLevel(Message, frozen=True, tag="trace_level"):
    """Asks for the outline of the value at a point of a slice, through it; see ``Outline``."""

    number: Annotated[int, msgspec.Meta(ge=0)]
    point: Vector
    normal: Vector


class FillOutline(Message, frozen=True, tag="fill_outline"):
    """Paints what an outline in a slice encloses, or takes it away: one step of undo.

    Only voxels with such ``values`` are changed, where these are given.
    """

    id: SegmentId
    erases: bool
    points: Annotated[list[Vector], msgspec.Meta(min_length=3, max_length=50_000)]
    normal: Vector
    values: tuple[Value, Value] | None


class EndPaint(Message, frozen=True, tag="end_paint"):
    """Ends a stroke of the brush as one step of undo, or takes it back where it is not kept."""

    keep: bool


class StopSegmentWork(Message, frozen=True, tag="stop_segment_work"):
    """Stops what ``SegmentWork`` tells of and forgets what waits; what is not done is not begun."""


class SegmentProperties(Message, frozen=True, tag="segment_properties"):
    """Changes how a segment looks and whether it can be touched."""

    id: SegmentId
    name: Name
    colour: Colour
    visible: bool
    touchable: bool
    shown_as: ShownAs
    opacity: Share
    smoothing: SmoothingDegree
    surface_from: SurfaceSource
    wireframe: bool


class SegmentFeel(Message, frozen=True, tag="segment_feel"):
    """Changes how the surface of a segment feels."""

    id: SegmentId
    feel: Feel


class SetMaterial(Message, frozen=True, tag="set_material"):
    """Tells what a segment is made of, by name or by constants; with neither it is hard.

    Undo takes it back where it is ``undoable``: what a page asks for by itself is not.
    """

    id: SegmentId
    preset: Name | None
    constants: Constants | None
    undoable: bool


class SetDeformation(Message, frozen=True, tag="set_deformation"):
    """Chooses the model by which matter gives way, null makes all hard, and the edge of its box.

    The edge counts nodes or cells; null is as many as usual. Undo takes the choice back where it is
    ``undoable``.
    """

    model: ModelName | None
    edge: Annotated[int, msgspec.Meta(ge=1, le=1001)] | None
    undoable: bool


class ShowParts(Message, frozen=True, tag="show_parts"):
    """Has this page told the nodes or particles of the model, or no more."""

    on: bool


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


class FollowEdits(Message, frozen=True, tag="follow_edits"):
    """Has the picture follow edits every so many-th of its frames, of 60 a second.

    Edits in between are shown together. The slowest of several pages sets the pace.
    """

    every: Annotated[int, msgspec.Meta(ge=1, le=4)]


class RecordSession(Message, frozen=True, tag="record"):
    """Begins to keep every input of the servo, or ends it: the file is at ``/api/recording``."""

    on: bool


class RemoveSegment(Message, frozen=True, tag="remove_segment"):
    """Removes a segment; undo brings it back."""

    id: SegmentId


class ChangeSettings(Message, frozen=True, tag="change_settings"):
    """Asks for new settings."""

    settings: Settings


class Fence(Message, frozen=True, tag="fence"):
    """Asks to be told when all is done that the page asked for before; ``number`` comes back."""

    number: Annotated[int, msgspec.Meta(ge=0)]


class Tool(Message, frozen=True, tag="tool"):
    """Chooses the tool for the next strokes: the radius of its ball [mm], and what it changes.

    Of a needle the radius is its own, and ``tissues`` say what each of its segments is. A painter
    gives what is touched of the segments to the first of them, so ``depth`` below the surface [mm],
    or in all of its ball; what is painted stays in its segment, too, where it ``overlaps``.
    """

    kind: ToolKind
    radius: Annotated[float, msgspec.Meta(gt=0.0, le=50.0)]
    segments: list[SegmentId]
    tissues: list[TissueName] = []
    depth: Annotated[float, msgspec.Meta(gt=0.0, le=50.0)] | None = None
    overlaps: bool = False


class WithdrawNeedle(Message, frozen=True, tag="withdraw_needle"):
    """Takes the needle out on the way that it went in."""


class Stroke(Message, frozen=True, tag="stroke"):
    """Begins a stroke of the tool, or ends it: what it changed is one step of undo."""

    on: bool


class Recover(Message, frozen=True, tag="recover"):
    """Brings back what an earlier session left, or keeps it aside and starts afresh."""

    bring_back: bool


class Undo(Message, frozen=True, tag="undo"):
    """Takes the last edit back."""


class Redo(Message, frozen=True, tag="redo"):
    """Applies the last undone edit again."""


FromPage = (
    Hand
    | Place
    | View
    | Clutch
    | Threshold
    | Otsu
    | GrowSegment
    | GrowSeeds
    | ChangeShape
    | StopSegmentWork
    | NewSegment
    | Paint
    | EndPaint
    | Wire
    | TraceLevel
    | FillOutline
    | SegmentProperties
    | SegmentFeel
    | SetMaterial
    | SetDeformation
    | ShowParts
    | MoveSegment
    | Grab
    | TurnGrabbed
    | CutSegment
    | CutAlong
    | WatchGap
    | FollowEdits
    | RecordSession
    | RemoveSegment
    | ChangeSettings
    | Fence
    | Tool
    | WithdrawNeedle
    | Stroke
    | Recover
    | Undo
    | Redo
)

_encoder = msgspec.msgpack.Encoder()
_decoder: msgspec.msgpack.Decoder[FromPage] = msgspec.msgpack.Decoder(FromPage)


def encode_to_page(message: ToPage) -> bytes:
    """Packs a message for the page."""
    return _encoder.encode(message)


def decode_from_page(packed: bytes) -> FromPage:
    """Unpacks a message of the page.

    Raises:
        msgspec.DecodeError: The bytes are not msgpack, or the message is not of the schema.
    """
    try:
        return _decoder.decode(packed)
    except UnicodeDecodeError as error:
        raise msgspec.DecodeError(str(error)) from None
