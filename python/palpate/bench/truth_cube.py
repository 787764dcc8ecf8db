"""``palpate bench truth-cube``: how well the lattice predicts the deformation of a silicone cube.

The Truth Cube is a cube of silicone of 80 mm, pressed between two plates that it sticks to; 343
beads in it were located by CT (Kerdok et al., Med. Image Anal. 7, 2003). Here the whole cube is a
lattice, solved off-line and compared with linear elasticity by finite elements on the mesh of the
data set, whose inner nodes are the beads. The only input of both is the stated displacement of the
plate: for one material with prescribed displacement, Young's modulus has no effect.

The plate also drifted, by 2 mm sideways and 2 mm further down than stated. So the error is reported
twice: as it is, and without the drift of the moving plate that fits each model best, assumed to be
linear in height. Frame of the data: z up the cube, the plate that moves at its lower end [mm].
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Self

import numpy as np
from numpy.typing import NDArray

from palpate import _core
from palpate.base.errors import OptionError
from palpate.base.progress import Progress, silent
from palpate.bench.goals.soft_tissue import TRUTH_CUBE_ROWS, TRUTH_LEVELS, TRUTH_MODELS, truth_case
from palpate.bench.haptics_data import data_file
from palpate.bench.linear_fem import LinearFem
from palpate.bench.report import Row, row_of

__all__ = ["Cube", "beads_of", "errors_of", "lattice_displacements", "measure"]

FOLDER = "camitk_truthcube"
MESH = "TruthCube-0-HexaFEM.pml"
EDGE = 9
"""Nodes of the mesh along an edge."""
YOUNG = 15_000.0
"""Young's modulus of the silicone, as the data set states it [Pa]."""
TOLERANCE = 1e-5
ITERATIONS = 40_000

Points = NDArray[np.float64]

ATOM = re.compile(r'<atomProperties\s+index="(\d+)"\s+x="([^"]+)"\s+y="([^"]+)"\s+z="([^"]+)"')


def beads_of(path: Path) -> dict[int, tuple[float, float, float]]:
    """Reads the positions of numbered points [mm] from a PML file.

    Raises:
        OptionError: It has none.
    """
    found = ATOM.findall(path.read_text(encoding="utf-8", errors="replace"))
    if not found:
        raise OptionError(f"{path} given; allowed: a PML file with atoms that have x, y and z")
    return {int(number): (float(x), float(y), float(z)) for number, x, y, z in found}


@dataclass(frozen=True)
class Cube:
    """The mesh at rest and the measurements."""

    mesh: Points
    """Nodes [mm], shape [9, 9, 9, 3], z slowest."""
    beads: Points
    """Beads at rest [mm], shape [343, 3]."""
    numbers: NDArray[np.int64]
    """Indices of the beads in the mesh."""
    measured: Mapping[float, Points]
    """Displacements of the beads [mm], by compression [%]."""

    @classmethod
    def load(cls) -> Self:
        """Reads the data set.

        Raises:
            MissingDataError: It is missing.
            OptionError: It is another data set.
        """
        rest = beads_of(data_file(f"{FOLDER}/{MESH}"))
        pressed = {
            level: beads_of(data_file(f"{FOLDER}/{name}")) for level, name in TRUTH_LEVELS.items()
        }
        numbers = sorted(next(iter(pressed.values())))
        if set(rest) != set(range(EDGE**3)) or any(sorted(p) != numbers for p in pressed.values()):
            raise OptionError(f"{FOLDER} given; allowed: {EDGE}³ nodes, and the same beads in each")
        nodes = np.array([rest[number] for number in range(EDGE**3)])
        beads = nodes[numbers]
        measured = {
            level: np.array([places[number] for number in numbers]) - beads
            for level, places in pressed.items()
        }
        return cls(nodes.reshape(EDGE, EDGE, EDGE, 3), beads, np.array(numbers), measured)

    @property
    def low(self) -> Points:
        """The lowest corner [mm]."""
        return np.asarray(np.min(self.mesh, axis=(0, 1, 2)))

    @property
    def sides(self) -> Points:
        """Lengths of the edges [mm]."""
        return np.asarray(np.max(self.mesh, axis=(0, 1, 2)) - self.low)

    def stroke(self, level: float) -> float:
        """Returns the stated displacement of the lower plate [mm]."""
        return float(self.sides[2]) * level / 100.0


def measure(progress: Progress = silent) -> tuple[list[Row], dict[str, Points]]:
    """Measures all models at all compressions; returns rows, and displacements by case.

    Raises:
        MissingDataError: The data set is missing.
        OptionError: scikit-fem is not installed.
    """
    LinearFem.check()
    cube = Cube.load()
    reports: dict[str, dict[str, float]] = {}
    moved: dict[str, Points] = {}
    for done, level in enumerate(TRUTH_LEVELS):
        for name, (method, poisson, nodes) in TRUTH_MODELS.items():
            progress(f"{name}, {level:g} %", done / len(TRUTH_LEVELS))
            case = truth_case(name, level)
            residual = 0.0
            if method == "fem":
                fem = LinearFem(cube.mesh, poisson)
                moved[case] = fem.pressed(cube.stroke(level)).reshape(-1, 3)[cube.numbers]
            else:
                moved[case], residual = lattice_displacements(cube, level, poisson, nodes=nodes)
            reports[case] = {**errors_of(cube, level, moved[case]), "residual": residual}
        _compare(reports, level)
    return [row_of(goal, reports[goal.case]) for goal in TRUTH_CUBE_ROWS], moved


def _compare(reports: dict[str, dict[str, float]], level: float) -> None:
    """Adds the comparison of each model with the FEM of its Poisson's ratio, and with the best."""
    fems = {
        poisson: reports[truth_case(name, level)]["rmse"]
        for name, (method, poisson, _) in TRUTH_MODELS.items()
        if method == "fem"
    }
    for name, (_, poisson, _) in TRUTH_MODELS.items():
        report = reports[truth_case(name, level)]
        report["ratio"] = report["rmse"] / fems[poisson]
        report["to_best"] = report["rmse"] / min(fems.values())


def lattice_displacements(
    cube: Cube, level: float, poisson: float, *, nodes: int
) -> tuple[Points, float]:
    """Returns the displacements of the beads in a lattice with so many nodes along an edge [mm].

    The second figure is the residual, relative to the force on a plate.

    Raises:
        OptionError: The lattice cannot be made.
    """
    spacing = float(cube.sides[0]) / (nodes - 1)
    try:
        found = _core.press_block(
            (nodes, nodes, nodes),
            spacing,
            YOUNG,
            poisson,
            (0.0, 0.0, cube.stroke(level)),
            (0.0, 0.0, 0.0),
            TOLERANCE,
            ITERATIONS,
        )
    except ValueError as error:
        raise OptionError(str(error)) from None
    field = found["moved"].reshape(nodes, nodes, nodes, 3)
    return _between(field, (cube.beads - cube.low) / spacing), float(found["residual"])


def _between(field: Points, places: Points) -> Points:
    """Interpolates a field [z, y, x, 3] at places (x, y, z) in units of nodes, linearly."""
    low = np.clip(np.floor(places).astype(int), 0, np.array(field.shape[2::-1]) - 2)
    share = places - low
    found = np.zeros_like(places)
    for corner in np.ndindex(2, 2, 2):
        x, y, z = (low + corner).T
        weight = np.where(corner, share, 1.0 - share).prod(axis=1)
        found += weight[:, None] * field[z, y, x]
    return found


def errors_of(cube: Cube, level: float, moved: Points) -> dict[str, float]:
    """Returns the root mean square of the beads' errors [mm], as they are and without drift."""
    apart = moved - cube.measured[level]
    height = 1.0 - (cube.beads[:, 2] - cube.low[2]) / cube.sides[2]
    drift = height @ apart / (height @ height)
    return {"rmse": _rms(apart), "without_drift": _rms(apart - np.outer(height, drift))}


def _rms(vectors: Points) -> float:
    return float(np.sqrt((vectors**2).sum(axis=1).mean()))
