"""What pages keep with a scan: marks, landmarks, clipping, windows, looks.

Parts have a name and a value, JSON that only pages understand. They belong to the scan by its
identity (``scan_identity``), never by its name, and lie in a file of the program's state, or in a
scene. What is changed after a scene was opened has a file of its own beside that of the scan, so
that neither takes the place of the other.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from hashlib import blake2b
from threading import Lock
from typing import Any

import msgspec

from palpate.base.errors import OptionError
from palpate.base.state_folder import keep, kept, state_folder
from palpate.volumes.scan_hash import scan_identity
from palpate.volumes.scene import Scene

__all__ = ["KEPT_IN_VIEW", "KeptWithScan", "Part", "parts_in"]

KEPT_IN_VIEW = "kept"
"""Name of the parts in the view of a scene."""
MOST_PARTS = 4096
MOST_BYTES = 1 << 22
"""Bytes of all values; a mark takes about 150."""
MOST_VALUE_BYTES = 1 << 16
NAME = re.compile(r"[a-z]{1,24}(\.[0-9a-f]{1,40})?")
OLD_NAMES = re.compile("appearance|optics|curve|lighting|inside|unfelt|window|clip|brush|matter")
"""Parts that scenes of earlier versions have among what was ``remembered``."""


@dataclass(frozen=True)
class Part:
    """A part as it is now."""

    version: int
    value: str | None
    """JSON; None where it was removed."""


class _File(msgspec.Struct, frozen=True):
    parts: dict[str, msgspec.Raw]


class KeptWithScan:
    """The parts of one open scan; all methods may be called from any thread."""

    def __init__(
        self, scene: Scene, *, view: Mapping[str, Any] | None = None, on_disk: bool = False
    ) -> None:
        """Takes up what was kept of the first scan of a scene.

        Args:
            scene: The scene that is open.
            view: The view of a scene file, whose parts hold.
            on_disk: Whether parts are kept in the folder of the program's state.
        """
        self._lock = Lock()
        self._changed: set[str] = set()
        self._waits = False
        identity = scan_identity(scene.volume)
        first = {} if view is None else dict(_texts(parts_in(view, scene)))
        if view is not None:
            text = msgspec.json.encode(first, order="deterministic")
            identity += f"-{blake2b(text, digest_size=8).hexdigest()}"
        self.path = state_folder() / "scans" / f"{identity}.json" if on_disk else None
        self._parts = {name: Part(1, value) for name, value in (first | self._on_disk()).items()}

    def now(self) -> dict[str, Part]:
        """Returns all parts, those too that were removed."""
        with self._lock:
            return dict(self._parts)

    def change(self, name: str, value: str | None) -> Part:
        """Changes a part, or removes it.

        Raises:
            OptionError: The value is no JSON, or there is too much of it.
        """
        if value is not None:
            _require_json(value)
        with self._lock:
            old = self._parts.get(name, Part(0, None))
            parts = {**self._parts, name: Part(old.version + 1, value)}
            size = sum(len(part.value or "") for part in parts.values())
            if len(parts) > MOST_PARTS or size > MOST_BYTES:
                raise OptionError(
                    f"no more is kept with this scan; allowed: {MOST_PARTS} marks and other parts, "
                    f"{MOST_BYTES >> 20} MiB"
                )
            self._parts = parts
            self._changed.add(name)
            self._waits = True
            return parts[name]

    def write(self) -> None:
        """Brings the file up to date; where it cannot be written nothing is kept on disk."""
        with self._lock:
            waits, self._waits = self._waits, False
            mine = {n: part.value for n, part in self._parts.items() if n in self._changed}
        if self.path is None or not waits:
            return
        # another process may have the same scan open: what it has changed stays
        parts = self._on_disk() | mine
        raw = {name: msgspec.Raw(value.encode()) for name, value in parts.items() if value}
        keep(self.path, _File(raw))

    def in_view(self) -> dict[str, Any]:
        """Returns the parts as the view of a scene file holds them."""
        return {
            name: msgspec.json.decode(part.value)
            for name, part in self.now().items()
            if part.value is not None
        }

    def _on_disk(self) -> dict[str, str | None]:
        file = None if self.path is None else kept(self.path, _File)
        return {} if file is None else {k: bytes(v).decode() for k, v in file.parts.items()}


def _require_json(value: str) -> None:
    try:
        msgspec.json.decode(value)
    except (msgspec.DecodeError, RecursionError) as error:
        raise OptionError(f"what is kept with a scan is JSON; given: {error}") from None


def parts_in(view: Mapping[str, Any], scene: Scene | None = None) -> dict[str, Any]:
    """Returns the parts that the view of a scene file holds, also one of an earlier version.

    That has how a second scan looked as well, which goes to the one of ``scene``.
    """
    given = view.get(KEPT_IN_VIEW)
    parts = given.items() if isinstance(given, dict) else _of_earlier_versions(view, scene)
    return {name: value for name, value in parts if NAME.fullmatch(name)}


def _texts(parts: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """Yields parts as JSON; one that is too large is left out."""
    for name, value in parts.items():
        text = msgspec.json.encode(value).decode()
        if len(text) <= MOST_VALUE_BYTES:
            yield name, text


def _of_earlier_versions(view: Mapping[str, Any], scene: Scene | None) -> Iterator[tuple[str, Any]]:
    remembered = view.get("remembered")
    for name, value in remembered.items() if isinstance(remembered, dict) else ():
        if not isinstance(value, dict):
            continue
        if OLD_NAMES.fullmatch(name):
            yield name, value
        elif name == "marks" and isinstance(value.get("list"), list):
            for number, mark in enumerate(value["list"], start=1):
                yield f"mark.{number:x}", mark
        elif name == "second" and scene is not None and scene.second is not None:
            yield f"second.{scan_identity(scene.second.volume)}", value
