"""Opening of a path: a scan with a default segment of bone, or a saved scene."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from palpate.base.errors import EmptySegmentError
from palpate.base.progress import Progress, silent
from palpate.io.reading import read
from palpate.saved.ending import is_scene
from palpate.saved.scene_file import SavedScene, open_scene
from palpate.volumes.scene import Scene
from palpate.volumes.volume import Volume

__all__ = ["Opening", "offer_bone", "opening", "opening_of"]


@dataclass(frozen=True)
class Opening:
    """A scene that is ready to be shown."""

    scene: Scene
    saved: SavedScene | None
    """The file of a saved scene."""
    messages: tuple[str, ...]
    """Messages on the reading for the user."""


def opening(
    path: Path,
    *,
    series: str | None = None,
    frame: int | None = None,
    raw: str | None = None,
    voxel_size: tuple[float, float, float] | None = None,
    progress: Progress = silent,
) -> Opening:
    """Reads what is at a path, with the options of ``palpate.read``.

    Raises:
        PalpateError: It cannot be read.
        FileNotFoundError: It does not exist.
    """
    if is_scene(path):
        saved = open_scene(path, progress=progress)
        return Opening(saved.scene(), saved, saved.messages)
    volume = read(
        path, series=series, frame=frame, raw=raw, voxel_size=voxel_size, progress=progress
    )
    return opening_of(volume)


def opening_of(volume: Volume) -> Opening:
    """Returns a scan as an opening."""
    scene = Scene(volume)
    message = offer_bone(scene)
    return Opening(scene, None, () if message is None else (message,))


def offer_bone(scene: Scene) -> str | None:
    """Adds the default segment of bone; returns a message where there is none."""
    try:
        scene.add(scene.volume.offered_bone())
    except EmptySegmentError:
        return f"no bone found in {scene.volume.name}: choose a threshold on the page"
    return None
