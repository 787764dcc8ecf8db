"""Hash of a scan: its values and its geometry."""

from __future__ import annotations

from hashlib import blake2b

import numpy as np

from palpate.volumes.volume import Volume

__all__ = ["scan_hash"]


def scan_hash(volume: Volume) -> bytes:
    """Returns a hash of the stored values and the geometry of a scan, 32 bytes."""
    hasher = blake2b(digest_size=32)
    hasher.update(np.asarray(volume.dimensions, "<i8").tobytes())
    hasher.update(np.asarray(volume.patient_from_grid, "<f8").tobytes())
    hasher.update(np.asarray([volume.slope, volume.intercept], "<f8").tobytes())
    for plane in volume.array:
        hasher.update(np.ascontiguousarray(plane, "<i2").data)
    return hasher.digest()
