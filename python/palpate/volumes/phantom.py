"""The built-in phantom: a procedural trunk in plausible HU, with its exact labels."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from palpate import _core
from palpate.base.errors import OptionError
from palpate.volumes.segment import Segment
from palpate.volumes.volume import Volume, VolumeTraits

__all__ = ["TUMOUR", "TUMOUR_RADIUS", "Phantom", "phantom"]

TUMOUR = (-46.0, -65.5, 27.0)
"""Middle of the tumour in the phantom's liver [LPS, mm]."""

TUMOUR_RADIUS = 10.0
"""Its radius [mm]."""


@dataclass(frozen=True)
class Phantom:
    """A scan and its ground truth."""

    volume: Volume
    labels: NDArray[np.uint8]
    """Label of each voxel, shape [depth, height, width]."""
    names: dict[str, int]
    """Label of each part, by name."""

    def part(self, name: str) -> Segment:
        """Returns the voxels of a part as a segment.

        Raises:
            OptionError: There is no part of this name.
        """
        if name not in self.names:
            raise OptionError(f"part {name!r} is not known; allowed: {', '.join(self.names)}")
        return self.volume.segment(self.labels == self.names[name], name=name)

    def tumour(self) -> Segment:
        """Returns a tumour in the liver: a ball below its front, of its values and without a label.

        The scan does not show it, as it does not show some real ones: it is found by touch.
        """
        middles = [
            first + spacing * np.arange(count) - middle
            for first, spacing, count, middle in zip(
                self.volume.origin, self.volume.spacing, self.volume.dimensions, TUMOUR, strict=True
            )
        ]
        x, y, z = np.meshgrid(*middles, indexing="ij", sparse=True)
        ball = (x * x + y * y + z * z <= TUMOUR_RADIUS**2).transpose(2, 1, 0)
        return self.volume.segment(ball & (self.labels == self.names["liver"]), name="tumour")


def phantom(dimensions: tuple[int, int, int] = (200, 140, 270), *, seed: int = 1) -> Phantom:
    """Makes a procedural CT scan of a trunk, with noise, and its labels.

    Args:
        dimensions: Voxels along x, y, z.
        seed: Seed of the noise; the same seed makes the same phantom.

    Raises:
        OptionError: The dimensions are not allowed.
    """
    try:
        internal, labels, names = _core.phantom(dimensions, seed)
    except ValueError as error:
        raise OptionError(str(error)) from None
    first_voxel = internal.patient_from_grid @ (0.5, 0.5, 0.5, 1.0)
    volume = Volume(
        internal.values(),
        spacing=internal.spacing,
        origin=first_voxel[:3].tolist(),
        traits=VolumeTraits(name="phantom", modality="CT", unit="HU"),
    )
    return Phantom(volume, labels, names)
