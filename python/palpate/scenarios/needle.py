"""Driving a needle into a scan without a device; ``docs/understand/needle.md`` explains the model.

Points are in the patient, LPS [mm].
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import astuple

from palpate import _core
from palpate.base.errors import OptionError
from palpate.scenarios.drive import Drive
from palpate.scenarios.run import ScenarioEvent, ScenarioRun, samples_of
from palpate.session.needle import Tissue
from palpate.volumes.segment import Segment
from palpate.volumes.volume import Volume

__all__ = ["drive_needle"]


def drive_needle(
    volume: Volume,
    layers: Sequence[tuple[Segment, Tissue | None]],
    drive: Drive,
    *,
    scenario: str = "needle",
) -> ScenarioRun:
    """Drives a needle straight to a point or until the force limit, and out again.

    Args:
        volume: The scan.
        layers: Segments, each with its tissue; None where it is rigid.
        drive: Path of the tip.
        scenario: Name of the run.

    Raises:
        OptionError: An argument is not allowed.
    """
    given = [
        (segment._internal, None if tissue is None else astuple(tissue))  # noqa: SLF001
        for segment, tissue in layers
    ]
    names = tuple(segment.name for segment, _ in layers)
    try:
        run = _core.drive_needle(volume._internal, given, drive.given())  # noqa: SLF001
    except ValueError as error:
        raise OptionError(str(error)) from None
    return ScenarioRun(
        scenario=scenario,
        scan=volume.name,
        layers=names,
        radius=0.0,
        over="travel",
        phase=tuple(run["phase"]),
        samples=samples_of(run),
        events=tuple(
            ScenarioEvent(
                kind=kind,
                segment=names[number - 1] if number else "",
                time=time,
                depth=depth,
                force=force,
            )
            for kind, number, time, depth, force in run["events"]
        ),
        wall_at=run["wall_at"],
        violations=run["violations"],
    )
