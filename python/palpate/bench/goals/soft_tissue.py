"""Rows of the benchmarks of soft tissue, and their goals."""

from __future__ import annotations

from dataclasses import dataclass

from palpate.bench.goals.goal import Goal

__all__ = [
    "BORDER",
    "COST",
    "COST_SIZES",
    "CRYSTALS",
    "CUBOID",
    "DEFORM_ROWS",
    "FCC",
    "LATTICE_CASES",
    "MATTER_STRESS_ROWS",
    "MODELS",
    "NO_MODEL",
    "SESSION_GROUNDS",
    "SESSION_ROWS",
    "THESIS",
    "TRUTH_CUBE_ROWS",
    "TRUTH_LEVELS",
    "TRUTH_MODELS",
    "LatticeCase",
    "crystal_case",
    "session_case",
    "stress_case",
    "thesis_figures",
    "truth_case",
]


@dataclass(frozen=True)
class LatticeCase:
    """Layers that a ball presses on."""

    soft: int
    """Layers of soft tissue over the stiff one; many for one material."""
    ratio: float
    """Young's modulus of the stiff tissue relative to that of the soft one."""
    poisson: float
    name: str


ONE_MATERIAL = 1000
"""More layers than any box has."""

LATTICE_CASES = tuple(
    LatticeCase(soft, ratio, poisson, f"lattice 21³, {name}, ν {poisson:g}")
    for poisson in (0.25, 0.45, 0.49)
    for soft, ratio, name in (
        (ONE_MATERIAL, 1.0, "one material"),
        (6, 100.0, "6 layers over 100 times stiffer"),
        (6, 6e5, "6 layers over bone"),
    )
)

COST = "lattice, an iteration"
COST_SIZES = (11, 21, 31, 41)
BORDER = "lattice, force at 21³ beside 81³"
CRYSTALS = {10: 4000, 20: 32_000}
"""Particles of a Lennard-Jones crystal by its cells along an axis."""
FCC = "fcc-lj cannot"
CUBOID = "cuboid-lj cannot"


def crystal_case(particles: int) -> str:
    """Returns the name of a case of Lennard-Jones pairs."""
    return f"Lennard-Jones, {particles} particles, cut at 2.1 a, NVE, one thread"


def _lattice_rows(case: str) -> tuple[Goal, ...]:
    return (
        Goal(case, "frames, median", "per_second", 1.0, "Hz", 30.0, "higher"),
        Goal(case, "force beside residual 1e-6, worst", "worst_error", 100.0, "%", 1.0, "lower"),
    )


def _crystal_rows(case: str) -> tuple[Goal, ...]:
    def energy(metric: str, key: str) -> Goal:
        return Goal(case, f"energy apart, {metric}", key, 1.0, "1", 1e-6, "lower")

    return (
        Goal(case, "rate", "ours", 1e-6, "M pairs/s", None, "higher"),
        Goal(case, "LAMMPS lj/cut/opt", "lammps", 1e-6, "M pairs/s", None, "higher"),
        Goal(case, "ratio to LAMMPS", "ratio", 1.0, "x", 1.0, "higher"),
        Goal(case, "lists built", "builds", 1.0, "1", None, "lower"),
        Goal(case, "lists built by LAMMPS", "lammps_builds", 1.0, "1", None, "lower"),
        energy("at the start", "apart_at_start"),
        energy("after the warm-up", "apart_after_warm_up"),
        energy("at the end", "apart_at_end"),
    )


DEFORM_ROWS = (
    *(row for case in LATTICE_CASES for row in _lattice_rows(case.name)),
    *(Goal(COST, f"{count}³", str(count), 1e9, "ns a node", None, "lower") for count in COST_SIZES),
    Goal(COST, "most over least", "spread", 1.0, "x", 1.5, "lower"),
    Goal(BORDER, "apart", "apart", 100.0, "%", 5.0, "lower"),
    *(row for particles in CRYSTALS.values() for row in _crystal_rows(crystal_case(particles))),
    # what they are, not what they should be
    Goal(FCC, "E along [110] by E along [100]", "young_110", 1.0, "x", None, "lower"),
    Goal(FCC, "E along [111] by E along [100]", "young_111", 1.0, "x", None, "lower"),
    Goal(FCC, "Poisson's ratio, whatever is asked", "poisson", 1.0, "1", None, "higher"),
    Goal(CUBOID, "kinetic energy at the start", "heat_at_start", 1.0, "D", None, "lower"),
    Goal(CUBOID, "after 10 T₀, left alone", "heat_early", 1.0, "D", None, "lower"),
    Goal(CUBOID, "after 50 T₀, left alone", "heat_late", 1.0, "D", None, "lower"),
    Goal(CUBOID, "after 50 T₀ with critical friction", "heat_damped", 1.0, "D", None, "lower"),
)

NO_MODEL = "none"
MODELS = ("lattice", "fcc-lj", "cuboid-lj", "global-lj")
"""Deformation models; those of the thesis have its figures beside them."""

SESSION_GROUNDS = {
    "CThead bone": "Head small",
    "LIDC bone": None,
    "phantom 520×512×512": "Torso",
}
"""Scans, and the data of the thesis' tables that has their size."""

Rates = tuple[float, float, float]
"""Mean, minimum and maximum over the seconds."""


@dataclass(frozen=True)
class ThesisRates:
    """Rates in the thesis for one scan and one model."""

    servo: Rates
    """[kHz], tables 5.1 and 5.2."""
    deformation: Rates | None = None
    """[Hz], table 5.3."""
    equal_voxels: Rates | None = None
    """[Hz], normalized by the voxels of the box, table 5.4."""

    def figures(self) -> dict[str, tuple[float, str]]:
        """Returns each figure with its unit, by its key."""
        rates = {
            "servo": (self.servo, "kHz"),
            "deformation": (self.deformation, "Hz"),
            "deformation, equal voxels": (self.equal_voxels, "Hz"),
        }
        return {
            f"thesis, {name}, {which}": (figure, unit)
            for name, (figures, unit) in rates.items()
            for which, figure in zip(WHICH, figures or (), strict=figures is not None)
        }


WHICH = ("average", "least second", "most")

THESIS = {
    ("Head small", NO_MODEL): ThesisRates((66.0, 61.0, 77.0)),
    ("Head small", "fcc-lj"): ThesisRates(
        (68.0, 56.0, 74.0), (60.0, 48.0, 92.0), (60.0, 48.0, 92.0)
    ),
    ("Head small", "cuboid-lj"): ThesisRates(
        (64.0, 57.0, 77.0), (30.0, 29.0, 45.0), (120.0, 116.0, 180.0)
    ),
    ("Head small", "global-lj"): ThesisRates((120.0, 109.0, 129.0)),
    ("Torso", NO_MODEL): ThesisRates((57.0, 47.0, 65.0)),
    ("Torso", "fcc-lj"): ThesisRates((63.0, 59.0, 67.0), (51.0, 49.0, 54.0), (51.0, 49.0, 54.0)),
    ("Torso", "cuboid-lj"): ThesisRates(
        (68.0, 65.0, 71.0), (28.0, 26.0, 30.0), (112.0, 104.0, 120.0)
    ),
    ("Torso", "global-lj"): ThesisRates((96.0, 49.0, 140.0)),
}
"""Tables 5.1 to 5.4 of the thesis, on 4 × AMD FX-4100 (section 5.27); there is no deformation rate
of the global model."""


def thesis_figures(ground: str, model: str) -> dict[str, tuple[float, str]]:
    """Returns the thesis' figures with their units, by key; empty where it has none."""
    rates = THESIS.get((SESSION_GROUNDS[ground] or "", model))
    return {} if rates is None else rates.figures()


def session_case(ground: str, model: str) -> str:
    """Returns the name of a case of a session."""
    return f"{ground}, {'hard' if model == NO_MODEL else model}"


def _session_rows(ground: str, model: str) -> tuple[Goal, ...]:
    case = session_case(ground, model)

    def rate(metric: str, key: str) -> Goal:
        return Goal(case, f"servo, {metric}", key, 1e-3, "kHz", None, "higher")

    rows = [
        rate("average", "servo"),
        rate("least second", "servo_least"),
        rate("most", "servo_most"),
        Goal(case, "in contact", "contact_share", 100.0, "%", None, "higher"),
        Goal(case, "probe in a solid voxel", "violations", 1.0, "ticks", 0.0, "lower"),
    ]
    if model != NO_MODEL:
        rows += [
            Goal(case, "deformation, average", "answers", 1.0, "Hz", 30.0, "higher"),
            Goal(case, "deformation, least second", "answers_least", 1.0, "Hz", None, "higher"),
            Goal(case, "deformation, most", "answers_most", 1.0, "Hz", None, "higher"),
            Goal(case, "nodes", "nodes", 1.0, "1", None, "higher"),
        ]
    rows += [
        Goal(case, name, name, 1.0, unit, None, "higher")
        for name, (_, unit) in thesis_figures(ground, model).items()
    ]
    return tuple(rows)


SESSION_ROWS = tuple(
    row
    for ground in SESSION_GROUNDS
    for model in (NO_MODEL, *MODELS)
    for row in _session_rows(ground, model)
)

TRUTH_LEVELS = {5.0: "TruthCube-5.pml", 12.5: "TruthCube-12.pml", 18.25: "TruthCube-18.pml"}
"""Compressions [%] at which beads were measured, and the file of each."""

TRUTH_MODELS = {
    "lattice, ν 0.45, 9³ nodes": ("lattice", 0.45, 9),
    "lattice, ν 0.45, 33³ nodes": ("lattice", 0.45, 33),
    "linear FEM, ν 0.45, 9³ nodes": ("fem", 0.45, 9),
    "linear FEM, ν 0.49, 9³ nodes": ("fem", 0.49, 9),
}
"""Method, Poisson's ratio, nodes along an edge; the FEM uses the mesh of the data set, whose inner
nodes are the beads."""


def truth_case(model: str, level: float) -> str:
    """Returns the name of a case of the Truth Cube."""
    return f"{model}: {level:g} %"


def _truth_rows(model: str, level: float) -> tuple[Goal, ...]:
    case = truth_case(model, level)
    rows = [
        Goal(case, "RMSE of 343 beads", "rmse", 1.0, "mm", None, "lower"),
        Goal(case, "the same without the plate's drift", "without_drift", 1.0, "mm", None, "lower"),
    ]
    if model.startswith("lattice"):
        rows += [
            Goal(case, "RMSE by that of the FEM with its ν", "ratio", 1.0, "x", 1.0, "lower"),
            Goal(case, "RMSE by that of the best FEM", "to_best", 1.0, "x", None, "lower"),
            Goal(case, "residual", "residual", 1.0, "1", 1e-4, "lower"),
        ]
    return tuple(rows)


TRUTH_CUBE_ROWS = tuple(
    row for level in TRUTH_LEVELS for model in TRUTH_MODELS for row in _truth_rows(model, level)
)


def stress_case(model: str) -> str:
    """Returns the name of a case of work in soft tissue."""
    return f"{model}: pressing, drilling, needles"


def _stress_rows(case: str) -> tuple[Goal, ...]:
    def count(metric: str, key: str, goal: float | None = None) -> Goal:
        return Goal(case, metric, key, 1.0, "1", goal, "higher")

    return (
        Goal(case, "violations", "violations", 1.0, "1", 0.0, "lower"),
        count("ticks", "ticks"),
        Goal(case, "in contact", "contact_share", 100.0, "%", 80.0, "higher"),
        count("bits changed around the probe", "bits", 1.0),
        count("edits", "edits", 1.0),
        count("answers of the model", "answers", 1.0),
        count("ticks a voxel deep in bone", "in_bone", 1.0),
        count("voxels drilled", "drilled", 1.0),
        count("layers punctured", "punctures", 1.0),
        count("rests to the bit", "rests", 1.0),
    )


MATTER_STRESS_ROWS = tuple(row for model in MODELS for row in _stress_rows(stress_case(model)))
