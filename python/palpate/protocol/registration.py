"""Messages of the registration of a second scan; see ``__init__.py``."""

from __future__ import annotations

from typing import Annotated

import msgspec

from palpate.protocol.types import (
    BeforeOrAfter,
    Message,
    PointPair,
    RegistrationKind,
    RegistrationMetric,
    RegistrationStart,
    Share,
)

__all__ = [
    "FoundRegistration",
    "RedoRegistration",
    "Register",
    "Registration",
    "RegistrationLevel",
    "ShowRegistration",
    "StopRegistration",
    "UndoRegistration",
]


class RegistrationLevel(msgspec.Struct, frozen=True):
    """The metric after each step on one level of a registration; made small."""

    name: str
    values: list[float]


class FoundRegistration(msgspec.Struct, frozen=True):
    """What a registration has found: the metric before and after, and how far points move [mm].

    ``overlap`` is the share of the first scan that the second covers in the end.
    """

    kind: RegistrationKind
    metric: RegistrationMetric
    before: float
    after: float
    overlap: Share
    moved_mean: float
    moved_most: float


class Registration(Message, frozen=True, tag="registration"):
    """How far the registration of the second scan is, and what the last one has found.

    ``doing`` and ``share`` are null where none runs, ``failure`` says why the last one changed
    nothing; ``curve`` is that of the one that runs or ran last. ``steps`` counts registrations that
    can be taken back, ``undone`` those that can be made again. ``shown`` tells whether the second
    scan stands as before or after ``found``.
    """

    doing: str | None
    share: Share | None
    curve: list[RegistrationLevel]
    failure: str | None
    found: FoundRegistration | None
    shown: BeforeOrAfter
    steps: int
    undone: int


class Register(Message, frozen=True, tag="register"):
    """Finds where the second scan lies in the first; it then stands there, and undo takes it back.

    Each of ``pairs`` is a point of the first scan and the same place in the second, in the patient
    of each.
    """

    kind: RegistrationKind
    metric: RegistrationMetric
    start: RegistrationStart
    pairs: Annotated[list[PointPair], msgspec.Meta(max_length=100)]


class StopRegistration(Message, frozen=True, tag="stop_registration"):
    """Stops the registration that runs; nothing is changed then."""


class ShowRegistration(Message, frozen=True, tag="show_registration"):
    """Shows the second scan as before the last registration, or as after it; no step of undo."""

    which: BeforeOrAfter


class UndoRegistration(Message, frozen=True, tag="undo_registration"):
    """Takes the last registration back."""


class RedoRegistration(Message, frozen=True, tag="redo_registration"):
    """Makes the registration again that was taken back last."""
