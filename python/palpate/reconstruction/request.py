"""A request for a reconstruction, from the command line or the page."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from palpate.base.progress import Progress, silent
from palpate.base.request import Request, words
from palpate.reconstruction.beams import WATER, Beam, Zero

if TYPE_CHECKING:
    from palpate.reconstruction.projections import ProjectionStack
    from palpate.reconstruction.scanner import Grid, Scanner
    from palpate.volumes.volume import Volume

__all__ = ["ReconstructionRequest", "grid_of", "reconstruct_file", "suggested"]

ARCS: dict[Beam, float] = {"parallel": 180.0, "cone": 360.0}
"""Common arcs [degrees]."""
DISTANCES = (1000.0, 1536.0)
"""Distances of a common radiotherapy machine from its source to axis and detector [mm]."""


class ReconstructionRequest(Request, frozen=True, kw_only=True):
    """Geometry of projections, and the requested scan: the options of ``palpate reconstruct``."""

    beam: Annotated[Beam, words("Geometry: parallel, or cone (circular source trajectory).")]
    pixel: Annotated[tuple[float, float], words("Pixel size of the detector in mm.", form="U,V")]
    size: Annotated[
        tuple[int, int, int] | None,
        words("Number of voxels; by default the whole field of view.", form="X,Y,Z"),
    ] = None
    voxel: Annotated[
        tuple[float, float, float] | None,
        words("Voxel size in mm; by default the pixel size at the axis.", form="X,Y,Z"),
    ] = None
    arc: Annotated[float, words("Angular range of the projections in degrees.")] = 360.0
    first_angle: Annotated[float, words("Angle of the first projection in degrees.")] = 0.0
    source_to_axis: Annotated[
        float,
        words("Cone: distance from source to rotation axis in mm.", name="source-axis"),
    ] = 0.0
    source_to_detector: Annotated[
        float,
        words("Cone: distance from source to detector in mm.", name="source-detector"),
    ] = 0.0
    offset: Annotated[
        tuple[float, float],
        words("Offset of the detector's centre from the central ray in mm.", form="U,V"),
    ] = (0.0, 0.0)
    zero: Annotated[
        Zero,
        words(
            "Side of the patient with the source at angle 0: back, or front (IEC 61217, RTK); it "
            "moves to the patient's left."
        ),
    ] = "back"
    sinograms: Annotated[bool, words("The images are sinograms, one for each detector row.")] = (
        False
    )
    intensities: Annotated[
        float | None,
        words("The images are intensities; the value is the intensity without a patient."),
    ] = None
    water: Annotated[float, words("Attenuation coefficient of water in 1/mm.")] = WATER
    hann: Annotated[
        float,
        words(
            "Cut-off of the Hann window as a fraction of the highest frequency; 0 for no window."
        ),
    ] = 0.0

    def scanner(self, projections: int) -> Scanner:
        """Returns the geometry of so many projections."""
        import numpy as np

        from palpate.reconstruction.scanner import Scanner

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
    from palpate.reconstruction.scanner import fitted_grid

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
    from palpate.reconstruction.projections import integrals_of, read_projections
    from palpate.reconstruction.reconstruction import reconstruct

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
