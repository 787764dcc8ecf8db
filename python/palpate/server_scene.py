"""Scenes for pages: the file that keeps one, and the view of one that was opened."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import msgspec
from starlette.background import BackgroundTask
from starlette.responses import FileResponse, PlainTextResponse, Response

from palpate.errors import PalpateError
from palpate.scene_file import ENDING, save_scene
from palpate.server_segments import ShownSegments
from palpate.session import Session

__all__ = ["MOST_VIEW_BYTES", "scene_response", "view_response"]

MOST_VIEW_BYTES = 1 << 16
"""Of what a page asks to be kept; its view takes some 2 kB."""


class WantedScene(msgspec.Struct, frozen=True):
    """What a page asks to be saved."""

    view: dict[str, Any]
    """How it looks at the scan; only pages read it."""
    copy: bool = False
    """Whether the scan goes into the file."""


def scene_response(
    session: Session, segments: ShownSegments, body: bytes, *, passing: bool = False
) -> Response:
    """Saves a scene and answers with its file; one that cannot be is told as a sentence.

    The file of a scan whose own files are ``passing`` holds the scan whether asked for or not.
    """
    if len(body) > MOST_VIEW_BYTES:
        return _refusal(f"{len(body)} bytes given; allowed: {MOST_VIEW_BYTES}")
    try:
        wanted = msgspec.json.decode(body, type=WantedScene)
    except msgspec.DecodeError as error:
        return _refusal(f"this is no view: {error}")
    folder = TemporaryDirectory(prefix="palpate-")
    try:
        name = re.sub(r"[^\w.-]+", "-", session.scene.volume.title).strip("-.")[:60] or "scene"
        path = Path(folder.name) / f"{name}{ENDING}"
        copy = wanted.copy or passing
        save_scene(path, session, looks=segments.kept(), view=wanted.view, copy=copy)
    except (PalpateError, OSError, RuntimeError) as error:
        folder.cleanup()
        return _refusal(f"the scene was not saved: {error}")
    return FileResponse(
        path,
        media_type="application/octet-stream",
        filename=path.name,
        background=BackgroundTask(folder.cleanup),
    )


def view_response(view: Mapping[str, Any] | None) -> Response:
    """Answers with the view of a scene that was opened; with nothing where there is none."""
    if view is None:
        return Response(status_code=204)
    return Response(msgspec.json.encode(view), media_type="application/json")


def _refusal(reason: str) -> Response:
    return PlainTextResponse(reason, status_code=400)
