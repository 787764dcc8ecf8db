"""What routes of the library have in common: bodies that are read, and answers to them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

import msgspec
from starlette.requests import Request
from starlette.responses import PlainTextResponse, Response
from starlette.types import ASGIApp

from palpate.base.errors import OptionError, PalpateError

__all__ = ["errors_as_text", "json_body", "json_response"]

MOST_BODY_BYTES = 1 << 24
"""Of a list of files that will come: 50 000 names."""

Wanted = TypeVar("Wanted")


async def json_body(request: Request, kind: type[Wanted]) -> Wanted:
    """Returns what a page asks.

    Raises:
        OptionError: It is too much, or something else.
    """
    body = b""
    async for chunk in request.stream():
        body += chunk
        if len(body) > MOST_BODY_BYTES:
            raise OptionError(f"more than {MOST_BODY_BYTES} bytes given; allowed: fewer files")
    try:
        return msgspec.json.decode(body, type=kind)
    except msgspec.DecodeError as error:
        raise OptionError(f"this is not understood: {error}") from None


def json_response(content: object) -> Response:
    """Returns an answer."""
    return Response(msgspec.json.encode(content), media_type="application/json")


def errors_as_text(handle: Callable[[Request], Any]) -> Callable[[Request], Any]:
    """Tells as a sentence what cannot be done."""

    async def wrapped(request: Request) -> ASGIApp:
        try:
            answer: ASGIApp = await handle(request)
        except (PalpateError, OSError) as error:
            return PlainTextResponse(str(error), status_code=400)
        return answer

    return wrapped
