"""Rows of the benchmark of surfaces, and their goals."""

from __future__ import annotations

from palpate.bench.goals.goal import Goal
from palpate.bench.goals.haptics import CHEST, HEAD

__all__ = [
    "DRILLED",
    "FLYING",
    "SPHERES",
    "SURFACES",
    "SURFACE_ROWS",
    "TRUNK_512",
    "sphere_case",
]

TRUNK_512 = "phantom 512³"
SURFACES = (HEAD, CHEST, TRUNK_512)
"""Bones of ``palpate bench surface``."""
FLYING = ("vtkFlyingEdges3D", "vtkDiscreteFlyingEdges3D")
"""Filters of VTK that are compared."""
DRILLED = "phantom 512³: drill of 5 voxels, smoothed"
SPHERES = {20.0: 1.0, 5.0: 3.0}
"""Largest error of area and volume of a smoothed ball [%], by its radius [voxels]."""


def sphere_case(radius: float) -> str:
    """Returns the name of a case of a ball."""
    return f"sphere of {radius:g} voxels, smoothed"


def _surface_rows(bone: str) -> tuple[Goal, ...]:
    """Returns the rows of the surface of a bone."""

    def rates(case: str) -> tuple[Goal, ...]:
        def rate(metric: str, key: str) -> Goal:
            return Goal(case, metric, key, 1e-6, "M tri/s", None, "higher")

        return (
            rate("rate", "per_second"),
            *(rate(kind, kind) for kind in FLYING),
            *(Goal(case, f"ratio to {kind}", f"ratio {kind}", 1.0, "x", 1.0, "higher")
              for kind in FLYING),
            rate("rate, smoothed", "smoothed_per_second"),
        )  # fmt: skip

    shape = f"{bone}: shape"
    return (
        *rates(f"{bone}: one thread"),
        *rates(f"{bone}: all threads"),
        Goal(shape, "area beside VTK's", "area", 100.0, "%", 1.0, "lower"),
        Goal(shape, "volume beside VTK's", "volume", 100.0, "%", 1.0, "lower"),
    )


SURFACE_ROWS = (
    *(row for bone in SURFACES for row in _surface_rows(bone)),
    Goal(DRILLED, "median", "median", 1e3, "ms", 5.0, "lower"),
    Goal(DRILLED, "95 %", "p95", 1e3, "ms", 5.0, "lower"),
    Goal(DRILLED, "max", "max", 1e3, "ms", None, "lower"),
    *(
        Goal(sphere_case(radius), f"{kind} beside the sphere's", kind, 100.0, "%", most, "lower")
        for radius, most in SPHERES.items()
        for kind in ("area", "volume")
    ),
)
