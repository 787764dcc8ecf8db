"""Pages come back to a server that was started anew, and nobody else does."""

from __future__ import annotations

import hmac
import os
import stat
from pathlib import Path

import httpx
import pytest
from palpate.server.resume import kept_key, kept_port, note_port
from running_server import PATIENCE, RunningServer

KNOWN = "0" * 64


def ask(server: RunningServer, body: dict[str, str], **headers: str) -> httpx.Response:
    """Asks without any token."""
    return httpx.post(
        f"{server.base}/api/resume", json=body, headers=headers, trust_env=False, timeout=PATIENCE
    )


def proof(server: RunningServer, key: str, whose: str, *numbers: str) -> str:
    """What a page computes."""
    said = " ".join((whose, str(server.access.port), *numbers))
    return hmac.new(key.encode(), said.encode(), "sha256").hexdigest()


def test_who_knows_the_key_is_let_in_once_for_each_number(shared_server: RunningServer) -> None:
    key = shared_server.get("/api/resume/key").json()["key"]
    told = ask(shared_server, {"nonce": KNOWN}).json()
    # the server has shown who it is before the page shows anything
    assert told["proof"] == proof(shared_server, key, "server", KNOWN, told["nonce"])
    shown = proof(shared_server, key, "page", KNOWN, told["nonce"])
    body = {"nonce": KNOWN, "answers": told["nonce"], "proof": shown}
    answer = ask(shared_server, body)
    assert answer.status_code == 204
    cookie = answer.headers["set-cookie"]
    assert "HttpOnly" in cookie
    assert "SameSite=Lax" in cookie
    sent = cookie.partition(";")[0]
    assert shared_server.get("/api/volume", Cookie=sent).status_code == 200
    assert ask(shared_server, body).status_code == 403


@pytest.mark.parametrize("wrong", ["key", "server", "other number"])
def test_a_wrong_proof_is_refused(shared_server: RunningServer, wrong: str) -> None:
    told = ask(shared_server, {"nonce": KNOWN}).json()
    key = KNOWN if wrong == "key" else shared_server.access.key
    whose = "server" if wrong == "server" else "page"
    number = KNOWN if wrong == "other number" else told["nonce"]
    shown = proof(shared_server, key, whose, KNOWN, number)
    answer = ask(shared_server, {"nonce": KNOWN, "answers": told["nonce"], "proof": shown})
    assert answer.status_code == 403
    assert "set-cookie" not in answer.headers
    # what the server has shown is no proof of a page either, and its number is spent
    assert (
        ask(
            shared_server, {"nonce": KNOWN, "answers": told["nonce"], "proof": told["proof"]}
        ).status_code
        == 403
    )


def test_another_page_cannot_ask_and_the_key_needs_the_token(shared_server: RunningServer) -> None:
    assert ask(shared_server, {"nonce": "1"}, Origin="http://evil.example").status_code == 403
    assert ask(shared_server, {"nonce": "1"}, Host="evil.example").status_code == 403
    assert shared_server.get("/api/resume/key", Cookie="").status_code == 403
    assert shared_server.get("/api/resume", Cookie="").status_code == 403


def test_the_key_of_a_port_stays_and_is_for_its_person_alone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PALPATE_STATE", str(tmp_path))
    key = kept_key(4711)
    assert kept_key(4711) == key
    assert kept_key(4712) != key
    (path,) = tmp_path.rglob("4711.key")
    if os.name == "posix":
        assert stat.S_IMODE(path.stat().st_mode) == 0o600
        # one that others could have read is none any more
        path.chmod(0o644)
        assert kept_key(4711) != key
        assert stat.S_IMODE(path.stat().st_mode) == 0o600
    path.write_text("cut")
    assert len(kept_key(4711)) == len(key)


def test_a_folder_that_cannot_be_written_gives_a_key_for_this_start(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("PALPATE_STATE", str(tmp_path / "file"))
    assert kept_key(4711) != kept_key(4711)
    note_port("scan", 4711)
    assert kept_port("scan") == 0


def test_a_scan_comes_back_at_its_port(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PALPATE_STATE", str(tmp_path))
    note_port("one", 4711)
    note_port("other", 4712)
    assert (kept_port("one"), kept_port("other"), kept_port("third")) == (4711, 4712, 0)
    # a port is that of the scan that was shown there last
    note_port("third", 4711)
    assert (kept_port("one"), kept_port("third")) == (0, 4711)
