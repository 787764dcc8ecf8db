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
    """The metric after each step on one level of a registration; smaller is better."""

    name: str
    values: list[float]


class FoundRegistration(msgspec.Struct, frozen=True):
    """Result of a registration: the metric before and after, and how far points move [mm].

    ``overlap_before`` and ``overlap`` are the fractions of the first scan that the second covers at
    the start and afterwards; ``start_kept`` says that the start was right already.
    """

    kind: RegistrationKind
    metric: RegistrationMetric
    before: float
    after: float
    overlap_before: Share
    overlap: Share
    start_kept: bool
    moved_mean: float
    moved_most: float


class Registration(Message, frozen=True, tag="registration"):
    """Progress of the registration of the second scan, and the result of the last one.

    ``doing`` and ``share`` are null where none is running, ``failure`` says why the last one
    changed nothing; ``curve`` is that of the current or last one. ``steps`` counts registrations
    that can be undone, ``undone`` those that can be redone. ``shown`` says whether the second scan
    is shown before or after ``found``.
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
    """Registers the second scan to the first and moves it there; undo takes that back.

    Each of ``pairs`` is a point of the first scan and the same place in the second, in the patient
    frame of each.
    """

    kind: RegistrationKind
    metric: RegistrationMetric
    start: RegistrationStart
    pairs: Annotated[list[PointPair], msgspec.Meta(max_length=100)]


class StopRegistration(Message, frozen=True, tag="stop_registration"):
    """Stops the current registration; nothing is changed then."""


class ShowRegistration(Message, frozen=True, tag="show_registration"):
    """Shows the second scan before or after the last registration; no step of undo."""

    which: BeforeOrAfter


class UndoRegistration(Message, frozen=True, tag="undo_registration"):
    """Undoes the last registration."""


class RedoRegistration(Message, frozen=True, tag="redo_registration"):
    """Redoes the registration that was undone last."""
