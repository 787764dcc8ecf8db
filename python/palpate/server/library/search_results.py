"""What is found where pages look for scans: lists with pictures, and the place of what is chosen.

A place is a path of this machine, which its person may read anyway, an upload, or the address of a
DICOMweb service. What is found is kept until more recent finds push it out.
"""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Callable
from contextlib import AbstractContextManager
from dataclasses import dataclass, replace
from itertools import count
from pathlib import Path
from typing import Literal, NoReturn

import msgspec

from palpate.base.errors import OptionError, VolumeFormatError
from palpate.base.progress import Progress
from palpate.io.browse import Choice, Fetch, browsed, previews
from palpate.io.browse_web import MOST_PICTURED, browsed_web
from palpate.io.preview import png_of
from palpate.labels.kind import labels_told
from palpate.reconstruction.projections import ProjectionStack, are_projections, stack_at
from palpate.saved.autosave import Autosave
from palpate.saved.opening import is_scene
from palpate.server.job import Tell
from palpate.server.library.conversions import Bare, bare_pictures, bare_raw, bare_told
from palpate.server.library.reconstruction import told_of
from palpate.volumes.volume import Volume

__all__ = ["Finds", "Place", "WantedFind", "WantedScan", "WantedSegments", "path_of"]

MOST_FINDS = 8


class WantedFind(msgspec.Struct, frozen=True):
    """Where scans are looked for: one of both."""

    path: str | None = None
    """Or an address of the web."""
    upload: int | None = None
    taken_as: Literal["anything", "scan", "projections"] = "anything"
    """What it is; as anything, what looks like projections or segments is taken as such."""


class WantedScan(msgspec.Struct, frozen=True):
    """What is to be opened: a choice of a find, or a path."""

    find: int | None = None
    choice: int = 0
    path: str | None = None
    series: str | None = None
    raw: str | None = None
    """Layout of raw voxels, as ``palpate.read`` takes it."""
    voxel_size: tuple[float, float, float] | None = None
    """Where the files do not tell it [mm]."""
    beside: bool = False
    """Whether it is shown with the open scan, and not in its place."""


class WantedSegments(msgspec.Struct, frozen=True):
    """Where segments are that are to be added to the open scan: one of these."""

    path: str | None = None
    upload: int | None = None
    find: int | None = None
    """Of a list in which they are a ``choice``."""
    choice: int = 0
    resample: bool = False
    """Whether they may lie on another grid."""


class ListedScan(msgspec.Struct, frozen=True):
    """A scan in a list."""

    patient: str
    study: str
    name: str
    part: str
    """The end of its name that tells it from other volumes of its series; "" if alone."""
    modality: str
    size: tuple[int, ...]
    spacing: tuple[float, ...] | None
    refused: str | None
    labels: str | None
    """What it is where it holds segments and no scan, such as "a label map"."""


@dataclass(frozen=True)
class Place:
    """Where a scan is, or where scans are looked for."""

    path: Path
    upload: int | None = None
    series: str | None = None
    fetch: Fetch | None = None
    """Brings its files here first."""
    given: bool = False
    """Whether a person gave this very path."""
    make: Callable[[Progress], Volume] | None = None
    """Makes the scan of what is there; None where it is read."""
    raw: str | None = None
    voxel_size: tuple[float, float, float] | None = None
    """Both as ``palpate.read`` takes them."""
    loose: bool = False
    """Whether the path is a folder of our own, whose name says nothing."""
    name: str | None = None
    """Of the scan, where that of the path is none."""
    autosave: Autosave | None = None
    """What is brought back with the scan."""


@dataclass(frozen=True)
class Find:
    """What was found at a place."""

    choices: list[Choice]
    upload: int | None = None
    path: Path | None = None
    """The path that a person gave."""
    stack: ProjectionStack | None = None
    """What is there, where it is projections and no scan."""
    bare: Bare | None = None
    """What is there, where its layout or the size of its voxels is to be told."""
    autosave: Autosave | None = None
    """What is kept of a scene whose file is damaged."""


class Finds:
    """Lists of scans that pages can choose from."""

    def __init__(self) -> None:
        """Begins without any."""
        self._finds: dict[int, Find] = {}
        self._numbers = count(1)

    def look(
        self, place: Place, progress: Progress, tell: Tell, *, taken_as: str = "anything"
    ) -> None:
        """Tells the scans at a place of this machine, then their pictures.

        Or what is there in their place: projections, segments, files that do not tell their layout.

        Raises:
            FileNotFoundError: There is no such place.
            VolumeFormatError: It holds none of these, or not what it is taken as.
        """
        anything = taken_as == "anything"
        if taken_as == "projections" or (anything and are_projections(place.path)):
            self._tell_projections(place, tell)
        elif is_scene(place.path):
            choice = Choice(path=place.path, name=place.path.stem, size=(), picture=_no_picture)
            self._tell_find(Find([choice], place.upload, place.path), tell)
        elif anything and (labels := labels_told(place.path, progress=progress)) is not None:
            name = "masks" if place.loose and not labels.image else labels.name
            tell({"kind": "labels", "name": name, "what": labels.what, "image": labels.image})
        elif (bare := _bare_file(place.path)) is not None:
            self._tell_bare(place, bare, tell)
        else:
            self._browse(place, progress, tell)

    def _browse(self, place: Place, progress: Progress, tell: Tell) -> None:
        try:
            found = browsed(place.path, progress=progress)
            self._tell_found(found, tell, progress, place=place)
        except VolumeFormatError:
            # a folder of raw slices is found to be nothing else first
            bare = bare_raw(place.path)
            if bare is None:
                raise
            self._tell_bare(place, bare, tell)

    def _tell_projections(self, place: Place, tell: Tell) -> None:
        stack = stack_at(place.path)
        if place.upload is not None and stack.path.is_dir():
            # of our own folder
            stack = replace(stack, name="projections")
        number = self._keep(Find([], place.upload, place.path, stack))
        tell({"kind": "projections", "find": number, **told_of(stack)})

    def _tell_bare(self, place: Place, bare: Bare, tell: Tell) -> None:
        if place.loose:
            bare = replace(bare, name=bare.begins or "slices")
        number = self._keep(Find([], place.upload, place.path, bare=bare))
        tell({"kind": "bare", "find": number, **bare_told(bare)})

    def offer(self, autosave: Autosave, tell: Tell) -> None:
        """Tells the autosave of a damaged scene; it can be opened where its scan is there."""
        find = None if autosave.place is None else self._keep(Find([], autosave=autosave))
        when = autosave.when.isoformat(timespec="seconds")
        tell({"kind": "autosave", "find": find, "scan": autosave.scan.name, "when": when})

    def look_at_web(self, address: str, progress: Progress, tell: Tell) -> None:
        """Tells the scans of a DICOMweb service, then pictures of the first of them.

        Raises:
            OptionError: It is no address.
            DicomWebError: The server is not there, refuses, or has none.
        """
        found = browsed_web(address, progress=progress)
        self._tell_found(found, tell, progress, pictured=MOST_PICTURED)

    def _tell_found(
        self,
        found: AbstractContextManager[list[Choice]],
        tell: Tell,
        progress: Progress,
        *,
        place: Place | None = None,
        pictured: int | None = None,
    ) -> None:
        upload, path = (None, None) if place is None else (place.upload, place.path)
        with found as choices:
            self._tell_find(Find(choices, upload, path), tell)
            # a single one needs no choice
            for number, picture in previews(choices[:pictured]) if len(choices) > 1 else ():
                progress("drawing slices", None)
                png = b64encode(png_of(picture)).decode("ascii")
                tell({"kind": "picture", "choice": number, "png": png})

    def _keep(self, find: Find) -> int:
        number = next(self._numbers)
        self._finds[number] = find
        while len(self._finds) > MOST_FINDS:
            del self._finds[min(self._finds)]
        return number

    def _tell_find(self, find: Find, tell: Tell) -> None:
        number = self._keep(find)
        labels = [_labels_of(one) for one in find.choices]
        scans = [_listed(*both) for both in zip(find.choices, labels, strict=True)]
        tell({"kind": "found", "find": number, "scans": scans})

    def projections(self, find: int) -> tuple[ProjectionStack, int | None]:
        """Returns the projections of a find, and their upload where they were dropped.

        Raises:
            OptionError: It is gone, or of scans.
        """
        found = self._finds.get(find)
        if found is None or found.stack is None:
            raise OptionError("those projections are gone; allowed: look for them again")
        return found.stack, found.upload

    def bare(self, find: int) -> Bare:
        """Returns the files of a find whose layout is to be told.

        Raises:
            OptionError: It is gone, or of scans.
        """
        found = self._finds.get(find)
        if found is None or found.bare is None:
            raise OptionError("those files are gone; allowed: look for them again")
        return found.bare

    def chosen(self, wanted: WantedScan) -> Place:
        """Returns where the scan is that a page wants.

        Raises:
            OptionError: It cannot be opened, or its list is gone.
        """
        if wanted.path is not None:
            return Place(
                path_of(wanted.path),
                series=wanted.series,
                given=True,
                raw=wanted.raw,
                voxel_size=wanted.voxel_size,
            )
        find = self._finds.get(wanted.find or 0)
        if find is not None and find.bare is not None:
            return Place(
                find.bare.path,
                find.upload,
                given=find.upload is None,
                raw=wanted.raw,
                voxel_size=wanted.voxel_size,
                name=find.bare.name,
            )
        if find is not None and find.autosave is not None:
            return Place(find.autosave.path, autosave=find.autosave)
        if find is None or not 0 <= wanted.choice < len(find.choices):
            raise OptionError("that list is gone; allowed: look for scans again")
        choice = find.choices[wanted.choice]
        if choice.refused is not None:
            raise OptionError(choice.refused)
        given = find.upload is None and choice.fetch is None and choice.path == find.path
        return Place(choice.path, find.upload, choice.series, choice.fetch, given)


def _labels_of(choice: Choice) -> str | None:
    """Says what an image file of a list is where it holds segments."""
    if choice.uid or choice.fetch is not None or not choice.path.is_file():
        return None
    told = labels_told(choice.path)
    return None if told is None else told.what


def _listed(choice: Choice, labels: str | None) -> ListedScan:
    return ListedScan(
        patient=choice.patient,
        study=choice.study,
        name=choice.name,
        part=choice.part,
        modality=choice.modality,
        size=choice.size,
        spacing=choice.spacing,
        refused=choice.refused,
        labels=labels,
    )


def _bare_file(path: Path) -> Bare | None:
    """Returns what is told of pictures, or of one file of raw voxels."""
    return bare_pictures(path) or (bare_raw(path) if path.is_file() else None)


def _no_picture() -> NoReturn:
    raise OptionError("a scene has no picture")


def path_of(given: str) -> Path:
    """Returns the path that a person has typed.

    Raises:
        OptionError: It is empty, or none.
    """
    text = given.strip().strip("\"'")
    if not text or "\0" in text:
        raise OptionError("no path given; allowed: that of a folder or file on this machine")
    return Path(text).expanduser()
