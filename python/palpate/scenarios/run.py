"""Result of a scenario, and its file.

The file is one JSON object with the fields of ``ScenarioRun``; ``palpate scenario`` writes it with
``--json``, and the page plays it back: the tool is at ``samples["x"]``, ``["y"]``, ``["z"]`` at
``samples["time"]``, and the chart shows ``samples["force"]`` over ``samples[over]``, with a mark at
the time of each event.

Frame: scene, LPS [mm]; s, N, N/mm.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from palpate.base.errors import OptionError
from palpate.base.whole_file import whole_file
from palpate.scenarios.engine_run import EngineRun
from palpate.scenarios.hole import Hole, hole_told

__all__ = [
    "UNITS",
    "Lump",
    "Press",
    "ScenarioEvent",
    "ScenarioRun",
    "read_run",
    "samples_of",
    "write_run",
]

FORMAT = "palpate-scenario-1"

MOST_ROWS = 20_000
"""Most ticks in a file."""

UNITS: Mapping[str, str] = {
    "time": "s",
    "x": "mm",
    "y": "mm",
    "z": "mm",
    "travel": "mm",
    "tip": "mm",
    "probe": "mm",
    "force": "N",
    "across": "N",
    "segment": "",
    "stiffness": "N",
    "cutting": "N",
    "friction": "N",
    "wall": "N",
    "lateral": "N",
    "volume": "mm³",
    "piled": "mm³",
    "load": "mW",
    "press": "",
}
"""Columns of ``ScenarioRun.samples`` and their units."""


@dataclass(frozen=True, kw_only=True)
class ScenarioEvent:
    """An event in a scenario."""

    kind: str
    """Of a needle ``punctured``, ``crossed``, ``stopped`` or ``withdrawn``; of other tools
    ``contact`` or ``free``."""
    segment: str
    """Name of the layer; empty where there is none."""
    time: float
    """Time [s]."""
    depth: float
    """Depth [mm]: of a needle from its point of entry, of other tools along the path of the drive.
    """
    force: float
    """Force at the tool [N]."""


@dataclass(frozen=True, kw_only=True)
class Press:
    """Result of pressing one place of a palpation."""

    place: tuple[float, float, float]
    """Point on the surface [mm]."""
    along: float
    """Distance along the line of places [mm]."""
    thickness: float | None
    """Thickness of soft tissue over the first bone [mm]; None where there is no bone."""
    depth: float
    """Depth of the tool in the tissue [mm]."""
    force: float
    """Force at that depth [N]."""
    stiffness: float
    """Slope of the force there [N/mm]."""
    young: float | None = None
    """Young's modulus of an even body that a ball feels so [kPa], by Hertz; None if unknown."""
    across: float | None = None
    """Distance across the rows of a square of places [mm]; None in a line."""


@dataclass(frozen=True, kw_only=True)
class Lump:
    """Where a square of places feels stiffest."""

    place: tuple[float, float, float]
    """Point on the surface [mm]."""
    times: float
    """How many times as stiff as the median place."""
    hidden: tuple[float, float, float] | None
    """Middle of the lump that is there [mm]; None where none is known."""

    @property
    def aside(self) -> float | None:
        """Distance from the place to the line of sight through the middle of the lump [mm].

        Presses are along the second patient axis.
        """
        if self.hidden is None:
            return None
        return float(np.hypot(self.place[0] - self.hidden[0], self.place[2] - self.hidden[2]))


@dataclass(frozen=True, kw_only=True)
class ScenarioRun:
    """Result of driving a tool without a device."""

    scenario: str
    """Its name on the command line."""
    scan: str
    """Name of the scan."""
    layers: tuple[str, ...]
    """Names of the segments; they are numbered from 1."""
    radius: float
    """Radius of the tool's ball [mm]; 0 for a tip."""
    over: str
    """Column over which the force is plotted."""
    phase: tuple[str, ...]
    """Phase of the drive in each tick: ``in``, ``rest`` or ``out``."""
    samples: Mapping[str, NDArray[np.float64]]
    """One value for each tick of a millisecond; a file of a long run has only every nth tick.

    ``time``; ``x``, ``y``, ``z`` of the tool; ``travel`` of the drive from its start, ``tip`` and
    ``probe``, the positions of the tool and of the rigid probe along the path; ``force`` on the
    drive along its path, positive outward, and ``across`` it; ``segment``, the number of the layer
    at the tool, 0 where there is none.

    Of a needle its forces: ``stiffness``, ``cutting``, ``friction``, ``wall``, ``lateral``. Of a
    tool in bone ``volume``, places of bone that are empty by then; of a drill ``load``, its power;
    of particles ``piled``, empty places that are bone by then. Of a palpation ``press``, the
    number of the press from 0.
    """
    events: tuple[ScenarioEvent, ...]
    presses: tuple[Press, ...] = ()
    """Of a palpation, one for each place."""
    lump: Lump | None = None
    """Of a palpation of a square, where it feels stiffest."""
    hole: Hole | None = None
    """Of a tool in bone, what it leaves."""
    wall_at: float | None = None
    """Travel at which the path meets a rigid obstacle [mm]; None where it does not."""
    violations: int
    """Ticks in which the probe was in a solid voxel; 0 unless a guarantee of touch is violated."""

    @property
    def time(self) -> NDArray[np.float64]:
        """Time of each tick [s]."""
        return self.samples["time"]

    @property
    def travel(self) -> NDArray[np.float64]:
        """Distance of the drive from its start [mm]."""
        return self.samples["travel"]

    @property
    def tip(self) -> NDArray[np.float64]:
        """Position of the tool along the path [mm]; the spring makes it lag behind the drive."""
        return self.samples["tip"]

    @property
    def probe(self) -> NDArray[np.float64]:
        """Position of the probe along the path [mm]; the probe never enters solid voxels."""
        return self.samples["probe"]

    @property
    def force(self) -> NDArray[np.float64]:
        """Force on the drive along its path, positive outward [N]."""
        return self.samples["force"]

    def spikes(self, *, ticks: int = 10, share: float = 1.5, least: float = 1e-3) -> int:
        """Counts forces above ``share`` times the median of their neighbours, except at events.

        Args:
            ticks: Neighbours on either side.
            share: Factor of the median.
            least: Smaller forces do not count [N].
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

    def figures(self) -> dict[str, float | int | None]:
        """Returns the main figures: forces [N], distances [mm], counts."""
        return {
            "largest_force": float(np.abs(self.force).max()),
            "deepest": float(self.tip.max()),
            "deepest_probe": float(self.probe.max()),
            "wall": self.wall_at,
            "lump_aside": None if self.lump is None else self.lump.aside,
            "hole_depth": None if self.hole is None else self.hole.depth,
            "hole_rim": None if self.hole is None else self.hole.rim,
            "spikes": self.spikes(),
            "violations": self.violations,
        }


def samples_of(run: EngineRun) -> dict[str, NDArray[np.float64]]:
    """Returns the columns of a run of the engine, with ``tool`` split into its coordinates."""
    x, y, z = np.asarray(run["tool"], dtype=float).T
    columns: dict[str, object] = {**run, "x": x, "y": y, "z": z}
    return {name: np.asarray(columns[name], float) for name in UNITS if name in columns}


def write_run(run: ScenarioRun, path: Path) -> None:
    """Writes a run and its figures as one JSON object, rounded to a millionth of each unit.

    Of long runs only every second tick, or third, and so on is written: at most ``MOST_ROWS``.
    """
    rows = slice(None, None, -(-len(run.phase) // MOST_ROWS))
    content = {field.name: getattr(run, field.name) for field in fields(run)}
    content["phase"] = run.phase[rows]
    content["samples"] = {
        name: np.round(column[rows], 6).tolist() for name, column in run.samples.items()
    }
    content["events"] = [asdict(event) for event in run.events]
    content["presses"] = [asdict(press) for press in run.presses]
    content["lump"] = None if run.lump is None else asdict(run.lump)
    content["hole"] = None if run.hole is None else asdict(run.hole)
    content = {"format": FORMAT, "figures": run.figures(), **content}
    with whole_file(path) as unfinished:
        unfinished.write_text(json.dumps(content) + "\n", encoding="utf-8")


def _lump(told: Mapping[str, Any] | None) -> Lump | None:
    if told is None:
        return None
    hidden = told["hidden"]
    return Lump(
        place=tuple(told["place"]),
        times=told["times"],
        hidden=None if hidden is None else tuple(hidden),
    )


def read_run(path: Path) -> ScenarioRun:
    """Reads a run.

    Raises:
        OptionError: The file is not a run.
    """
    try:
        # JSON of any version; what it holds is checked below
        content: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
        if content["format"] != FORMAT:
            raise OptionError(f"{path}: format {content['format']!r} given; allowed: {FORMAT!r}")
        samples = {name: np.asarray(column, float) for name, column in content["samples"].items()}
        if {len(column) for column in samples.values()} != {len(content["phase"])}:
            raise OptionError(f"{path}: columns of unequal lengths given; allowed: one per tick")
        known = {field.name for field in fields(ScenarioRun)}
        given = {name: value for name, value in content.items() if name in known}
        return ScenarioRun(
            **{
                **given,
                "layers": tuple(content["layers"]),
                "phase": tuple(content["phase"]),
                "samples": samples,
                "events": tuple(ScenarioEvent(**event) for event in content["events"]),
                "presses": tuple(
                    Press(**{**press, "place": tuple(press["place"])})
                    for press in content["presses"]
                ),
                "lump": _lump(content.get("lump")),
                "hole": hole_told(content.get("hole")),
            }
        )
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise OptionError(
            f"{path} is no scenario's file ({error}); allowed: what `palpate scenario NAME --json "
            "FILE` has written"
        ) from None
