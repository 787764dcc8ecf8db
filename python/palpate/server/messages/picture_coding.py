"""How pictures of the engine are packed for the way to their page: as they are, or smaller.

On one machine they go as they are: any packing takes longer than it saves. From afar they go as
WebP, so fine that a picture is on its way for a tenth of a second, the last one always without a
loss that is seen.
"""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["NOT_PACKED", "Packing", "PictureCoder"]

RAW_BYTES = 10
"""Of a pixel that is not packed."""
RAW_SECONDS = 0.03
"""On their way, up to which pictures are not packed; packing takes as long."""
LAST_RAW_SECONDS = 0.6
"""The same of the last picture, which a person looks at: exact is worth a moment, and a busy
machine seems to be farther away than it is."""
WANTED_SECONDS = 0.1
"""On their way, of pictures that are packed."""
QUALITIES = {50: 0.7, 75: 1.0, 90: 1.7}
"""Of WebP, and how large pictures are beside those of 75; measured on CThead."""
LAST_QUALITY = 95
"""Off by less than 0.6/255 on average."""
FIRST_SIZE = 0.25
"""Bytes of a pixel at quality 75, before any was packed."""
LEARNED = 0.5


@dataclass(frozen=True)
class Packing:
    """How one picture is packed."""

    quality: int | None = None
    """Of WebP; None: not packed."""
    depth_step: float = 0.25
    """Step of depths [mm]."""
    depth_every: int = 1
    """Depths of every so many-th pixel of every so many-th row."""


NOT_PACKED = Packing()


class PictureCoder:
    """Learns how small pictures become, and chooses how they are packed."""

    def __init__(self) -> None:
        """Knows nothing yet."""
        self._size = FIRST_SIZE

    def packing(self, pixels: int, rate: float, *, moving: bool, last: bool) -> Packing:
        """Returns how to pack a picture for a way of so many bytes a second."""
        if RAW_BYTES * pixels <= rate * (LAST_RAW_SECONDS if last else RAW_SECONDS):
            return NOT_PACKED
        if last:
            return Packing(LAST_QUALITY)
        fitting = rate * WANTED_SECONDS / (pixels * self._size)
        quality = max(
            (q for q, share in QUALITIES.items() if share <= fitting), default=min(QUALITIES)
        )
        return Packing(quality, depth_step=1.0, depth_every=2) if moving else Packing(quality)

    def learn(self, packing: Packing, pixels: int, size: int) -> None:
        """Takes how many bytes a packed picture has."""
        if packing.quality in QUALITIES:
            size_at_75 = size / pixels / QUALITIES[packing.quality]
            self._size += LEARNED * (size_at_75 - self._size)
