"""The built-in phantom: a procedural trunk in plausible HU, with its exact labels."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from palpate import _core
from palpate.base.errors import OptionError
from palpate.volumes.segment import Segment
from palpate.volumes.volume import Volume, VolumeTraits

__all__ = ["Phantom", "phantom"]


@dataclass(frozen=True)
class Phantom:
    """A scan and the truth about it."""

    volume: Volume
    labels: NDArray[np.uint8]
    """What each voxel is, shape [depth, height, width]."""
    names: dict[str, int]
    """The number of each part in ``labels``."""

    def part(self, name: str) -> Segment:
        """Returns the voxels of a part, by its name.

        Raises:
            OptionError: There is no such part.
        """
        if name not in self.names:
            raise OptionError(f"part {name!r} is not known; allowed: {', '.join(self.names)}")
        return self.volume.segment(self.labels == self.names[name], name=name)


def phantom(dimensions: tuple[int, int, int] = (200, 140, 270), *, seed: int = 1) -> Phantom:
    """Makes the phantom.

    Args:
        dimensions: Voxels along x, y, z.
        seed: Of its noise; the same seed makes the same phantom.

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
