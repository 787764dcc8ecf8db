"""``palpate bench surface``: speed of surface extraction, compared with VTK in the same run.

The whole surface of bones from voxels, with shared vertices and normals for both: VTK gets the
voxels as bytes with a border of free voxels, so that both surfaces are closed. Runs of Palpate and
of VTK alternate, and the fastest of each counts. A drill removes balls of 5 voxels from the surface
of bone, and the time until the smoothed patches are up to date is reported.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from palpate import _core
from palpate.base.progress import Progress, silent
from palpate.bench.flying_edges import FlyingEdges
from palpate.bench.goals import GOALS
from palpate.bench.goals.haptics import CHEST, HEAD
from palpate.bench.goals.surface import (
    DRILLED,
    FLYING,
    SPHERES,
    SURFACES,
    TRUNK_512,
    sphere_case,
)
from palpate.bench.haptics_data import CTHEAD, CTHEAD_BONE, LIDC, MissingDataError, data_file
from palpate.bench.report import Row, row_of
from palpate.io.reading import read
from palpate.volumes.segment import Segment

__all__ = ["Bone", "bone_of", "drill", "measure", "spheres", "whole_surface"]

ROUNDS = 5
"""Number of runs, of which the fastest counts."""
EDITS = 200
RADIUS = 5
"""Radius of the drill [voxels]."""
UPRIGHT = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)
PHANTOM_SIZE = (512, 512, 512)
FIELD_OF_VIEW = (400.0, 280.0, 540.0)
"""Size of the phantom [mm]."""


@dataclass(frozen=True)
class Bone:
    """The voxels of a bone."""

    segment: _core.Segment
    spacing: tuple[float, float, float]

    def surface(self, smoothing: int | None) -> _core.Surface:
        """Returns its surface; None for the default smoothing."""
        zero = (0.0, 0.0, 0.0)
        return _core.Surface(self.segment, self.spacing, zero, UPRIGHT, 1, smoothing, False)  # noqa: FBT003


def measure(progress: Progress = silent) -> tuple[list[Row], list[str]]:
    """Runs all measurements; returns the rows, and the missing data sets.

    Raises:
        OptionError: VTK is not installed.
    """
    FlyingEdges.check()
    reports: dict[str, dict[str, float]] = {}
    missing = []
    for done, (name, load) in enumerate(LOADS.items()):
        progress(f"the surface of {name}", done / (len(LOADS) + 1))
        try:
            bone = load()
        except MissingDataError as error:
            missing.append(f"{name}: {error}")
            continue
        reports |= whole_surface(name, bone)
        if name == TRUNK_512:
            reports[DRILLED] = drill(bone)
    progress("spheres", len(LOADS) / (len(LOADS) + 1))
    reports |= spheres()
    rows = [row_of(goal, reports[goal.case]) for goal in GOALS["surface"] if goal.case in reports]
    return rows, missing


def whole_surface(name: str, bone: Bone) -> dict[str, dict[str, float]]:
    """Returns the figures of a body by case."""
    theirs = FlyingEdges(bone.segment.mask(), bone.spacing)
    plain, smooth = bone.surface(0), bone.surface(None)
    reports = {}
    for case, threads in (("one thread", 1), ("all threads", _cores())):
        theirs.use_threads(threads)
        ours, smoothed, *others = _quickest(
            [
                partial(plain.time_all, threads),
                partial(smooth.time_all, threads),
                *map(theirs.run_of, FLYING),
            ]
        )
        report = {
            "per_second": plain.triangle_count / ours,
            "smoothed_per_second": smooth.triangle_count / smoothed,
        }
        for kind, seconds in zip(FLYING, others, strict=True):
            report[kind] = theirs.triangle_count(kind) / seconds
            report[f"ratio {kind}"] = report["per_second"] / report[kind]
        reports[f"{name}: {case}"] = report

    area, volume = theirs.shape()
    reports[f"{name}: shape"] = {
        "area": abs(plain.area() / area - 1.0),
        "volume": abs(plain.volume() / volume - 1.0),
    }
    return reports


def drill(bone: Bone, edits: int = EDITS) -> dict[str, float]:
    """Returns the time until patches follow an edit, with the default smoothing."""
    surface = bone.surface(None)
    mask = bone.segment.mask().astype(bool)
    on_surface = mask.copy()
    on_surface[1:] &= ~mask[:-1]
    places = np.argwhere(on_surface)
    picked = np.random.default_rng(1).integers(0, len(places), edits)
    threads = _cores()
    seconds = [
        surface.time_drill((int(x), int(y), int(z)), RADIUS, threads) for z, y, x in places[picked]
    ]
    quantiles = np.quantile(seconds, [0.5, 0.95, 1.0])
    return dict(zip(("median", "p95", "max"), map(float, quantiles), strict=True))


def spheres() -> dict[str, dict[str, float]]:
    """Returns the errors of smoothed balls relative to spheres."""
    reports = {}
    for radius in SPHERES:
        size = 2 * int(radius) + 9
        far = np.square(np.arange(size) - size // 2)
        inside = far[:, None, None] + far[None, :, None] + far[None, None, :] <= radius**2
        bone = Bone(_core.Segment.from_mask(inside.astype(np.uint8)), (1.0, 1.0, 1.0))
        surface = bone.surface(None)
        reports[sphere_case(radius)] = {
            "area": abs(surface.area() / (4.0 * np.pi * radius**2) - 1.0),
            "volume": abs(surface.volume() / (4.0 / 3.0 * np.pi * radius**3) - 1.0),
        }
    return reports


def bone_of(segment: Segment) -> Bone:
    """Returns the voxels of a segment."""
    return Bone(segment._internal, segment.volume.spacing)  # noqa: SLF001


def _phantom() -> Bone:
    x, y, z = (width / count for width, count in zip(FIELD_OF_VIEW, PHANTOM_SIZE, strict=True))
    return Bone(_core.phantom_bones(PHANTOM_SIZE), (x, y, z))


LOADS: dict[str, Callable[[], Bone]] = {
    HEAD: lambda: bone_of(read(data_file(CTHEAD)).threshold(CTHEAD_BONE)),
    CHEST: lambda: bone_of(read(data_file(LIDC)).offered_bone()),
    TRUNK_512: _phantom,
}
assert tuple(LOADS) == SURFACES  # noqa: S101  # the order of the rows


def _cores() -> int:
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _quickest(runs: Sequence[Callable[[], float]]) -> list[float]:
    """Returns the shortest time of each function, with alternating runs."""
    rounds = [[run() for run in runs] for _ in range(ROUNDS)]
    return [min(times) for times in zip(*rounds, strict=True)]
