"""A request for a reconstruction, from the command line or the page."""

from __future__ import annotations

from pathlib import Path

import msgspec
import numpy as np

from palpate.base.progress import Progress, silent
from palpate.reconstruction.projections import ProjectionStack, integrals_of, read_projections
from palpate.reconstruction.reconstruction import WATER, reconstruct
from palpate.reconstruction.scanner import Beam, Grid, Scanner, Zero, fitted_grid
from palpate.volumes.volume import Volume

__all__ = ["ReconstructionRequest", "grid_of", "reconstruct_file", "suggested"]

ARCS: dict[Beam, float] = {"parallel": 180.0, "cone": 360.0}
"""Common arcs [degrees]."""
DISTANCES = (1000.0, 1536.0)
"""Distances of a common radiotherapy machine from its source to axis and detector [mm]."""


class ReconstructionRequest(msgspec.Struct, frozen=True, kw_only=True):
    """Geometry of projections, and the requested scan."""

    beam: Beam
    pixel: tuple[float, float]
    """Pixel size of the detector along u and v [mm]."""
    arc: float = 360.0
    """Arc of the projections [degrees]."""
    first_angle: float = 0.0
    """First angle of the gantry [degrees]."""
    offset: tuple[float, float] = (0.0, 0.0)
    """Offset of the detector's middle from the central ray along u and v [mm]."""
    source_to_axis: float = 0.0
    """Distance from source to axis, for cone beams [mm]."""
    source_to_detector: float = 0.0
    """Distance from source to detector, for cone beams [mm]."""
    zero: Zero = "back"
    """Side of the patient at which the source is at angle 0."""
    sinograms: bool = False
    """Whether each image is one row of the detector at all angles."""
    intensities: float | None = None
    """Count of the detector without a patient; None where values are line integrals."""
    size: tuple[int, int, int] | None = None
    """Number of voxels along x, y, z; None for all that is visible."""
    voxel: tuple[float, float, float] | None = None
    """Voxel size along x, y, z [mm]; None for that of the pixels."""
    water: float = WATER
    """Attenuation of water [1/mm]."""
    hann: float = 0.0
    """Cut-off of the Hann window, as a fraction of the highest frequency."""

    def scanner(self, projections: int) -> Scanner:
        """Returns the geometry of so many projections."""
        step = self.arc / max(1, projections)
        return Scanner(
            beam=self.beam,
            angles=(self.first_angle + step * np.arange(projections)).tolist(),
            pixel=self.pixel,
            offset=self.offset,
            source_to_axis=self.source_to_axis,
            source_to_detector=self.source_to_detector,
            zero=self.zero,
        )


def suggested(stack: ProjectionStack) -> ReconstructionRequest:
    """Returns a likely request for a stack, for a user to check."""
    # sinograms are of parallel beams: the rows of a cone beam cannot be parted
    beam: Beam = "parallel" if stack.sinograms else "cone"
    near, far = DISTANCES
    return ReconstructionRequest(
        beam=beam,
        pixel=stack.pixel,
        arc=ARCS[beam],
        source_to_axis=near,
        source_to_detector=far,
        sinograms=stack.sinograms,
        intensities=float(2**stack.bits - 1) if stack.counts else None,
    )


def grid_of(stack: ProjectionStack, request: ReconstructionRequest) -> Grid:
    """Returns the grid of the requested scan.

    Raises:
        OptionError: The request is not possible.
    """
    images, rows, columns = stack.shape
    shape = (rows, images, columns) if request.sinograms else (images, rows, columns)
    return fitted_grid(shape, request.scanner(shape[0]), size=request.size, voxel=request.voxel)


def reconstruct_file(
    path: Path,
    request: ReconstructionRequest,
    *,
    name: str = "reconstruction",
    progress: Progress = silent,
) -> Volume:
    """Reconstructs a scan [HU] from the projections at a path.

    Args:
        path: As for ``palpate.reconstruction.projections.read_projections``.
        request: Geometry of the projections, and the requested scan.
        name: Name of the scan.
        progress: Takes the progress; an exception that it raises stops the reconstruction.

    Raises:
        FileNotFoundError: ``path`` does not exist.
        VolumeFormatError: It is not a stack of images.
        OptionError: A number is not allowed, or RTK is not installed.
    """
    images = read_projections(path, sinograms=request.sinograms, progress=progress)
    if request.intensities is not None:
        images = integrals_of(images, request.intensities)
    return reconstruct(
        images,
        request.scanner(len(images)),
        size=request.size,
        voxel=request.voxel,
        water=request.water,
        hann=request.hann,
        name=name,
        progress=progress,
    )
