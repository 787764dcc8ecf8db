"""Messages on what is kept with a scan: marks, clipping, windows, looks.

Each part has a name and a value, JSON that only pages understand. The engine keeps them with the
scan, numbers their versions, and tells every page of a change.
"""

from __future__ import annotations

import msgspec

from palpate.protocol.types import KeptName, KeptValue, Message

__all__ = ["Keep", "Kept", "KeptPart"]


class KeptPart(msgspec.Struct, frozen=True):
    """A part as it is now; a ``value`` of null is one that was removed."""

    name: KeptName
    version: int
    value: KeptValue | None


class Kept(Message, frozen=True, tag="kept"):
    """A part is another one now.

    ``answers`` says that this answers a ``Keep`` of the same page: each is answered once, with what
    holds then, whether it was taken or not.
    """

    part: KeptPart
    answers: bool


class Keep(Message, frozen=True, tag="keep"):
    """Changes a part, or removes it (null).

    ``after`` is the version that the page has seen, 0 for none. If another page has changed the
    part since, its change stays.
    """

    name: KeptName
    value: KeptValue | None
    after: int
