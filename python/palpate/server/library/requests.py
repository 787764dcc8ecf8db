"""What pages ask of the library, and the place of a scan that they mean."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import msgspec

from palpate.base.errors import OptionError
from palpate.base.progress import Progress
from palpate.io.browse import Fetch
from palpate.reconstruction.request import ReconstructionRequest
from palpate.saved.autosave import Autosave
from palpate.volumes.volume import Volume

__all__ = [
    "LayoutRequest",
    "OpenRequest",
    "PicturesRequest",
    "Place",
    "ReconstructRequest",
    "SearchRequest",
    "SegmentsRequest",
    "VolumeRequest",
    "path_of",
]


class SearchRequest(msgspec.Struct, frozen=True):
    """Where scans are looked for: ``path`` or ``upload``."""

    path: str | None = None
    """A file or folder, or the address of a DICOMweb service."""
    upload: int | None = None
    taken_as: Literal["anything", "scan", "projections"] = "anything"
    """What it is; as anything, what looks like projections or segments is taken as such."""


class PicturesRequest(msgspec.Struct, frozen=True):
    """Scans of a search result whose pictures are wanted."""

    find: int
    choices: list[int]


class OpenRequest(msgspec.Struct, frozen=True):
    """A scan to open: a ``choice`` of the search result ``find``, or a ``path``."""

    find: int | None = None
    choice: int = 0
    path: str | None = None
    series: str | None = None
    frame: int | None = None
    """Volume of an image file with several."""
    raw: str | None = None
    """Layout of raw voxels, as ``palpate.read`` takes it."""
    voxel_size: tuple[float, float, float] | None = None
    """Where the files do not have it [mm]."""
    beside: bool = False
    """Whether it is shown with the open scan, and not in its place."""
    demo: bool = False
    """Whether the built-in phantom is meant, and no file."""


class VolumeRequest(msgspec.Struct, frozen=True):
    """The open scan read again: another volume of its file, or with what its file does not tell."""

    number: int | None = None
    """Of another volume of its file or series, such as another time, from 1."""
    unit: Literal["HU"] | None = None
    orientation: str | None = None
    """Both as ``palpate.read`` takes them."""
    beside: bool = False
    """Whether the second scan is meant."""


class SegmentsRequest(msgspec.Struct, frozen=True):
    """Segments to add to the open scan: of a ``path``, an ``upload`` or a search result."""

    path: str | None = None
    upload: int | None = None
    find: int | None = None
    """Search result in which they are a ``choice``."""
    choice: int = 0
    resample: bool = False
    """Whether they may lie on another grid."""
    another_patient: bool = False
    """Whether they may be of another patient, study or frame of reference."""


class LayoutRequest(msgspec.Struct, frozen=True):
    """The layout that a page gives for headerless files."""

    find: int
    raw: str | None = None
    """As ``palpate.read`` takes it; None for pictures."""
    voxel_size: tuple[float, float, float] | None = None
    """[mm]; the aspect ratio of the preview follows from it."""


class ReconstructRequest(msgspec.Struct, frozen=True):
    """A scan to reconstruct from the projections of a search result."""

    find: int
    request: ReconstructionRequest
    geometry: int | None = None
    """Upload of the file that states their geometry."""
    beside: bool = False
    """Whether the scan is shown with the open one, and not in its place."""


@dataclass(frozen=True)
class Place:
    """Where a scan is, or where scans are looked for."""

    path: Path
    upload: int | None = None
    series: str | None = None
    frame: int | None = None
    fetch: Fetch | None = None
    """Downloads its files first; None where they are here."""
    given: bool = False
    """Whether a person typed this path."""
    make: Callable[[Progress], Volume] | None = None
    """Makes the scan of what is there; None where it is read."""
    raw: str | None = None
    voxel_size: tuple[float, float, float] | None = None
    """Both as ``palpate.read`` takes them."""
    loose: bool = False
    """Whether the path is a temporary folder, whose name is not that of the scan."""
    name: str | None = None
    """Name of the scan; by default that of the path."""
    autosave: Autosave | None = None
    """Changes that are restored with the scan."""
    demo: bool = False
    """Whether it is the built-in phantom, which is at no path."""


def path_of(given: str) -> Path:
    """Returns the path that a person has typed.

    Raises:
        OptionError: It is empty, or none.
    """
    text = given.strip().strip("\"'")
    if not text or "\0" in text:
        raise OptionError("no path given; allowed: that of a folder or file on this machine")
    return Path(text).expanduser()
