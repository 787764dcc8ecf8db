"""What a person asks of a reconstruction, on the command line or on the page, and its doing."""

from __future__ import annotations

from pathlib import Path

import msgspec
import numpy as np

from palpate.base.progress import Progress, silent
from palpate.reconstruction.projections import ProjectionStack, integrals_of, read_projections
from palpate.reconstruction.reconstruction import WATER, reconstruct
from palpate.reconstruction.scanner import Beam, Grid, Scanner, fitted_grid
from palpate.volumes.volume import Volume

__all__ = ["ReconstructionRequest", "grid_of", "reconstruct_file", "suggested"]

ARCS: dict[Beam, float] = {"parallel": 180.0, "cone": 360.0}
"""Usual ones [degrees]."""
DISTANCES = (1000.0, 1536.0)
"""From the source to axis and detector of a usual machine for radiotherapy [mm]."""


class ReconstructionRequest(msgspec.Struct, frozen=True, kw_only=True):
    """How projections were taken, and which scan is wanted of them."""

    beam: Beam
    pixel: tuple[float, float]
    """Of the detector along u and v [mm]."""
    arc: float = 360.0
    """That the projections cover [degrees]."""
    first_angle: float = 0.0
    """Of the gantry [degrees]."""
    offset: tuple[float, float] = (0.0, 0.0)
    """Of the detector's middle from the central ray [mm]."""
    source_to_axis: float = 0.0
    """For cone beams [mm]."""
    source_to_detector: float = 0.0
    """For cone beams [mm]."""
    sinograms: bool = False
    """Whether each image is one row of the detector at all angles."""
    intensities: float | None = None
    """What the detector counts without a patient; None where values are line integrals."""
    size: tuple[int, int, int] | None = None
    """Voxels; None for all that is seen."""
    voxel: tuple[float, float, float] | None = None
    """Their edges [mm]; None for those of pixels."""
    water: float = WATER
    """Attenuation [1/mm]."""
    hann: float = 0.0
    """Share of the highest frequency at which the window that smooths ends."""

    def scanner(self, projections: int) -> Scanner:
        """Returns how so many projections were taken."""
        step = self.arc / max(1, projections)
        return Scanner(
            beam=self.beam,
            angles=(self.first_angle + step * np.arange(projections)).tolist(),
            pixel=self.pixel,
            offset=self.offset,
            source_to_axis=self.source_to_axis,
            source_to_detector=self.source_to_detector,
        )


def suggested(stack: ProjectionStack) -> ReconstructionRequest:
    """Returns what is likely of a stack, for a person to look at."""
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
    """Returns the grid of the scan that would come.

    Raises:
        OptionError: What is asked cannot be.
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
    """Returns the scan [HU] that the projections at a path tell.

    Args:
        path: As ``palpate.reconstruction.projections.read_projections`` takes it.
        request: How they were taken, and what is wanted.
        name: What to call the scan.
        progress: Told how far it is; what it raises stops the work and is raised from here.

    Raises:
        FileNotFoundError: ``path`` does not exist.
        VolumeFormatError: It holds no stack of images.
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
