"""Palpation without a device: a ball presses soft tissue at one place after the other.

``docs/understand/deformation.md`` explains models and materials.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from palpate import _core
from palpate.base.errors import OptionError
from palpate.scenarios.drive import Drive
from palpate.scenarios.press_lines import PressLine
from palpate.scenarios.run import Press, ScenarioEvent, ScenarioRun, samples_of
from palpate.volumes.segment import Segment
from palpate.volumes.volume import Volume

__all__ = ["palpate_line"]

Progress = Callable[[str, float | None], None]

Columns = dict[str, NDArray[np.float64]]

PAUSE = 0.05
"""Pause between two presses, so that charts do not join them [s]."""


def palpate_line(
    volume: Volume,
    layers: Sequence[tuple[Segment, str | None]],
    line: PressLine,
    *,
    radius: float,
    depth: float = 2.5,
    speed: float = 4.0,
    force_limit: float = 6.0,
    stiffness: float = 1.0,
    model: str = "lattice",
    progress: Progress | None = None,
) -> ScenarioRun:
    """Presses a ball into soft tissue at each place of a line, and out again.

    Force and stiffness of a place are those at ``depth``, or where the force limit stopped the
    ball.

    Args:
        volume: The scan.
        layers: Segments, each with the name of its material; None where it is rigid.
        line: The places.
        radius: Radius of the ball [mm].
        depth: Depth to which the ball presses [mm].
        speed: Speed of the drive [mm/s].
        force_limit: Force at which the drive stops [N].
        stiffness: Stiffness of the spring between drive and ball [N/mm].
        model: Name of the deformation model.
        progress: Called before each press.

    Raises:
        OptionError: An argument is not allowed.
    """
    given = [(segment._internal, material) for segment, material in layers]  # noqa: SLF001
    names = tuple(segment.name for segment, _ in layers)
    columns: list[Columns] = []
    phases: list[str] = []
    presses: list[Press] = []
    events: list[ScenarioEvent] = []
    violations = 0
    begins = 0.0
    # a ball is held off by up to a voxel
    margin = 2.0 * max(volume.spacing)
    for number, (surface, along, thickness) in enumerate(
        zip(line.surface, line.along, line.thickness, strict=True)
    ):
        if progress is not None:
            progress("press", number / len(line.surface))
        drive = Drive(
            start=surface - (radius + margin) * line.direction,
            # the spring between drive and ball takes a part of the way, up to there
            target=surface + (depth - radius + force_limit / stiffness) * line.direction,
            speed=speed,
            force_limit=force_limit,
            rest_secs=0.2,
            stiffness=stiffness,
        )
        try:
            run = _core.press(
                volume._internal,  # noqa: SLF001
                given,
                drive.given(),
                margin + float(depth),
                float(radius),
                model,
            )
        except ValueError as error:
            raise OptionError(str(error)) from None
        samples = samples_of(run)
        # the ball's centre stands its radius before its face
        below = samples["tip"] - margin
        inward = np.array(run["phase"]) == "in"
        felt = _felt(below[inward], samples["force"][inward], depth)
        x, y, z = surface.tolist()
        presses.append(Press(place=(x, y, z), along=along, thickness=thickness, **felt))
        samples["time"] = samples["time"] + begins
        samples["press"] = np.full(len(below), float(number))
        events += _contacts(samples, names)
        begins = float(samples["time"][-1]) + PAUSE
        columns.append(samples)
        phases += run["phase"]
        violations += run["violations"]
    return ScenarioRun(
        scenario="palpation",
        scan=volume.name,
        layers=names,
        radius=float(radius),
        over="tip",
        phase=tuple(phases),
        samples={name: np.concatenate([each[name] for each in columns]) for name in columns[0]},
        events=tuple(events),
        presses=tuple(presses),
        violations=violations,
    )


def _contacts(samples: Columns, names: Sequence[str]) -> list[ScenarioEvent]:
    """Returns where the force of a press begins and ends; light contact may do so several times."""
    felt = np.abs(samples["force"]) > 0.0
    changes = np.nonzero(felt[1:] != felt[:-1])[0] + 1
    return [
        ScenarioEvent(
            kind="contact" if felt[tick] else "free",
            segment=names[int(samples["segment"][tick]) - 1] if samples["segment"][tick] else "",
            time=float(samples["time"][tick]),
            depth=float(samples["tip"][tick]),
            force=float(samples["force"][tick]),
        )
        for tick in changes.tolist()
    ]


def _felt(below: NDArray[np.float64], force: NDArray[np.float64], depth: float) -> dict[str, float]:
    """Returns depth, force, and the slope of the force over the last quarter of that depth."""
    reached = np.nonzero(below >= depth)[0]
    end = int(reached[0]) + 1 if len(reached) else len(below)
    deepest = float(below[:end].max())
    last = (np.arange(len(below)) < end) & (below >= 0.75 * deepest)
    slope = float(np.polyfit(below[last], force[last], 1)[0])
    return {"depth": deepest, "force": float(force[end - 1]), "stiffness": slope}
