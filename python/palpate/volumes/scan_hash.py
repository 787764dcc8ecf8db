"""What tells one scan from another: a hash of its values and its geometry, and its UIDs."""

from __future__ import annotations

from hashlib import blake2b
from weakref import WeakKeyDictionary

import numpy as np

from palpate.volumes.volume import Volume

__all__ = ["scan_hash", "scan_identity"]

_known: WeakKeyDictionary[Volume, bytes] = WeakKeyDictionary()
"""Hashes that were computed: values of a volume never change."""


def scan_hash(volume: Volume) -> bytes:
    """Returns a hash of the stored values and the geometry of a scan, 32 bytes."""
    known = _known.get(volume)
    if known is None:
        known = _known[volume] = _hash_of(volume)
    return known


def scan_identity(volume: Volume) -> str:
    """Returns what a scan is known by, whatever its name and place: 32 hexadecimal digits.

    Two scans have the same where values, geometry, and the UIDs of study and series are the same.
    """
    uids = "\0".join((volume.traits.study, volume.traits.series))
    return blake2b(scan_hash(volume) + uids.encode(), digest_size=16).hexdigest()


def _hash_of(volume: Volume) -> bytes:
    hasher = blake2b(digest_size=32)
    hasher.update(np.asarray(volume.dimensions, "<i8").tobytes())
    hasher.update(np.asarray(volume.patient_from_grid, "<f8").tobytes())
    hasher.update(np.asarray([volume.slope, volume.intercept], "<f8").tobytes())
    for plane in volume.array:
        hasher.update(np.ascontiguousarray(plane, "<i2").data)
    return hasher.digest()
