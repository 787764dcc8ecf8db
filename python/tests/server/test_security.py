"""Nobody gets in without token, right Host and right Origin, on any route."""

from __future__ import annotations

from socket import create_connection
from typing import Any

import httpx
import pytest
from palpate.server.security import Access
from running_server import PATIENCE
from websockets.exceptions import InvalidStatus

ROUTES = ["/", "/assets/page.js", "/api/volume", "/api/labels", "/api/live", "/nothing"]
ANSWERS = {"/": 200, "/assets/page.js": 200, "/api/volume": 200, "/api/labels": 200}


@pytest.mark.parametrize("route", ROUTES)
def test_with_the_token_as_a_cookie_routes_answer(shared_server: Any, route: str) -> None:
    assert shared_server.get(route).status_code == ANSWERS.get(route, 404)


@pytest.mark.parametrize("route", ROUTES)
def test_with_the_token_in_the_address_routes_answer(shared_server: Any, route: str) -> None:
    answer = httpx.get(
        f"{shared_server.base}{route}?token={shared_server.access.token}",
        trust_env=False,
        timeout=PATIENCE,
    )
    # from the page's own address the token goes at once
    assert answer.status_code == (303 if route == "/" else ANSWERS.get(route, 404))


def test_the_token_leaves_the_address_and_goes_on_as_a_cookie(shared_server: Any) -> None:
    with httpx.Client(trust_env=False, timeout=PATIENCE) as browser:
        entered = browser.get(shared_server.access.url)
        assert entered.headers["location"] == "/"
        assert shared_server.access.token not in entered.text
        page = browser.get(shared_server.base + entered.headers["location"])
        assert page.status_code == 200
        assert browser.get(f"{shared_server.base}/api/volume").status_code == 200


@pytest.mark.parametrize("route", ROUTES)
@pytest.mark.parametrize(
    "cookie", ["", "palpate-1=x", "{name}=", "{name}=wrong", "{name}={token}x", 'a="; {name}=']
)
def test_without_the_right_token_a_readable_page_refuses(
    shared_server: Any, route: str, cookie: str
) -> None:
    sent = cookie.format(name=shared_server.access.cookie, token=shared_server.access.token)
    answer = shared_server.get(f"{route}?token=wrong", Cookie=sent)
    assert answer.status_code == 403
    assert "token is missing or wrong" in answer.text
    assert answer.headers["content-type"].startswith("text/html")
    assert "set-cookie" not in answer.headers


@pytest.mark.parametrize("route", ROUTES)
@pytest.mark.parametrize(
    "host",
    ["evil.example", "127.0.0.1", "127.0.0.1:1", "localhost.evil.example:{port}", "0:{port}"],
)
def test_another_host_is_refused(shared_server: Any, route: str, host: str) -> None:
    answer = shared_server.get(route, Host=host.format(port=shared_server.access.port))
    assert answer.status_code == 403
    assert "address is not the one" in answer.text


@pytest.mark.parametrize("route", ROUTES)
@pytest.mark.parametrize(
    "origin", ["http://evil.example", "null", "https://127.0.0.1:{port}", "http://127.0.0.1:1"]
)
def test_another_origin_is_refused(shared_server: Any, route: str, origin: str) -> None:
    answer = shared_server.get(route, Origin=origin.format(port=shared_server.access.port))
    assert answer.status_code == 403
    assert "another page" in answer.text


@pytest.mark.parametrize("host", ["127.0.0.1", "localhost"])
def test_both_names_of_this_machine_are_let_in(shared_server: Any, host: str) -> None:
    name = f"{host}:{shared_server.access.port}"
    assert shared_server.get("/", Host=name, Origin=f"http://{name}").status_code == 200


@pytest.mark.parametrize(
    "options",
    [
        {"origin": "http://evil.example"},
        {"origin": None},
        {"host_name": "evil.example"},
    ],
)
def test_the_websocket_refuses_other_origins_and_hosts(
    shared_server: Any, options: dict[str, Any]
) -> None:
    with pytest.raises(InvalidStatus, match="403"), shared_server.page(**options):
        pass


def test_the_websocket_refuses_a_wrong_token(shared_server: Any) -> None:
    stranger = type(shared_server)(Access(port=shared_server.access.port), shared_server.session)
    with pytest.raises(InvalidStatus, match="403"), stranger.page():
        pass


def test_the_cookie_is_for_this_port_and_hidden_from_scripts(shared_server: Any) -> None:
    answer = httpx.get(shared_server.access.url, trust_env=False, timeout=PATIENCE)
    cookie = answer.headers["set-cookie"]
    assert cookie.startswith(f"palpate-{shared_server.access.port}=")
    assert "HttpOnly" in cookie
    assert "SameSite=Lax" in cookie


def test_answers_carry_protective_headers(shared_server: Any) -> None:
    for answer in (shared_server.get("/"), shared_server.get("/", Cookie="")):
        assert "default-src 'none'" in answer.headers["content-security-policy"]
        assert answer.headers["cache-control"] == "no-store"
        assert answer.headers["x-content-type-options"] == "nosniff"
        assert answer.headers["referrer-policy"] == "no-referrer"


def test_only_reading_is_possible_over_http(shared_server: Any) -> None:
    answer = httpx.post(
        f"{shared_server.base}/api/volume?token={shared_server.access.token}",
        trust_env=False,
        timeout=PATIENCE,
    )
    assert answer.status_code == 405


@pytest.mark.parametrize(
    "way", ["/..", "/%2e%2e", "/%2e%2e%2f", "/assets/../..", "/assets/..%2f..", "//..", "/..%5c"]
)
def test_files_beside_the_page_are_not_served(shared_server: Any, way: str) -> None:
    with create_connection(("127.0.0.1", shared_server.access.port), timeout=PATIENCE) as plain:
        # by hand, since clients tidy such paths
        request = (
            f"GET {way}/beside.txt?token={shared_server.access.token} HTTP/1.1\r\n"
            f"Host: 127.0.0.1:{shared_server.access.port}\r\nConnection: close\r\n\r\n"
        )
        plain.sendall(request.encode())
        answer = b"".join(iter(lambda: plain.recv(1 << 16), b""))
    assert answer.startswith(b"HTTP/1.1 404")
    assert b"not for the page" not in answer


def test_tokens_are_long_and_differ() -> None:
    tokens = {Access(port=1).token for _ in range(100)}
    assert len(tokens) == 100
    assert min(map(len, tokens)) >= 32
    assert Access(port=1).token not in repr(Access(port=1))
