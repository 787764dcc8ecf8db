"""VTK's own ray caster on the CPU, with which ``palpate bench render`` compares.

``vtkFixedPointVolumeRayCastMapper`` draws the same values with the same transfer function, camera
and size, shaded by its own light, on all cores, into a window off the screen. VTK is an optional
package, for benchmarks only; it needs no display, but OpenGL in software (EGL or OSMesa) to put the
picture into the window, which takes it some milliseconds.
"""

from __future__ import annotations

import math
import os
import time
from importlib import import_module

import numpy as np
from numpy.typing import NDArray

from palpate.base.errors import OptionError
from palpate.bench.flying_edges import FlyingEdges
from palpate.bench.pictures.equal_quality import TimedPicture
from palpate.bench.pictures.on_page import screen_from_linear
from palpate.pictures.appearance import Appearance
from palpate.pictures.camera import Camera
from palpate.volumes.volume import Volume

__all__ = ["VtkCaster"]

CURVE_POINTS = 512
"""Points that curves are sampled at."""
AMBIENT = 0.3
"""Share of light from everywhere."""
UNIT = 1.0
"""Thickness that opacities are told for [mm]."""


class VtkCaster:
    """VTK's ray caster before one scan."""

    def __init__(
        self, volume: Volume, look: Appearance, camera: Camera, *, size: tuple[int, int]
    ) -> None:
        """Prepares pictures of the transfer function of a look; its segments are not drawn.

        Raises:
            OptionError: VTK is not installed, or finds no OpenGL.
        """
        FlyingEdges.check()
        # without a display it would first try X, and complain
        if "DISPLAY" not in os.environ:
            os.environ.setdefault("VTK_DEFAULT_OPENGL_WINDOW", "vtkEGLRenderWindow")
        self._vtk = import_module("vtk")
        self._numpy = import_module("vtkmodules.util.numpy_support")
        self._smallest = min(volume.spacing)
        self._size = size
        self._mapper = self._mapper_of(volume)
        drawn = self._vtk.vtkVolume()
        drawn.SetMapper(self._mapper)
        drawn.SetProperty(self._property_of(volume, look))
        drawn.SetUserMatrix(self._placed(volume))
        self._window = self._window_of(drawn, camera)
        if not self.draw(1.0).screen.any():
            raise OptionError("VTK drew nothing; allowed: a machine with EGL or OSMesa")

    def draw(self, steps: float) -> TimedPicture:
        """Draws with so many steps for each smallest voxel edge."""
        distance = self._smallest / steps
        self._mapper.SetSampleDistance(distance)
        self._mapper.SetInteractiveSampleDistance(distance)
        self._mapper.Modified()
        began = time.perf_counter()
        self._window.Render()
        seconds = time.perf_counter() - began
        return TimedPicture(seconds, self._screen())

    def _screen(self) -> NDArray[np.float64]:
        grab = self._vtk.vtkWindowToImageFilter()
        grab.SetInput(self._window)
        grab.ReadFrontBufferOff()
        grab.ShouldRerenderOff()
        grab.Update()
        scalars = self._numpy.vtk_to_numpy(grab.GetOutput().GetPointData().GetScalars())
        columns, rows = self._size
        # rows from the lower edge
        return np.asarray(scalars.reshape(rows, columns, 3)[::-1] / 255.0)

    # VTK has no types: Any is whatever it makes

    def _mapper_of(self, volume: Volume):  # type: ignore[no-untyped-def]  # noqa: ANN202
        image = self._vtk.vtkImageData()
        image.SetDimensions(*volume.array.shape[::-1])
        image.SetSpacing(*volume.spacing)
        scalars = np.ascontiguousarray(volume.array).ravel()
        image.GetPointData().SetScalars(self._numpy.numpy_to_vtk(scalars, deep=True))
        mapper = self._vtk.vtkFixedPointVolumeRayCastMapper()
        mapper.SetInputData(image)
        mapper.SetAutoAdjustSampleDistances(0)
        mapper.SetLockSampleDistanceToInputSpacing(0)
        mapper.SetImageSampleDistance(1.0)
        mapper.SetNumberOfThreads(os.cpu_count() or 1)
        return mapper

    def _property_of(self, volume: Volume, look: Appearance):  # type: ignore[no-untyped-def]  # noqa: ANN202
        colours, opacities = self._vtk.vtkColorTransferFunction(), self._vtk.vtkPiecewiseFunction()
        values = np.array([value for value, _, _ in look.transfer])
        curves = np.array([[*colour, extinction] for _, colour, extinction in look.transfer])
        for value in np.linspace(values[0], values[-1], CURVE_POINTS):
            red, green, blue, extinction = (np.interp(value, values, each) for each in curves.T)
            stored = (value - volume.intercept) / volume.slope
            # it blends colours as the screen has them
            colours.AddRGBPoint(stored, *screen_from_linear(np.array([red, green, blue])))
            opacities.AddPoint(stored, 1.0 - math.exp(-look.density * extinction * UNIT))
        found = self._vtk.vtkVolumeProperty()
        found.SetColor(colours)
        found.SetScalarOpacity(opacities)
        found.SetScalarOpacityUnitDistance(UNIT)
        found.SetInterpolationTypeToLinear()
        found.SetShade(look.mode == "shaded")
        found.SetAmbient(AMBIENT)
        found.SetDiffuse(1.0 - AMBIENT)
        return found

    def _placed(self, volume: Volume):  # type: ignore[no-untyped-def]  # noqa: ANN202
        """Returns the place of the image in the patient; it begins in the first voxel's middle."""
        from_grid = np.array(volume.patient_from_grid, np.float64)
        middle = from_grid @ [0.5, 0.5, 0.5, 1.0]
        from_image = from_grid @ np.diag([*(1.0 / np.array(volume.spacing)), 1.0])
        from_image[:3, 3] = middle[:3]
        matrix = self._vtk.vtkMatrix4x4()
        matrix.DeepCopy(from_image.ravel().tolist())
        return matrix

    def _window_of(self, drawn, camera: Camera):  # type: ignore[no-untyped-def]  # noqa: ANN001, ANN202
        renderer, window = self._vtk.vtkRenderer(), self._vtk.vtkRenderWindow()
        renderer.AddVolume(drawn)
        window.SetOffScreenRendering(1)
        window.SetMultiSamples(0)
        window.SetSize(*self._size)
        window.AddRenderer(renderer)
        seen = renderer.GetActiveCamera()
        target, back = np.array(camera.target), np.array(camera.back)
        seen.SetFocalPoint(*target)
        seen.SetPosition(*(target + camera.distance * back))
        seen.SetViewUp(*camera.up)
        seen.SetViewAngle(math.degrees(camera.field))
        renderer.ResetCameraClippingRange()
        return window
