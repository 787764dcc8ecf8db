"""Messages on the session as a whole: its start, its state, undo, recording."""

from __future__ import annotations

from typing import Annotated, Literal

import msgspec

from palpate.protocol.kept import KeptPart
from palpate.protocol.picture import Scan
from palpate.protocol.segments import MovedPose, Segment
from palpate.protocol.soft_tissue import DeformationModel, MaterialPreset, MatterState
from palpate.protocol.touch import DeviceLimits, NeedleState, Rates, Safety, Settings, ToolState
from palpate.protocol.types import Message, Vector

__all__ = [
    "Fence",
    "Hello",
    "Notice",
    "Offer",
    "Passed",
    "RecordSession",
    "Recover",
    "Recovery",
    "Redo",
    "State",
    "Undo",
]


class Hello(Message, frozen=True, tag="hello"):
    """First message of the engine: what the page needs to begin.

    ``kept`` is what is kept with the scan; ``defaults`` are the settings at the start of the
    session.
    """

    protocol: int
    version: str
    scan: Scan
    kept: list[KeptPart]
    segments: list[Segment]
    settings: Settings
    defaults: Settings
    device: str
    device_limits: DeviceLimits
    presets: list[MaterialPreset]
    models: list[DeformationModel]


class State(Message, frozen=True, tag="state"):
    """Current state, about 60 times a second; latest wins.

    ``samples`` are the ticks since the last state, thinned to at most 250 a second: rows (time,
    force x, force y, force z). ``contact_point`` is the origin of the force on the smooth surface,
    near ``proxy``, which never is in a solid voxel; ``normal`` points outward there, and is zero
    without contact. ``probe_radius`` is the current radius of the probe [mm]: less than in the
    settings where there is no room for it. ``poses`` are the current poses of moved segments,
    ``grabbed`` the segment attached to the probe, 0 for none. ``clutched`` says that the device
    moves without the probe, ``device_origin`` is the centre of its workspace. ``step`` counts the
    steps of undo that are done, including one in progress. ``steps_made`` counts all completed
    steps since the start; where it increases, undone ones are discarded. ``recording`` is the
    length of the current recording [s].
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
    step: int
    steps_made: int
    tool: ToolState
    needle: NeedleState
    matter: MatterState
    rates: Rates
    safety: Safety
    recording: float | None
    samples: list[tuple[float, float, float, float]]


class Notice(Message, frozen=True, tag="notice"):
    """A message for the user."""

    level: Literal["info", "warning", "error"]
    text: str


class Offer(msgspec.Struct, frozen=True):
    """Changes of this scan that an earlier session left: their number, the time of the last.

    ``when`` is ISO 8601. ``lost_bytes`` is the number of damaged bytes at the end of their file.
    ``second`` is the name of the second scan that was shown.
    """

    steps: int
    when: str
    lost_bytes: int
    second: str | None


class Recovery(Message, frozen=True, tag="recovery"):
    """Changes that can be recovered; null once that is decided, or where there are none."""

    offer: Offer | None


class Passed(Message, frozen=True, tag="passed"):
    """Answer to a ``Fence``: everything that this page requested before it is done.

    Touch follows it from ``tick`` on. Thresholds, growing and changes of shape run in the
    background and may complete later.
    """

    number: int
    tick: int


class RecordSession(Message, frozen=True, tag="record"):
    """Starts recording every input of the servo, or stops it; the file is at ``/api/recording``."""

    on: bool


class Fence(Message, frozen=True, tag="fence"):
    """Requests an answer once all earlier requests of the page are done; ``number`` is returned."""

    number: Annotated[int, msgspec.Meta(ge=0)]


class Recover(Message, frozen=True, tag="recover"):
    """Recovers what an earlier session left, or keeps it aside and starts anew."""

    bring_back: bool


class Undo(Message, frozen=True, tag="undo"):
    """Undoes the last step."""


class Redo(Message, frozen=True, tag="redo"):
    """Redoes the last undone step."""
