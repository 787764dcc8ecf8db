"""Scenes for pages: the file that keeps one, and the view of one that was opened."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any
from uuid import uuid4

import msgspec
from starlette.responses import Response

from palpate.base.counted import counted
from palpate.saved.autosave import note_scene
from palpate.saved.ending import ENDING
from palpate.saved.journal import Journal
from palpate.saved.kept_with_scan import KEPT_IN_VIEW, KeptWithScan
from palpate.saved.scene_file import save_scene
from palpate.server.download import file_name, file_response
from palpate.server.messages.segment_list import SegmentList
from palpate.session.session import Session

__all__ = ["MOST_VIEW_BYTES", "scene_response", "shared_scene_response", "view_response"]

MOST_VIEW_BYTES = 1 << 16
"""Bytes of a view that a page saves; it takes some 2 kB."""


class SceneRequest(msgspec.Struct, frozen=True):
    """What a page asks to be saved."""

    view: dict[str, Any]
    """Camera, windows and panels; only pages read it."""
    copy: bool = False
    """Whether the scan goes into the file."""


class SharedSceneRequest(msgspec.Struct, frozen=True):
    """What a page asks to be saved for others."""

    view: dict[str, Any]
    names_checked: bool = False
    """Whether the person says that no name of a segment or mark names anybody."""
    pixels_checked: bool = False
    """Whether the person has looked for text in the pixels."""


def scene_response(
    session: Session,
    segments: SegmentList,
    body: bytes,
    *,
    passing: bool = False,
    journal: Journal | None = None,
    kept: KeptWithScan | None = None,
) -> Response:
    """Saves a scene and answers with its file; or with why it cannot be saved.

    The ``journal`` of the session notes that its changes are saved. The file of a scan whose own
    files are ``passing`` holds the scan whether asked for or not. What is ``kept`` with the scan is
    a part of the view.
    """

    def write(wanted: SceneRequest, folder: Path) -> tuple[Path, list[str]]:
        path = folder / f"{file_name(session.scene.volume.title, 'scene')}{ENDING}"
        save_id = uuid4().hex
        scan = save_scene(
            path,
            session,
            looks=segments.kept(),
            view=_whole_view(wanted.view, kept),
            copy=wanted.copy or passing,
            save_id=save_id,
        )
        if journal is not None:
            journal.note_saved(save_id)
        # the browser puts it where only it knows
        note_scene(scan, path, passing=True)
        return path, []

    return file_response(body, SceneRequest, write, most_bytes=MOST_VIEW_BYTES, called="view")


def shared_scene_response(
    session: Session,
    segments: SegmentList,
    body: bytes,
    *,
    passing: bool = False,
    kept: KeptWithScan | None = None,
) -> Response:
    """Answers with the scene's file as others may have it; or with why it cannot be shared."""

    def write(wanted: SharedSceneRequest, folder: Path) -> tuple[Path, list[str]]:
        from palpate.saved.shared_scene import share_scene

        own, shared = (folder / f"{name}{ENDING}" for name in ("own", "shared"))
        view = _whole_view(wanted.view, kept)
        save_scene(own, session, looks=segments.kept(), view=view, copy=passing)
        names = share_scene(
            own,
            shared,
            # files that were dropped on the page are there, and the file that is shared has none
            scan=session.scene.volume,
            names_checked=wanted.names_checked,
            pixels_checked=wanted.pixels_checked,
        )
        numbered = counted(names.replaced, "name", "names")
        return shared, [f"{numbered} became numbers"] if names.replaced else []

    return file_response(body, SharedSceneRequest, write, most_bytes=MOST_VIEW_BYTES, called="view")


def _whole_view(view: dict[str, Any], kept: KeptWithScan | None) -> dict[str, Any]:
    return view if kept is None else {**view, KEPT_IN_VIEW: kept.in_view()}


def view_response(view: Mapping[str, Any] | None) -> Response:
    """Answers with the view of a scene that was opened; with nothing where there is none."""
    if view is None:
        return Response(status_code=204)
    return Response(msgspec.json.encode(view), media_type="application/json")
