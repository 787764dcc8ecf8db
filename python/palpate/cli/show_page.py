"""What ``palpate open`` and ``palpate demo`` do once their options are understood."""

from __future__ import annotations

import os
import socket
import sys
from collections.abc import Callable
from pathlib import Path
from threading import Thread

import typer

from palpate.base.console import Display, warn
from palpate.base.errors import OptionError
from palpate.base.progress import Progress
from palpate.cli.first_page import show_in_browser
from palpate.saved.autosave import note_scene
from palpate.saved.opening import Opening
from palpate.saved.recent import note_recent
from palpate.server.app import PAGE, serve
from palpate.server.loading_scan import LoadingScan
from palpate.server.open_scan import OpenScan
from palpate.server.resume import kept_key
from palpate.server.security import Access
from palpate.server.workbench import Workbench

__all__ = [
    "check_page",
    "check_rate",
    "check_start",
    "choose_on_page",
    "serve_page",
    "show",
    "show_workbench",
]

RATES = (1000, 4000)
"""Servo rates that are offered [Hz]."""

PAGE_SECONDS = 10.0
"""How long a browser that was started is waited for, to say on the page what failed [s]."""


def check_start(rate: int) -> None:
    """Refuses what would fail after the scan was read.

    Raises:
        OptionError: The rate is not offered, or the page is not built.
    """
    check_rate(rate)
    check_page()


def check_rate(rate: int) -> None:
    """Refuses a rate that is not offered.

    Raises:
        OptionError: It is none of them.
    """
    if rate not in RATES:
        allowed = " or ".join(map(str, RATES))
        raise OptionError(f"rate {rate} Hz given; allowed: {allowed} Hz")


def check_page() -> None:
    """Refuses to show what cannot be shown.

    Raises:
        OptionError: The page is not built.
    """
    if not (PAGE / "index.html").is_file():
        raise OptionError(f"the page is not built in {PAGE}; allowed: after `make setup`")


def show(
    name: str,
    make: Callable[[Progress], Opening],
    listener: socket.socket,
    *,
    rate: int,
    browser: bool,
    journalled: bool | None = None,
    recover: bool | None = None,
    run: Path | None = None,
) -> None:
    """Serves a scene until Ctrl-C; a recording that still runs then is kept.

    The page comes while the scene is still made. Options as in ``OpenScan.begin``; by default only
    scans that the page opens are journalled.

    Raises:
        PalpateError: What ``make`` raises.
    """

    def notify(sentence: str) -> None:
        warn(sentence)
        workbench.notify(sentence)

    def begin(progress: Progress) -> OpenScan:
        made = _made(make, progress)
        opened = OpenScan.begin(
            made.scene,
            rate=rate,
            journalled=bool(journalled),
            recover=recover,
            run=run,
            saved=made.saved,
            notify=notify,
        )
        _note_opened(opened, made)
        return opened

    loading = LoadingScan(name, begin)
    workbench = Workbench(loading=loading, rate=rate, journalled=journalled is not False)
    show_workbench(workbench, listener, browser=browser)
    if loading.failure is not None:
        raise loading.failure


def _made(make: Callable[[Progress], Opening], progress: Progress) -> Opening:
    """Makes a scene, with its progress and its warnings in the terminal too."""
    with Display() as display:

        def both(what: str, share: float | None, /) -> None:
            progress(what, share)
            display(what, share)

        made = make(both)
    for sentence in made.messages:
        warn(sentence)
    return made


def _note_opened(opened: OpenScan, made: Opening) -> None:
    """Notes what was opened as recent, and warns of changes that can be brought back."""
    # pages ask by themselves
    if opened.journal is not None and (offer := opened.journal.offer) is not None:
        warn(
            f"{offer.steps} changes of this scan are kept from {offer.when:%d %B %Y, %H:%M}: "
            "the page asks whether to bring them back; --recover and --no-recover answer before"
        )
    note_recent(made.scene.volume, None if made.saved is None else made.saved.path)
    if made.saved is not None:
        note_scene(made.saved.scan, made.saved.path)


def choose_on_page(listener: socket.socket, *, rate: int, browser: bool, journalled: bool) -> None:
    """Serves a page that asks for a scan, until Ctrl-C."""
    workbench = Workbench(rate=rate, journalled=journalled)
    show_workbench(workbench, listener, browser=browser)


def show_workbench(workbench: Workbench, listener: socket.socket, *, browser: bool) -> None:
    """Serves a workbench until Ctrl-C, and keeps what is kept of what is open then."""
    try:
        serve_page(workbench, listener, browser=browser)
    finally:
        workbench.end()


def serve_page(
    workbench: Workbench,
    listener: socket.socket,
    *,
    browser: bool,
    seconds: float | None = None,
) -> None:
    """Serves a workbench until Ctrl-C, or for so long."""
    port = listener.getsockname()[1]
    access = Access(port=port, key=kept_key(port))

    loading, opened = workbench.loading, workbench.opened
    shown = opened if loading is None else loading
    name = "a scan once one is chosen" if shown is None else shown.name

    def announce() -> None:
        if loading is not None and not loading.recognised():
            return
        typer.echo(f"Palpate shows {name} at\n{access.url}\nCtrl-C stops it.")
        sys.stdout.flush()
        if browser and has_display():
            workbench.page_seconds = PAGE_SECONDS
            show_in_browser(access)

    def ready() -> None:
        # the server goes on meanwhile
        Thread(target=announce, daemon=True).start()

    try:
        serve(workbench, listener, access=access, ready=ready, seconds=seconds)
    except KeyboardInterrupt:
        typer.echo("stopped")


def has_display() -> bool:
    """Says whether a browser could show itself here."""
    return sys.platform != "linux" or bool(
        os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")
    )
