"""The columns of recordings: ticks, and what else a replay needs.

Points and forces have shape [count, 3], quaternions [count, 4], bricks one row each; other columns
have shape [count]. Points are in the scene, LPS [mm]; forces [N] in scene axes; times [s] since the
session's start. Columns that end in ``_in_device`` are in the device's own frame.
"""

from __future__ import annotations

from typing import Any, Literal, TypedDict, cast

import numpy as np
from numpy.typing import NDArray

__all__ = [
    "SINCE_3",
    "SINCE_4",
    "TAPE",
    "TICKS",
    "Columns",
    "ReplayResult",
    "TapeColumns",
    "TickColumns",
    "by_name",
]

Columns = dict[str, NDArray[Any]]
"""Columns by name, where all of them are treated alike."""

Naturals = NDArray[np.uint64]
Counts = NDArray[np.uint32]
Bytes = NDArray[np.uint8]
Stored = NDArray[np.int16]
Reals = NDArray[np.float64]
Flags = NDArray[np.bool_]


class TickColumns(TypedDict):
    """One row for each tick."""

    tick: Naturals
    """Number of the tick."""
    time: Reals
    """[s]."""
    device: Reals
    """Position of the device."""
    hand: Reals
    """Position of the hand that pulls it."""
    proxy: Reals
    """Position of the probe."""
    force: Reals
    """Contact force, before the safety stage."""
    sent_force: Reals
    """Force sent last when the tick began: that of one or two ticks before."""
    contact: Flags
    """Whether an obstacle stops the probe."""
    touched: Bytes
    """Segment in contact; 0 for none."""
    tool_volume: Reals
    """Volume changed in the stroke [mm³]."""
    tool_time: Reals
    """Time of the tool at work in the stroke [s]."""
    tool_load: Reals
    """Power of the drill [mW]."""
    command: Naturals
    """Number of the last command that was followed."""
    reading: Naturals
    """Number of the reading of the device."""
    read_at: Reals
    """When it was read [s]."""
    position_in_device: Reals
    velocity_in_device: Reals
    orientation: Reals
    """Of the handle, a quaternion x, y, z, w."""
    buttons: Counts
    """Pressed buttons, one bit each."""
    hand_target: Reals
    """Where the hand was asked to go."""
    hand_number: Naturals
    """Number of that request."""
    has_room: Flags
    """Whether the recorder could keep up."""


class TapeColumns(TypedDict):
    """What a replay needs beside the ticks: the state at the start, commands and changed bricks."""

    start: Bytes
    commands: Bytes
    command_ends: Naturals
    brick_ends: Naturals
    brick_segment: Bytes
    brick_index: Counts
    brick_words: Naturals
    solid_segment: Bytes
    solid_index: Counts
    solid_words: Naturals
    value_index: Counts
    value_stored: Stored
    share_ends: Naturals
    share_segment: Bytes
    share_index: Counts
    share_bytes: Bytes
    known_segment: Bytes
    known_index: Counts
    known_bytes: Bytes


class ReplayResult(TypedDict):
    """What a replay of a recording computed."""

    ticks: TickColumns
    first_row: int
    """Where in the recording the computed ticks begin."""
    recorded_hash: int
    replayed_hash: int
    different: int
    """Ticks that differ."""
    first_difference: tuple[int, float, float, float] | None
    """Tick, time [s], distance of the probes [mm] and of the forces [N]."""
    end: tuple[Literal["whole", "lost", "commands"], int, int]
    """Why the replay ended, after which tick, and how many ticks were lost."""


def by_name(columns: TickColumns | TapeColumns) -> Columns:
    """Returns the same columns, for access by names that are known at run time only."""
    return cast("Columns", columns)


TICKS: dict[str, tuple[str, int]] = {
    "tick": ("<u8", 0),
    "time": ("<f8", 0),
    "device": ("<f8", 3),
    "hand": ("<f8", 3),
    "proxy": ("<f8", 3),
    "force": ("<f8", 3),
    "sent_force": ("<f8", 3),
    "contact": ("|b1", 0),
    "touched": ("|u1", 0),
    "tool_volume": ("<f8", 0),
    "tool_time": ("<f8", 0),
    "tool_load": ("<f8", 0),
    "command": ("<u8", 0),
    "reading": ("<u8", 0),
    "read_at": ("<f8", 0),
    "position_in_device": ("<f8", 3),
    "velocity_in_device": ("<f8", 3),
    "orientation": ("<f8", 4),
    "buttons": ("<u4", 0),
    "hand_target": ("<f8", 3),
    "hand_number": ("<u8", 0),
    "has_room": ("|b1", 0),
}
"""Columns of the ticks: NumPy's name of the type, and numbers in a row; 0 for shape [count]."""

SINCE_3 = ("tool_volume", "tool_time", "tool_load")
"""Columns of ticks that were added in version 3 of the file."""

TAPE: dict[str, tuple[str, int]] = {
    "start": ("|u1", 0),
    "commands": ("|u1", 0),
    "command_ends": ("<u8", 0),
    "brick_ends": ("<u8", 0),
    "brick_segment": ("|u1", 0),
    "brick_index": ("<u4", 0),
    "brick_words": ("<u8", 8),
    "solid_segment": ("|u1", 0),
    "solid_index": ("<u4", 0),
    "solid_words": ("<u8", 8),
    "value_index": ("<u4", 0),
    "value_stored": ("<i2", 512),
    "share_ends": ("<u8", 0),
    "share_segment": ("|u1", 0),
    "share_index": ("<u4", 0),
    "share_bytes": ("|u1", 512),
    "known_segment": ("|u1", 0),
    "known_index": ("<u4", 0),
    "known_bytes": ("|u1", 512),
}
"""Columns of the tape, as ``TICKS``."""

SINCE_4 = tuple(name for name in TAPE if name.startswith(("share_", "known_")))
"""Columns of the tape that were added in version 4: occupancy fractions of masks."""
