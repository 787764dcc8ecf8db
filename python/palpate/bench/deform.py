"""``palpate bench deform``: speed of the deformation models, and accuracy of their force.

The bonded lattice under a ball that presses and slides a quarter of a node each frame, on one core;
the cost of one of its nodes in small and large boxes; the effect of its border, compared with a box
of 81³. Pairs of Lennard-Jones particles per second, compared with LAMMPS from the same positions
and velocities in the same run. And the limits of the thesis' particles.
"""

from __future__ import annotations

import statistics
from dataclasses import dataclass

from palpate import _core
from palpate.base.errors import OptionError
from palpate.base.progress import Progress, silent
from palpate.bench.goals.soft_tissue import (
    BORDER,
    COST,
    COST_SIZES,
    CRYSTALS,
    CUBOID,
    DEFORM_ROWS,
    FCC,
    LATTICE_CASES,
    LatticeCase,
    crystal_case,
)
from palpate.bench.lammps_pairs import LammpsCrystal
from palpate.bench.report import Row, row_of

__all__ = ["CANNOT", "Effort", "measure"]

NODES = 21
ITERATIONS = 160
"""Iterations of a frame."""
PAIRS = 27.0
"""Pairs of a particle within the cut-off, each counted once, whatever neighbour lists hold."""

CANNOT = (
    "fcc-lj and cuboid-lj are there for comparison. Neither has a strength or a Poisson's ratio "
    "of its own: an FCC crystal of Lennard-Jones is 2.2 times stiffer along [111] than along [100] "
    "and slips at a strain of some 0.1, and cuboid-lj has no energy to conserve: left alone it "
    "heats up until it flies apart. global-lj has no modulus of its own: the springs that hold its "
    "particles where they rest add to it."
)


@dataclass(frozen=True)
class Effort:
    """How much is measured."""

    updates: float = 2e7
    """Updates of nodes to time one."""
    warm_up: int = 100
    steps: int = 400
    """Steps of the smaller crystal; the larger one gets as many steps times particles."""
    rounds: int = 5
    """Runs of each crystal, alternately with LAMMPS; the fastest of each counts."""
    large: int = 81
    """Nodes along the edge of the box that counts as infinite."""


QUICK = Effort(updates=2e5, warm_up=20, steps=40, rounds=1, large=41)


def measure(
    amount: Effort, progress: Progress = silent, *, lammps: bool = True
) -> tuple[list[Row], list[str]]:
    """Runs all measurements; returns the rows, and what could not be measured.

    Args:
        amount: How much is measured.
        progress: Takes the progress.
        lammps: Whether to compare with LAMMPS.
    """
    reports: dict[str, dict[str, float]] = {}
    for done, layers in enumerate(LATTICE_CASES):
        progress(layers.name, 0.4 * done / len(LATTICE_CASES))
        reports[layers.name] = _frames(layers)
    progress(COST, 0.4)
    costs = {count: _core.bench_lattice_cost(count, amount.updates) for count in COST_SIZES}
    spread = max(costs.values()) / min(costs.values())
    reports[COST] = {**{str(count): cost for count, cost in costs.items()}, "spread": spread}
    progress(BORDER, 0.5)
    small, large = (_core.bench_lattice_force(count, 1500) for count in (NODES, amount.large))
    reports[BORDER] = {"apart": abs(small / large - 1.0)}
    progress("what particles cannot do", 0.6)
    reports[FCC] = reports[CUBOID] = _core.particle_limits()
    missing = []
    try:
        if lammps:
            LammpsCrystal.check()
    except OptionError as error:
        missing.append(str(error))
        lammps = False
    for done, (cells, particles) in enumerate(CRYSTALS.items()):
        case = crystal_case(particles)
        progress(case, 0.7 + 0.3 * done / len(CRYSTALS))
        reports[case] = _crystal(cells, particles, amount, lammps=lammps)
    rows = [
        row_of(goal, reports[goal.case]) for goal in DEFORM_ROWS if goal.key in reports[goal.case]
    ]
    return rows, missing


def _frames(case: LatticeCase) -> dict[str, float]:
    found = _core.bench_lattice_frames(NODES, case.poisson, case.soft, case.ratio, ITERATIONS)
    return {
        "per_second": 1.0 / max(1e-9, statistics.median(found["seconds"])),
        "worst_error": found["worst_error"],
    }


def _crystal(cells: int, particles: int, amount: Effort, *, lammps: bool) -> dict[str, float]:
    """Returns the figures of a crystal, and those of LAMMPS where it is compared."""
    smaller = min(CRYSTALS.values())
    steps = max(10, amount.steps * smaller // particles)
    report: dict[str, float] = {"ours": 0.0, "lammps": 0.0}
    for _ in range(amount.rounds):
        ours = _core.bench_lj_pairs(cells, 1.0, amount.warm_up, steps, 1)
        report["ours"] = max(report["ours"], ours["pairs_per_second"])
        report["builds"] = ours["builds"]
        if not lammps:
            continue
        crystal = LammpsCrystal(ours["side"], ours["positions"], ours["velocities"])
        theirs = crystal.run(ours["step"], warm_up=amount.warm_up, steps=steps)
        rate = PAIRS * particles * steps / theirs.seconds
        report["lammps"] = max(report["lammps"], rate)
        report["lammps_builds"] = theirs.builds
        for key, our_energy, their_energy in (
            ("at_start", ours["potential_at_start"], theirs.potential_at_start),
            ("after_warm_up", ours["potential_after_warm_up"], theirs.potential_after_warm_up),
            ("at_end", ours["total_at_end"], theirs.total_at_end),
        ):
            apart = abs(our_energy / their_energy - 1.0)
            report[f"apart_{key}"] = max(report.get(f"apart_{key}", 0.0), apart)
    if lammps:
        report["ratio"] = report["ours"] / report["lammps"]
    else:
        del report["lammps"]
    return report
