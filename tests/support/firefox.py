"""A page in Firefox on a screen of its own, where Mesa's llvmpipe draws.

It is asked by WebDriver BiDi (W3C), which Firefox speaks itself.
"""

from __future__ import annotations

import base64
import json
import os
import re
import subprocess
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from browser import ANSWER_LIMIT, END_LIMIT, ROOT, START_LIMIT, ended, lines_of
from numpy.typing import NDArray
from websockets.sync.client import ClientConnection, connect

SETTINGS = {
    "app.normandy.enabled": False,
    "browser.newtabpage.enabled": False,
    "browser.shell.checkDefaultBrowser": False,
    "browser.startup.page": 0,
    "datareporting.policy.dataSubmissionEnabled": False,
    "network.captive-portal-service.enabled": False,
    "webgl.force-enabled": True,
}
"""Nothing is fetched or asked at the start, and WebGL is there whatever is known of the driver."""


class Firefox:
    """A window with one page."""

    def __init__(self, connection: ClientConnection) -> None:
        """Takes the window that is there."""
        self._connection = connection
        self._asked = 0
        self._do("session.new", capabilities={})
        self._window = self._do("browsingContext.getTree")["contexts"][0]["context"]

    def remember(self, **choices: Any) -> None:
        """Has every page find choices of an earlier visit."""
        kept = json.dumps({f"palpate.{name}": json.dumps(c) for name, c in choices.items()})
        self._do(
            "script.addPreloadScript",
            functionDeclaration=f"() => Object.assign(localStorage, {kept})",
        )

    def open(self, url: str, *, width: int, height: int) -> None:
        """Opens a page, and waits until the scan is there."""
        size = {"width": width, "height": height}
        self._do("browsingContext.setViewport", context=self._window, viewport=size)
        self._do("browsingContext.navigate", context=self._window, url=url, wait="interactive")
        self.wait("window.palpate?.ready === true")

    def read(self, expression: str) -> Any:
        """Returns the value of an expression in the page, by way of JSON."""
        answer = self._do(
            "script.evaluate",
            expression=f"(async () => JSON.stringify(await ({expression})) ?? 'null')()",
            target={"context": self._window},
            awaitPromise=True,
        )
        assert answer["type"] == "success", f"{expression}: {answer['exceptionDetails']['text']}"
        return json.loads(answer["result"]["value"])

    def wait(self, expression: str, *, seconds: float = 120.0) -> None:
        """Waits until an expression in the page is true."""
        ends = time.monotonic() + seconds
        while not self.read(expression):
            assert time.monotonic() < ends, f"not true within {seconds} s: {expression}"
            time.sleep(0.1)

    def picture(self, path: Path) -> NDArray[np.float64]:
        """Returns what is drawn, once it is as fine as it gets: RGB 0..1, shape [h, w, 3]."""
        import SimpleITK

        self.read("window.palpate.setJitter(false)")
        # a change of the view is taken up by the next frame
        self.read(f"new Promise(resolve => {2 * 'requestAnimationFrame(() => '}resolve(0))))")
        self.wait("window.palpate.finished")
        picture = self.read("document.querySelector('main canvas').toDataURL()")
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(base64.b64decode(picture.partition(",")[2]))
        pixels = SimpleITK.GetArrayFromImage(SimpleITK.ReadImage(str(path)))
        return np.asarray(pixels[..., :3], np.float64) / 255.0

    def close(self) -> None:
        """Ends Firefox with all of its processes."""
        self._do("browser.close")

    def _do(self, method: str, **parameters: Any) -> dict[str, Any]:
        self._asked += 1
        order = {"id": self._asked, "method": method, "params": parameters}
        self._connection.send(json.dumps(order))
        while True:
            answer = json.loads(self._connection.recv(timeout=ANSWER_LIMIT))
            # events have no number
            if answer.get("id") == self._asked:
                assert answer["type"] == "success", f"{method}: {answer.get('message')}"
                result: dict[str, Any] = answer["result"]
                return result


@contextmanager
def firefox() -> Iterator[Firefox]:
    """Gives a Firefox on a screen of its own, and ends both."""
    found = subprocess.run(
        [ROOT / "scripts" / "firefox.sh"], check=True, capture_output=True, text=True
    )
    with TemporaryDirectory(ignore_cleanup_errors=True) as profile, _screen() as display:
        settings = (f"user_pref({json.dumps(k)}, {json.dumps(v)});\n" for k, v in SETTINGS.items())
        Path(profile, "user.js").write_text("".join(settings), encoding="utf-8")
        options = ["--no-remote", "--profile", profile, "--remote-debugging-port", "0"]
        process = subprocess.Popen(
            [found.stdout.strip(), *options],
            env=os.environ | {"DISPLAY": display, "HOME": profile, "LIBGL_ALWAYS_SOFTWARE": "1"},
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        )
        with ended(process), connect(_address_in(process), max_size=None) as connection:
            started = Firefox(connection)
            try:
                yield started
            finally:
                started.close()
                process.wait(timeout=END_LIMIT)


@contextmanager
def _screen() -> Iterator[str]:
    """Gives a screen that nobody sees, at the first number that is free."""
    read, write = os.pipe()
    process = subprocess.Popen(
        ["Xvfb", "-displayfd", str(write), "-screen", "0", "1280x800x24", "-nolisten", "tcp"],
        stderr=subprocess.DEVNULL,
        text=True,
        pass_fds=[write],
    )
    os.close(write)
    with ended(process), os.fdopen(read) as number:
        yield f":{number.readline().strip()}"


def _address_in(process: subprocess.Popen[str]) -> str:
    """Returns the address at which Firefox listens."""
    lines, ends = lines_of(process), time.monotonic() + START_LIMIT
    while time.monotonic() < ends:
        if found := re.search(r"BiDi listening on (ws://\S+)", lines.get(timeout=START_LIMIT)):
            return f"{found.group(1)}/session"
    raise AssertionError(f"Firefox did not listen within {START_LIMIT} s")
