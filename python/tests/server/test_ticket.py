"""The browser that a command starts gets in by an address that works once, for this user alone."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path
from socket import create_connection
from typing import Any

import httpx
import pytest
from palpate.cli import first_page
from palpate.cli.first_page import show_in_browser
from palpate.server.security import Access
from palpate.server.ticket import LIFETIME, Ticket, tells_owners, user_of
from running_server import PATIENCE

NOBODY = 65534
ASK = """
import http.client, sys
connection = http.client.HTTPConnection("127.0.0.1", int(sys.argv[1]), timeout=20)
connection.request("GET", "/?ticket=" + sys.argv[2])
print(connection.getresponse().status)
"""
linux = pytest.mark.skipif(not tells_owners(), reason="the system tells no owners of connections")


def ask(access: Access, ticket: str) -> httpx.Response:
    address = f"http://127.0.0.1:{access.port}/?ticket={ticket}"
    return httpx.get(address, trust_env=False, timeout=PATIENCE)


def test_a_ticket_lets_in_once_and_gives_the_cookie(server: Any) -> None:
    access = server.access
    first = httpx.get(access.first_url, trust_env=False, timeout=PATIENCE)
    assert (first.status_code, first.headers["location"]) == (303, "/")
    assert first.headers["set-cookie"].startswith(f"{access.cookie}={access.token};")
    again = ask(access, access.ticket.value)
    assert again.status_code == 403
    assert "set-cookie" not in again.headers


def test_a_wrong_ticket_is_refused_and_uses_up_nothing(server: Any) -> None:
    access = server.access
    assert ask(access, "wrong").status_code == 403
    assert ask(access, access.ticket.value).status_code == 303


def test_a_ticket_opens_nothing_but_the_page(server: Any) -> None:
    address = f"{server.base}/api/volume?ticket={server.access.ticket.value}"
    assert httpx.get(address, trust_env=False, timeout=PATIENCE).status_code == 403


@linux
@pytest.mark.skipif(
    sys.platform != "linux" or os.getuid() != 0 or shutil.which("setpriv") is None,
    reason="only root can start a program as another user",
)
def test_another_user_of_the_machine_does_not_get_in_by_a_ticket(server: Any) -> None:
    access = server.access
    as_nobody = ["setpriv", f"--reuid={NOBODY}", "--clear-groups", "--"]
    asked = [
        *as_nobody,
        "/usr/bin/env",
        "python3",
        "-c",
        ASK,
        str(access.port),
        access.ticket.value,
    ]
    found = subprocess.run(asked, capture_output=True, text=True, check=True, cwd="/")
    assert found.stdout.strip() == "403"
    # nor was it used up
    assert ask(access, access.ticket.value).status_code == 303


@linux
def test_the_owner_of_a_connection_is_told(server: Any) -> None:
    with create_connection(("127.0.0.1", server.access.port), timeout=PATIENCE) as client:
        assert user_of(client.getsockname()[1], server.access.port) == os.getuid()
    assert user_of(1, 1) is None


def test_a_ticket_is_of_no_use_for_long(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("palpate.server.ticket._is_own", lambda *_: True)
    late = Ticket()
    monkeypatch.setattr("palpate.server.ticket.monotonic", lambda: late._until + LIFETIME)
    assert not late.take(late.value, client=("127.0.0.1", 1), port=1)


def test_the_browser_is_given_no_token(monkeypatch: pytest.MonkeyPatch) -> None:
    given: list[str] = []
    monkeypatch.setattr("webbrowser.open", given.append)
    access = Access(port=1234)
    monkeypatch.setattr(first_page, "tells_owners", lambda: True)
    show_in_browser(access)
    assert given == [access.first_url]
    assert access.token not in given[0]


def test_where_no_owners_are_told_a_private_file_leads_to_the_page(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    given: list[str] = []
    monkeypatch.setattr("webbrowser.open", given.append)
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    monkeypatch.setattr(first_page, "tells_owners", lambda: False)
    access = Access(port=1234)
    show_in_browser(access)
    (file,) = tmp_path.iterdir()
    assert given == [file.as_uri()]
    assert file.stat().st_mode & 0o077 == 0
    assert f"url={access.first_url}" in file.read_text().replace("; ", "")
