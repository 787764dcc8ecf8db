"""Registration of the second scan on behalf of pages: beside all else, with undo.

Where it lies after each registration is kept, so that before and after can be compared and taken
back. What is stopped, diverges or fails changes nothing.
"""

from __future__ import annotations

import asyncio
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import msgspec
import numpy as np
from starlette.responses import Response

from palpate import protocol
from palpate.base.errors import OptionError, PalpateError
from palpate.export.image import write_scan
from palpate.registration.inverse import inverse_of
from palpate.registration.options import Curve, Pairs, Points, SearchOptions, Start
from palpate.registration.point_map import linear_part, matrix_of
from palpate.registration.registration import (
    Registration,
    RegistrationError,
    register,
    resampled,
    write_transform,
)
from palpate.server.download import file_name, refusal
from palpate.server.download import file_response as download_response
from palpate.server.messages.outbox import Outbox
from palpate.server.messages.table import MessageTable, Runs
from palpate.session.session import Session
from palpate.volumes.second_scan import SecondScan, placed
from palpate.volumes.volume import Volume

__all__ = ["MOST_REQUEST_BYTES", "RegistrationMessages"]

OPTIONS = SearchOptions()
"""How pages search."""
PACE = 0.1
"""Seconds between two messages of how far it is, at least."""
MOST_STEPS = 20
"""Registrations that can be taken back; each B-spline keeps a resampled scan."""
MOST_POINTS = 150
"""Points of a curve on one level that are published."""
MOST_REQUEST_BYTES = 1 << 10
"""Bytes of a request for a file."""


class StoppedError(Exception):
    """A person has stopped the work."""


@dataclass(frozen=True)
class Place:
    """Where the second scan lies."""

    volume: Volume
    """The second scan as it was read."""
    transform: Any
    """SimpleITK's, from points of the first scan to the second's [mm]."""
    matrix: Points
    """The same without its B-spline: the start of a next search. Shape [4, 4]."""
    shown: SecondScan
    """What pages see."""
    found: protocol.FoundRegistration | None
    """What has brought it there; None where it was opened so."""


class FileRequest(msgspec.Struct, frozen=True):
    """What a page asks to save: where the second scan lies, or its values on the first's grid."""

    what: Literal["transform", "inverse", "scan"]
    """The inverse is from points of the second scan to those of the first."""
    ending: Literal[".nii.gz", ".nrrd"] = ".nii.gz"


class RegistrationMessages:
    """The registration that runs, and the places that were found."""

    def __init__(
        self,
        session: Session,
        *,
        show: Callable[[SecondScan], None],
        publish: Callable[[protocol.ToPage], None],
    ) -> None:
        """Takes how the second scan is shown elsewhere, and where messages go; from any thread."""
        self._session = session
        self._show = show
        self._publish = publish
        self._stops = 0
        self._task: asyncio.Task[None] | None = None
        self._published_at = 0.0
        self._places: list[Place] = []
        self._at = 0
        self._before = False
        self.message = protocol.Registration(
            doing=None,
            share=None,
            curve=[],
            failure=None,
            found=None,
            shown="after",
            steps=0,
            undone=0,
        )
        """The newest message on the progress and the places."""
        self._restart(session.scene.second)

    def add_to(self, table: MessageTable) -> None:
        """Adds the rows of registration."""
        table.add(protocol.Register, self._begin, runs=Runs.BESIDE)
        table.add(protocol.StopRegistration, self._stop, runs=Runs.ON_LOOP)
        table.add(protocol.ShowRegistration, self._show_which, runs=Runs.ON_LOOP)
        table.add(protocol.UndoRegistration, self._undo, runs=Runs.ON_LOOP)
        table.add(protocol.RedoRegistration, self._redo, runs=Runs.ON_LOOP)

    def stop(self) -> None:
        """Stops what runs as soon as it can be."""
        self._stops += 1

    def follow(self, second: SecondScan | None) -> None:
        """Forgets all places where another scan is shown, or the same one by another's hand."""
        if not any(second is place.shown for place in self._places):
            self.stop()
            self._restart(second)
            self._publish_change(doing=None, share=None, curve=[], failure=None)

    def file_response(self, body: bytes) -> Response:
        """Answers with a file that a page asks for, or with why there is none."""
        if not self._places:
            return refusal("there is no second scan. Add one first")
        return download_response(
            body,
            FileRequest,
            self._write,
            most_bytes=MOST_REQUEST_BYTES,
            called="registration's file",
        )

    # --- messages -------------------------------------------------------------------------

    def _stop(self, _message: protocol.StopRegistration, _: Outbox) -> None:
        self.stop()

    def _show_which(self, message: protocol.ShowRegistration, _: Outbox) -> None:
        self._go(self._at, before=message.which == "before")

    def _undo(self, _message: protocol.UndoRegistration, _: Outbox) -> None:
        self._go(self._at - 1, before=False)

    def _redo(self, _message: protocol.RedoRegistration, _: Outbox) -> None:
        self._go(self._at + 1, before=False)

    # --- the search -----------------------------------------------------------------------

    def _begin(self, wanted: protocol.Register, _: Outbox) -> None:
        if not self._places:
            raise OptionError("there is no second scan; allowed: add one first")
        if self._task is not None and not self._task.done():
            raise OptionError("a registration runs already; allowed: stop it first")
        self._publish_change(doing="Beginning", share=None, curve=[], failure=None)
        self._task = asyncio.create_task(asyncio.to_thread(self._work, wanted, self._stops))

    def _work(self, wanted: protocol.Register, stops: int) -> None:
        """Searches from where the scan stands, unless there are more ``stops`` meanwhile."""
        first, here = self._session.scene.volume, self._here
        curve: list[protocol.RegistrationLevel] = []

        def watch(levels: Curve) -> None:
            curve[:] = _curve_of(levels)

        def progress(what: str, share: float | None, /) -> None:
            if self._stops != stops:
                raise StoppedError
            if time.monotonic() - self._published_at >= PACE:
                self._published_at = time.monotonic()
                self._publish_change(
                    doing=what[:1].upper() + what[1:], share=share, curve=list(curve)
                )

        failure = None
        try:
            start, pairs = _start_of(wanted, here)
            found = register(
                first,
                here.volume,
                kind=wanted.kind,
                metric=wanted.metric,
                start=start,
                landmarks=pairs,
                options=OPTIONS,
                progress=progress,
                watch=watch,
            )
            curve[:] = _curve_of(found.curve)
            place = _place_of(found, here.volume, first)
            progress("showing it", 1.0)
            self._add(place)
            if found.doubt is not None:
                text = f"{found.doubt[:1].upper()}{found.doubt[1:]}."
                self._publish(protocol.Notice(level="warning", text=text))
        except StoppedError:
            self._publish(
                protocol.Notice(level="info", text="Stopped: the second scan lies as before.")
            )
        except RegistrationError as error:
            curve[:] = _curve_of(error.curve)
            failure = str(error)
        except (PalpateError, RuntimeError, MemoryError) as error:
            failure = str(error) or "not enough memory"
        finally:
            self._publish_change(doing=None, share=None, curve=list(curve), failure=failure)

    # --- places ---------------------------------------------------------------------------

    @property
    def _here(self) -> Place:
        """Where the scan stands."""
        return self._places[self._at - 1 if self._before else self._at]

    def _restart(self, second: SecondScan | None) -> None:
        self._places = [] if second is None else [_as_opened(second)]
        self._at, self._before = 0, False

    def _add(self, place: Place) -> None:
        """Makes a step: what was taken back before is forgotten."""
        base = self._at if not self._before else self._at - 1
        self._places = [*self._places[: base + 1], place][-MOST_STEPS - 1 :]
        self._at, self._before = len(self._places) - 1, False
        self._show(place.shown)

    def _go(self, at: int, *, before: bool) -> None:
        """Shows a place that was found earlier; nothing where there is none."""
        if self._task is not None and not self._task.done():
            raise OptionError("a registration runs; allowed: stop it first")
        if not int(before) <= at < len(self._places):
            return
        self._at, self._before = at, before
        self._show(self._here.shown)
        self._publish_change(failure=None)

    def _publish_change(self, **changes: Any) -> None:  # noqa: ANN401  # fields of the message
        """Tells pages what has changed, and which places there are."""
        self.message = msgspec.structs.replace(
            self.message,
            found=self._places[self._at].found if self._places else None,
            shown="before" if self._before else "after",
            steps=self._at,
            undone=max(0, len(self._places) - 1 - self._at),
            **changes,
        )
        self._publish(self.message)

    def _write(self, wanted: FileRequest, folder: Path) -> tuple[Path, list[str]]:
        here, first = self._here, self._session.scene.volume
        ending = wanted.ending if wanted.what == "scan" else ".tfm"
        names = file_name(here.volume.title), file_name(first.title)
        one, other = reversed(names) if wanted.what == "inverse" else names
        path = folder / f"{one}-to-{other}{ending}"
        if wanted.what == "transform":
            write_transform(here.transform, path)
        elif wanted.what == "inverse":
            inverse = inverse_of(here.transform, here.volume)
            write_transform(inverse.transform, path)
            if not inverse.exact:
                return path, [inverse.sentence]
        else:
            write_scan(resampled(here.volume, first, here.transform), path)
        return path, []


def _start_of(wanted: protocol.Register, here: Place) -> tuple[Start | Points, Pairs | None]:
    """Returns where a search begins, and pairs of points where it begins with them."""
    if wanted.start == "as-it-stands":
        return here.matrix, None
    if wanted.start != "landmarks":
        return wanted.start, None
    pairs = [point for point, _ in wanted.pairs], [point for _, point in wanted.pairs]
    return wanted.start, pairs


def _as_opened(second: SecondScan) -> Place:
    transform = second.transform
    return Place(second.as_read, transform, matrix_of(linear_part(transform)), second, None)


def _place_of(found: Registration, volume: Volume, first: Volume) -> Place:
    moved = np.linalg.norm(found.moved(first), axis=1)
    message = protocol.FoundRegistration(
        kind=found.kind,
        metric=found.metric,
        before=found.before,
        after=found.after,
        overlap_before=found.overlap_before,
        overlap=found.overlap,
        start_kept=found.start_kept,
        moved_mean=float(moved.mean()),
        moved_most=float(moved.max()),
    )
    shown = placed(first, volume, found.transform)
    return Place(volume, found.transform, found.unbent, shown, message)


def _curve_of(levels: Sequence[Any]) -> list[protocol.RegistrationLevel]:
    """Returns a curve as messages; of many steps some are left out."""
    curve = []
    for level in levels:
        coarser = f", {level.shrink} times coarser" if level.shrink > 1 else ""
        every = max(1, -(-len(level.values) // MOST_POINTS))
        values = [value for value in level.values[::every] if np.isfinite(value)]
        curve.append(protocol.RegistrationLevel(f"{level.stage}{coarser}", values))
    return curve
