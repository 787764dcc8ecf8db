"""Recordings of sessions, tick by tick: stored, replayed, and written as tables.

Points are in the scene, LPS [mm]; forces [N] in scene axes; times [s] since the session's start.
Columns that end in ``_in_device`` are in the device's own frame.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from os import PathLike
from pathlib import Path
from typing import Self

import msgspec
import numpy as np
from numpy.typing import NDArray

from palpate import _core
from palpate.base.errors import OptionError, RecordingFormatError
from palpate.session.recording_columns import TapeColumns, TickColumns
from palpate.session.recording_file import About, read_file, write_file
from palpate.session.recording_table import write_csv, write_npz

__all__ = ["Recording", "Replay"]

EVENTS = {
    "Root": "segments",
    "Bricks": "edit",
    "Place": "place",
    "Turn": "view",
    "Settings": "settings",
    "Feel": "feel",
    "Pose": "move",
    "Mark": "recording",
}
"""Names for users of the engine's commands; others keep their own name."""


@dataclass(frozen=True)
class Replay:
    """Result of replaying a recording."""

    first_tick: int
    """Number of the first replayed tick."""
    ticks: int
    """Number of replayed ticks."""
    seconds: float
    """Duration of the replayed ticks [s]."""
    recorded_hash: str
    """Hash of the recorded ticks: 16 hexadecimal digits over the bits of every probe and force."""
    replayed_hash: str
    """Hash of the replayed ticks."""
    different: int
    """Number of ticks that differ in any bit."""
    first_difference: dict[str, float] | None
    """The first of them: ``tick``, ``time`` [s], and differences of ``probe`` [mm] and ``force``
    [N]."""
    stopped: str
    """Why the replay ended before the recording; "" where it did not."""
    same_build: bool
    """Whether the same build recorded it; another build may compute other bits."""
    positions: NDArray[np.float64]
    """Replayed positions of the probe, shape [ticks, 3]."""
    forces: NDArray[np.float64]
    """Replayed contact forces, shape [ticks, 3]."""

    @property
    def is_equal(self) -> bool:
        """Whether every replayed tick equals the recorded one bit for bit."""
        return self.different == 0


class Recording:
    """All ticks of a period of a session, one row for each tick."""

    def __init__(
        self,
        columns: TickColumns,
        *,
        tape: TapeColumns | None = None,
        about: About | None = None,
    ) -> None:
        """Takes columns as the engine or a file provides them.

        Args:
            columns: The ticks.
            tape: What else a replay needs.
            about: Origin of the recording.
        """
        self.columns = columns
        self.about = about
        self._tape = tape

    def __len__(self) -> int:
        return len(self.ticks)

    def __repr__(self) -> str:
        return f"<Recording: {len(self)} ticks in {self.seconds:g} s>"

    # --- columns --------------------------------------------------------------------------

    @property
    def ticks(self) -> NDArray[np.uint64]:
        """Numbers of the ticks, shape [count]."""
        return self.columns["tick"]

    @property
    def times(self) -> NDArray[np.float64]:
        """Times since the session's start [s], shape [count]."""
        return self.columns["time"]

    @property
    def devices(self) -> NDArray[np.float64]:
        """Positions of the device, shape [count, 3]."""
        return self.columns["device"]

    @property
    def hands(self) -> NDArray[np.float64]:
        """Positions of the hand that pulls the device, shape [count, 3]."""
        return self.columns["hand"]

    @property
    def positions(self) -> NDArray[np.float64]:
        """Positions of the probe, shape [count, 3]."""
        return self.columns["proxy"]

    @property
    def forces(self) -> NDArray[np.float64]:
        """Contact forces, before the safety stage, shape [count, 3]."""
        return self.columns["force"]

    @property
    def sent_forces(self) -> NDArray[np.float64]:
        """Forces sent to the device, shape [count, 3]."""
        return self.columns["sent_force"]

    @property
    def contacts(self) -> NDArray[np.bool_]:
        """Whether an obstacle stopped the probe, shape [count]."""
        return self.columns["contact"]

    @property
    def touched(self) -> NDArray[np.uint8]:
        """Numbers of the touched segments, some milliseconds late; 0 for none; shape [count]."""
        return self.columns["touched"]

    @property
    def tool_volumes(self) -> NDArray[np.float64]:
        """Volume that the tool has changed in the current stroke [mm³], shape [count]."""
        return self.columns["tool_volume"]

    @property
    def tool_times(self) -> NDArray[np.float64]:
        """Time at work of the tool in the current stroke [s], shape [count]."""
        return self.columns["tool_time"]

    @property
    def tool_loads(self) -> NDArray[np.float64]:
        """Power of the drill [N mm/s], 0 where it rests, shape [count]."""
        return self.columns["tool_load"]

    # --- figures --------------------------------------------------------------------------

    @property
    def depths(self) -> NDArray[np.float64]:
        """Distances of device and probe [mm], shape [count]."""
        lengths: NDArray[np.float64] = np.linalg.norm(self.devices - self.positions, axis=1)
        return lengths

    @property
    def seconds(self) -> float:
        """Duration from the first tick to the last [s]."""
        return float(self.times[-1] - self.times[0]) if len(self) else 0.0

    @property
    def contact_share(self) -> float:
        """Fraction of the ticks in contact, 0 to 1."""
        return float(self.contacts.mean()) if len(self) else 0.0

    @property
    def largest_force(self) -> float:
        """Largest contact force, before the safety stage [N]."""
        return float(np.linalg.norm(self.forces, axis=1).max()) if len(self) else 0.0

    @property
    def lost(self) -> int:
        """Number of ticks missing between the first and the last."""
        return int(self.ticks[-1] - self.ticks[0]) + 1 - len(self) if len(self) else 0

    @property
    def can_be_replayed(self) -> bool:
        """Whether it holds what a replay needs, from some tick on."""
        return self._tape is not None

    @cached_property
    def events(self) -> list[str]:
        """Events of each tick beside touch: commands, and ticks lost before it; "" for none."""
        said: dict[int, list[str]] = {}
        steps = np.diff(self.ticks.astype(np.int64))
        for before in np.flatnonzero(steps > 1).tolist():
            said[before + 1] = [f"{steps[before] - 1} ticks lost"]
        for row, name in self._commands():
            said.setdefault(row, []).append(name)
        events = [""] * len(self)
        for row, names in said.items():
            events[row] = " + ".join(names)
        return events

    def _commands(self) -> list[tuple[int, str]]:
        """Returns the row and the name of each command."""
        if self._tape is None:
            return []
        try:
            start = msgspec.msgpack.decode(self._tape["start"].tobytes())
            first = int(start["state"]["command"]) + 1
            commands = self._tape["commands"].tobytes()
            ends = [0, *(int(end) for end in self._tape["command_ends"])]
            packed = [commands[begin:end] for begin, end in pairwise(ends)]
            names = [_event_of(msgspec.msgpack.decode(command)) for command in packed]
        except (msgspec.MsgspecError, UnicodeDecodeError, KeyError, TypeError, ValueError) as error:
            raise RecordingFormatError(
                f"the commands of the recording cannot be read ({error}); allowed: those that the "
                "engine wrote"
            ) from None
        numbers = np.arange(first, first + len(names), dtype=np.uint64)
        rows = np.searchsorted(self.columns["command"], numbers)
        # the last commands may have been sent after the last tick
        return [(int(row), name) for row, name in zip(rows, names, strict=True) if row < len(self)]

    # --- again ----------------------------------------------------------------------------

    def replay(self) -> Replay:
        """Computes the ticks again and compares every bit of probe and force.

        Raises:
            OptionError: The recording lacks what a replay needs.
            RecordingFormatError: Its parts do not fit together.
        """
        if self._tape is None:
            raise OptionError(
                "this recording cannot be replayed: a change waited for the probe all the time, "
                "or it was too short; allowed: recordings that begin while nothing is pending"
            )
        try:
            found = _core.replay_recording(self.columns, self._tape)
        except ValueError as error:
            raise RecordingFormatError(
                f"the recording is damaged: {error}; allowed: recordings as they were written"
            ) from None
        again = found["ticks"]
        first = int(found["first_row"])
        count = len(again["tick"])
        difference = found["first_difference"]
        names = ("tick", "time", "probe", "force")
        return Replay(
            first_tick=int(self.ticks[first]),
            ticks=count,
            seconds=float(again["time"][-1] - again["time"][0]) if count else 0.0,
            recorded_hash=f"{found['recorded_hash']:016x}",
            replayed_hash=f"{found['replayed_hash']:016x}",
            different=found["different"],
            first_difference=dict(zip(names, difference, strict=True)) if difference else None,
            stopped=_stopped(*found["end"]),
            same_build=self.about is not None and self.about.build == _core.build(),
            positions=again["proxy"],
            forces=again["force"],
        )

    # --- files ----------------------------------------------------------------------------

    @classmethod
    def load(cls, path: str | PathLike[str]) -> Self:
        """Reads a file that ``save`` wrote.

        Raises:
            RecordingFormatError: The file is not a recording, is truncated or damaged.
            OSError: The file cannot be read.
        """
        ticks, tape, about = read_file(Path(path))
        return cls(ticks, tape=tape, about=about)

    def save(self, path: str | PathLike[str]) -> None:
        """Writes a file that can be replayed.

        Raises:
            OptionError: The origin of the recording is not known.
            OSError: The file cannot be written.
        """
        if self.about is None:
            raise OptionError("a recording without `about` cannot be saved; allowed: of a session")
        write_file(Path(path), ticks=self.columns, tape=self._tape, about=self.about)

    def to_csv(self, path: str | PathLike[str]) -> None:
        """Writes poses, forces and events as a CSV file."""
        write_csv(Path(path), self.columns, self.events)

    def to_npz(self, path: str | PathLike[str]) -> None:
        """Writes poses, forces and events as a NumPy archive."""
        write_npz(Path(path), self.columns, self.events)


def _event_of(command: object) -> str:
    """Returns the name of a command: it is packed as its name, or as a map with that key."""
    name = next(iter(command)) if isinstance(command, dict) else command
    return EVENTS.get(str(name), str(name).lower())


def _stopped(end: str, after: int, count: int) -> str:
    if end == "lost":
        return f"{count} ticks were lost after tick {after}: the machine was too busy"
    if end == "commands":
        return f"the changes after tick {after} were not kept: they were too many"
    return ""
