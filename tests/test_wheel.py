"""The wheel alone is enough: no Rust, no Node, nothing of the source tree."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
import urllib.error
import urllib.request
import zipfile
from collections.abc import Iterator
from pathlib import Path

import pytest
from browser import address_in

pytestmark = pytest.mark.wheel

ROOT = Path(__file__).parent.parent


@pytest.fixture(scope="module")
def wheel() -> Path:
    """The one wheel in PALPATE_WHEELS, else the one that `make wheel` left."""
    wheels = list(Path(os.environ.get("PALPATE_WHEELS", ROOT / "dist")).glob("*.whl"))
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
            yield address_in(process)
            process.send_signal(signal.SIGINT)
            # stopping takes under a second; the rest is for a busy machine
            assert process.wait(timeout=60.0) == 0
        finally:
            process.kill()


def fetch(url: str) -> bytes:
    """Returns what a browser with an empty cookie jar would get."""
    jar = urllib.request.build_opener(
        urllib.request.ProxyHandler({}), urllib.request.HTTPCookieProcessor()
    )
    with jar.open(url, timeout=60.0) as answer:
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
    first = fetch(f"{base}/{script.group(1)}?{query}").decode()
    parts = set(re.findall(r"assets/[\w-]+\.js", first)) - {script.group(1)}
    assert sum(len(fetch(f"{base}/{part}?{query}")) for part in parts) > 100_000
    assert len(fetch(f"{base}/api/volume?step=4&{query}")) > 10_000

    with pytest.raises(urllib.error.HTTPError, match="403") as refused:
        fetch(f"{base}/api/volume?step=4")
    refused.value.close()
