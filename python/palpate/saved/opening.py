"""What is at a path, ready to be shown: a scan with the segment offered as bone, or a scene."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from palpate.base.errors import EmptySegmentError
from palpate.base.progress import Progress, silent
from palpate.io.reading import read
from palpate.saved.scene_file import ENDING, SavedScene, open_scene
from palpate.volumes.scene import Scene
from palpate.volumes.volume import Volume

__all__ = ["Opening", "is_scene", "offer_bone", "opening", "opening_of"]


@dataclass(frozen=True)
class Opening:
    """A scene that can be begun."""

    scene: Scene
    saved: SavedScene | None
    """The file that it comes from, where it was saved."""
    told: tuple[str, ...]
    """What a person should know of the reading."""


def opening(
    path: Path,
    *,
    series: str | None = None,
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
        return Opening(saved.scene(), saved, saved.told)
    return opening_of(read(path, series=series, raw=raw, voxel_size=voxel_size, progress=progress))


def opening_of(volume: Volume) -> Opening:
    """Returns a scan as it is opened."""
    scene = Scene(volume)
    told = offer_bone(scene)
    return Opening(scene, None, () if told is None else (told,))


def is_scene(path: Path) -> bool:
    """Says whether a path is that of a scene's file, by its name."""
    return path.suffix == ENDING and path.is_file()


def offer_bone(scene: Scene) -> str | None:
    """Adds the segment that is offered as bone; says so where there is none."""
    try:
        scene.add(scene.volume.offered_bone())
    except EmptySegmentError:
        return f"no bone found in {scene.volume.name}: choose a threshold on the page"
    return None
