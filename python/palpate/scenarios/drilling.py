"""Driving a drill into bone without a device; ``docs/understand/tools.md`` explains the model."""

from __future__ import annotations

from palpate import _core
from palpate.base.errors import OptionError
from palpate.scenarios.drive import Drive
from palpate.scenarios.run import ScenarioEvent, ScenarioRun, samples_of
from palpate.volumes.segment import Segment
from palpate.volumes.volume import Volume

__all__ = ["drive_drill"]


def drive_drill(
    volume: Volume,
    bone: Segment,
    drive: Drive,
    *,
    radius: float = 2.0,
    air: float | None = None,
    energy: float | None = None,
) -> ScenarioRun:
    """Drives a drill straight to a point and out again; it turns on the way in and while it rests.

    Args:
        volume: The scan.
        bone: The segment that it removes, and that stops the burr.
        drive: Path of the burr's centre.
        radius: Radius of the burr [mm].
        air: Value of drilled voxels [unit of the scan]; None is -1000.
        energy: Work per volume [mJ/mm³]; None is that of bone by HU.

    Raises:
        OptionError: An argument is not allowed.
    """
    try:
        run = _core.drive_drill(
            volume._internal,  # noqa: SLF001
            bone._internal,  # noqa: SLF001
            drive.given(),
            float(radius),
            air,
            energy,
        )
    except ValueError as error:
        raise OptionError(str(error)) from None
    return ScenarioRun(
        scenario="drilling",
        scan=volume.name,
        layers=(bone.name,),
        radius=float(radius),
        over="time",
        phase=tuple(run["phase"]),
        samples=samples_of(run),
        events=tuple(
            ScenarioEvent(
                kind="contact" if is_contact else "free",
                segment=bone.name,
                time=time,
                depth=travel,
                force=force,
            )
            for is_contact, time, travel, force in run["events"]
        ),
        violations=run["violations"],
    )
