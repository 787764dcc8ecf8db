"""A page in a real browser, driven by ``viewer/e2e/drive.mjs``, and a running command."""

from __future__ import annotations

import json
import os
import queue
import re
import signal
import socket
import subprocess
import threading
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

ROOT = Path(__file__).parents[2]
START_LIMIT = 120.0
"""Seconds until an address must be printed; a scan takes about one."""
END_LIMIT = 60.0
"""Seconds until a process must have ended; most take less than one."""
NARROW_SPACE, MINUS = "\u202f", "\u2212"
"""As the page writes them before a unit and a negative number."""
ANSWER_LIMIT = 300.0
"""Seconds for one answer of the browser: software GL on a busy machine takes its time."""


class Browser:
    """A browser with one page; every call is one action of ``drive.mjs``."""

    def __init__(self, *, flags: str = "", drawer: str = "") -> None:
        """Starts it; ``flags`` go to Chromium, ``drawer`` was chosen by a person, "" is none."""
        found = subprocess.run(
            [ROOT / "scripts" / "chromium.sh"], check=True, capture_output=True, text=True
        )
        self._process = subprocess.Popen(
            ["node", ROOT / "viewer" / "e2e" / "drive.mjs"],
            env=os.environ
            | {"CHROMIUM": found.stdout.strip(), "CHROMIUM_FLAGS": flags, "DRAWER": drawer},
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        self._lines = lines_of(self._process)
        self.complaints: list[str] = []
        """What the page wrote to its console as errors."""

    def do(self, action: str, **options: Any) -> dict[str, Any]:
        """Does an action and returns its answer."""
        assert self._process.stdin is not None
        self._process.stdin.write(json.dumps({"do": action, **options}) + "\n")
        self._process.stdin.flush()
        answer: dict[str, Any] = json.loads(self._lines.get(timeout=ANSWER_LIMIT))
        self.complaints += answer.pop("complaints")
        assert "error" not in answer, f"{action} {options}: {answer['error']}"
        return answer

    def read(self, expression: str) -> Any:
        """Returns the value of an expression in the page."""
        return self.do("read", expression=expression).get("value")

    def text(self, testid: str) -> str:
        """Returns the text of an element, in plain spaces and hyphens as a test types them."""
        text = str(self.do("text", testid=testid)["value"])
        # where its source goes on in a new line stands a space
        return re.sub(r"\s*\n\s*", " ", text).replace(NARROW_SPACE, " ").replace(MINUS, "-")

    def wait(self, expression: str, *, seconds: float = 60.0) -> None:
        """Waits until an expression in the page is true."""
        self.do("wait", seconds=seconds, **{"for": expression})

    def shows(self, testid: str, condition: str) -> None:
        """Waits until a condition on the ``text`` of an element holds, as ``text`` returns it.

        Numbers on the page follow the state at a pace that can be read.
        """
        element = f"document.querySelector('[data-testid={testid}]')"
        self.wait(
            f"(text => text !== undefined && ({condition}))"
            f"({element}?.textContent.trim().replaceAll('{NARROW_SPACE}', ' ')"
            f".replaceAll('{MINUS}', '-'))"
        )

    def all_done(self) -> None:
        """Waits until the engine has done all that the page has asked for, and has told of it."""
        self.read("window.palpate.allDone()")

    def settled(self) -> dict[str, Any]:
        """Returns the state once all that was asked for is done and all that moves is at rest.

        That is: device, proxy [mm], force [N] and poses change < 0.01 in 300 ticks, twice in a
        row. Ticks are counted instead of the page's time: a page that shows an old state for a
        while looks at rest too, and so does a device whose thread a busy machine holds up.
        """
        self.all_done()
        self.read("void (window.__last = window.__settled = undefined, window.__rested = 0)")
        self.wait(
            "(() => { const { state } = window.palpate, { tick, device, proxy, force } = state;"
            " const poses = state.poses.flatMap(({ pose }) => pose);"
            " const now = [...device, ...proxy, ...force, ...poses], last = window.__last;"
            " if (last !== undefined && tick - last.tick < 300) return false;"
            " window.__last = { tick, now };"
            " const rests = last !== undefined && last.now.length === now.length"
            " && Math.hypot(...now.map((c, i) => c - last.now[i])) < 0.01;"
            " window.__rested = rests ? window.__rested + 1 : 0;"
            " if (rests) window.__settled = state;"
            " return window.__rested === 2; })()"
        )
        # the one that was found at rest: by now the servo may have been late for a tick
        state: dict[str, Any] = self.read("window.__settled")
        return state

    @contextmanager
    def settings(self) -> Iterator[None]:
        """Has the settings open."""
        dialog = "document.querySelector('[data-testid=settings]')"
        self.read("document.querySelector('[data-testid=open-settings]').click()")
        self.wait(f"{dialog}?.open === true")
        yield
        self.read("document.querySelector('[data-testid=close-settings]').click()")
        self.wait(f"{dialog} === null")

    def frames(self) -> None:
        """Waits until the page has drawn what was changed before: it takes a frame or two."""
        self.read(f"new Promise(resolve => {2 * 'requestAnimationFrame(() => '}resolve(0))))")

    def draw_by(self, drawer: str) -> None:
        """Chooses who draws the 3-D view."""
        with self.settings():
            self.do("choose", testid="drawer", value=drawer)
        self.frames()

    def finish(self) -> None:
        """Waits until the picture of the present view is as fine as it gets."""
        # a change of the view is taken up by the next frame
        self.frames()
        self.wait("window.palpate.finished", seconds=120.0)

    def picture(self, path: Path) -> NDArray[np.float64]:
        """Returns the 3-D picture, once it is as fine as it gets: RGB 0..1, shape [h, w, 3].

        Nothing in it is random, it does not depend on how quick the machine is, and what is told
        is gone from before it.
        """
        import SimpleITK

        self.read("window.palpate.setJitter(false)")
        self.read("document.querySelectorAll('.notice button').forEach((each) => each.click())")
        self.finish()
        path.parent.mkdir(parents=True, exist_ok=True)
        self.do("screenshot", path=str(path), testid="canvas")
        pixels = SimpleITK.GetArrayFromImage(SimpleITK.ReadImage(str(path)))
        return np.asarray(pixels[..., :3], np.float64) / 255.0

    def close(self) -> None:
        """Ends it."""
        with self._process as process:
            assert process.stdin is not None
            process.stdin.close()
            try:
                process.wait(timeout=END_LIMIT)
            except subprocess.TimeoutExpired:
                process.kill()


@contextmanager
def browser(*, flags: str = "", drawer: str = "engine") -> Iterator[Browser]:
    """Gives a browser and ends it.

    It has no graphics card, so that the engine draws the 3-D view where it can: several times
    quicker. Tests of what the browser itself draws say so by ``drawer="browser"``, those of the
    choice by ``drawer=""``: by itself a page goes by what it measures, and two pictures that are
    compared could be drawn by either.
    """
    started = Browser(flags=flags, drawer=drawer)
    try:
        yield started
    finally:
        started.close()


@dataclass
class Command:
    """A running ``palpate open`` or ``palpate demo``."""

    process: subprocess.Popen[str]
    url: str

    def stop(self) -> int:
        """Ends it as Ctrl-C does; returns its exit code."""
        self.process.send_signal(signal.SIGINT)
        return self.process.wait(timeout=END_LIMIT)


def free_port() -> int:
    """Finds a port that nothing uses; below those that the system itself gives to programs."""
    for port in range(20_000 + os.getpid() % 10_000, 32_768):
        with suppress(OSError), socket.create_server(("127.0.0.1", port)):
            return port
    raise AssertionError("no free port")


NO_PRIORITY = ("setpriv", "--bounding-set=-sys_nice", "--inh-caps=-sys_nice", "--")
"""Starts a command without the right to ask for real-time priority."""


TOOL = (ROOT / ".venv" / "bin" / "palpate",)
"""The command line tool."""


@contextmanager
def palpate(
    *arguments: str | Path,
    real_time: bool = True,
    tool: Sequence[str | Path] = TOOL,
    state: Path | None = None,
) -> Iterator[Command]:
    """Runs the command line tool until the address is printed, and to its end.

    Journals are kept in ``state``, by default in a folder of their own.
    """
    with TemporaryDirectory() as fresh:
        environment = {"PALPATE_STATE": str(state or fresh), "PYTHONUNBUFFERED": "1"}
        process = subprocess.Popen(
            [*(() if real_time else NO_PRIORITY), *tool, *arguments, "--no-browser"],
            env=os.environ | environment,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        )
        with ended(process):
            yield Command(process, address_in(process))


@contextmanager
def ended(process: subprocess.Popen[str]) -> Iterator[None]:
    """Ends a process, whatever happens."""
    with process:
        try:
            yield
        finally:
            process.kill()


def address_in(process: subprocess.Popen[str]) -> str:
    """Returns the address that a command prints."""
    lines, ends, seen = lines_of(process), time.monotonic() + START_LIMIT, ""
    while time.monotonic() < ends and (process.poll() is None or not lines.empty()):
        try:
            seen += lines.get(timeout=0.2)
        except queue.Empty:
            continue
        if found := re.search(r"http://(?:127\.0\.0\.1|localhost):\d+/\S*", seen):
            return found.group()
    raise AssertionError(f"no address within {START_LIMIT} s; printed: {seen!r}")


def lines_of(process: subprocess.Popen[str]) -> queue.Queue[str]:
    """Gives lines as they come, so that a process that prints nothing cannot block."""
    assert process.stdout is not None
    lines: queue.Queue[str] = queue.Queue()
    threading.Thread(target=_hand_over, args=(process.stdout, lines), daemon=True).start()
    return lines


def _hand_over(output: IO[str], lines: queue.Queue[str]) -> None:
    for line in output:
        lines.put(line)
