"""The journal of a session: every change on disk, so that a crash loses none."""

from __future__ import annotations

from pathlib import Path

from palpate.session.engine import Engine, option_errors
from palpate.session.felt import FeltSegments
from palpate.session.step_groups import StepGroups

__all__ = ["SessionJournal"]


class SessionJournal:
    """Writes a journal, and recovers a session from one."""

    def __init__(self, engine: Engine, felt: FeltSegments, groups: StepGroups) -> None:
        """Takes the engine, and what learns which recovered segments are obstacles, and steps one.

        Args:
            engine: What writes and repeats changes.
            felt: What is felt.
            groups: Steps that are undone as one.
        """
        self._engine = engine
        self._felt = felt
        self._groups = groups

    def look_at_journal(self, path: Path, scan_hash: bytes) -> tuple[int, int] | None:
        """Inspects a journal without changing anything.

        Args:
            path: The file.
            scan_hash: SHA-256 of the scan, 32 bytes.

        Returns:
            The number of its steps, and of damaged bytes at its end; None where there is no file.

        Raises:
            OptionError: The file is not a journal of this scan.
            OSError: The file cannot be read, or another session writes it (BlockingIOError).
        """
        with option_errors():
            return self._engine.look_at_journal(path, scan_hash)

    def begin_journal(self, path: Path, scan_hash: bytes) -> None:
        """Starts a journal: the current state, and from now on every change.

        Args:
            path: A new file.
            scan_hash: SHA-256 of the scan, 32 bytes.

        Raises:
            OSError: The file exists, or cannot be written.
        """
        with option_errors():
            self._engine.begin_journal(path, scan_hash)

    def keep_state(self, path: Path, scan_hash: bytes) -> None:
        """Writes the current state as a journal without steps; a running journal continues.

        Args:
            path: A new file.
            scan_hash: SHA-256 of the scan, 32 bytes.

        Raises:
            OptionError: The file exists, or cannot be written.
        """
        with option_errors():
            self._engine.keep_state(path, scan_hash)

    def recover_journal(self, path: Path, scan_hash: bytes) -> tuple[int, int, list[bytes]]:
        """Repeats the changes of a journal, and continues it.

        Args:
            path: The file.
            scan_hash: SHA-256 of the scan, 32 bytes.

        Returns:
            The number of its steps, of damaged bytes at its end, and its notes, oldest first.

        Raises:
            OptionError: A record cannot be repeated; the changes before it are done then.
            OSError: The file cannot be read, or another session writes it (BlockingIOError).
        """
        with option_errors():
            try:
                steps, damaged, notes = self._engine.recover_journal(path, scan_hash)
                return steps, damaged, self._groups.take(notes)
            finally:
                self._felt.learn()

    def end_journal(self) -> None:
        """Writes what is pending, and closes the journal."""
        with option_errors():
            self._engine.end_journal()

    def note_in_journal(self, note: bytes) -> None:
        """Writes a note into the journal; does nothing where there is no journal.

        Args:
            note: Any bytes; ``recover_journal`` returns them.
        """
        self._engine.note_in_journal(note)
