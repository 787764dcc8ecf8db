"""Reconstruction: a scan from projections, by filtered back-projection in a library (RTK).

Parallel beams (Ramachandran and Lakshminarayanan, PNAS 68(9), 1971), and cone beams from a source
that goes round in a circle (Feldkamp, Davis and Kress, JOSA A 1(6), 1984; Rit et al., J. Phys.:
Conf. Ser. 489, 2014).

Frame of the device: y is the axis of rotation, the detector's columns u run along x and its rows v
along y where the angle is 0; the source is at +z [mm]. The scan is given in the patient (LPS) as if
he lay on his back with the axis of rotation from feet to head: x, y, z of the patient are x, -z, y
of the device.

Layout: projections are [angle, v, u], line integrals of attenuation [1].
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from importlib import import_module
from importlib.util import find_spec
from typing import Any, Literal, get_args

import numpy as np
from numpy.typing import NDArray

from palpate.errors import OptionError
from palpate.progress import Progress, silent
from palpate.stored import to_stored
from palpate.volume import Volume, VolumeTraits

__all__ = ["BEAMS", "WATER", "Beam", "Scanner", "reconstruct"]

Beam = Literal["parallel", "cone"]
BEAMS: tuple[Beam, ...] = get_args(Beam)

WATER = 0.0206
"""Attenuation of water at 60 keV [1/mm] (NIST, Hubbell and Seltzer)."""
FAR = 1e6
"""Of a source whose beams count as parallel [mm]."""
LEAST_ANGLES = 8
MOST_VOXELS = 1024**3

Values = NDArray[np.float32]


@dataclass(frozen=True, kw_only=True)
class Scanner:
    """How projections were taken."""

    beam: Beam
    angles: Sequence[float]
    """Of the gantry at each projection [degrees], one after the other, evenly over the arc."""
    pixel: tuple[float, float]
    """Of the detector along u and v [mm]."""
    offset: tuple[float, float] = (0.0, 0.0)
    """From where the central ray meets the detector to its middle, along u and v [mm]."""
    source_to_axis: float = 0.0
    """For cone beams [mm]."""
    source_to_detector: float = 0.0
    """For cone beams [mm]."""

    @property
    def arc(self) -> float | None:
        """Which even angles cover [degrees]; None where they are uneven."""
        steps = np.diff(self.angles)
        even = bool(np.allclose(steps, steps[0], rtol=1e-3, atol=1e-6))
        return abs(float(steps[0])) * len(self.angles) if even else None

    def check(self, shape: tuple[int, ...]) -> None:
        """Refuses what projections of a shape cannot have been taken with.

        Raises:
            OptionError: The geometry is not possible.
        """
        if self.beam not in BEAMS:
            raise OptionError(f"beam {self.beam!r} given; allowed: {', '.join(BEAMS)}")
        if len(shape) != 3 or min(shape) < 1 or shape[2] < 2:
            raise OptionError(
                f"projections of shape {list(shape)} given; allowed: [angles, rows, columns]"
            )
        if len(self.angles) != shape[0] or shape[0] < LEAST_ANGLES:
            raise OptionError(
                f"{len(self.angles)} angles and {shape[0]} projections given; allowed: as many "
                f"angles as projections, {LEAST_ANGLES} or more"
            )
        numbers = (*self.angles, *self.pixel, *self.offset)
        if not np.isfinite(numbers).all() or min(self.pixel) <= 0.0:
            raise OptionError(f"pixels of {self.pixel} mm given; allowed: lengths above 0")
        arc = self.arc
        if arc is None or not np.isclose(arc, 360.0, rtol=1e-3):
            half = arc is not None and bool(np.isclose(arc, 180.0, rtol=1e-3))
            if not (self.beam == "parallel" and half and self.offset[0] == 0.0):
                told = "uneven angles" if arc is None else f"an arc of {arc:g} degrees"
                raise OptionError(
                    f"{told} given; allowed: even ones over 360 degrees, or with parallel beams on "
                    "a detector whose middle the central ray meets, over 180"
                )
        near, far = self.source_to_axis, self.source_to_detector
        if self.beam == "cone" and not 0.0 < near < far < np.inf:
            raise OptionError(
                f"source at {near:g} mm from the axis and {far:g} mm from the detector given; "
                "allowed: above 0, the axis nearer than the detector"
            )


def reconstruct(
    projections: NDArray[Any],
    scanner: Scanner,
    *,
    size: tuple[int, int, int],
    voxel: tuple[float, float, float],
    water: float = WATER,
    hann: float = 0.0,
    name: str = "reconstruction",
    progress: Progress = silent,
) -> Volume:
    """Returns the scan [HU] that projections tell.

    Args:
        projections: Line integrals of attenuation, shape [angle, v, u].
        scanner: How they were taken.
        size: Voxels along x, y, z of the patient; the middle lies on the axis.
        voxel: Their edges along x, y, z [mm].
        water: Attenuation of water [1/mm]: what becomes 0 HU.
        hann: Where a window smooths the ramp filter to 0, as a share of the highest frequency;
            0 leaves the ramp as it is.
        name: What to call the scan.
        progress: Told what is being done.

    Raises:
        OptionError: A number is not allowed, or RTK is not installed.
    """
    given = np.ascontiguousarray(projections, np.float32)
    scanner.check(given.shape)
    _check(size, voxel, water=water, hann=hann)
    if not np.isfinite(given).all():
        raise OptionError("projections with NaN or infinite values given; allowed: finite ones")
    given, angles = _all_round(given, scanner)
    itk, rtk = _rtk()
    progress(f"reconstructing from {len(given)} projections", None)
    image = itk.Image[itk.F, 3]
    x, y, z = size
    # patient to device: x, z, y
    empty = _empty(rtk.ConstantImageSource[image], (x, z, y), (voxel[0], voxel[2], voxel[1]))
    taken = itk.image_from_array(given)
    taken.SetSpacing([*scanner.pixel, 1.0])
    taken.SetOrigin(
        [
            offset - 0.5 * (count - 1) * edge
            for offset, count, edge in zip(
                scanner.offset, given.shape[:0:-1], scanner.pixel, strict=True
            )
        ]
        + [0.0]
    )
    method = rtk.FDKConeBeamReconstructionFilter[image].New()
    method.SetInput(0, empty)
    method.SetInput(1, taken)
    method.SetGeometry(_geometry(rtk, scanner, angles))
    method.GetRampFilter().SetTruncationCorrection(0.0)
    method.GetRampFilter().SetHannCutFrequency(hann)
    method.Update()
    attenuation = itk.array_from_image(method.GetOutput())
    # [z, y, x] of the device to [z, y, x] of the patient, whose back lies toward -z
    upright = np.transpose(attenuation, (1, 0, 2))[:, ::-1]
    return _scan(upright, voxel, water=water, name=name)


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


def _check(
    size: tuple[int, int, int], voxel: tuple[float, float, float], *, water: float, hann: float
) -> None:
    if min(size) < 2 or int(np.prod(size, dtype=np.int64)) > MOST_VOXELS:
        raise OptionError(f"{size} voxels given; allowed: 2 or more, together {MOST_VOXELS}")
    if not np.isfinite(voxel).all() or min(voxel) <= 0.0:
        raise OptionError(f"voxels of {voxel} mm given; allowed: lengths above 0")
    if not 0.0 < water < np.inf:
        raise OptionError(f"water {water:g} given; allowed: above 0 [1/mm], such as {WATER:g}")
    if not 0.0 <= hann <= 1.0:
        raise OptionError(f"hann {hann:g} given; allowed: 0 to 1")


def _rtk() -> tuple[Any, Any]:
    """Returns the modules itk and RTK.

    Raises:
        OptionError: They are not installed.
    """
    try:
        there = find_spec("itk") is not None and find_spec("itk.RTKPython") is not None
    except (ImportError, ValueError):
        there = False
    if not there:
        raise OptionError(
            "RTK is not installed; allowed: with it (`pip install 'palpate[reconstruct]'`)"
        )
    itk = import_module("itk")
    return itk, itk.RTK


def _all_round(given: Values, scanner: Scanner) -> tuple[Values, list[float]]:
    """Returns projections and their angles over a whole circle, on which RTK counts."""
    arc = scanner.arc
    angles = [float(angle) for angle in scanner.angles]
    if arc is None or arc > 270.0:
        return given, angles
    # parallel beams see the same from behind, mirrored
    return np.concatenate([given, given[:, :, ::-1]]), [*angles, *(a + 180.0 for a in angles)]


def _geometry(rtk: Any, scanner: Scanner, angles: Sequence[float]) -> Any:  # noqa: ANN401
    geometry = rtk.ThreeDCircularProjectionGeometry.New()
    cone = scanner.beam == "cone"
    for angle in angles:
        # beams from very far away are parallel: they part by 0.01 mm within 100 mm
        distances = (scanner.source_to_axis, scanner.source_to_detector) if cone else (FAR, FAR)
        geometry.AddProjection(*distances, angle)
    return geometry


def _empty(kind: Any, size: Sequence[int], spacing: Sequence[float]) -> Any:  # noqa: ANN401
    """Returns an image of 0 around the origin, from a kind of source."""
    source = kind.New()
    source.SetSize(list(size))
    source.SetSpacing(list(spacing))
    source.SetOrigin([-0.5 * (count - 1) * edge for count, edge in zip(size, spacing, strict=True)])
    source.SetConstant(0.0)
    source.Update()
    return source.GetOutput()
