"""The recording that pages begin and end, and the file that they get.

A finished recording stays until the next one is finished, so that every page can fetch it. Every
method may be called from any thread.
"""

from __future__ import annotations

import re
import shutil
from pathlib import Path
from tempfile import TemporaryDirectory
from threading import Lock

from palpate.base.errors import OptionError
from palpate.base.whole_file import whole_file
from palpate.session.recording import Recording
from palpate.session.session import Session

__all__ = ["Recorder", "summary"]

ENDING = ".palpate-session"


def summary(recording: Recording) -> str:
    """Says what a recording holds, and what it lacks."""
    said = (
        f"{recording.seconds:.1f} s ({len(recording)} ticks), {recording.contact_share:.0%} in "
        f"contact, largest force {recording.largest_force:.2f} N"
    )
    if recording.lost:
        said += f"; {recording.lost} ticks were lost, and it can be replayed up to there only"
    elif not recording.can_be_replayed:
        said += "; it cannot be replayed, since a change waited for the probe all the time"
    return said


class Recorder:
    """Keeps at most one running recording of a session, and the last finished one."""

    def __init__(self, session: Session) -> None:
        """Records this session."""
        self._session = session
        self._lock = Lock()
        self._folder: TemporaryDirectory[str] | None = None
        self._running = False
        self._files: list[Path] = []
        self._finished = 0

    @property
    def is_running(self) -> bool:
        """Whether ticks are kept now."""
        return self._running

    def newest(self) -> Path | None:
        """Returns the last finished recording; one that is being written is waited for."""
        with self._lock:
            return self._files[-1] if self._files else None

    @property
    def file_name(self) -> str:
        """What to call it where it is kept."""
        name = re.sub(r"[^\w.-]+", "-", self._session.scene.volume.title).strip("-.")
        return f"{name[:60] or 'session'}{ENDING}"

    def start(self) -> None:
        """Begins a recording.

        Raises:
            OptionError: One runs already.
        """
        with self._lock:
            if self._running:
                raise OptionError("a recording runs already; allowed: one at a time")
            self._session.start_recording()
            self._running = True

    def stop(self) -> str:
        """Ends the recording and writes its file; says what it holds.

        Raises:
            OptionError: None runs.
        """
        with self._lock:
            if not self._running:
                raise OptionError("no recording runs; allowed: to end one that was begun")
            self._running = False
            recording = self._session.stop_recording()
            if self._folder is None:
                self._folder = TemporaryDirectory(prefix="palpate-")
            self._finished += 1
            file = Path(self._folder.name) / f"{self._finished}{ENDING}"
            recording.save(file)
            self._files.append(file)
            # the one before may be on its way to a page
            for old in self._files[:-2]:
                old.unlink(missing_ok=True)
            del self._files[:-2]
            return summary(recording)

    def keep(self, target: Path) -> None:
        """Copies the last finished recording to a place of its own."""
        file = self.newest()
        if file is not None:
            with whole_file(target) as unfinished:
                shutil.copyfile(file, unfinished)

    def close(self) -> None:
        """Removes the files that were not kept."""
        with self._lock:
            self._files.clear()
            if self._folder is not None:
                self._folder.cleanup()
                self._folder = None
