"""What routes have in common: JSON in requests and responses, and errors as text."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

import msgspec
from starlette.requests import ClientDisconnect, Request
from starlette.responses import PlainTextResponse, Response
from starlette.types import ASGIApp

from palpate.base.errors import OptionError, PalpateError
from palpate.server.page_words import page_words

__all__ = ["errors_as_text", "json_body", "json_response", "whole_body"]

MOST_BODY_BYTES = 1 << 24
"""Bytes of a request: a list of 50 000 files to upload."""

Wanted = TypeVar("Wanted")


async def json_body(request: Request, kind: type[Wanted], *, most: int = MOST_BODY_BYTES) -> Wanted:
    """Returns the JSON of a request as a structure.

    Raises:
        OptionError: It is too much, or something else.
    """
    try:
        return msgspec.json.decode(await whole_body(request, most=most), type=kind)
    except msgspec.DecodeError as error:
        raise OptionError(f"this is not understood: {error}") from None


async def whole_body(request: Request, *, most: int = MOST_BODY_BYTES) -> bytes:
    """Returns the body of a request, which is at most so many bytes.

    Raises:
        OptionError: It is more, which is known before all of it has come, or the page has left.
    """
    body = bytearray()
    try:
        async for chunk in request.stream():
            body += chunk
            if len(body) > most:
                raise OptionError(f"more than {most} bytes given; allowed: fewer")
    except ClientDisconnect:
        raise OptionError("the page has left while it asked") from None
    return bytes(body)


def json_response(content: object) -> Response:
    """Returns an answer."""
    return Response(msgspec.json.encode(content), media_type="application/json")


def errors_as_text(handle: Callable[[Request], Any]) -> Callable[[Request], Any]:
    """Answers 400 and the message of the error where a handler fails."""

    async def wrapped(request: Request) -> ASGIApp:
        try:
            answer: ASGIApp = await handle(request)
        except (PalpateError, OSError) as error:
            return PlainTextResponse(page_words(str(error)), status_code=400)
        return answer

    return wrapped
