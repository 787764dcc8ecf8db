"""Messages on the session as a whole: its beginning, its state, undo, recording."""

from __future__ import annotations

from typing import Annotated, Literal

import msgspec

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
    its workspace. ``step`` counts the steps of undo that were made, less those that were taken
    back; one that is not ended counts. ``steps_made`` counts those that were made and ended, ever:
    where it rises, undone ones are forgotten. ``recording`` says since how long every input of the
    servo is kept [s].
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
    """A sentence for the person at the page."""

    level: Literal["info", "warning", "error"]
    text: str


class Offer(msgspec.Struct, frozen=True):
    """Changes of this scan that an earlier session left: how many, when the last (ISO 8601).

    ``lost_bytes`` at the end of their file are not whole. ``second``: name of the second scan that
    was shown.
    """

    steps: int
    when: str
    lost_bytes: int
    second: str | None


class Recovery(Message, frozen=True, tag="recovery"):
    """What can be brought back; null once somebody has decided, or where there is nothing."""

    offer: Offer | None


class Passed(Message, frozen=True, tag="passed"):
    """The answer to a ``Fence``: all that this page asked for before it is done.

    Touch follows it from ``tick`` on. Thresholds, growing and changes of shape are made beside all
    others: they may come later.
    """

    number: int
    tick: int


class RecordSession(Message, frozen=True, tag="record"):
    """Begins to keep every input of the servo, or ends it: the file is at ``/api/recording``."""

    on: bool


class Fence(Message, frozen=True, tag="fence"):
    """Asks to be told when all is done that the page asked for before; ``number`` comes back."""

    number: Annotated[int, msgspec.Meta(ge=0)]


class Recover(Message, frozen=True, tag="recover"):
    """Brings back what an earlier session left, or keeps it aside and starts afresh."""

    bring_back: bool


class Undo(Message, frozen=True, tag="undo"):
    """Takes the last edit back."""


class Redo(Message, frozen=True, tag="redo"):
    """Applies the last undone edit again."""
