"""The surface of the same voxels by VTK, with which ``palpate bench surface`` compares.

VTK is an optional package, for this benchmark only.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from importlib import import_module

import numpy as np
from numpy.typing import NDArray

from palpate.base.errors import OptionError
from palpate.bench.goals.surface import FLYING

__all__ = ["FlyingEdges"]


class FlyingEdges:
    """Filters of VTK on one mask, with shared vertices and normals."""

    def __init__(self, mask: NDArray[np.uint8], spacing: tuple[float, float, float]) -> None:
        """Passes a mask to VTK, shape [depth, height, width], with a border of free voxels.

        Raises:
            OptionError: VTK is not installed.
        """
        FlyingEdges.check()
        self._vtk = import_module("vtk")
        # VTK does not own the memory
        self._mask = np.pad(mask, 1)
        image = self._vtk.vtkImageData()
        image.SetDimensions(*self._mask.shape[::-1])
        image.SetSpacing(*spacing)
        to_vtk = import_module("vtkmodules.util.numpy_support").numpy_to_vtk
        image.GetPointData().SetScalars(to_vtk(self._mask.ravel(), deep=False))
        self._filters = {kind: getattr(self._vtk, kind)() for kind in FLYING}
        for kind, made in self._filters.items():
            made.SetInputData(image)
            made.ComputeNormalsOn()
            made.ComputeGradientsOff()
            made.ComputeScalarsOff()
            # the discrete one takes the label itself
            made.SetValue(0, 1.0 if "Discrete" in kind else 0.5)

    @staticmethod
    def check() -> None:
        """Checks that VTK is installed.

        Raises:
            OptionError: It is not installed; the message says how to install it.
        """
        try:
            import_module("vtk")
        except ImportError:
            raise OptionError(
                "vtk is not installed; allowed: pip install 'palpate[bench]', to measure beside it"
            ) from None

    def use_threads(self, threads: int) -> None:
        """Sets the number of threads."""
        tools = self._vtk.vtkSMPTools
        tools.SetBackend("Sequential" if threads == 1 else "STDThread")
        tools.Initialize(threads)

    def run_of(self, kind: str) -> Callable[[], float]:
        """Returns a function that makes the surface again and returns the time it took [s]."""
        made = self._filters[kind]

        def run() -> float:
            made.Modified()
            start = time.perf_counter()
            made.Update()
            return time.perf_counter() - start

        return run

    def triangle_count(self, kind: str) -> int:
        """Returns the number of triangles of the last run."""
        return int(self._filters[kind].GetOutput().GetNumberOfCells())

    def shape(self) -> tuple[float, float]:
        """Returns area [mm²] and volume [mm³]."""
        properties = self._vtk.vtkMassProperties()
        properties.SetInputData(self._filters[FLYING[0]].GetOutput())
        properties.Update()
        return float(properties.GetSurfaceArea()), float(properties.GetVolume())
