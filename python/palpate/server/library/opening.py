"""How a scan of the library is opened, shown with the open one, or gives that one segments.

Files that were uploaded or downloaded are removed when their scan is closed.
"""

from __future__ import annotations

from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

from anyio import from_thread

from palpate.base.errors import OptionError, PalpateError, SceneFormatError, SeriesChoiceError
from palpate.base.progress import Progress
from palpate.io.reading import read, read_again, read_sibling
from palpate.labels.labels import read_labels
from palpate.saved.autosave import autosave_of, note_scene
from palpate.saved.demonstration import demonstration
from palpate.saved.ending import is_scene
from palpate.saved.opening import Opening, opening, opening_of
from palpate.saved.recent import note_recent
from palpate.saved.scene_file import SavedScene
from palpate.server.added_labels import add_labels
from palpate.server.job import Emit
from palpate.server.library.requests import Place, VolumeRequest
from palpate.server.library.search_results import SearchResults
from palpate.server.library.upload import Uploads
from palpate.server.open_scan import OpenScan
from palpate.server.page_words import page_words
from palpate.server.workbench import Workbench
from palpate.volumes.second_scan import SecondScan, placed
from palpate.volumes.volume import Volume

__all__ = ["Opener"]

PASSING = "temporary copy; save the scene with the scan to keep it"
"""Warning of a scan that was uploaded, or came from a server."""
MADE = "it is in no file: a saved scene has the scan in it, and Export writes it"
"""Warning of a scan that was reconstructed."""

Files = TemporaryDirectory[str]
"""Folder with the files of a scan, for as long as it is open."""


class Opener:
    """Opens scans on a workbench; its methods run in worker threads."""

    def __init__(self, workbench: Workbench, results: SearchResults, uploads: Uploads) -> None:
        """Takes where scans are shown, and where they come from."""
        self._workbench = workbench
        self._results = results
        self._uploads = uploads

    def open(self, place: Place, *, beside: bool, progress: Progress, emit: Emit) -> None:
        """Shows a scan in place of the open one or ``beside`` it; its files are downloaded first.

        Where they hold several volumes, such as times, these are emitted to choose from instead.

        Raises:
            PalpateError: It cannot be opened.
        """
        if place.fetch is None:
            try:
                self.show(place, beside=beside, progress=progress)
            except SceneFormatError:
                if (autosave := autosave_of(place.path)) is not None:
                    self._results.offer_autosave(autosave, emit)
                raise
            return
        with ExitStack() as unless_shown:
            files = TemporaryDirectory(prefix="palpate-")
            unless_shown.callback(files.cleanup)
            folder = Path(files.name) / "scan"
            folder.mkdir()
            place.fetch(folder, progress)
            try:
                here = replace(place, path=folder)
                self.show(here, beside=beside, progress=progress, fetched=files)
            except SeriesChoiceError:
                unless_shown.pop_all()
                kept = self._uploads.keep(files)
                self._results.search(Place(folder, kept), progress, emit)
            unless_shown.pop_all()

    def show(
        self, place: Place, *, beside: bool, progress: Progress, fetched: Files | None = None
    ) -> None:
        """Shows a scan whose files are here; those that were ``fetched`` go with it.

        Raises:
            PalpateError: It cannot be opened.
        """
        if beside:
            self._add(place, fetched, progress)
        else:
            self._exchange(place, fetched, progress)

    def _exchange(self, place: Place, fetched: Files | None, progress: Progress) -> None:
        """Shows a scan in place of the one that is open."""
        if place.upload is not None:
            # its files may be those of a scan by now
            self._uploads.of(place.upload)
        self._replace(_read(place, progress), place, fetched=fetched, progress=progress)

    def _replace(
        self, opened: Opening, place: Place, *, fetched: Files | None, progress: Progress
    ) -> None:
        """Shows a scene that was read in place of the one that is open."""
        if opened.saved is not None:
            progress("checking the scene", None)
            self._rehearse(opened.saved)
        # from here on it cannot be taken back
        progress("starting", None)
        for sentence in opened.messages:
            self._workbench.notify(sentence)
        _name(opened.scene.volume, place, passing=place.upload is not None or fetched is not None)
        try:
            from_thread.run(self._workbench.exchange, lambda: self._begin(opened, place, fetched))
        except (PalpateError, OSError, RuntimeError) as error:
            self._workbench.notify(f"The scan was not opened: {page_words(str(error))}")
            raise

    def _rehearse(self, saved: SavedScene) -> None:
        """Brings a saved scene back where nobody sees it: a damaged one leaves what is open.

        Raises:
            PalpateError: It is damaged.
        """
        OpenScan.begin(saved.scene(), rate=self._workbench.rate, saved=saved).end()

    def _begin(self, read: Opening, place: Place, fetched: Files | None) -> OpenScan:
        """Starts the session of a scan that was read, and notes it as recent."""
        opened = OpenScan.begin(
            read.scene,
            rate=self._workbench.rate,
            journalled=self._workbench.journalled,
            recover=None if place.autosave is None else True,
            saved=read.saved,
            notify=self._workbench.notify,
        )
        if place.upload is not None:
            opened.files = self._uploads.take_out(place.upload)
        elif fetched is not None:
            opened.files = fetched
        else:
            note_recent(read.scene.volume, place.path if read.saved is not None else None)
        if read.saved is not None:
            note_scene(read.saved.scan, place.path, passing=place.upload is not None)
        return opened

    def reread(self, wanted: VolumeRequest, progress: Progress) -> None:
        """Shows the open scan as it is wanted in its place.

        Raises:
            PalpateError: It cannot be read like that.
        """
        opened = self._opened()
        volume = opened.session.scene.volume
        other = _reread(volume, wanted, progress)
        place = Place(Path(), given=volume.traits.given)
        # files that go with a scan are those of the new one too
        files, opened.files = opened.files, None
        with ExitStack() as unless_shown:
            if files is not None:
                unless_shown.callback(files.cleanup)
            self._replace(opening_of(other), place, fetched=files, progress=progress)
            unless_shown.pop_all()

    def reread_second(self, wanted: VolumeRequest, progress: Progress) -> None:
        """Shows the second scan as it is wanted in its place.

        Raises:
            PalpateError: It cannot be read like that.
        """
        opened = self._opened()
        second = opened.session.scene.second
        if second is None:
            raise OptionError("there is no second scan; allowed: add one first")
        if second.before_resampling is not None:
            raise OptionError(
                "the second scan is deformed by a transform; allowed: after it is laid as it was"
            )
        volume = _reread(second.volume, wanted, progress)
        opened.show_second(SecondScan(volume, second.second_from_first))

    def _add(self, place: Place, fetched: Files | None, progress: Progress) -> None:
        """Shows a scan with the one that is open."""
        opened = self._opened()
        if is_scene(place.path):
            raise OptionError("a scene was chosen; allowed: a scan")
        volume = _read_volume(place, progress)
        volume.traits = replace(volume.traits, name=place.name or volume.traits.name)
        files = fetched if place.upload is None else self._uploads.take_out(place.upload)
        if files is None:
            note_recent(volume)
        else:
            # they go with it: a saved scene has to hold it
            volume.source = None
        opened.show_second(placed(opened.session.scene.volume, volume), files=files)

    def add_segments(
        self, path: Path, *, resample: bool, another_patient: bool = False, progress: Progress
    ) -> None:
        """Adds the segments of a file or folder to the open scan.

        Raises:
            PalpateError: They cannot be read, or do not fit the scan.
        """
        opened = self._opened()
        found = read_labels(
            path,
            opened.session.scene.volume,
            resample=resample,
            another_patient=another_patient,
            progress=progress,
        )
        # from here on it cannot be taken back
        progress("adding segments", None)
        add_labels(opened.live, found)

    def _opened(self) -> OpenScan:
        opened = from_thread.run(self._workbench.settled)
        if opened is None:
            raise OptionError("no scan is open; allowed: open one first")
        return opened


def _read(place: Place, progress: Progress) -> Opening:
    """Reads what is at a place, or makes it."""
    if place.demo:
        return demonstration(progress)
    if place.make is not None:
        return opening_of(place.make(progress))
    if place.autosave is not None:
        return opening_of(place.autosave.read(progress))
    return opening(
        place.path,
        series=place.series,
        frame=place.frame,
        raw=place.raw,
        voxel_size=place.voxel_size,
        progress=progress,
    )


def _reread(volume: Volume, wanted: VolumeRequest, progress: Progress) -> Volume:
    """Reads a scan again."""
    if wanted.number is not None:
        return read_sibling(volume, wanted.number, progress=progress)
    told = {"unit": wanted.unit, "orientation": wanted.orientation}
    changes = {name: value for name, value in told.items() if value is not None}
    return read_again(volume, changes, progress=progress)


def _read_volume(place: Place, progress: Progress) -> Volume:
    """Reads the scan at a place, or makes it."""
    if place.make is not None:
        return place.make(progress)
    return read(
        place.path,
        series=place.series,
        frame=place.frame,
        raw=place.raw,
        voxel_size=place.voxel_size,
        progress=progress,
    )


def _name(volume: Volume, place: Place, *, passing: bool) -> None:
    """Gives a scan its name, and a warning where its files do not stay."""
    warnings = volume.traits.warnings
    if place.make is not None:
        warnings = (*warnings, MADE)
    elif passing:
        warnings = (*warnings, PASSING)
    name = place.name or volume.traits.name
    volume.traits = replace(volume.traits, name=name, warnings=warnings, given=place.given)
