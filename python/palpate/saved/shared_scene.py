"""A scene for others: with its scan, and without paths, identifiers and names of people."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import msgspec

from palpate.base.progress import Progress, silent
from palpate.saved.kept_with_scan import KEPT_IN_VIEW, parts_in
from palpate.saved.scene_file import SavedScene, open_scene, save_scene
from palpate.saved.shared_names import SharedNames
from palpate.session.appearance import (
    appearance_of_number,
    keep_appearances,
    restore_appearances,
)
from palpate.session.known_steps import KeptList
from palpate.session.session import Session, SessionOptions
from palpate.volumes.scan_hash import scan_identity
from palpate.volumes.scene import Scene
from palpate.volumes.second_scan import SecondScan
from palpate.volumes.volume import Volume, VolumeTraits

__all__ = ["share_scene"]

SEEN_FROM = ("camera", "crosshair")
"""Parts of a view that are numbers. Which panels a person had open is nobody else's business."""


def share_scene(
    path: Path,
    out: Path,
    *,
    scan: Volume | None = None,
    names_checked: bool = False,
    pixels_checked: bool = False,
    progress: Progress = silent,
) -> SharedNames:
    """Writes a scene that others may have; returns what names are in it.

    Headers tell which words name somebody, and whether pixels have text. They are those of the
    files of ``scan``; by default of the scan that the scene links to. A scene that holds its scan
    has none.

    Raises:
        SceneFormatError: The scene cannot be opened, or its scan is not there.
        UncheckedPixelsError: There may be text in the pixels, and nobody has looked.
        OSError: The disk refuses the new file.
    """
    saved = open_scene(path, progress=progress)
    names = SharedNames.of(
        saved.volume if scan is None else scan,
        checked=names_checked,
        pixels_checked=pixels_checked,
        progress=progress,
    )
    scene = _without_names(saved)
    with Session(scene, options=SessionOptions(real_time=False)) as session:
        saved.restore(session)
        shown = restore_appearances(session, saved.looks)

        def renamed(number: int) -> Any:  # noqa: ANN401  # an appearance of a segment
            look = shown.get(number, appearance_of_number(number))
            return msgspec.structs.replace(look, name=names.name(look.name, f"segment {number}"))

        looks = keep_appearances(session, renamed)
        _rename_in_steps(session, names)
        view = None if saved.view is None else _shared_view(saved.view, scene, names)
        progress(f"writing {out.name}", None)
        save_scene(out, session, looks=looks, view=view, copy=True)
    return names


def _without_names(saved: SavedScene) -> Scene:
    """Returns the scans of a scene, which know neither where they are from nor whose they are."""
    scene = Scene(_nameless(saved.volume))
    if saved.second is not None:
        second = saved.second
        scene.second = SecondScan(_nameless(second.volume), second.second_from_first)
    return scene


def _nameless(volume: Volume) -> Volume:
    return Volume(
        volume.array,
        spacing=volume.spacing,
        origin=volume.origin,
        direction=volume.direction,
        slope=volume.slope,
        intercept=volume.intercept,
        exact=volume.exact,
        traits=VolumeTraits(
            name=volume.modality or "scan",
            modality=volume.modality,
            unit=volume.unit,
            orientation_known=volume.traits.orientation_known,
        ),
    )


def _rename_in_steps(session: Session, names: SharedNames) -> None:
    """Renames the segments that steps say they united, subtracted or intersected."""
    kept = session.kept_steps()
    if kept is None:
        return
    lists = msgspec.msgpack.decode(kept, type=list[KeptList])
    renamed = [
        each
        if each.steps is None
        else msgspec.structs.replace(each, steps=each.steps.with_names(names.name))
        for each in lists
    ]
    session.restore_steps(msgspec.msgpack.encode(renamed))


def _shared_view(view: Mapping[str, Any], scene: Scene, names: SharedNames) -> dict[str, Any]:
    """Returns where it is seen from, and marks and looks with other names."""
    parts = {}
    for part, value in parts_in(view, scene).items():
        kind, _, rest = part.partition(".")
        if kind == "second" and scene.second is not None:
            # it was known by UIDs too
            rest = scan_identity(scene.second.volume)
        parts[f"{kind}.{rest}".strip(".")] = _renamed(value, f"{kind} {rest}".strip(), names)
    return {**{one: view.get(one) for one in SEEN_FROM}, KEPT_IN_VIEW: parts}


def _renamed(value: Any, otherwise: str, names: SharedNames) -> Any:  # noqa: ANN401  # JSON
    """Returns JSON with other names in it."""
    if isinstance(value, dict):
        return {
            key: names.name(held, otherwise)
            if key == "name" and isinstance(held, str) and held
            else _renamed(held, otherwise, names)
            for key, held in value.items()
        }
    return [_renamed(one, otherwise, names) for one in value] if isinstance(value, list) else value
