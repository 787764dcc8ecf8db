"""Reconstruction of a scan from projections, by filtered back-projection with a library (RTK).

Without the library, parallel beams are still reconstructed (``parallel_beams``), but more slowly.

Parallel beams (Ramachandran and Lakshminarayanan, PNAS 68(9), 1971), and cone beams from a source
on a circle (Feldkamp, Davis and Kress, JOSA A 1(6), 1984; Rit et al., J. Phys.: Conf. Ser. 489,
2014): projections are weighted, filtered by a ramp, and back-projected along their rays, a few at a
time.

Frame of the device: that of ``palpate.reconstruction.scanner``. The scan is given in the patient
frame (LPS) for a patient in supine position whose axis from feet to head is that of rotation: x, y,
z of the patient are x, z, y of the device, or x, -z, y where the source begins in front.

Layout: projections are [angle, v, u], line integrals of attenuation [1].
"""

from __future__ import annotations

from collections.abc import Sequence
from importlib import import_module
from importlib.util import find_spec
from typing import Any

import numpy as np
from numpy.typing import NDArray

from palpate.base.errors import OptionError
from palpate.base.progress import Progress, silent
from palpate.reconstruction.beams import WATER, Beam
from palpate.reconstruction.parallel_beams import back_projected
from palpate.reconstruction.scanner import Grid, Scanner, fitted_grid
from palpate.reconstruction.views import View
from palpate.volumes.stored_values import to_stored
from palpate.volumes.volume import Volume, VolumeTraits

__all__ = ["missing_library", "reconstruct"]

NOT_INSTALLED = "RTK is not installed; allowed: with it (`pip install 'palpate[reconstruct]'`)"
FAR = 1e6
"""Distance of the source from which on beams count as parallel [mm]."""
AT_ONCE = 8
"""Projections between two reports of progress."""

Values = NDArray[np.float32]


def missing_library(beam: Beam = "cone") -> str | None:
    """Returns how to install RTK; None where it is installed, or not needed for these beams."""
    return None if beam == "parallel" or _has_rtk() else NOT_INSTALLED


def _has_rtk() -> bool:
    try:
        return find_spec("itk") is not None and find_spec("itk.RTKPython") is not None
    except (ImportError, ValueError):
        return False


def reconstruct(
    projections: NDArray[Any],
    scanner: Scanner,
    *,
    size: tuple[int, int, int] | None = None,
    voxel: tuple[float, float, float] | None = None,
    water: float = WATER,
    hann: float = 0.0,
    name: str = "reconstruction",
    progress: Progress = silent,
) -> Volume:
    """Reconstructs a scan [HU] from projections.

    Args:
        projections: Line integrals of attenuation, shape [angle, v, u].
        scanner: Geometry of the projections.
        size: Voxels along x, y, z of the patient, centred on the axis; the default is all that
            every projection shows.
        voxel: Voxel size along x, y, z [mm]; the default is that of the detector's pixels.
        water: Attenuation of water [1/mm], which becomes 0 HU.
        hann: Cut-off of the Hann window of the ramp filter, as a fraction of the highest frequency;
            0 for no window.
        name: Name of the scan.
        progress: Takes the progress; an exception that it raises stops the reconstruction.

    Raises:
        OptionError: A number is not allowed, or RTK is not installed.
    """
    given = np.ascontiguousarray(projections, np.float32)
    grid = fitted_grid(given.shape, scanner, size=size, voxel=voxel)
    if not 0.0 < water < np.inf:
        raise OptionError(f"water {water:g} given; allowed: above 0 [1/mm], such as {WATER:g}")
    if not 0.0 <= hann <= 1.0:
        raise OptionError(f"hann {hann:g} given; allowed: 0 to 1")
    if not np.isfinite(given).all():
        raise OptionError("projections with NaN or infinite values given; allowed: finite ones")
    if scanner.beam == "parallel" and not _has_rtk():
        found = back_projected(given, scanner, grid, hann=hann, progress=progress)
    else:
        found = _by_rtk(given, scanner, grid, hann=hann, progress=progress)
    progress("storing values as 16 bits", None)
    return _scan(found, grid.voxel, water=water, name=name)


def _by_rtk(
    given: Values, scanner: Scanner, grid: Grid, *, hann: float, progress: Progress
) -> Values:
    """Returns attenuation [1/mm] in the patient frame, shape [z, y, x]."""
    count = len(given)
    # its modules are large: the first time may take half a minute
    progress("loading RTK", None)
    rtk = _Rtk(scanner)
    given, views = _all_round(given, scanner)
    if scanner.beam == "cone":
        given = rtk.completed(given, views)
    weighted = rtk.weighted(given, views)
    x, y, z = grid.size
    # patient to device: x, z, y
    image = rtk.empty((x, z, y), (grid.voxel[0], grid.voxel[2], grid.voxel[1]))
    for first in range(0, len(views), AT_ONCE):
        progress(f"reconstructing from {count} projections", first / len(views))
        some = slice(first, first + AT_ONCE)
        image = rtk.smeared_back(rtk.sharpened(weighted[some], hann), views[some], onto=image)
    # [z, y, x] of the device to [z, y, x] of the patient: a mirror image, as its projections are,
    # unless the source begins in front
    found = np.transpose(rtk.values(image), (1, 0, 2))
    return found if scanner.posterior > 0.0 else found[:, ::-1]


def _scan(
    attenuation: Values, voxel: tuple[float, float, float], *, water: float, name: str
) -> Volume:
    values = np.rint(1000.0 * (attenuation / water - 1.0))
    stored = to_stored(values)
    middles = [
        -0.5 * (count - 1) * edge for count, edge in zip(values.shape[::-1], voxel, strict=True)
    ]
    return Volume(
        stored.values,
        spacing=voxel,
        origin=middles,
        slope=stored.scale.slope,
        intercept=stored.scale.intercept,
        traits=VolumeTraits(name=name, modality="CT", unit="HU"),
    )


def _all_round(given: Values, scanner: Scanner) -> tuple[Values, list[View]]:
    """Returns projections and views extended to a full circle, which RTK assumes."""
    if scanner.beam == "cone":
        return given, list(scanner.all_views())
    angles = [float(angle) for angle in scanner.angles]
    arc = scanner.arc
    if arc is not None and arc <= 270.0:
        # parallel beams see the same from behind, mirrored
        given = np.concatenate([given, given[:, :, ::-1]])
        angles += [angle + 180.0 for angle in angles]
    # beams from very far away are parallel: they part by 0.01 mm within 100 mm
    views = [View(angle=angle, source_to_axis=FAR, source_to_detector=FAR) for angle in angles]
    return given, views


class _Rtk:
    """The part of RTK that is used, for one geometry; images are ITK's, in the device's frame."""

    def __init__(self, scanner: Scanner) -> None:
        """Loads the library.

        Raises:
            OptionError: It is not installed.
        """
        if not _has_rtk():
            raise OptionError(NOT_INSTALLED)
        self._itk = import_module("itk")
        self._rtk = self._itk.RTK
        self._kind = self._itk.Image[self._itk.F, 3]
        self._pixel = scanner.pixel
        self._middle = scanner.offset
        """Place of the images' middle [mm]."""

    def values(self, image: Any) -> Values:  # noqa: ANN401  # ITK has no types
        """Returns an image as an array [z, y, x]."""
        array: Values = self._itk.array_from_image(image)
        return array

    def empty(self, size: Sequence[int], spacing: Sequence[float]) -> Any:  # noqa: ANN401
        """Returns an image of zeros around the origin."""
        source = self._rtk.ConstantImageSource[self._kind].New()
        source.SetSize(list(size))
        source.SetSpacing(list(spacing))
        source.SetOrigin(_corner(size, spacing))
        source.SetConstant(0.0)
        source.Update()
        return source.GetOutput()

    def completed(self, projections: Values, views: Sequence[View]) -> Values:
        """Returns projections of a detector that stands aside with its other side, as zeros.

        What both sides show is weighted (Wang, Med. Phys. 29(7), 2002); others stay as they are.
        """
        wide = self._rtk.DisplacedDetectorImageFilter[self._kind].New()
        wide.SetInput(self._taken(projections))
        wide.SetGeometry(self._geometry(views))
        wide.Update()
        image = wide.GetOutput()
        values = self.values(image)
        first = image.TransformIndexToPhysicalPoint(image.GetLargestPossibleRegion().GetIndex())
        self._middle = first[0] + 0.5 * (values.shape[2] - 1) * self._pixel[0], self._middle[1]
        return values

    def weighted(self, projections: Values, views: Sequence[View]) -> Values:
        """Returns projections weighted for oblique rays and for the angle that each covers."""
        weight = self._rtk.FDKWeightProjectionFilter[self._kind].New()
        weight.SetInput(self._taken(projections))
        weight.SetGeometry(self._geometry(views))
        weight.Update()
        return self.values(weight.GetOutput())

    def sharpened(self, projections: Values, hann: float) -> Any:  # noqa: ANN401
        """Returns filtered projections as an image."""
        ramp = self._rtk.FFTRampImageFilter[self._kind, self._kind, self._itk.D].New()
        ramp.SetInput(self._taken(projections))
        ramp.SetTruncationCorrection(0.0)
        ramp.SetHannCutFrequency(hann)
        ramp.Update()
        return ramp.GetOutput()

    def smeared_back(self, projections: Any, views: Sequence[View], *, onto: Any) -> Any:  # noqa: ANN401
        """Adds projections to an image, along their rays."""
        back = self._rtk.FDKBackProjectionImageFilter[self._kind, self._kind].New()
        back.SetInput(0, onto)
        back.SetInput(1, projections)
        back.SetGeometry(self._geometry(views))
        back.Update()
        done = back.GetOutput()
        done.DisconnectPipeline()
        return done

    def _taken(self, projections: Values) -> Any:  # noqa: ANN401
        """Returns projections as an image in the plane of the detector."""
        image = self._itk.image_from_array(np.ascontiguousarray(projections))
        image.SetSpacing([*self._pixel, 1.0])
        corner = _corner(projections.shape[:0:-1], self._pixel)
        image.SetOrigin([*np.add(corner, self._middle).tolist(), 0.0])
        return image

    def _geometry(self, views: Sequence[View]) -> Any:  # noqa: ANN401
        geometry = self._rtk.ThreeDCircularProjectionGeometry.New()
        for view in views:
            geometry.AddProjection(
                view.source_to_axis,
                view.source_to_detector,
                view.angle,
                *view.detector_offset,
                view.out_of_plane,
                view.in_plane,
                *view.source_offset,
            )
        return geometry


def _corner(size: Sequence[int], spacing: Sequence[float]) -> list[float]:
    """Returns the centre of the first of so many cells around 0 [mm]."""
    return [-0.5 * (count - 1) * edge for count, edge in zip(size, spacing, strict=True)]
