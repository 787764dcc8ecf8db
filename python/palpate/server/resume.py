"""How a page that is open goes on with a server that was started anew on its port.

Tokens are new with each start. Beside them a page gets a key, which stays for the port and never
goes over an unproven connection: server and page show each other that they know it, by HMAC of
numbers that are used once. So another program that takes the port meanwhile learns neither key nor
token, and a cookie that it is sent opens nothing later.

The key is in the folder of the program's state, readable by its person alone.

Sources: RFC 2104 (HMAC), ISO/IEC 9798-4 (mutual authentication in three passes).
"""

from __future__ import annotations

import hmac
import os
import secrets
from collections import deque
from contextlib import suppress
from pathlib import Path

import msgspec
from starlette.requests import Request
from starlette.responses import PlainTextResponse, Response
from starlette.routing import Route
from starlette.types import ASGIApp

from palpate.base.state_folder import keep, kept, private_folder, state_folder
from palpate.server.answers import errors_as_text, json_body, json_response
from palpate.server.security import RESUME, Access

__all__ = ["Resuming", "kept_key", "kept_port", "note_port"]

KEY_BYTES = 32
MOST_WAITING = 16
"""Pages that are asked for their proof at once."""
MOST_BYTES = 1 << 12
"""Bytes of a request, which may be anybody's."""
MOST_PORTS = 64


class ResumeRequest(msgspec.Struct, frozen=True):
    """What a page asks that was let in before."""

    nonce: str
    """A number of its own, used once."""
    answers: str | None = None
    """The number of ours that it answers; None where it asks for one."""
    proof: str = ""


class Resuming:
    """Proves to pages that this is their server, and lets those in that prove that they were."""

    def __init__(self, access: Access) -> None:
        """Lets pages in by ``access``."""
        self._access = access
        self._asked: deque[str] = deque(maxlen=MOST_WAITING)

    @property
    def routes(self) -> list[Route]:
        """The way in, which needs no token, and the key, which does."""
        return [
            Route(RESUME, errors_as_text(self._resume), methods=["POST"]),
            Route(f"{RESUME}/key", errors_as_text(self._key), methods=["GET"]),
        ]

    async def _key(self, _: Request) -> ASGIApp:
        return json_response({"key": self._access.key})

    async def _resume(self, request: Request) -> ASGIApp:
        wanted = await json_body(request, ResumeRequest, most=MOST_BYTES)
        if wanted.answers is None:
            number = secrets.token_hex(KEY_BYTES)
            self._asked.append(number)
            proof = self._proof("server", wanted.nonce, number)
            return json_response({"nonce": number, "proof": proof})
        if wanted.answers not in self._asked:
            return PlainTextResponse("this was not asked, or was answered", status_code=403)
        self._asked.remove(wanted.answers)
        expected = self._proof("page", wanted.nonce, wanted.answers)
        if not secrets.compare_digest(expected.encode(), wanted.proof.encode()):
            return PlainTextResponse("the proof is wrong", status_code=403)
        return Response(status_code=204, headers={"Set-Cookie": self._access.set_cookie})

    def _proof(self, whose: str, *numbers: str) -> str:
        said = " ".join((whose, str(self._access.port), *numbers))
        return hmac.new(self._access.key.encode(), said.encode(), "sha256").hexdigest()


def kept_key(port: int) -> str:
    """Returns the key of a port; one that cannot be kept is good for this start only."""
    path = _folder() / f"{port}.key"
    fresh = secrets.token_hex(KEY_BYTES)
    with suppress(OSError):
        private_folder(_folder())
        with suppress(FileExistsError):
            _write_private(path, fresh)
        kept = path.read_text("ascii")
        # one that others could read, or that was cut off, proves nothing
        if len(kept) == len(fresh) and _is_private(path):
            return kept
        path.unlink()
        _write_private(path, fresh)
    return fresh


def kept_port(name: str) -> int:
    """Returns the port where such a scan was shown last; 0 where it was nowhere."""
    return _ports().get(name, 0)


def note_port(name: str, port: int) -> None:
    """Keeps where a scan is shown, so that it comes back there."""
    others = {known: at for known, at in _ports().items() if known != name and at != port}
    newest = dict([*others.items(), (name, port)][-MOST_PORTS:])
    keep(_ports_file(), newest)


def _ports() -> dict[str, int]:
    return kept(_ports_file(), dict[str, int]) or {}


def _ports_file() -> Path:
    return state_folder() / "ports.json"


def _folder() -> Path:
    return state_folder() / "doors"


def _write_private(path: Path, text: str) -> None:
    with os.fdopen(os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600), "w") as file:
        file.write(text)


def _is_private(path: Path) -> bool:
    # elsewhere the folder of a person is theirs alone
    return os.name != "posix" or (
        path.stat().st_mode & 0o077 == 0 and path.stat().st_uid == os.getuid()
    )
