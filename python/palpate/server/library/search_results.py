"""Results of searches for scans: lists with previews, and the place of the scan that is chosen.

A place is a path of this machine, which its user may read anyway, an upload, or the address of a
DICOMweb service. The newest results are kept.
"""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Sequence
from contextlib import AbstractContextManager, suppress
from dataclasses import dataclass, replace
from itertools import count
from pathlib import Path
from typing import NoReturn

import msgspec
import numpy as np
from numpy.typing import NDArray

from palpate.base.errors import OptionError, PalpateError, VolumeFormatError
from palpate.base.progress import Progress
from palpate.io.browse import Choice, browsed, late_picture, previews
from palpate.io.browse_web import MOST_PICTURED, browsed_web
from palpate.io.preview import png_of
from palpate.labels.kind import labels_told
from palpate.reconstruction.projections import ProjectionStack, are_projections, stack_at
from palpate.saved.autosave import Autosave
from palpate.saved.ending import is_scene
from palpate.server.job import Emit
from palpate.server.library.conversions import (
    Headerless,
    headerless_pictures,
    headerless_raw,
    headerless_summary,
    projections_summary,
)
from palpate.server.library.requests import OpenRequest, Place, path_of
from palpate.server.page_words import page_words

__all__ = ["SearchResults"]

MOST_RESULTS = 8
"""Results that are kept."""
GONE = "that list is gone; allowed: search again"


class ListedScan(msgspec.Struct, frozen=True):
    """A scan in a list."""

    patient: str
    study: str
    name: str
    part: str
    """The end of its name, which differs among volumes of its series; "" if alone."""
    modality: str
    size: tuple[int, ...]
    spacing: tuple[float, ...] | None
    refused: str | None
    labels: str | None
    """What it is where it holds segments and no scan, such as "a label map"."""
    late: bool
    """Whether its picture only comes when the page asks for it."""


@dataclass(frozen=True)
class SearchResult:
    """What was found at a place."""

    choices: list[Choice]
    upload: int | None = None
    path: Path | None = None
    """The path that a person gave."""
    stack: ProjectionStack | None = None
    """What is there, where it is projections and no scan."""
    headerless: Headerless | None = None
    """Files whose layout or voxel size the page has to give."""
    autosave: Autosave | None = None
    """What is kept of a scene whose file is damaged."""


class SearchResults:
    """Lists of scans that pages can choose from."""

    def __init__(self) -> None:
        """Begins without any."""
        self._results: dict[int, SearchResult] = {}
        self._numbers = count(1)

    def search(
        self, place: Place, progress: Progress, emit: Emit, *, taken_as: str = "anything"
    ) -> None:
        """Emits the scans at a place of this machine, then their previews.

        Where there are projections, segments or headerless files, these are emitted instead.

        Raises:
            FileNotFoundError: There is no such place.
            VolumeFormatError: It holds none of these, or not what it is taken as.
        """
        anything = taken_as == "anything"
        if taken_as == "projections" or (anything and are_projections(place.path)):
            self._emit_projections(place, emit)
        elif is_scene(place.path):
            choice = Choice(path=place.path, name=place.path.stem, size=(), picture=_no_picture)
            self._emit_result(SearchResult([choice], place.upload, place.path), emit)
        elif anything and (labels := labels_told(place.path, progress=progress)) is not None:
            name = "masks" if place.loose and not labels.image else labels.name
            emit({"kind": "labels", "name": name, "what": labels.what, "image": labels.image})
        elif (headerless := _headerless_file(place.path)) is not None:
            self._emit_headerless(place, headerless, emit)
        else:
            self._browse(place, progress, emit)

    def _browse(self, place: Place, progress: Progress, emit: Emit) -> None:
        try:
            found = browsed(place.path, progress=progress)
            self._emit_found(found, emit, progress, place=place)
        except VolumeFormatError:
            # a folder of raw slices is found to be nothing else first
            headerless = headerless_raw(place.path)
            if headerless is None:
                raise
            self._emit_headerless(place, headerless, emit)

    def _emit_projections(self, place: Place, emit: Emit) -> None:
        stack = stack_at(place.path)
        if place.upload is not None and stack.path.is_dir():
            # of our own folder
            stack = replace(stack, name="projections")
        number = self._keep(SearchResult([], place.upload, place.path, stack))
        emit({"kind": "projections", "find": number, **projections_summary(stack)})

    def _emit_headerless(self, place: Place, headerless: Headerless, emit: Emit) -> None:
        if place.loose:
            headerless = replace(headerless, name=headerless.begins or "slices")
        number = self._keep(SearchResult([], place.upload, place.path, headerless=headerless))
        emit({"kind": "bare", "find": number, **headerless_summary(headerless)})

    def offer_autosave(self, autosave: Autosave, emit: Emit) -> None:
        """Emits the autosave of a damaged scene; it can be opened where its scan is there."""
        find = None if autosave.place is None else self._keep(SearchResult([], autosave=autosave))
        when = autosave.when.isoformat(timespec="seconds")
        emit({"kind": "autosave", "find": find, "scan": autosave.scan.name, "when": when})

    def search_web(self, address: str, progress: Progress, emit: Emit) -> None:
        """Emits the scans of a DICOMweb service, then previews of the first of them.

        Raises:
            OptionError: It is no address.
            DicomWebError: The server is not there, refuses, or has none.
        """
        found = browsed_web(address, progress=progress)
        self._emit_found(found, emit, progress, pictured=MOST_PICTURED)

    def _emit_found(
        self,
        found: AbstractContextManager[list[Choice]],
        emit: Emit,
        progress: Progress,
        *,
        place: Place | None = None,
        pictured: int | None = None,
    ) -> None:
        upload, path = (None, None) if place is None else (place.upload, place.path)
        with found as choices:
            self._emit_result(SearchResult(choices, upload, path), emit)
            # a single one needs no choice
            for number, picture in previews(choices[:pictured]) if len(choices) > 1 else ():
                progress("drawing slices", None)
                _emit_picture(number, picture, emit)

    def emit_pictures(
        self, find: int, choices: Sequence[int], *, progress: Progress, emit: Emit
    ) -> None:
        """Emits pictures of choices of a find, as they are made; none of those that fail.

        Raises:
            OptionError: The find is gone, or has no such choice.
        """
        found = self._results.get(find)
        if found is None or not all(0 <= each < len(found.choices) for each in choices):
            raise OptionError(GONE)
        for number in choices:
            choice = found.choices[number]
            progress("drawing slices", None)
            if choice.late:
                with suppress(PalpateError, OSError):
                    _emit_picture(number, late_picture(choice, progress=progress), emit)

    def _keep(self, result: SearchResult) -> int:
        number = next(self._numbers)
        self._results[number] = result
        while len(self._results) > MOST_RESULTS:
            del self._results[min(self._results)]
        return number

    def _emit_result(self, find: SearchResult, emit: Emit) -> None:
        number = self._keep(find)
        labels = [_labels_of(one) for one in find.choices]
        scans = [_listed(*both) for both in zip(find.choices, labels, strict=True)]
        emit({"kind": "found", "find": number, "scans": scans})

    def projections(self, find: int) -> tuple[ProjectionStack, int | None]:
        """Returns the projections of a find, and their upload where they were dropped.

        Raises:
            OptionError: It is gone, or of scans.
        """
        found = self._results.get(find)
        if found is None or found.stack is None:
            raise OptionError("those projections are gone; allowed: search again")
        return found.stack, found.upload

    def headerless(self, find: int) -> Headerless:
        """Returns the headerless files of a result.

        Raises:
            OptionError: It is gone, or of scans.
        """
        found = self._results.get(find)
        if found is None or found.headerless is None:
            raise OptionError("those files are gone; allowed: search again")
        return found.headerless

    def place_of(self, wanted: OpenRequest) -> Place:
        """Returns where the scan is that a page wants.

        Raises:
            OptionError: It cannot be opened, or its list is gone.
        """
        if wanted.path is not None:
            return Place(
                path_of(wanted.path),
                series=wanted.series,
                frame=wanted.frame,
                given=True,
                raw=wanted.raw,
                voxel_size=wanted.voxel_size,
            )
        find = self._results.get(wanted.find or 0)
        if find is not None and find.headerless is not None:
            return Place(
                find.headerless.path,
                find.upload,
                given=find.upload is None,
                raw=wanted.raw,
                voxel_size=wanted.voxel_size,
                name=find.headerless.name,
            )
        if find is not None and find.autosave is not None:
            return Place(find.autosave.path, autosave=find.autosave)
        if find is None or not 0 <= wanted.choice < len(find.choices):
            raise OptionError(GONE)
        choice = find.choices[wanted.choice]
        if choice.refused is not None:
            raise OptionError(choice.refused)
        given = find.upload is None and choice.fetch is None and choice.path == find.path
        return Place(
            choice.path,
            find.upload,
            series=choice.series,
            frame=choice.frame,
            fetch=choice.fetch,
            given=given,
        )


def _labels_of(choice: Choice) -> str | None:
    """Says what an image file of a list is where it holds segments."""
    if choice.frame is not None:
        # labels come as one volume
        return None
    if choice.uid or choice.fetch is not None or not choice.path.is_file():
        return None
    labels = labels_told(choice.path)
    return None if labels is None else labels.what


def _listed(choice: Choice, labels: str | None) -> ListedScan:
    return ListedScan(
        patient=choice.patient,
        study=choice.study,
        name=choice.name,
        part=choice.part,
        modality=choice.modality,
        size=choice.size,
        spacing=choice.spacing,
        refused=None if choice.refused is None else page_words(choice.refused),
        labels=labels,
        late=choice.late,
    )


def _emit_picture(choice: int, picture: NDArray[np.uint8], emit: Emit) -> None:
    png = b64encode(png_of(picture)).decode("ascii")
    emit({"kind": "picture", "choice": choice, "png": png})


def _headerless_file(path: Path) -> Headerless | None:
    """Returns a stack of pictures, or one file of raw voxels; None for anything else."""
    return headerless_pictures(path) or (headerless_raw(path) if path.is_file() else None)


def _no_picture() -> NoReturn:
    raise OptionError("a scene has no picture")
