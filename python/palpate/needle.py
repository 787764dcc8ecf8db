"""Needles: what tissues are to them, and driving one into a scan without a device.

The law is told in ``docs/algorithms/needle.md``. Points are in the patient [mm].
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import astuple, dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from palpate import _core
from palpate.errors import OptionError
from palpate.segment import Segment
from palpate.volume import Volume

__all__ = ["TISSUES", "NeedleEvent", "NeedleRun", "Tissue", "drive_needle", "line_through"]


@dataclass(frozen=True)
class Tissue:
    """What a needle meets in a tissue that it can puncture."""

    linear: float
    """Force per deflection of the tissue under the tip [N/mm]."""
    quadratic: float
    """What the square of the deflection adds [N/mm²]."""
    puncture: float
    """Force at which the tip goes in [N]."""
    cutting: float
    """Force at the tip while it cuts its way on [N]."""
    friction: float
    """Friction of the shaft per length in the tissue [N/mm]."""
    lateral: float
    """Stiffness against the side per length of shaft in the tissue [N/mm per mm]."""
    relaxation: float
    """Share of the cutting force that a tip at rest loses."""
    relaxation_secs: float
    """Time in which that loss comes to 63 % [s]."""


TISSUES: Mapping[str, Tissue] = {name: Tissue(*figures) for name, figures in _core.needle_tissues()}
"""Presets by name; bone is none of them, since no needle punctures it."""


BEYOND = 25.0
"""How far past the second mask ``line_through`` aims [mm]."""


@dataclass(frozen=True)
class NeedleEvent:
    """What happened to the needle."""

    kind: str
    """``punctured``, ``crossed``, ``stopped`` or ``withdrawn``."""
    segment: str
    """Which layer; empty where none."""
    time: float
    """When [s]."""
    depth: float
    """How deep along the line, from where the needle went in [mm]."""
    force: float
    """At the tip [N]."""


@dataclass(frozen=True)
class NeedleRun:
    """What a needle felt; arrays have one value a tick of a millisecond."""

    time: NDArray[np.float64]
    """[s]."""
    phase: list[str]
    """``in``, ``rest`` or ``out``."""
    travel: NDArray[np.float64]
    """How far the drive is from its start [mm]."""
    tip: NDArray[np.float64]
    """How far the tip is [mm]: less by what the spring between them gives."""
    probe: NDArray[np.float64]
    """How far the probe is that never enters what is solid [mm]."""
    force: NDArray[np.float64]
    """On the drive, against its way in where positive [N]."""
    across: NDArray[np.float64]
    """Across its way [N]."""
    parts: Mapping[str, NDArray[np.float64]]
    """``stiffness``, ``cutting``, ``friction``, ``wall``, ``lateral`` [N]."""
    segment: NDArray[np.uint8]
    """Number of the layer at the tip, from 1; 0 where there is none."""
    names: tuple[str, ...]
    """Of the layers."""
    events: tuple[NeedleEvent, ...]
    wall_at: float | None
    """Travel at which the line comes into what no needle punctures [mm]."""
    violations: int
    """Ticks in which the probe was in a solid voxel: none."""

    def spikes(self, *, ticks: int = 10, share: float = 1.5, least: float = 1e-3) -> int:
        """Counts forces above ``share`` of their neighbours' median outside of events.

        Args:
            ticks: Neighbours on either side.
            share: Of the median.
            least: Below this force nothing is a spike [N].
        """
        size = np.abs(self.force)
        windows = np.lib.stride_tricks.sliding_window_view(size, 2 * ticks + 1)
        medians = np.median(windows, axis=1)
        middle = slice(ticks, len(size) - ticks)
        is_spike = size[middle] > share * medians + least
        when = self.time[middle]
        for event in self.events:
            is_spike &= np.abs(when - event.time) > (ticks + 0.5) * 1e-3
        return int(is_spike.sum())


def drive_needle(
    volume: Volume,
    layers: Sequence[tuple[Segment, Tissue | None]],
    *,
    start: ArrayLike,
    target: ArrayLike,
    speed: float = 5.0,
    force_limit: float = 6.0,
    rest_secs: float = 1.0,
    stiffness: float = 1.0,
) -> NeedleRun:
    """Drives a needle straight toward a point until the force stops it, and out again.

    Args:
        volume: The scan.
        layers: Its segments, each with what it is for the needle; None where it is hard.
        start: Where the tip begins [mm], outside of all layers.
        target: Where it goes to [mm].
        speed: How fast [mm/s].
        force_limit: Where it stops [N].
        rest_secs: How long it rests before it goes out [s].
        stiffness: Of the spring between drive and needle [N/mm].

    Raises:
        OptionError: Something given is not allowed.
    """
    given = [
        (segment._internal, None if tissue is None else astuple(tissue))  # noqa: SLF001
        for segment, tissue in layers
    ]
    names = tuple(segment.name for segment, _ in layers)
    first, last = (_point(point) for point in (start, target))
    try:
        told = _core.drive_needle(
            volume._internal,  # noqa: SLF001
            given,
            first,
            last,
            float(speed),
            float(force_limit),
            float(rest_secs),
            float(stiffness),
        )
    except ValueError as error:
        raise OptionError(str(error)) from None
    return _run(told, names)


def line_through(
    volume: Volume,
    first: NDArray[np.bool_],
    then: NDArray[np.bool_],
    *,
    margin: float = 8.0,
    longest: float = 300.0,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Returns start and target of a needle that meets one mask and then another one [mm].

    Lines along the second axis of the arrays are tried, from its lower end: in an axial scan
    from the front. The one with the longest way in ``first`` before ``then`` is taken, up to
    ``longest``, of those whose neighbours have one too.

    Args:
        volume: The scan.
        first: What the needle goes through, shape of the volume.
        then: Where it ends.
        margin: How far before the first voxel of the body it begins [mm].
        longest: Way in ``first`` [mm].

    Raises:
        OptionError: No line meets both.
    """
    solid = first | then
    end = np.where(then.any(axis=1), then.argmax(axis=1), -1)
    before = np.arange(first.shape[1])[None, :, None] < end[:, None, :]
    length = (first & before).sum(axis=1)
    length[length > longest / volume.spacing[1]] = 0
    # a way that is as long beside it, so that it is no rim
    around = length.copy()
    for axis in (0, 1):
        for step in (-2, 2):
            around = np.minimum(around, np.roll(length, step, axis=axis))
    if not around.any():
        raise OptionError("no line from the front meets both; allowed: segments behind one another")
    z, x = np.unravel_index(int(around.argmax()), around.shape)
    entry = int(solid[z, :, x].argmax())
    spacing = volume.spacing[1]
    # past what stops it, as a hand would push
    ends = (entry - margin / spacing, end[z, x] + BEYOND / spacing)
    grid = np.array([[x + 0.5, y, z + 0.5, 1.0] for y in ends])
    start, target = (grid @ volume.patient_from_grid.T)[:, :3]
    return start, target


def _point(given: ArrayLike) -> tuple[float, float, float]:
    numbers = np.asarray(given, dtype=float)
    if numbers.shape != (3,):
        raise OptionError(f"point {given!r} given; allowed: three numbers [mm]")
    x, y, z = numbers.tolist()
    return x, y, z


def _run(told: dict[str, Any], names: tuple[str, ...]) -> NeedleRun:
    parts = {name: told[name] for name in ("stiffness", "cutting", "friction", "wall", "lateral")}
    events = tuple(
        NeedleEvent(
            kind=event["kind"],
            segment=names[event["segment"] - 1] if event["segment"] else "",
            time=event["time"],
            depth=event["depth"],
            force=event["force"],
        )
        for event in told["events"]
    )
    columns = ("time", "phase", "travel", "tip", "probe", "force", "across", "segment")
    return NeedleRun(
        **{name: told[name] for name in columns},
        parts=parts,
        names=names,
        events=events,
        wall_at=told["wall_at"],
        violations=told["violations"],
    )
