"""Who may talk to the server: the page that the person opened, and nothing else.

The server listens on 127.0.0.1 only. Other programs and other web pages of the same machine
are kept out by a random token, and by comparing Host and Origin against DNS rebinding and
cross-site requests. Every route passes here, the WebSocket too.

Sources: RFC 6454 (Origin), RFC 6265bis (SameSite), W3C Content Security Policy Level 3.
"""

from __future__ import annotations

import secrets
from collections.abc import MutableMapping
from dataclasses import dataclass, field
from html import escape
from http.cookies import CookieError, SimpleCookie
from typing import Any
from urllib.parse import parse_qs

from starlette.datastructures import Headers, MutableHeaders
from starlette.responses import HTMLResponse, RedirectResponse
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from palpate.server.ticket import Ticket

__all__ = ["RESUME", "Access", "AccessMiddleware"]

HOSTS = ("127.0.0.1", "localhost")
ENTRANCE = ("GET", "/")
RESUME = "/api/resume"
"""The one route without a token: there pages prove in another way that they were let in before."""


@dataclass(frozen=True)
class Access:
    """What a request has to carry to be let in."""

    port: int
    token: str = field(default_factory=lambda: secrets.token_urlsafe(24), repr=False)
    key: str = field(default_factory=lambda: secrets.token_hex(32), repr=False)
    """With it pages of an earlier start of this port are let in again."""
    ticket: Ticket = field(default_factory=Ticket, repr=False)
    """Lets in the browser that the command starts."""

    @property
    def url(self) -> str:
        """The address to open, token and all."""
        return f"http://{HOSTS[0]}:{self.port}/?token={self.token}"

    @property
    def first_url(self) -> str:
        """The address for the browser that is started, which others may read: it works once."""
        return f"http://{HOSTS[0]}:{self.port}/?ticket={self.ticket.value}"

    @property
    def cookie(self) -> str:
        """Name of the cookie: the port is in it, since ports share cookies."""
        return f"palpate-{self.port}"

    @property
    def set_cookie(self) -> str:
        """What has a browser keep the token, out of reach of scripts.

        Lax: a link from elsewhere may open the page, but nothing else is let in from there.
        """
        return f"{self.cookie}={self.token}; Path=/; HttpOnly; SameSite=Lax"

    @property
    def hosts(self) -> tuple[str, ...]:
        """Values of Host that are let in."""
        return tuple(f"{host}:{self.port}" for host in HOSTS)

    @property
    def origins(self) -> tuple[str, ...]:
        """Values of Origin that are let in."""
        return tuple(f"http://{host}" for host in self.hosts)

    def refuses(
        self, headers: Headers, query: str, *, websocket: bool, known: bool = False
    ) -> str | None:
        """Says why a request is not let in; None where it is. Who is ``known`` needs no token."""
        if headers.getlist("host") not in [[host] for host in self.hosts]:
            return "this address is not the one that Palpate printed"
        origin = headers.get("origin")
        if origin not in self.origins and (origin is not None or websocket):
            return "another page asked for this"
        if not known and not self._knows(headers, query):
            return "the token is missing or wrong"
        return None

    def gives_token(self, query: str) -> bool:
        """Says whether the token stands in a query."""
        return any(self._is_token(given) for given in parse_qs(query).get("token", []))

    def takes_ticket(self, query: str, client: tuple[str, int] | None) -> bool:
        """Says whether a ticket stands in a query that lets its client in; it does once."""
        return any(
            self.ticket.take(given, client=client, port=self.port)
            for given in parse_qs(query).get("ticket", [])
        )

    def _knows(self, headers: Headers, query: str) -> bool:
        try:
            cookies = SimpleCookie(headers.get("cookie", ""))
        except CookieError:
            cookies = SimpleCookie()
        kept = cookies.get(self.cookie)
        return self.gives_token(query) or (kept is not None and self._is_token(kept.value))

    def _is_token(self, given: str) -> bool:
        # takes the same time wherever the first difference is
        return secrets.compare_digest(given.encode(), self.token.encode())

    @property
    def policy(self) -> str:
        """Content security policy: everything from here, styles also in place."""
        sockets = " ".join(f"ws://{host}" for host in self.hosts)
        return (
            "default-src 'none'; script-src 'self'; style-src 'self' 'unsafe-inline'; "
            f"img-src 'self' data: blob:; connect-src 'self' {sockets}; "
            "worker-src 'self' blob:; font-src 'self'; base-uri 'none'; form-action 'none'; "
            "frame-ancestors 'none'"
        )


class AccessMiddleware:
    """Lets in who carries the token, and puts protective headers on every answer."""

    def __init__(self, app: ASGIApp, *, access: Access) -> None:
        """Stands before an app."""
        self.app = app
        self.access = access

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Handles one connection, as ASGI asks for it."""
        if scope["type"] == "lifespan":
            await self.app(scope, receive, send)
            return
        query = scope["query_string"].decode("latin-1")
        websocket = scope["type"] == "websocket"
        asked = None if websocket else (scope["method"], scope["path"])
        has_ticket = asked == ENTRANCE and self.access.takes_ticket(query, scope["client"])
        reason = self.access.refuses(
            Headers(scope=scope),
            query,
            websocket=websocket,
            known=has_ticket or asked == ("POST", RESUME),
        )
        enters = asked == ENTRANCE and (has_ticket or self.access.gives_token(query))
        if reason is None:
            # what lets in leaves the address bar, and the history too
            app = RedirectResponse("/", 303) if enters else self.app
            await app(scope, receive, self._guarded(send, enters=enters))
        elif websocket:
            # closed before it was accepted: the browser sees 403
            await receive()
            await send({"type": "websocket.close", "code": 1008, "reason": reason})
        else:
            await refusal(reason)(scope, receive, self._guarded(send, enters=False))

    def _guarded(self, send: Send, *, enters: bool) -> Send:
        """Returns a ``send`` that adds headers, and the cookie for a page that ``enters``."""

        async def guarded(message: Message) -> None:
            if message["type"] == "http.response.start":
                self._protect(message, enters=enters)
            await send(message)

        return guarded

    def _protect(self, message: MutableMapping[str, Any], *, enters: bool) -> None:
        headers = MutableHeaders(scope=message)
        headers["Content-Security-Policy"] = self.access.policy
        headers["Cache-Control"] = "no-store"
        headers["X-Content-Type-Options"] = "nosniff"
        headers["Referrer-Policy"] = "no-referrer"
        headers["Cross-Origin-Opener-Policy"] = "same-origin"
        headers["Cross-Origin-Resource-Policy"] = "same-origin"
        if enters:
            headers.append("Set-Cookie", self.access.set_cookie)


REFUSAL = """<!doctype html>
<html lang="en"><head><meta charset="utf-8"><title>Palpate</title><style>
body {{ background: #14171a; color: #d8dcdf; font: 16px/1.5 system-ui, sans-serif;
  display: grid; place-content: center; min-height: 90vh; margin: 0 24px }}
main {{ max-width: 36em }} h1 {{ font-size: 20px; color: #fff }} code {{ color: #7fd1c7 }}
</style></head><body><main><h1>Palpate did not open this page</h1><p>{text}</p></main></body></html>
"""


def refusal(reason: str) -> HTMLResponse:
    """Returns the page that a refused request gets, with the reason as plain text."""
    text = (
        f"Access denied: {reason}. Use the full address printed by `palpate open`, with its token; "
        "the browser has to accept a cookie for this machine."
    )
    return HTMLResponse(REFUSAL.format(text=escape(text)), status_code=403)
