"""A recording for others: without the name of the scan, names of people, and when it was made."""

from __future__ import annotations

from pathlib import Path

from msgspec.structs import replace

from palpate.saved.shared_names import SharedNames
from palpate.session.recording import Recording

__all__ = ["share_recording"]


def share_recording(path: Path, out: Path, *, names_checked: bool = False) -> SharedNames:
    """Writes a recording that others may have; returns what names are in it.

    It has no link to a scan, so nothing tells which words of a name name somebody.

    Raises:
        RecordingFormatError: The file is no recording, or a damaged one.
        OSError: The disk refuses the new file.
    """
    recording = Recording.load(path)
    names = SharedNames(None, checked=names_checked)
    about = recording.about
    if about is not None:
        segments = [
            replace(one, name=names.name(one.name, f"segment {one.id}")) for one in about.segments
        ]
        scan = replace(about.scan, name=about.scan.modality or "scan")
        recording.about = replace(about, recorded="", scan=scan, segments=segments)
    recording.save(out)
    return names
