"""The wheel alone is enough: no Rust, no Node, nothing of the source tree."""

from __future__ import annotations

import os
import queue
import re
import signal
import subprocess
import sys
import threading
import time
import urllib.error
import urllib.request
import zipfile
from collections.abc import Iterator
from pathlib import Path
from typing import IO

import pytest

pytestmark = pytest.mark.wheel

ROOT = Path(__file__).parent.parent
START_LIMIT = 60.0
"""Seconds until the page's address must be printed: the phantom takes 2 s on two cores."""


@pytest.fixture(scope="module")
def wheel() -> Path:
    """The one wheel that `make wheel` left."""
    wheels = list((ROOT / "dist").glob("*.whl"))
    assert len(wheels) == 1, f"{wheels}: run `make wheel`"
    return wheels[0]


@pytest.fixture(scope="module")
def palpate(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The command, installed from the wheel into an empty environment outside the tree."""
    folder = tmp_path_factory.mktemp("installed") / "venv"
    subprocess.run([sys.executable, "-m", "venv", folder], check=True)
    lock = ROOT / "python" / "requirements.lock"
    subprocess.run(
        [folder / "bin" / "pip", "install", "--quiet", "--constraint", lock, wheel], check=True
    )
    subprocess.run([folder / "bin" / "pip", "check"], check=True)
    return folder / "bin" / "palpate"


def outside(palpate: Path) -> dict[str, str]:
    """Returns an environment in which no tool and no module of the source tree is found."""
    kept = {name: value for name, value in os.environ.items() if not name.startswith("PYTHON")}
    return kept | {"PATH": str(palpate.parent), "PYTHONUNBUFFERED": "1"}


@pytest.fixture
def address(palpate: Path, tmp_path: Path) -> Iterator[str]:
    """The page's address of a demo that runs from the wheel; its end is part of the test."""
    demo = subprocess.Popen(
        [palpate, "demo", "--no-browser"],
        cwd=tmp_path,
        env=outside(palpate),
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )
    with demo as process:
        try:
            yield wait_for_address(process)
            process.send_signal(signal.SIGINT)
            # stopping takes under a second; the rest is for a busy machine
            assert process.wait(timeout=10.0) == 0
        finally:
            process.kill()


def wait_for_address(process: subprocess.Popen[str]) -> str:
    """Returns the address that the command prints."""
    assert process.stdout is not None
    lines: queue.Queue[str] = queue.Queue()
    reader = threading.Thread(target=read_lines, args=(process.stdout, lines), daemon=True)
    reader.start()
    ends, seen = time.monotonic() + START_LIMIT, ""
    while time.monotonic() < ends and (process.poll() is None or not lines.empty()):
        try:
            seen += lines.get(timeout=0.2)
        except queue.Empty:
            continue
        if found := re.search(r"http://(?:127\.0\.0\.1|localhost):\d+/\S*", seen):
            return found.group()
    raise AssertionError(f"no address within {START_LIMIT} s; printed: {seen!r}")


def read_lines(output: IO[str], lines: queue.Queue[str]) -> None:
    """Hands lines over as they come, so that a command that prints nothing cannot block."""
    for line in output:
        lines.put(line)


def fetch(url: str) -> bytes:
    """Returns what a browser with an empty cookie jar would get."""
    jar = urllib.request.build_opener(
        urllib.request.ProxyHandler({}), urllib.request.HTTPCookieProcessor()
    )
    with jar.open(url, timeout=30.0) as answer:
        return bytes(answer.read())


def test_it_holds_engine_page_and_licence_and_no_tests(wheel: Path) -> None:
    names = zipfile.ZipFile(wheel).namelist()
    for needed in (
        r"palpate/_core\.abi3\.so",
        r"palpate/py\.typed",
        r"palpate/_core\.pyi",
        r"palpate/viewer/index\.html",
        r"palpate/viewer/assets/.+\.js",
        r"palpate-.+\.dist-info/licenses/LICENSE",
    ):
        assert any(re.fullmatch(needed, name) for name in names), f"no {needed} in {names}"
    assert not [name for name in names if re.search(r"tests?/|\.rs$|\.pyc$|node_modules", name)]


def test_it_tells_its_version(palpate: Path, tmp_path: Path) -> None:
    told = subprocess.run(
        [palpate, "--version"],
        cwd=tmp_path,
        env=outside(palpate),
        check=True,
        capture_output=True,
        text=True,
    ).stdout
    manifest = (ROOT / "Cargo.toml").read_text()
    stated = re.search(r'^version = "(.+)"', manifest, re.MULTILINE)
    assert stated is not None
    assert told.strip() == f"palpate {stated.group(1)}"


def test_it_shows_the_phantom_on_a_page(address: str) -> None:
    page = fetch(address).decode()
    assert "<title>" in page
    assert "Palpate" in page

    # what the page loads next comes with the same token
    base, _, query = address.partition("/?")
    script = re.search(r'src="\.?/?(assets/[^"]+\.js)"', page)
    assert script is not None, page
    assert len(fetch(f"{base}/{script.group(1)}?{query}")) > 10_000
    assert len(fetch(f"{base}/api/volume?step=4&{query}")) > 10_000

    with pytest.raises(urllib.error.HTTPError, match="403") as refused:
        fetch(f"{base}/api/volume?step=4")
    refused.value.close()
