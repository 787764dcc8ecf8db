"""A request for a reconstruction, from the command line or the page."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from palpate.base.errors import OptionError
from palpate.base.progress import Progress, silent
from palpate.base.request import Request, options_of, words
from palpate.reconstruction.beams import WATER, Beam, Zero

if TYPE_CHECKING:
    from palpate.reconstruction.projections import ProjectionStack
    from palpate.reconstruction.scanner import Grid, Scanner
    from palpate.volumes.volume import Volume

__all__ = ["ReconstructionRequest", "grid_of", "reconstruct_file", "suggested"]

CIRCLE = 360.0
ARCS: dict[Beam, float] = {"parallel": 180.0, "cone": 360.0}
"""Common arcs [degrees]."""
STATED = ("arc", "first_angle", "source_to_axis", "source_to_detector", "zero")
"""Options that say what a geometry file says too."""
PLACE_TOLERANCE = 1e-3
"""Largest difference between two places that are one [mm]."""
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
    geometry: Annotated[
        Path | None,
        words(
            "Geometry file of RTK (XML), instead of angles, distances and the side of the source.",
            reads=True,
        ),
    ] = None
    arc: Annotated[
        float | None,
        words("Angular range of the projections in degrees; by default a full circle."),
    ] = None
    first_angle: Annotated[
        float | None, words("Angle of the first projection in degrees; by default 0.")
    ] = None
    source_to_axis: Annotated[
        float | None,
        words("Cone: distance from source to rotation axis in mm.", name="source-axis"),
    ] = None
    source_to_detector: Annotated[
        float | None,
        words("Cone: distance from source to detector in mm.", name="source-detector"),
    ] = None
    offset: Annotated[
        tuple[float, float] | None,
        words(
            "Offset of the detector's centre from the central ray in mm, by default 0,0; with a "
            "geometry file, place of the centre in the images, by default as they state it.",
            form="U,V",
        ),
    ] = None
    zero: Annotated[
        Zero | None,
        words(
            "Side of the patient with the source at angle 0: back, the default, or front "
            "(IEC 61217, RTK); it moves to the patient's left."
        ),
    ] = None
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

    def check(self) -> None:
        """Refuses what says the same as a geometry file.

        Raises:
            OptionError: The file and an option are both given.
        """
        if self.geometry is None:
            return
        for option in options_of(type(self)):
            value = getattr(self, option.field)
            # the source of all files is in front
            if option.field in STATED and value is not None and value != "front":
                raise OptionError(
                    f"{option.name} given with a geometry file; allowed: one of them, as the file "
                    "states where the source is"
                )

    def scanner(self, stack: ProjectionStack) -> Scanner:
        """Returns the geometry of projections.

        Raises:
            OptionError: The geometry file is another one's, or says otherwise than an option.
            VolumeFormatError: It cannot be used.
        """
        import numpy as np

        from palpate.reconstruction.scanner import Scanner

        if self.geometry is not None:
            return self._scanner_of_file(self.geometry, stack)
        images, _, _ = self.shape_of(stack)
        step = (CIRCLE if self.arc is None else self.arc) / max(1, images)
        return Scanner(
            beam=self.beam,
            angles=((self.first_angle or 0.0) + step * np.arange(images)).tolist(),
            pixel=self.pixel,
            offset=self.offset or (0.0, 0.0),
            source_to_axis=self.source_to_axis or 0.0,
            source_to_detector=self.source_to_detector or 0.0,
            zero=self.zero or "back",
        )

    def _scanner_of_file(self, path: Path, stack: ProjectionStack) -> Scanner:
        from palpate.reconstruction.rtk_geometry import read_geometry

        self.check()
        if stack.turned:
            raise OptionError(
                f"{stack.path} states directions in which its columns and rows are turned; "
                "allowed with a geometry file: those of the detector"
            )
        # a row of sinograms is no row of pixels
        stated = None if self.sinograms else stack.middle
        if self.offset is not None and stated is not None:
            apart = max(abs(here - there) for here, there in zip(self.offset, stated, strict=True))
            if apart > PLACE_TOLERANCE:
                raise OptionError(
                    f"offset {self.offset[0]:g},{self.offset[1]:g} given, and {stack.path} places "
                    f"its middle at {stated[0]:g},{stated[1]:g}; allowed: without an offset"
                )
        scanner = read_geometry(path, pixel=self.pixel, offset=self.offset or stated or (0.0, 0.0))
        images, _, _ = self.shape_of(stack)
        if len(scanner.angles) != images:
            raise OptionError(
                f"{path} describes {len(scanner.angles)} projections, and {stack.path} holds "
                f"{images}; allowed: as many"
            )
        if scanner.beam != self.beam:
            raise OptionError(
                f"beam {self.beam} given, and {path} describes {scanner.beam} beams; allowed: "
                f"{scanner.beam}"
            )
        return scanner

    def shape_of(self, stack: ProjectionStack) -> tuple[int, int, int]:
        """Returns the shape of the projections, [angle, v, u]."""
        images, rows, columns = stack.shape
        return (rows, images, columns) if self.sinograms else (images, rows, columns)


def suggested(stack: ProjectionStack) -> ReconstructionRequest:
    """Returns a likely request for a stack, for a user to check."""
    # sinograms are of parallel beams: the rows of a cone beam cannot be parted
    beam: Beam = "parallel" if stack.sinograms else "cone"
    near, far = DISTANCES
    return ReconstructionRequest(
        beam=beam,
        pixel=stack.pixel,
        arc=ARCS[beam],
        first_angle=0.0,
        source_to_axis=near,
        source_to_detector=far,
        offset=(0.0, 0.0),
        zero="back",
        sinograms=stack.sinograms,
        intensities=float(2**stack.bits - 1) if stack.counts else None,
    )


def grid_of(stack: ProjectionStack, request: ReconstructionRequest) -> Grid:
    """Returns the grid of the requested scan.

    Raises:
        OptionError: The request is not possible.
    """
    from palpate.reconstruction.scanner import fitted_grid

    scanner = request.scanner(stack)
    return fitted_grid(request.shape_of(stack), scanner, size=request.size, voxel=request.voxel)


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
    from palpate.reconstruction.projections import integrals_of, read_projections, stack_at
    from palpate.reconstruction.reconstruction import reconstruct

    # a geometry that does not fit is refused before all images are read
    scanner = request.scanner(stack_at(path))
    images = read_projections(path, sinograms=request.sinograms, progress=progress)
    if request.intensities is not None:
        images = integrals_of(images, request.intensities)
    return reconstruct(
        images,
        scanner,
        size=request.size,
        voxel=request.voxel,
        water=request.water,
        hann=request.hann,
        name=name,
        progress=progress,
    )
