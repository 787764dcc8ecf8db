"""What a tool did and felt in a scenario, and the file that keeps it.

The file is one JSON object with the fields of ``ScenarioRun``; ``palpate scenario`` writes it with
``--json``, and the page plays it back: the tool stands at ``samples["x"]``, ``["y"]``, ``["z"]`` at
``samples["time"]``, and the chart shows ``samples["force"]`` over ``samples[over]`` with a mark at
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
from palpate.scenarios.engine_run import EngineRun

__all__ = ["UNITS", "Press", "ScenarioEvent", "ScenarioRun", "read_run", "samples_of", "write_run"]

FORMAT = "palpate-scenario-1"

MOST_ROWS = 20_000
"""Ticks in a file, at most."""

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
    "load": "mW",
    "press": "",
}
"""Columns of ``ScenarioRun.samples`` and their units."""


@dataclass(frozen=True, kw_only=True)
class ScenarioEvent:
    """What happened at once."""

    kind: str
    """Of a needle ``punctured``, ``crossed``, ``stopped``, ``withdrawn``; of other tools
    ``contact``, ``free``."""
    segment: str
    """Name of the layer; empty where none."""
    time: float
    """When [s]."""
    depth: float
    """How deep [mm]: of a needle from where it went in, of others along the drive's way."""
    force: float
    """At the tool [N]."""


@dataclass(frozen=True, kw_only=True)
class Press:
    """What one place of a palpation feels like."""

    place: tuple[float, float, float]
    """On the surface [mm]."""
    along: float
    """How far along the line of places [mm]."""
    thickness: float | None
    """Of what is soft, over the first bone on the way in [mm]; None where there is none."""
    depth: float
    """How deep the tool was in the matter [mm]."""
    force: float
    """At that depth [N]."""
    stiffness: float
    """How much the force rises with the depth there [N/mm]."""


@dataclass(frozen=True, kw_only=True)
class ScenarioRun:
    """A tool that was driven without a device."""

    scenario: str
    """Its name on the command line."""
    scan: str
    """Name of the scan."""
    layers: tuple[str, ...]
    """Names of the segments, which are numbered from 1."""
    radius: float
    """Of the tool's ball [mm]; 0 for a tip."""
    over: str
    """The column over which the force is drawn."""
    phase: tuple[str, ...]
    """What the drive does in each tick: ``in``, ``rest`` or ``out``."""
    samples: Mapping[str, NDArray[np.float64]]
    """One value for each tick of a millisecond; in the file of a long run, of every so many-th.

    ``time``; ``x``, ``y``, ``z`` of the tool; ``travel`` of the drive from its start, and ``tip``
    and ``probe``, how far the tool and the hard probe are along the drive's way; ``force`` on the
    drive, against its way in where positive, and ``across`` its way; ``segment``, the number of the
    layer at the tool, 0 where there is none.

    Of a needle the forces that hold it: ``stiffness``, ``cutting``, ``friction``, ``wall``,
    ``lateral``. Of a drill ``volume``, matter that is gone, and ``load``, the power on it. Of a
    palpation ``press``, its number from 0.
    """
    events: tuple[ScenarioEvent, ...]
    presses: tuple[Press, ...] = ()
    """Of a palpation."""
    wall_at: float | None = None
    """Travel at which the way comes into what stops the tool [mm]; None where nothing does."""
    violations: int
    """Ticks in which the probe was in a solid voxel: none."""

    @property
    def time(self) -> NDArray[np.float64]:
        """When each tick was [s]."""
        return self.samples["time"]

    @property
    def travel(self) -> NDArray[np.float64]:
        """How far the drive is from its start [mm]."""
        return self.samples["travel"]

    @property
    def tip(self) -> NDArray[np.float64]:
        """How far the tool is: less than the drive by what the spring between them gives [mm]."""
        return self.samples["tip"]

    @property
    def probe(self) -> NDArray[np.float64]:
        """How far the probe is that never enters what is solid [mm]."""
        return self.samples["probe"]

    @property
    def force(self) -> NDArray[np.float64]:
        """On the drive, against its way in where positive [N]."""
        return self.samples["force"]

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

    def figures(self) -> dict[str, float | int | None]:
        """Returns what a reader looks at first: forces [N], ways [mm], counts."""
        return {
            "largest_force": float(np.abs(self.force).max()),
            "deepest": float(self.tip.max()),
            "deepest_probe": float(self.probe.max()),
            "wall": self.wall_at,
            "spikes": self.spikes(),
            "violations": self.violations,
        }


def samples_of(told: EngineRun) -> dict[str, NDArray[np.float64]]:
    """Returns the columns among what the engine tells, ``tool`` by its coordinates."""
    x, y, z = np.asarray(told["tool"], dtype=float).T
    columns: dict[str, object] = {**told, "x": x, "y": y, "z": z}
    return {name: np.asarray(columns[name], float) for name in UNITS if name in columns}


def write_run(run: ScenarioRun, path: Path) -> None:
    """Writes a run as one JSON object, with its figures, to a millionth of each unit.

    Of long runs it has every second tick, or third, and so on: at most ``MOST_ROWS``.
    """
    rows = slice(None, None, -(-len(run.phase) // MOST_ROWS))
    told = {field.name: getattr(run, field.name) for field in fields(run)}
    told["phase"] = run.phase[rows]
    told["samples"] = {
        name: np.round(column[rows], 6).tolist() for name, column in run.samples.items()
    }
    told["events"] = [asdict(event) for event in run.events]
    told["presses"] = [asdict(press) for press in run.presses]
    told = {"format": FORMAT, "figures": run.figures(), **told}
    path.write_text(json.dumps(told) + "\n", encoding="utf-8")


def read_run(path: Path) -> ScenarioRun:
    """Reads a run.

    Raises:
        OptionError: The file is no run.
    """
    try:
        told: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
        if told["format"] != FORMAT:
            raise OptionError(f"{path}: format {told['format']!r} given; allowed: {FORMAT!r}")
        samples = {name: np.asarray(column, float) for name, column in told["samples"].items()}
        if {len(column) for column in samples.values()} != {len(told["phase"])}:
            raise OptionError(f"{path}: columns of unequal lengths given; allowed: one per tick")
        known = {field.name for field in fields(ScenarioRun)}
        given = {name: value for name, value in told.items() if name in known}
        return ScenarioRun(
            **{
                **given,
                "layers": tuple(told["layers"]),
                "phase": tuple(told["phase"]),
                "samples": samples,
                "events": tuple(ScenarioEvent(**event) for event in told["events"]),
                "presses": tuple(
                    Press(**{**press, "place": tuple(press["place"])}) for press in told["presses"]
                ),
            }
        )
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise OptionError(
            f"{path} is no scenario's file ({error}); allowed: what `palpate scenario NAME --json "
            "FILE` has written"
        ) from None
