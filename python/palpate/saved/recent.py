"""The list of recently opened scans: where they are, and nothing about patients.

It is one JSON file in the folder of the program's state.
"""

from __future__ import annotations

from contextlib import suppress
from datetime import datetime
from pathlib import Path

import msgspec

from palpate.base.state_folder import keep, kept, state_folder
from palpate.volumes.volume import Volume

__all__ = ["Recent", "forget_recent", "note_recent", "recent_scans"]

MOST = 12


class Recent(msgspec.Struct, frozen=True):
    """A scan or a scene that was opened."""

    path: str
    series: str | None
    name: str
    when: str
    """ISO 8601, local time with its offset."""
    frame: int | None = None
    """Volume of an image file with several."""
    raw: str | None = None
    """Layout of raw voxels, as ``palpate.read`` takes it."""
    voxel_size: tuple[float, float, float] | None = None
    """Voxel size, where the files do not state it [mm]."""


def recent_scans() -> list[Recent]:
    """Returns recent scans that still exist, newest first."""
    return [one for one in _kept() if Path(one.path).exists()]


def note_recent(volume: Volume, path: Path | None = None) -> None:
    """Puts a scan, or the scene at ``path``, at the top; a scan without a file is not listed."""
    source = volume.source
    if path is None and source is None:
        return
    place = path if path is not None else source.path if source is not None else Path()
    options = {} if path is not None or source is None else source.options
    series = options.get("series")
    when = datetime.now().astimezone().isoformat(timespec="seconds")
    newest = Recent(
        str(place.resolve()),
        series,
        volume.name,
        when,
        frame=options.get("frame"),
        raw=options.get("raw"),
        voxel_size=options.get("voxel_size"),
    )
    same = (newest.path, newest.series, newest.frame)
    others = [one for one in _kept() if (one.path, one.series, one.frame) != same]
    keep(_file(), [newest, *others][:MOST])


def forget_recent() -> None:
    """Empties the list."""
    with suppress(OSError):
        _file().unlink(missing_ok=True)


def _file() -> Path:
    return state_folder() / "recent.json"


def _kept() -> list[Recent]:
    return kept(_file(), list[Recent]) or []
