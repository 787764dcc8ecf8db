"""What ``palpate export`` does once its options are understood."""

from __future__ import annotations

from pathlib import Path

import typer

from palpate.base.console import warn
from palpate.base.errors import OptionError
from palpate.base.progress import Progress
from palpate.export.export import KINDS, Kind, check_export, kind_of
from palpate.saved.edited_scene import edited_scene
from palpate.saved.scene_file import open_scene
from palpate.volumes.scene import Scene

__all__ = ["check_target", "saved_scene", "tell_export"]


def check_target(out: Path, kind: str | None, *, has_segments: bool, keep_identity: bool) -> Kind:
    """Returns what is to be written; refuses what could not be, before a scan is read.

    Raises:
        OptionError: The kind is not known, or does not fit the name.
    """
    if kind is not None and kind not in KINDS:
        raise OptionError(f"--as {kind} given; allowed: {', '.join(KINDS)}")
    known = kind_of(out, has_segments=has_segments) if kind is None else kind
    check_export(out, known, keep_identity=keep_identity)
    return known


def saved_scene(path: Path, progress: Progress) -> Scene:
    """Returns the scan of a scene that was saved, with its edits and segments.

    Raises:
        SceneFormatError: It cannot be opened.
    """
    saved = open_scene(path, progress=progress)
    scene, told = edited_scene(saved)
    for note in (*saved.volume.warnings, *told):
        warn(note)
    return scene


def tell_export(scene: Scene, out: Path, told: list[str]) -> None:
    """Says what was written."""
    for note in told:
        warn(note)
    files = sum(1 for file in out.rglob("*") if file.is_file()) if out.is_dir() else 1
    what = f"{files} files" if files > 1 else f"{out.stat().st_size / 2**20:.1f} MiB"
    typer.echo(f"{out}: {what}, of {len(scene)} segments in {scene.volume.name}")
