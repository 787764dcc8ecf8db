"""Messages between engine and page: the one schema that both sides check.

Each message is one msgpack map with a ``type``. Points and vectors are (x, y, z) in the
scene frame, LPS [mm]; forces [N]; stiffness [N/mm]; times [s]. The TypeScript side
(``viewer/src/core/protocol.ts``) is generated from this module; a test fails where the
two differ.
"""

from __future__ import annotations

import msgspec

from palpate.protocol.engine_picture import (
    DrawnPicture,
    DrawPicture,
    LookLight,
    LookSecond,
    LookSegment,
    LookSurface,
    PictureFailed,
    PictureLook,
    PictureOver,
    PicturePart,
    PictureTaken,
    SeenFrom,
)
from palpate.protocol.kept import Keep, Kept, KeptPart
from palpate.protocol.outline import FillOutline, Outline, TraceLevel, Wire
from palpate.protocol.picture import (
    Changed,
    ChangedVoxels,
    FollowEdits,
    Histogram,
    Scan,
    SecondScan,
    SegmentSurface,
    SurfacePatch,
    ThresholdPreset,
)
from palpate.protocol.registration import (
    FoundRegistration,
    RedoRegistration,
    Register,
    Registration,
    RegistrationLevel,
    ShowRegistration,
    StopRegistration,
    UndoRegistration,
)
from palpate.protocol.segments import (
    ChangeGrown,
    ChangeShape,
    ChangeSteps,
    CropScan,
    CutAlong,
    CutPreview,
    EndGoing,
    EndGrown,
    EndPaint,
    Feel,
    FindTable,
    Gap,
    Grab,
    Grown,
    GrowSeeds,
    GrowSegment,
    Islands,
    MovedPose,
    MoveSegment,
    NewSegment,
    Otsu,
    Paint,
    RemoveFromScan,
    RemoveSegment,
    RemoveTable,
    Scissors,
    Segment,
    SegmentFeel,
    SegmentProperties,
    Segments,
    SegmentStep,
    SegmentSteps,
    SegmentWork,
    ShowIslands,
    ShownSegments,
    ShowScissors,
    ShowSegments,
    StopSegmentWork,
    SuggestTable,
    TableFound,
    TableSuggested,
    Threshold,
    TurnGrabbed,
    WantedStep,
    WatchGap,
)
from palpate.protocol.session import (
    Fence,
    Hello,
    Notice,
    Offer,
    Passed,
    RecordSession,
    Recover,
    Recovery,
    Redo,
    State,
    Undo,
)
from palpate.protocol.soft_tissue import (
    Boxes,
    Constants,
    DeformationModel,
    Displaced,
    Fading,
    MaterialPreset,
    MatterParts,
    MatterRegion,
    MatterState,
    ModelOptions,
    Prony,
    Range,
    SegmentMaterial,
    SetDeformation,
    SetForceSource,
    SetMaterial,
    SetRegions,
    Shares,
    ShowParts,
)
from palpate.protocol.touch import (
    ChangeSettings,
    ChangeTouchClip,
    Clutch,
    DeviceLimits,
    Hand,
    HandLed,
    Lift,
    NeedleDirection,
    NeedleEvent,
    NeedleEvents,
    NeedleState,
    Place,
    Press,
    Rate,
    Rates,
    Safety,
    Settings,
    SettingsChanged,
    Stroke,
    Tool,
    ToolState,
    TouchClipChanged,
    View,
    WithdrawNeedle,
)
from palpate.protocol.types import (
    BeforeOrAfter,
    Calibration,
    ClipPlanes,
    Colour,
    Coordinate,
    ForceSource,
    Friction,
    GridPlace,
    Index,
    KeptName,
    KeptValue,
    LightAmount,
    LinearColour,
    Message,
    ModelName,
    Motion,
    Name,
    NeedleEventKind,
    NodeCount,
    PointPair,
    Pose,
    RegistrationKind,
    RegistrationMetric,
    RegistrationStart,
    SegmentId,
    ShapeKind,
    Share,
    ShownAs,
    SmoothingDegree,
    StepKind,
    Stiffness,
    SurfaceSource,
    TissueName,
    ToolKind,
    Treatment,
    Value,
    Vector,
)

__all__ = [
    "PROTOCOL_VERSION",
    "BeforeOrAfter",
    "Boxes",
    "Calibration",
    "ChangeGrown",
    "ChangeSettings",
    "ChangeShape",
    "ChangeSteps",
    "ChangeTouchClip",
    "Changed",
    "ChangedVoxels",
    "ClipPlanes",
    "Clutch",
    "Colour",
    "Constants",
    "Coordinate",
    "CropScan",
    "CutAlong",
    "CutPreview",
    "DeformationModel",
    "DeviceLimits",
    "Displaced",
    "DrawPicture",
    "DrawnPicture",
    "EndGoing",
    "EndGrown",
    "EndPaint",
    "Fading",
    "Feel",
    "Fence",
    "FillOutline",
    "FindTable",
    "FollowEdits",
    "ForceSource",
    "FoundRegistration",
    "Friction",
    "FromPage",
    "Gap",
    "Grab",
    "GridPlace",
    "GrowSeeds",
    "GrowSegment",
    "Grown",
    "Hand",
    "HandLed",
    "Hello",
    "Histogram",
    "Index",
    "Islands",
    "Keep",
    "Kept",
    "KeptName",
    "KeptPart",
    "KeptValue",
    "Lift",
    "LightAmount",
    "LinearColour",
    "LookLight",
    "LookSecond",
    "LookSegment",
    "LookSurface",
    "MaterialPreset",
    "MatterParts",
    "MatterRegion",
    "MatterState",
    "Message",
    "ModelName",
    "ModelOptions",
    "Motion",
    "MoveSegment",
    "MovedPose",
    "Name",
    "NeedleDirection",
    "NeedleEvent",
    "NeedleEventKind",
    "NeedleEvents",
    "NeedleState",
    "NewSegment",
    "NodeCount",
    "Notice",
    "Offer",
    "Otsu",
    "Outline",
    "Paint",
    "Passed",
    "PictureFailed",
    "PictureLook",
    "PictureOver",
    "PicturePart",
    "PictureTaken",
    "Place",
    "PointPair",
    "Pose",
    "Press",
    "Prony",
    "Range",
    "Rate",
    "Rates",
    "RecordSession",
    "Recover",
    "Recovery",
    "Redo",
    "RedoRegistration",
    "Register",
    "Registration",
    "RegistrationKind",
    "RegistrationLevel",
    "RegistrationMetric",
    "RegistrationStart",
    "RemoveFromScan",
    "RemoveSegment",
    "RemoveTable",
    "Safety",
    "Scan",
    "Scissors",
    "SecondScan",
    "SeenFrom",
    "Segment",
    "SegmentFeel",
    "SegmentId",
    "SegmentMaterial",
    "SegmentProperties",
    "SegmentStep",
    "SegmentSteps",
    "SegmentSurface",
    "SegmentWork",
    "Segments",
    "SetDeformation",
    "SetForceSource",
    "SetMaterial",
    "SetRegions",
    "Settings",
    "SettingsChanged",
    "ShapeKind",
    "Share",
    "Shares",
    "ShowIslands",
    "ShowParts",
    "ShowRegistration",
    "ShowScissors",
    "ShowSegments",
    "ShownAs",
    "ShownSegments",
    "SmoothingDegree",
    "State",
    "StepKind",
    "Stiffness",
    "StopRegistration",
    "StopSegmentWork",
    "Stroke",
    "SuggestTable",
    "SurfacePatch",
    "SurfaceSource",
    "TableFound",
    "TableSuggested",
    "Threshold",
    "ThresholdPreset",
    "TissueName",
    "ToPage",
    "Tool",
    "ToolKind",
    "ToolState",
    "TouchClipChanged",
    "TraceLevel",
    "Treatment",
    "TurnGrabbed",
    "Undo",
    "UndoRegistration",
    "Value",
    "Vector",
    "View",
    "WantedStep",
    "WatchGap",
    "Wire",
    "WithdrawNeedle",
    "decode_from_page",
    "encode_to_page",
]

PROTOCOL_VERSION = 1

ToPage = (
    Hello
    | State
    | Segments
    | Changed
    | MatterParts
    | SettingsChanged
    | TouchClipChanged
    | HandLed
    | Recovery
    | Notice
    | Kept
    | Gap
    | Outline
    | DrawnPicture
    | PicturePart
    | PictureFailed
    | CutPreview
    | NeedleEvents
    | SegmentWork
    | Grown
    | Islands
    | Scissors
    | TableFound
    | TableSuggested
    | SecondScan
    | Registration
    | Passed
)

FromPage = (
    Hand
    | Press
    | Lift
    | Place
    | View
    | PictureLook
    | DrawPicture
    | PictureTaken
    | Clutch
    | Threshold
    | Otsu
    | GrowSegment
    | ChangeGrown
    | EndGrown
    | GrowSeeds
    | ChangeShape
    | ShowIslands
    | ShowScissors
    | EndGoing
    | ChangeSteps
    | StopSegmentWork
    | FindTable
    | SuggestTable
    | RemoveTable
    | RemoveFromScan
    | CropScan
    | Register
    | StopRegistration
    | ShowRegistration
    | UndoRegistration
    | RedoRegistration
    | NewSegment
    | Paint
    | EndPaint
    | Wire
    | TraceLevel
    | FillOutline
    | SegmentProperties
    | ShowSegments
    | SegmentFeel
    | SetMaterial
    | SetRegions
    | SetDeformation
    | SetForceSource
    | ShowParts
    | MoveSegment
    | Grab
    | TurnGrabbed
    | CutAlong
    | WatchGap
    | FollowEdits
    | RecordSession
    | RemoveSegment
    | ChangeSettings
    | ChangeTouchClip
    | Fence
    | Tool
    | NeedleDirection
    | WithdrawNeedle
    | Stroke
    | Recover
    | Keep
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
