"""What a session can do with its journal: every change on disk, so that a crash loses none."""

from __future__ import annotations

from pathlib import Path

from palpate.session.part import SessionPart, given

__all__ = ["SessionJournal"]


class SessionJournal(SessionPart):
    """The journal of a session."""

    def look_at_journal(self, path: Path, scan_hash: bytes) -> tuple[int, int] | None:
        """Counts the steps of a journal and the bytes at its end that are lost.

        Returns:
            Both, or None where there is no such file.

        Raises:
            OptionError: The file is no journal of this scan.
            OSError: The disk refuses it, or another session writes it (BlockingIOError).
        """
        with given():
            return self._internal.look_at_journal(path, scan_hash)

    def begin_journal(self, path: Path, scan_hash: bytes) -> None:
        """Writes every change to a new file from now on, after what is there now.

        Raises:
            OSError: The file exists already, or the disk refuses it.
        """
        with given():
            self._internal.begin_journal(path, scan_hash)

    def keep_state(self, path: Path, scan_hash: bytes) -> None:
        """Writes what is there now into a new file, as a journal without steps.

        Raises:
            OptionError: The file exists already, or the disk says no.
        """
        with given():
            self._internal.keep_state(path, scan_hash)

    def recover_journal(self, path: Path, scan_hash: bytes) -> tuple[int, int, list[bytes]]:
        """Does again what a journal says, step by step, and goes on with that file.

        Returns:
            Steps, bytes at the end that are lost, and notes, oldest first.

        Raises:
            OptionError: A record cannot be; what came before it is there then.
            OSError: The disk refuses it, or another session writes it (BlockingIOError).
        """
        with given():
            return self._internal.recover_journal(path, scan_hash)

    def end_journal(self) -> None:
        """Writes what waits and closes the journal."""
        with given():
            self._internal.end_journal()

    def note_in_journal(self, note: bytes) -> None:
        """Keeps bytes beside the voxels, where there is a journal."""
        self._internal.note_in_journal(note)
