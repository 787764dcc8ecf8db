"""Driving a tool into bone without a device, which it removes or pushes aside.

``docs/understand/tools.md`` explains removal by work, ``docs/understand/particles.md`` particles
that rearrange.
"""

from __future__ import annotations

import numpy as np

from palpate import _core
from palpate.base.errors import OptionError
from palpate.scenarios.drive import Drive
from palpate.scenarios.engine_run import DrillRun, RearrangingRun
from palpate.scenarios.hole import hole_of
from palpate.scenarios.run import ScenarioEvent, ScenarioRun, samples_of
from palpate.volumes.segment import Segment
from palpate.volumes.volume import Volume

__all__ = ["drive_drill", "drive_rearranging_ball"]


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
    return _told("drilling", run, (volume, bone), drive=drive, radius=radius)


def drive_rearranging_ball(
    volume: Volume,
    bone: Segment,
    drive: Drive,
    *,
    radius: float = 2.0,
    softening: float = 5000.0,
) -> ScenarioRun:
    """Presses a ball straight to a point and out again, through bone of particles that rearrange.

    Its material is that of thesis 5.28.3. The particles move alike however weak they are; as strong
    as bone, they would push ``softening`` times harder.

    Args:
        volume: The scan.
        bone: The segment that is made of particles.
        drive: Path of the ball's centre.
        radius: Radius of the ball [mm].
        softening: Factor by which the particles are weaker than bone.

    Raises:
        OptionError: An argument is not allowed.
    """
    if not 1.0 <= softening <= 1e6:
        raise OptionError(f"softening {softening:g} given; allowed: 1 to 1e6")
    try:
        run = _core.drive_rearranging_ball(
            volume._internal,  # noqa: SLF001
            bone._internal,  # noqa: SLF001
            drive.given(),
            float(radius),
            float(softening),
            volume.unit == "HU",
        )
    except ValueError as error:
        raise OptionError(str(error)) from None
    return _told("drilling-particles", run, (volume, bone), drive=drive, radius=radius)


def _told(
    scenario: str,
    run: DrillRun | RearrangingRun,
    scan: tuple[Volume, Segment],
    *,
    drive: Drive,
    radius: float,
) -> ScenarioRun:
    volume, bone = scan
    after = run["bone"].mask() != 0
    grid_from_patient = np.linalg.inv(volume.patient_from_grid)
    x, _, z = np.floor((grid_from_patient @ np.append(np.asarray(drive.start), 1.0))[:3])
    return ScenarioRun(
        scenario=scenario,
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
        hole=hole_of(bone.mask() != 0, after, column=(int(x), int(z)), spacing=volume.spacing),
        violations=run["violations"],
    )
