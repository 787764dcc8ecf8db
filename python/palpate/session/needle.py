"""Needles: what tissues are to them, and driving one into a scan without a device.

The law is told in ``docs/algorithms/needle.md``. Points are in the patient [mm].
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import astuple, dataclass, replace

from palpate import _core
from palpate.base.errors import OptionError
from palpate.scenarios.drive import Drive
from palpate.scenarios.run import ScenarioEvent, ScenarioRun, samples_of
from palpate.volumes.segment import Segment
from palpate.volumes.volume import Volume

__all__ = ["DIAMETER", "TISSUES", "NeedleEvent", "Tissue", "drive_needle"]


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

    def met_by(self, diameter: float) -> Tissue:
        """Returns what a needle of another diameter [mm] meets.

        Forces at tip and shaft grow in proportion to it, as the shaft's face does; that is assumed.
        """
        share = diameter / DIAMETER
        return replace(
            self,
            linear=self.linear * share,
            quadratic=self.quadratic * share,
            puncture=self.puncture * share,
            cutting=self.cutting * share,
            friction=self.friction * share,
        )


DIAMETER = 1.0
"""Of the needle that the presets are for [mm]."""

TISSUES: Mapping[str, Tissue] = {name: Tissue(*figures) for name, figures in _core.needle_tissues()}
"""Presets by name; bone is none of them, since no needle punctures it."""


@dataclass(frozen=True)
class NeedleEvent:
    """What happened to a needle in a session."""

    kind: str
    """``punctured``, ``crossed``, ``stopped`` or ``withdrawn``."""
    segment: int
    """Which segment; 0 where none."""
    time: float
    """When [s]."""
    depth: float
    """How deep, from where the needle went in [mm]."""
    force: float
    """At the tip [N]."""


def drive_needle(
    volume: Volume,
    layers: Sequence[tuple[Segment, Tissue | None]],
    drive: Drive,
    *,
    scenario: str = "needle",
) -> ScenarioRun:
    """Drives a needle straight toward a point until the force stops it, and out again.

    Args:
        volume: The scan.
        layers: Its segments, each with what it is for the needle; None where it is hard.
        drive: Where the tip goes.
        scenario: What to call the run.

    Raises:
        OptionError: Something given is not allowed.
    """
    given = [
        (segment._internal, None if tissue is None else astuple(tissue))  # noqa: SLF001
        for segment, tissue in layers
    ]
    names = tuple(segment.name for segment, _ in layers)
    try:
        told = _core.drive_needle(volume._internal, given, drive.given())  # noqa: SLF001
    except ValueError as error:
        raise OptionError(str(error)) from None
    return ScenarioRun(
        scenario=scenario,
        scan=volume.name,
        layers=names,
        radius=0.0,
        over="travel",
        phase=tuple(told["phase"]),
        samples=samples_of(told),
        events=tuple(
            ScenarioEvent(
                kind=kind,
                segment=names[number - 1] if number else "",
                time=time,
                depth=depth,
                force=force,
            )
            for kind, number, time, depth, force in told["events"]
        ),
        wall_at=told["wall_at"],
        violations=told["violations"],
    )
