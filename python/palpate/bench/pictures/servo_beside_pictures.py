"""Lateness of the servo while pictures are drawn beside it, and while none are, by turns.

A session runs at 1 kHz and its hand moves in circles through the scan, as in ``palpate bench
servo``. In every second span a thread draws pictures of a turning view one after the other, as a
page asks for them, without a pause. Both spans of a pair follow one another, in changing order, so
that other work on the machine meets both.
"""

from __future__ import annotations

import itertools
import math
import time
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from statistics import median
from threading import Event, Thread

import numpy as np

from palpate.bench.pictures.moving_quality import MOVING, Drawn
from palpate.bench.servo import HAND_RATE, HandCircle
from palpate.session.session import Session
from palpate.volumes.scene import Scene

__all__ = ["late_beside_pictures"]

RADIUS = 40.0
"""Of the circles of the hand [mm]."""
VIEWS = 24
"""Cameras around the body."""
DIVISOR = 3.0
"""Of the resolution of the pictures."""


def late_beside_pictures(scene: Scene, *, pairs: int, seconds: float) -> dict[str, float]:
    """Returns shares of late ticks with and without pictures, and their paired difference.

    Args:
        scene: As it is opened.
        pairs: Spans with and without pictures.
        seconds: Length of each span [s].
    """
    shares: dict[bool, list[float]] = {False: [], True: []}
    with Session(scene) as session:
        drawn = Drawn.of(session, scene, views=VIEWS)
        # light is worked out before
        drawn.draw(drawn.cameras[0], MOVING, divisor=DIVISOR)
        real_time = session.frame()["rates"]["real_time"]
        circle = _circle(scene)
        pictures = 0
        for pair in range(pairs):
            for drawing in (False, True) if pair % 2 == 0 else (True, False):
                counted: list[int] = []
                with _drawing(drawn, counted) if drawing else nullcontext():
                    shares[drawing].append(_late_share(session, circle, seconds))
                pictures += sum(counted)
    more = [with_ - without for with_, without in zip(shares[True], shares[False], strict=True)]
    return {
        "without": median(shares[False]),
        "with": median(shares[True]),
        "more": median(more),
        "pictures": pictures / (pairs * seconds),
        "real time": float(real_time),
    }


def _late_share(session: Session, circle: HandCircle, seconds: float) -> float:
    """Returns the fraction of ticks that begin more than 2 ms late, with the hand in circles."""
    before = session.lateness()["servo"]
    began = time.monotonic()
    for step in itertools.count():
        if time.monotonic() - began >= seconds:
            break
        session.hand(circle.at(step * math.tau / 80.0))
        time.sleep(1.0 / HAND_RATE)
    after = session.lateness()["servo"]
    ticks = after["ticks"] + after["missed"] - before["ticks"] - before["missed"]
    return (after["late"] - before["late"]) / max(1, ticks)


@contextmanager
def _drawing(drawn: Drawn, counted: list[int]) -> Iterator[None]:
    """Draws in a thread of its own; ``counted`` then has the number of pictures."""
    enough = Event()

    def draw() -> None:
        number = 0
        while not enough.is_set():
            drawn.draw(drawn.cameras[number % len(drawn.cameras)], MOVING, divisor=DIVISOR)
            number += 1
        counted.append(number)

    thread = Thread(target=draw, name="pictures beside the servo")
    thread.start()
    try:
        yield
    finally:
        enough.set()
        thread.join()


def _circle(scene: Scene) -> HandCircle:
    """Returns an upright circle around the middle of the scan."""
    volume = scene.volume
    middle = [*(count / 2.0 for count in volume.dimensions), 1.0]
    across, upward = np.array([RADIUS, 0.0, 0.0]), np.array([0.0, 0.0, RADIUS])
    return HandCircle((volume.patient_from_grid @ middle)[:3], (across, upward))
