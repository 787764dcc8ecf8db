"""A page in an installed Chromium, for benchmarks, controlled through its debugging port.

Values are read as expressions of the page. Without a GPU its canvas is drawn by software GL, and
the page around it without GL, as Chromium does then.
"""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
import time
import urllib.request
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import IO, TYPE_CHECKING, Any

from palpate.base.errors import OptionError
from palpate.bench.processor_time import spent

if TYPE_CHECKING:
    from websockets.sync.client import ClientConnection

__all__ = ["Page", "chromium", "opened", "served"]

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
FLAGS = (
    "--headless",
    "--no-sandbox",
    "--enable-unsafe-swiftshader",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--no-first-run",
    "--remote-debugging-port=0",
)
PATIENCE = 300.0
"""Longest wait for a start or a condition [s]; pictures are slow on a busy machine."""


def chromium() -> str:
    """Returns the path of the browser.

    Raises:
        OptionError: None is installed.
    """
    given = os.environ.get("PALPATE_CHROMIUM") or os.environ.get("CHROMIUM")
    found = next(filter(None, map(shutil.which, (given,) if given else NAMES)), None)
    if found is None:
        where = f"at {given}" if given else f"of the names {', '.join(NAMES)}"
        raise OptionError(
            f"no browser {where}; allowed: an installed Chromium, or PALPATE_CHROMIUM with its path"
        )
    return found


class Page:
    """One page of a running browser."""

    def __init__(self, socket: ClientConnection, browser: int) -> None:
        """Speaks over a connection to its debugging address, with a browser's process number."""
        self._socket = socket
        self._number = 0
        self._browser = browser

    def read(self, expression: str) -> Any:  # noqa: ANN401  # whatever it is
        """Returns the value of an expression in the page; waits for a promise.

        Raises:
            RuntimeError: The expression throws.
        """
        found = self._ask(
            "Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True
        )
        if "exceptionDetails" in found:
            raise RuntimeError(f"{expression}: {found['exceptionDetails']}")
        return found["result"].get("value")

    def wait(self, expression: str) -> None:
        """Waits until an expression is true.

        Raises:
            RuntimeError: It does not become true.
        """
        ends = time.monotonic() + PATIENCE
        while not self.read(expression):
            if time.monotonic() > ends:
                raise RuntimeError(f"not true within {PATIENCE:g} s: {expression}")
            time.sleep(0.03)

    def go(self, url: str) -> None:
        """Opens an address and waits for the picture of the whole scan."""
        self.glimpse(url)
        self.wait("window.palpate?.ready === true")

    def glimpse(self, url: str) -> None:
        """Opens an address and waits for a picture, which is coarse for a large scan."""
        self._ask("Page.navigate", url=url)
        self.wait("typeof window.palpate?.firstPicture === 'number'")

    def before(self, script: str) -> None:
        """Runs a script in pages that are opened from now on, before their own scripts."""
        self._ask("Page.enable")
        self._ask("Page.addScriptToEvaluateOnNewDocument", source=script)

    def resize(self, width: int, height: int) -> None:
        """Changes the size of the page [CSS pixels]."""
        self._ask(
            "Emulation.setDeviceMetricsOverride",
            width=width,
            height=height,
            deviceScaleFactor=1,
            mobile=False,
        )

    def press(self, key: str) -> None:
        """Presses and releases a key, as a person does."""
        for kind in ("keyDown", "keyUp"):
            self._ask("Input.dispatchKeyEvent", type=kind, key=key, code=key)

    def mouse(self, kind: str, place: tuple[float, float]) -> None:
        """Presses, moves or releases the left button of the mouse at a place [CSS pixels].

        ``kind`` is "mousePressed", "mouseMoved" or "mouseReleased".
        """
        x, y = place
        self._ask(
            "Input.dispatchMouseEvent",
            type=kind,
            x=x,
            y=y,
            button="left",
            buttons=0 if kind == "mouseReleased" else 1,
            clickCount=0 if kind == "mouseMoved" else 1,
        )

    def heap(self) -> float:
        """Returns the memory of the page's scripts after garbage collection [bytes]."""
        self._ask("HeapProfiler.collectGarbage")
        return float(self._ask("Runtime.getHeapUsage")["usedSize"])

    def spent(self) -> dict[str, float]:
        """Returns the processor time of the browser until now [s]."""
        return spent(self._browser)

    def _ask(self, method: str, **parameters: object) -> dict[str, Any]:
        # what a method of the browser returns is the browser's to say
        self._number += 1
        asked = {"id": self._number, "method": method, "params": parameters}
        self._socket.send(json.dumps(asked))
        while True:
            answer = json.loads(self._socket.recv(timeout=PATIENCE))
            # events of the browser come in between
            if answer.get("id") == self._number:
                break
        if "error" in answer:
            raise RuntimeError(f"{method}: {answer['error']}")
        result: dict[str, Any] = answer["result"]
        return result


CHOSEN = """try {
  localStorage.setItem("palpate.drawer", JSON.stringify({ choice: "%s" }));
} catch { /* an empty page has no storage */ }"""
"""Chooses who draws."""


@contextmanager
def opened(
    url: str | None, *, width: int, height: int, drawer: str | None = None
) -> Iterator[Page]:
    """Opens an address in a browser of its own, and closes it; None leaves the page empty.

    ``drawer``: who draws the 3-D view, as a person chose it before; None leaves it to the page.

    Raises:
        OptionError: There is no browser.
        RuntimeError: It does not start.
    """
    from websockets.sync.client import connect

    program = chromium()
    with TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        command = [program, *FLAGS, f"--user-data-dir={profile}", f"--window-size={width},{height}"]
        with _running([*command, "about:blank"], "stderr") as (process, output):
            debugging = _found_in(output, r"ws://([\d.:]+)/\S+", "the browser")
            listing = f"http://{debugging.group(1)}/json/list"
            with urllib.request.urlopen(listing, timeout=PATIENCE) as answer:
                pages = json.load(answer)
            shown = next(one for one in pages if one["type"] == "page")
            address = shown["webSocketDebuggerUrl"]
            with connect(address, max_size=None, compression=None) as socket:
                page = Page(socket, process.pid)
                if drawer is not None:
                    page.before(CHOSEN % drawer)
                if url is not None:
                    page.go(url)
                yield page


@contextmanager
def served(scan: Path) -> Iterator[str]:
    """Runs ``palpate open`` in a process of its own; yields the address.

    Raises:
        RuntimeError: It does not start.
    """
    with TemporaryDirectory() as state:
        environment = os.environ | {"PALPATE_STATE": state, "PYTHONUNBUFFERED": "1"}
        command = [sys.executable, "-m", "palpate", "open", str(scan), "--no-browser"]
        with _running(command, "stdout", environment) as (_, output):
            yield _found_in(output, r"http://(?:127\.0\.0\.1|localhost):\d+/\S*", "palpate").group()


@contextmanager
def _running(
    command: list[str], stream: str, environment: dict[str, str] | None = None
) -> Iterator[tuple[subprocess.Popen[str], IO[str]]]:
    """Runs a program with its output connected, and ends it in any case."""
    streams = {"stdout": subprocess.DEVNULL, "stderr": subprocess.STDOUT}
    streams |= {stream: subprocess.PIPE}
    process = subprocess.Popen(command, env=environment, text=True, **streams)  # type: ignore[call-overload]  # noqa: S603
    with process:
        try:
            yield process, getattr(process, stream)
        finally:
            process.kill()


def _found_in(output: IO[str], pattern: str, who: str) -> re.Match[str]:
    """Returns the match of the first line that has one; reads and discards what follows."""
    from threading import Thread

    seen = ""
    for line in output:
        seen += line
        if found := re.search(pattern, line):
            Thread(target=output.read, daemon=True).start()
            return found
    raise RuntimeError(f"{who} did not start; it said: {seen.strip() or 'nothing'}")
