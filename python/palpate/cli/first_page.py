"""Starts the person's browser with the page of a server, so that no other user gets in by it."""

from __future__ import annotations

import sys
import webbrowser
from html import escape
from pathlib import Path
from tempfile import NamedTemporaryFile

from palpate.server.security import Access
from palpate.server.ticket import tells_owners

__all__ = ["show_in_browser"]

LEADS_ON = '<!doctype html><meta charset="utf-8"><meta http-equiv="refresh" content="0; url={}">'


def show_in_browser(access: Access) -> None:
    """Shows a server's page: by an address that works once, and for this user alone.

    Where the system does not tell whose a connection is, but shows all users the arguments of a
    browser, a file that nobody else can read leads to the address.
    """
    if tells_owners() or sys.platform == "win32":
        webbrowser.open(access.first_url)
    else:
        webbrowser.open(_file_to(access.first_url).as_uri())


def _file_to(address: str) -> Path:
    """Writes a page that leads to an address, in the command's own temporary folder."""
    # mode 0600
    with NamedTemporaryFile("w", suffix=".html", delete=False, encoding="utf-8") as file:
        file.write(LEADS_ON.format(escape(address)))
    return Path(file.name)
