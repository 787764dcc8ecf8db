"""A file that a page asks for: written into a folder of its own, sent, and removed."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TypeVar
from urllib.parse import quote

import msgspec
from starlette.background import BackgroundTask
from starlette.responses import FileResponse, PlainTextResponse, Response

from palpate.base.errors import ConfirmationNeededError, PalpateError
from palpate.server.page_words import page_words

__all__ = ["file_name", "file_response", "refusal"]

MOST_NOTES = 1000
"""Letters."""
REFUSED = 400
TO_CONFIRM = 428
"""What the page asks for is done once its person has confirmed something: the reason says what."""

Wanted = TypeVar("Wanted")
Written = tuple[Path, Sequence[str]]
"""A file, and what was left out or lost in it."""


def file_response(
    body: bytes,
    kind: type[Wanted],
    write: Callable[[Wanted, Path], Written],
    *,
    most_bytes: int,
    called: str,
) -> Response:
    """Answers with the file that a page asks for, or with why there is none.

    What was left out or lost stands in the header ``X-Palpate-Notes``, a line each, in percent
    encoding.

    Args:
        body: What the page asks for, JSON.
        kind: Its type.
        write: Writes the file into a folder that is empty, and returns its path and what to note.
        most_bytes: Of ``body``.
        called: What the page asks for, in the sentence that it does not.
    """
    if len(body) > most_bytes:
        return refusal(f"{len(body)} bytes are too many. Send at most {most_bytes}")
    try:
        wanted = msgspec.json.decode(body, type=kind)
    except msgspec.DecodeError as error:
        return refusal(f"this is no {called}: {error}")
    folder = TemporaryDirectory(prefix="palpate-")
    try:
        path, notes = write(wanted, Path(folder.name))
    except (PalpateError, OSError, RuntimeError, MemoryError) as error:
        folder.cleanup()
        status = TO_CONFIRM if isinstance(error, ConfirmationNeededError) else REFUSED
        return refusal(page_words(str(error)) or "not enough memory", status=status)
    except BaseException:
        folder.cleanup()
        raise
    return FileResponse(
        path,
        media_type="application/octet-stream",
        filename=path.name,
        headers={"X-Palpate-Notes": quote("\n".join(notes)[:MOST_NOTES])} if notes else None,
        background=BackgroundTask(folder.cleanup),
    )


def file_name(called: str, otherwise: str = "shared") -> str:
    """Returns a name for a file of what is ``called`` so; that of a scan may name the patient."""
    return re.sub(r"[^\w.-]+", "-", called, flags=re.ASCII).strip("-.")[:60] or otherwise


def refusal(reason: str, *, status: int = REFUSED) -> Response:
    """Answers with why something cannot be done."""
    return PlainTextResponse(reason, status_code=status)
