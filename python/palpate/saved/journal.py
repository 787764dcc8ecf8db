"""The journal of a scan's changes on disk, and recovery of one that an earlier session left.

There is one file for each scan in ``state_folder()``, named by a hash of its values and geometry. A
file with steps is offered for recovery; if it is declined, it is set aside (``set_aside``). Whoever
writes a journal or offers it holds its lock: no other session touches it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from datetime import datetime
from hashlib import sha256
from pathlib import Path
from threading import Lock

import msgspec

from palpate.base.counted import counted
from palpate.base.errors import OptionError, PalpateError
from palpate.base.file_lock import FileLock
from palpate.base.state_folder import private_folder
from palpate.base.whole_file import whole_file
from palpate.saved.second_scan_note import keep_second, kept_second, second_name
from palpate.saved.set_aside import (
    JOURNAL,
    KEPT_DAYS,
    SCAN,
    SECOND,
    STEPS,
    folder_of_journals,
    lock_of,
    note_scan,
    put_aside,
    remove_old,
)
from palpate.session.session import Session
from palpate.volumes.scan_hash import scan_hash
from palpate.volumes.second_scan import SecondScan

__all__ = ["Journal", "Offer", "journal_place"]


def journal_place(of_scan: bytes, folder: Path | None = None) -> Path:
    """Returns the path of the journal of a scan with this hash."""
    return folder_of_journals(folder) / f"{of_scan.hex()[:32]}{JOURNAL}"


@dataclass(frozen=True)
class Offer:
    """Changes that an earlier session left."""

    steps: int
    """Number of changes, including undone and redone ones."""
    when: datetime
    """Local time of the last change."""
    lost_bytes: int
    """Damaged bytes at the end: what was being written when the session ended."""
    second: str | None = None
    """Name of the second scan that was shown."""


class _Saved(msgspec.Struct, frozen=True):
    """A scene file that has all that a journal had when it was written."""

    scene: str
    files: list[str | None]


class Journal:
    """The journal of one session; all methods may be called from any thread."""

    def __init__(
        self, session: Session, *, folder: Path | None = None, tell: Callable[[str], None] = print
    ) -> None:
        """Finds the path of the journal; nothing is written before ``start``.

        Args:
            session: The session whose changes are written.
            folder: Folder of the journal; the default is ``state_folder``.
            tell: Takes messages for the user.
        """
        self._session = session
        self._tell = tell
        self._lock = Lock()
        self._hash = scan_hash(session.scene.volume)
        self._running = False
        self._owned: FileLock | None = None
        self._folder = folder
        self.path = journal_place(self._hash, folder)
        self.offer: Offer | None = None
        """Changes of an earlier session; None once it was decided about them."""
        self.problem: str | None = None
        """Why changes are not written; None where they are, or an offer is open."""
        self.looks: bytes | None = None
        """The newest note of a recovered journal."""
        self.second: SecondScan | None = None
        """The recovered second scan."""
        self.lost_second: str | None = None
        """Why the second scan was not recovered."""
        self._steps: bytes | None = None
        """Steps of segments as the file beside the journal has them."""

    @property
    def is_running(self) -> bool:
        """Whether changes are written."""
        return self._running

    def start(self, *, recover: bool | None = None, scene: str | None = None) -> None:
        """Starts the journal, unless there is an offer to decide about.

        Args:
            recover: Whether to recover what an earlier session left; False keeps it aside, None
                asks.
            scene: The ``save_id`` of the scene that is open. Where it was saved after the last
                change of an earlier session there is nothing to ask: what that left is kept aside.
        """
        with self._lock:
            try:
                private_folder(self.path.parent)
                self._own()
                self._remove_old()
                if recover is None and scene is not None and self._is_saved_in(scene):
                    self._keep_aside(held=True)
                self._look(wanted=recover is True)
            except (OSError, OptionError) as error:
                self._give_up(error)
        if self.problem is None and (self.offer is None or recover is not None):
            self.decide(bring_back=bool(recover))

    def decide(self, *, bring_back: bool) -> None:
        """Recovers what an earlier session left, or keeps it aside, and continues.

        Further decisions do nothing. Where the file cannot be followed to its end, the changes up
        to there are recovered, the file is kept aside, and a new journal starts.
        """
        with self._lock:
            if self._running or self.problem is not None:
                return
            offer, self.offer = self.offer, None
            try:
                if offer is not None and bring_back:
                    self._bring_back_second()
                    self._bring_back()
                else:
                    aside = self._keep_aside(held=offer is not None)
                    self._session.begin_journal(self.path, self._hash)
                    if aside is not None:
                        self._tell(
                            "The earlier changes are set aside: `palpate recover` in a terminal "
                            f"lists them for {KEPT_DAYS} days."
                        )
                self._running = True
                note_scan(self.path, self._session.scene.volume)
                self.note_second(self.second)
                self._note_steps()
            except (OSError, OptionError) as error:
                self._give_up(error)

    def note(self, looks: bytes) -> None:
        """Writes the appearance of segments into the journal, and their steps beside it."""
        if self._running:
            self._session.note_in_journal(looks)
            self._note_steps()

    def note_second(self, second: SecondScan | None) -> None:
        """Notes the second scan and its place."""
        if self._running:
            try:
                keep_second(self._second_path, second)
            except OSError as error:
                self._tell(f"The second scan is not kept for a crash: {error}")

    def note_saved(self, scene: str) -> None:
        """Notes that the scene file with this ``save_id`` has all that the journal has now."""
        if not self._running:
            return
        with self._lock:
            note = _Saved(scene=scene, files=self._files())
            try:
                with whole_file(self._saved_path) as unfinished:
                    unfinished.write_bytes(msgspec.json.encode(note))
            except OSError as error:
                self._tell(f"It is not noted that the scene was saved: {error}")

    def close(self) -> None:
        """Removes a journal without changes, and reports one with changes.

        To be called after the session was stopped. It is let go of for other sessions.
        """
        try:
            self._close()
        finally:
            self._disown()

    def _close(self) -> None:
        if not self._running:
            return
        self._running = False
        frame = self._session.frame()
        if frame["can_undo"] or frame["can_redo"] or self._second_path.exists():
            self._tell("Your changes are kept: the next start with this scan offers them.")
        else:
            for path in (self.path, self._steps_path, self._saved_path, self._scan_path):
                path.unlink(missing_ok=True)

    def _own(self) -> None:
        """Takes the lock of the journal.

        Raises:
            OptionError: Another session has it.
        """
        self._owned = FileLock.take(lock_of(self.path))
        if self._owned is None:
            raise OptionError(
                "this scan is open in another session, which has its journal; allowed: one session "
                "of a scan at a time"
            )

    def _disown(self) -> None:
        if self._owned is not None:
            self._owned.let_go()
            self._owned = None

    def _remove_old(self) -> None:
        removed = remove_old(self._folder)
        if removed:
            some = counted(removed, "journal that was", "journals that were")
            self._tell(
                f"{some} set aside {KEPT_DAYS} days ago or longer, or beyond 1 GiB, is removed."
            )

    def _note_steps(self) -> None:
        steps = self._session.kept_steps(all_of_them=True)
        if steps is None or steps == self._steps:
            return
        try:
            with whole_file(self._steps_path) as unfinished:
                unfinished.write_bytes(steps)
        except OSError as error:
            self._tell(f"Steps of segments are not kept for a crash: {error}")
        self._steps = steps

    def _look(self, *, wanted: bool) -> None:
        """Looks for changes to recover; one without steps counts only where it is ``wanted``."""
        try:
            found = self._session.look_at_journal(self.path, self._hash)
        except OptionError as error:
            # no journal any more: it is in the way, and perhaps somebody can still read it
            aside = self._keep_aside(held=True)
            self._tell(f"{error}; it was kept aside as {aside}")
            return
        second = second_name(self._second_path)
        if (found is not None and (wanted or found != (0, 0))) or second is not None:
            steps, lost = found or (0, 0)
            newest = max(
                path.stat().st_mtime for path in (self.path, self._second_path) if path.exists()
            )
            when = datetime.fromtimestamp(newest).astimezone()
            self.offer = Offer(steps=steps, when=when, lost_bytes=lost, second=second)

    @property
    def _second_path(self) -> Path:
        return self.path.with_suffix(SECOND)

    @property
    def _scan_path(self) -> Path:
        return self.path.with_suffix(SCAN)

    def _is_saved_in(self, scene: str) -> bool:
        """Says whether a scene file has all that an earlier session left."""
        try:
            note = msgspec.json.decode(self._saved_path.read_bytes(), type=_Saved)
        except (OSError, msgspec.DecodeError):
            return False
        return note == _Saved(scene=scene, files=self._files())

    def _files(self) -> list[str | None]:
        """Returns hashes of the files of the journal; None for one that is not there."""
        places = (self.path, self._second_path, self._steps_path)
        return [
            sha256(place.read_bytes()).hexdigest() if place.exists() else None for place in places
        ]

    @property
    def _saved_path(self) -> Path:
        return self.path.with_suffix(".saved")

    @property
    def _steps_path(self) -> Path:
        return self.path.with_suffix(STEPS)

    def _bring_back_steps(self) -> None:
        try:
            self._session.restore_steps(self._steps_path.read_bytes())
        except FileNotFoundError:
            # written by an earlier version
            return
        except (OptionError, OSError) as error:
            self._tell(f"Steps of segments were not brought back: {error}")

    def _bring_back_second(self) -> None:
        if not self._second_path.exists():
            return
        try:
            self.second = kept_second(self._second_path)
        except (PalpateError, OSError) as error:
            aside = put_aside(self.path, [SECOND])
            self.lost_second = (
                f"The second scan was not brought back: {error}. What is known of it was kept as "
                f"{aside}."
            )
            self._tell(self.lost_second)

    def _bring_back(self) -> None:
        if not self.path.exists():
            self._session.begin_journal(self.path, self._hash)
            return
        try:
            _, _, notes = self._session.recover_journal(self.path, self._hash)
        except OptionError as error:
            aside = self._keep_aside(held=True)
            self._session.begin_journal(self.path, self._hash)
            self._tell(f"Not all could be brought back: {error}. The file was kept as {aside}.")
            return
        self.looks = notes[-1] if notes else None
        self._bring_back_steps()

    def _keep_aside(self, *, held: bool) -> Path | None:
        """Makes room for a new file; one with changes (``held``) gets another name."""
        self._saved_path.unlink(missing_ok=True)
        if not held:
            for path in (self.path, self._second_path, self._steps_path):
                path.unlink(missing_ok=True)
            return None
        return put_aside(self.path)

    def _give_up(self, error: Exception) -> None:
        self.problem = f"Changes are not kept for a crash: {error}"
        self._tell(self.problem)
        self._disown()
