"""Palpation without a device: a ball presses soft tissue at one place after the other.

What feels stiff in a square of places shows what lies below them: elastography by touch.

``docs/understand/deformation.md`` explains models and materials.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from palpate import _core
from palpate.base.errors import OptionError
from palpate.scenarios.drive import Drive
from palpate.scenarios.press_lines import PressLine
from palpate.scenarios.run import Lump, Press, ScenarioEvent, ScenarioRun, samples_of
from palpate.volumes.segment import Segment
from palpate.volumes.volume import Volume

__all__ = ["palpate_line", "with_lump"]

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
        young = _young(below[inward], samples["force"][inward], (depth, radius))
        x, y, z = surface.tolist()
        across = line.across[number] if line.across else None
        presses.append(
            Press(
                place=(x, y, z),
                along=along,
                across=across,
                thickness=thickness,
                young=young,
                **felt,
            )
        )
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


def with_lump(run: ScenarioRun, hidden: NDArray[np.float64] | None) -> ScenarioRun:
    """Returns a run of a square with the place where it feels stiffest.

    That is the middle of all places weighted by how much stiffer they are than the middle between
    the median and the stiffest one.

    Args:
        run: The run.
        hidden: Where a lump is [mm]; None where that is not known.
    """
    places = np.array([press.place for press in run.presses])
    young = np.array([press.young or 0.0 for press in run.presses])
    usual, most = float(np.median(young)), float(young.max())
    weight = np.maximum(young - 0.5 * (usual + most), 0.0)
    # where all feels alike no place is stiffer
    place = places[young.argmax()] if most <= usual else np.average(places, 0, weight)
    x, y, z = place.tolist()
    lump = Lump(place=(x, y, z), times=most / usual, hidden=None)
    if hidden is not None:
        x, y, z = hidden.tolist()
        lump = replace(lump, hidden=(x, y, z))
    return replace(run, lump=lump)


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


def _young(
    below: NDArray[np.float64], force: NDArray[np.float64], press: tuple[float, float]
) -> float | None:
    """Returns the modulus by which F to the power of 2/3 rises with depth in its lower half [kPa].

    Hertz: F = 4/3 E / (1 - ν²) √R δ^(3/2), here with ν = 0.45. Where the ball first touches, which
    steps of voxels make uncertain, does not count.

    Source: Johnson, Contact Mechanics (1985), section 4.2.
    """
    depth, radius = press
    reached = np.nonzero(below >= depth)[0]
    end = int(reached[0]) + 1 if len(reached) else len(below)
    half = (np.arange(len(below)) < end) & (below >= 0.5 * below[:end].max()) & (force > 0.0)
    if half.sum() < 10:
        return None
    slope = float(np.polyfit(below[half], force[half] ** (2 / 3), 1)[0])
    # N/mm² are 1000 kPa
    return 750.0 * (1.0 - 0.45**2) * float(max(slope, 0.0) ** 1.5 / np.sqrt(radius))
