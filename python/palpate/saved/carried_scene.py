"""A saved scene, carried to the other scan through a transform: scan, segments and marks.

The new file holds the scan on the other grid. Marks are the page's own; their points are carried
one by one. What depends on where the person stood (camera, clipping) is left out.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from palpate.base.counted import counted
from palpate.base.progress import Progress
from palpate.registration.carry import Carrier
from palpate.saved.edited_scene import edited_scene
from palpate.saved.kept_with_scan import KEPT_IN_VIEW, parts_in
from palpate.saved.scene_file import open_scene, save_scene
from palpate.session.appearance import appearances_of, keep_appearances
from palpate.session.session import Session, SessionOptions
from palpate.volumes.scene import Scene, SceneSegment
from palpate.volumes.segment import Segment

__all__ = ["carry_scene"]


def carry_scene(
    path: Path, out: Path, carrier: Carrier, *, progress: Progress
) -> tuple[str, list[str]]:
    """Writes a scene as it comes to lie in the other scan.

    Returns:
        What was written, in words; and sentences on what was left out or lost.

    Raises:
        SceneFormatError: The scene cannot be opened.
        OptionError: Nothing of it comes to lie in the other scan, or a mark has no place there.
        OSError: The disk refuses the new file.
    """
    saved = open_scene(path, progress=progress)
    scene, notes = edited_scene(saved)
    notes = [*saved.messages, *notes]
    shown = [one for one in scene if not one.segment.has_own_grid]
    notes += [
        f"{one.name} has a grid of its own and is left out: carry its surface instead"
        for one in scene
        if one.segment.has_own_grid
    ]
    progress("carrying the scan", None)
    made = Scene(carrier.scan(scene.volume))
    segments, told = carrier.segments([one.segment for one in shown])
    for one, segment in zip(shown, segments, strict=True):
        if segment is not None:
            _add_like(made, segment_of=one, segment=segment)
    view, marks = _carried_view(saved.view, carrier)
    progress(f"writing {out.name}", None)
    with Session(made, options=SessionOptions(real_time=False)) as session:
        looks = appearances_of(session)
        kept = keep_appearances(session, lambda number: looks[number])
        save_scene(out, session, looks=kept, view=view, copy=True)
    parts = counted(len(made), "segment", "segments"), counted(marks, "mark", "marks")
    return f"a scan, {' and '.join(parts)}", [*notes, *told]


def _add_like(scene: Scene, *, segment_of: SceneSegment, segment: Segment) -> None:
    """Adds a segment that is shown as it was."""
    added = scene.add(
        segment,
        colour=segment_of.colour,
        visible=segment_of.visible,
        touchable=segment_of.touchable,
        shown_as=segment_of.shown_as,
    )
    added.appearance = segment_of.appearance


def _carried_view(
    view: Mapping[str, Any] | None, carrier: Carrier
) -> tuple[dict[str, Any] | None, int]:
    """Returns the page's view with its marks carried and nothing else, and how many there are."""
    parts = {} if view is None else parts_in(view)
    marks = {name: part for name, part in parts.items() if name.startswith("mark.")}
    try:
        points = np.array([point for mark in marks.values() for point in mark["points"]], float)
        points = points.reshape(-1, 3)
    except (KeyError, TypeError, ValueError):
        return None, 0
    there = iter(carrier.points(points).tolist())
    carried = {
        name: {**mark, "points": [next(there) for _ in mark["points"]]}
        for name, mark in marks.items()
    }
    return ({KEPT_IN_VIEW: carried} if view is not None else None), len(carried)
