"""What ``palpate open`` and ``palpate demo`` do once their options are understood."""

from __future__ import annotations

import os
import socket
import sys
import webbrowser
from collections.abc import Callable
from pathlib import Path
from threading import Thread

import numpy as np
import typer

from palpate.base.console import Display, warn
from palpate.base.errors import OptionError, SceneFormatError
from palpate.base.progress import Progress
from palpate.io.reading import read
from palpate.labels.labels import read_labels
from palpate.saved.autosave import note_scene, with_autosave
from palpate.saved.opening import Opening, is_scene, offer_bone
from palpate.saved.recent import note_recent
from palpate.saved.scene_file import open_scene
from palpate.server.app import PAGE, serve
from palpate.server.loading_scan import Coming
from palpate.server.open_scan import OpenScan
from palpate.server.resume import kept_key
from palpate.server.security import Access
from palpate.server.workbench import Workbench
from palpate.volumes.scene import Scene
from palpate.volumes.second_scan import placed, read_transform
from palpate.volumes.volume import Volume

__all__ = [
    "add_second",
    "check_page",
    "check_rate",
    "check_start",
    "choose_on_page",
    "is_scene",
    "parse_threshold",
    "saved_scene",
    "scene_of",
    "serve_page",
    "show",
    "show_workbench",
    "wanted_scene",
]

RATES = (1000, 4000)
"""Servo rates that are offered [Hz]."""

PAGE_SECONDS = 10.0
"""How long a browser that was started is waited for, to say on the page what failed [s]."""

Bounds = tuple[float, float | None]


def parse_threshold(given: str | None) -> Bounds | None:
    """Returns the bounds that LOW or LOW,HIGH stands for; None where none is given.

    Raises:
        OptionError: It is neither.
    """
    if given is None:
        return None
    try:
        numbers = [float(part) for part in given.split(",")]
    except ValueError:
        numbers = []
    if len(numbers) not in (1, 2) or not np.isfinite(numbers).all():
        raise OptionError(
            f"threshold {given!r} given; allowed: LOW or LOW,HIGH, such as 250 or 250,1500"
        )
    return numbers[0], numbers[1] if len(numbers) == 2 else None


def wanted_scene(
    volume: Volume,
    *,
    bounds: Bounds | None,
    label_map: Path | None,
    resample: bool = False,
    progress: Progress,
) -> Scene:
    """Returns a scan with the segments asked for, and no others.

    Raises:
        EmptySegmentError: The threshold asked for selects nothing.
        VolumeFormatError: The label map cannot be read.
        OptionError: The label map does not fit the scan.
    """
    scene = Scene(volume)
    if bounds is not None:
        scene.add(volume.threshold(*bounds, name="threshold"))
    if label_map is not None:
        add_labels(scene, label_map, resample=resample, progress=progress)
    return scene


def scene_of(
    volume: Volume,
    *,
    bounds: Bounds | None,
    label_map: Path | None,
    resample: bool = False,
    progress: Progress,
) -> Scene:
    """Returns a scene with the segments asked for, or with the one offered as bone.

    Raises:
        EmptySegmentError: The threshold asked for selects nothing.
        VolumeFormatError: The label map cannot be read.
        OptionError: The label map does not fit the scan.
    """
    scene = wanted_scene(
        volume, bounds=bounds, label_map=label_map, resample=resample, progress=progress
    )
    if bounds is None and label_map is None and (told := offer_bone(scene)) is not None:
        warn(told)
    return scene


def add_labels(scene: Scene, path: Path, *, resample: bool, progress: Progress) -> None:
    """Adds the segments of a file or folder, and says what was changed or left out."""
    found = read_labels(path, scene.volume, resample=resample, progress=progress)
    for label in found.labels:
        # smooth bodies are read at a glance; until its surface is made, one is drawn from voxels
        scene.add(label.segment, colour=label.colour, shown_as="surface")
    for warning in found.warnings:
        warn(f"{path.name}: {warning}")


def add_second(
    scene: Scene, path: Path | None, transform: Path | None, *, progress: Progress
) -> None:
    """Shows a second scan with the first, where a transform says that it lies.

    Raises:
        OptionError: There is a transform and no scan, or it cannot be used.
        VolumeFormatError: The scan or the transform cannot be read.
    """
    if path is None:
        if transform is not None:
            raise OptionError(f"--transform {transform} given; allowed: together with --with")
        return
    volume = read(path, progress=progress)
    for warning in volume.warnings:
        warn(f"{path.name}: {warning}")
    known = None if transform is None else read_transform(transform)
    scene.second = placed(scene.volume, volume, known)


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

    def tell(sentence: str) -> None:
        warn(sentence)
        workbench.tell(sentence)

    def begin(progress: Progress) -> OpenScan:
        with Display() as display:

            def both(what: str, share: float | None, /) -> None:
                progress(what, share)
                display(what, share)

            made = make(both)
        for sentence in made.told:
            warn(sentence)
        opened = OpenScan.begin(
            made.scene,
            rate=rate,
            journalled=bool(journalled),
            recover=recover,
            run=run,
            saved=made.saved,
            tell=tell,
        )
        # pages ask by themselves
        if opened.journal is not None and (offer := opened.journal.offer) is not None:
            warn(
                f"{offer.steps} changes of this scan are kept from {offer.when:%d %B %Y, %H:%M}: "
                "the page asks whether to bring them back; --recover and --no-recover answer before"
            )
        note_recent(made.scene.volume, None if made.saved is None else made.saved.path)
        if made.saved is not None:
            note_scene(made.saved.scan, made.saved.path)
        return opened

    coming = Coming(name, begin)
    workbench = Workbench(coming=coming, rate=rate, journalled=journalled is not False)
    show_workbench(workbench, listener, browser=browser)
    if coming.failure is not None:
        raise coming.failure


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


def saved_scene(path: Path, progress: Progress) -> Opening:
    """Returns a scene that was saved.

    Raises:
        SceneFormatError: It cannot be opened; its last autosave is named then.
    """
    try:
        saved = open_scene(path, progress=progress)
        return Opening(saved.scene(), saved, saved.told)
    except SceneFormatError as error:
        raise with_autosave(error, path) from None


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

    coming, opened = workbench.coming, workbench.opened
    shown = opened if coming is None else coming
    name = "a scan once one is chosen" if shown is None else shown.name

    def announce() -> None:
        if coming is not None and not coming.recognised():
            return
        typer.echo(f"Palpate shows {name} at\n{access.url}\nCtrl-C stops it.")
        sys.stdout.flush()
        if browser and has_display():
            workbench.page_seconds = PAGE_SECONDS
            webbrowser.open(access.url)

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
