"""``palpate bench servo``: lateness of the ticks of the real servo thread.

A session on the built-in phantom runs at each rate: at rest and while other processes keep all
cores busy, with the hand moving in circles through bone; and with the lattice at work, with the
hand moving into the liver and out again. The thread itself counts its lateness, in bins; quantiles
are interpolated between the ends of a bin.
"""

from __future__ import annotations

import itertools
import math
import os
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from palpate.base.errors import OptionError
from palpate.base.progress import Progress, silent
from palpate.bench.goals import GOALS
from palpate.bench.goals.servo import BUSY, DEFORMING, LOADS, RATES, servo_case
from palpate.bench.report import Row, row_of
from palpate.session.frame_state import ThreadLateness
from palpate.session.session import Session, SessionOptions
from palpate.volumes.phantom import Phantom, phantom
from palpate.volumes.scene import Scene

__all__ = ["HAND_RATE", "HandCircle", "Lateness", "histogram", "measure", "rows_of"]

LEAST_SECONDS = 0.1
MOST_SECONDS = 3600.0
HAND_RATE = 60.0
"""Hand targets per second, as a page sends them."""
START = -0.75 * math.pi
"""Where a hand begins on its circle [rad]: outside of the liver. One that begins inside may feel
nothing until it has come out."""
BAR = 40
"""Characters of the longest bar of a histogram."""


@dataclass(frozen=True)
class Lateness:
    """Lateness of the servo in one case."""

    case: str
    real_time: bool
    """Whether the threads had real-time priority."""
    ticks: int
    missed: int
    late: int
    """Ticks that began more than 2 ms late, or were left out when that late."""
    ends_us: tuple[int, ...]
    """Upper ends of the bins [µs]; one more bin holds the rest."""
    counts: tuple[int, ...]
    worst_ms: float
    answers_hz: float = 0.0
    """Answers of the deformation model per second."""

    def quantile_ms(self, share: float) -> float:
        """Returns the lateness [ms] that this fraction of the ticks does not exceed."""
        ends = [*(end / 1000.0 for end in self.ends_us), math.inf]
        begins = [0.0, *ends[:-1]]
        left = share * sum(self.counts)
        for begin, end, count in zip(begins, ends, self.counts, strict=True):
            if count and left <= count:
                top = min(end, self.worst_ms)
                return min(self.worst_ms, begin + max(0.0, top - begin) * left / count)
            left -= count
        return self.worst_ms

    def report(self) -> dict[str, float]:
        """Returns the figures of the rows."""
        return {
            "p50_ms": self.quantile_ms(0.5),
            "p99_ms": self.quantile_ms(0.99),
            "p999_ms": self.quantile_ms(0.999),
            "max_ms": self.worst_ms,
            "late_share": self.late / max(1, self.ticks + self.missed),
            "missed_share": self.missed / max(1, self.ticks + self.missed),
            "answers_hz": self.answers_hz,
        }


@dataclass(frozen=True)
class HandCircle:
    """A circle of the hand, patient frame LPS [mm]."""

    centre: NDArray[np.float64]
    arms: tuple[NDArray[np.float64], NDArray[np.float64]]
    """From its centre to two of its points, at a right angle."""

    def at(self, angle: float) -> tuple[float, float, float]:
        """Returns the point at an angle [rad]."""
        x, y, z = self.centre + math.cos(angle) * self.arms[0] + math.sin(angle) * self.arms[1]
        return float(x), float(y), float(z)


def measure(seconds: float, progress: Progress = silent) -> list[Lateness]:
    """Measures every rate and load.

    Args:
        seconds: Duration of each case [s].
        progress: Takes the progress.

    Raises:
        OptionError: The time is not allowed.
    """
    if not LEAST_SECONDS <= seconds <= MOST_SECONDS:
        raise OptionError(
            f"{seconds:g} s given; allowed: {LEAST_SECONDS:g} to {MOST_SECONDS:g} s of each case"
        )
    progress("making the phantom", None)
    made = phantom()
    cases = list(itertools.product(LOADS, RATES))
    found = []
    for done, (load, rate) in enumerate(cases):
        progress(f"{servo_case(rate, load)}, {seconds:g} s", done / len(cases))
        with _busy(os.cpu_count() or 1 if load == BUSY else 0):
            found.append(_watch(made, rate, load, seconds=seconds))
    return found


def _watch(made: Phantom, rate: int, load: str, *, seconds: float) -> Lateness:
    scene = Scene(made.volume)
    scene.add(made.part("liver") if load == DEFORMING else made.volume.offered_bone())
    circle = _into_liver(made) if load == DEFORMING else _through_bone(made)
    with Session(scene, options=SessionOptions(rate_hz=rate)) as session:
        if load == DEFORMING:
            session.set_material(1, "liver")
            session.set_deformation("lattice")
        begins, step = time.monotonic(), 0
        while (passed := time.monotonic() - begins) < seconds:
            session.hand(circle.at(START + step * math.tau / 80.0))
            time.sleep(1.0 / HAND_RATE)
            step += 1
        servo, frame = session.lateness()["servo"], session.frame()
    return _lateness(
        servo_case(rate, load),
        servo,
        real_time=bool(frame["rates"]["real_time"]),
        answers_hz=frame["matter"]["answers"] / passed,
    )


def _through_bone(made: Phantom) -> HandCircle:
    half = [count / 2.0 for count in made.volume.dimensions]
    return _circle(made, half, 40.0, across=(1.0, 0.0, 0.0))


def _into_liver(made: Phantom) -> HandCircle:
    """Returns a circle half inside the liver and half in front of it."""
    liver = np.argwhere(made.labels == made.names["liver"])
    z, _, x = np.round(liver.mean(axis=0)).astype(int).tolist()
    front = liver[(liver[:, 0] == z) & (liver[:, 2] == x), 1].min()
    return _circle(made, [x + 0.5, float(front), z + 0.5], 5.0, across=(0.0, 1.0, 0.0))


def _circle(
    made: Phantom, middle: list[float], radius: float, *, across: tuple[float, float, float]
) -> HandCircle:
    """Returns an upright circle around a place of the grid [voxels], with a radius in mm."""
    centre = (made.volume.patient_from_grid @ [*middle, 1.0])[:3]
    return HandCircle(centre, (radius * np.array(across), radius * np.array([0.0, 0.0, 1.0])))


def _lateness(case: str, servo: ThreadLateness, *, real_time: bool, answers_hz: float) -> Lateness:
    return Lateness(
        case=case,
        real_time=real_time,
        ticks=servo["ticks"],
        missed=servo["missed"],
        late=servo["late"],
        ends_us=tuple(servo["lateness_bins_us"]),
        counts=tuple(servo["lateness"]),
        worst_ms=servo["worst_ever_ms"],
        answers_hz=answers_hz,
    )


@contextmanager
def _busy(count: int) -> Iterator[None]:
    """Keeps so many cores busy."""
    command = [sys.executable, "-c", "while True: pass"]
    processes = [subprocess.Popen(command) for _ in range(count)]  # noqa: S603  # ourselves
    try:
        if processes:
            # until they have started and really work
            time.sleep(0.5)
        yield
    finally:
        for process in processes:
            process.kill()
        for process in processes:
            process.wait()


def rows_of(found: Sequence[Lateness]) -> list[Row]:
    """Returns the rows; without real-time priority they have no goals."""
    by_case = {one.case: one for one in found}
    rows = []
    for goal in GOALS["servo"]:
        one = by_case[goal.case]
        row = row_of(goal, one.report())
        rows.append(row if one.real_time else replace(row, goal=None))
    return rows


def histogram(one: Lateness) -> str:
    """Returns the histogram of a case as text."""
    priority = "with" if one.real_time else "without"
    names = [f"≤ {end / 1000:g} ms" for end in one.ends_us]
    names.append(f"> {one.ends_us[-1] / 1000:g} ms")
    most = max(one.counts, default=0)
    lines = [f"{one.case}, {priority} real-time priority: {one.ticks} ticks"]
    for name, count in zip(names, one.counts, strict=True):
        # a bar of one letter for a single tick: the rare ones are what counts
        bar = "█" * math.ceil(BAR * count / most) if count else ""
        lines.append(f"{name:>10} {count:>9} {bar}".rstrip())
    return "\n".join(lines)
