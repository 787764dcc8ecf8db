"""The scan of a saved scene with its edits and segments, without a page."""

from __future__ import annotations

from palpate.saved.scene_file import SavedScene
from palpate.session.appearance import (
    ShownAppearance,
    appearance_of_number,
    restore_appearances,
    scene_with_appearances,
)
from palpate.session.edited_values import EditedValues
from palpate.session.session import Session, SessionOptions
from palpate.volumes.scene import Scene

__all__ = ["edited_scene"]

SETTLED = 0.05
"""Simulated time in which the picture of a session follows recovered edits [s]."""


def edited_scene(saved: SavedScene) -> tuple[Scene, list[str]]:
    """Returns the edited scan of a saved scene, and sentences on what files cannot store.

    Raises:
        SceneFormatError: The file is damaged.
        OptionError: Names and colours cannot be read.
    """
    with Session(Scene(saved.volume), options=SessionOptions(real_time=False)) as session:
        saved.restore(session)
        appearances = restore_appearances(session, saved.looks)
        session.run(SETTLED)
        edited = EditedValues(saved.volume.array)
        for change in session.picture_changes():
            for box in change["voxels"]:
                if box["stored"] is not None:
                    edited.write(box["low"], box["high"], box["stored"])

        def appearance_of(segment_id: int) -> ShownAppearance:
            return appearances.get(segment_id, appearance_of_number(segment_id))

        return scene_with_appearances(session, edited.values, appearance_of)
