"""What a surface keeps of the voxels that it was made of: volume and bodies, before and after."""

from __future__ import annotations

from dataclasses import asdict, dataclass

import numpy as np
from numpy.typing import NDArray

from palpate.base.volume_text import volume_text

__all__ = ["SurfaceReport", "ThinSummary", "thin_summary"]

TOLERANCE = 0.05
"""Share of its volume that a surface may gain or lose without a warning."""


@dataclass(frozen=True, kw_only=True)
class ThinSummary:
    """What a surface keeps of thin parts: those in no block of two or three voxels each way."""

    parts: int
    expected_volume: float
    """Volume of their voxels or, where the scan's values tell of partial volume, by those [mm³]."""
    volume: float
    """Volume that the surface has of them [mm³]."""
    changed_parts: int
    """Parts whose volume differs by more than the tolerance."""
    changed_most_at: tuple[float, float, float] | None
    """Where the part lies that differs most, in the patient, LPS [mm]."""
    changed_most: float
    """How much its volume differs [mm³]; below 0 where it is lost."""


@dataclass(frozen=True, kw_only=True)
class SurfaceReport:
    """Volume and bodies of a segment's voxels, and of the surface made of them.

    Bodies of voxels hang together through faces and edges, those of a mesh through vertices;
    cavities are no bodies. The volume of a mesh is that of the divergence theorem.
    """

    segment: str
    """Name of the segment."""
    triangles: int
    area: float
    """Area of the surface [mm²]."""
    volume: float
    """Volume that the surface encloses [mm³]."""
    bodies: int
    voxel_volume: float
    """Volume of the voxels [mm³]."""
    voxel_bodies: int
    expected_volume: float
    """Volume that the voxels stand for [mm³]: of thin parts by the scan's values, where those tell
    of partial volume; else that of the voxels."""
    halfway: bool
    """Whether for this the threshold was taken for halfway between most thin parts and what is
    around them; else their brightest voxels for full."""
    thin: ThinSummary
    touching_edges: int
    """Edges along which voxels touch that share no face: four triangles meet there in space."""

    @property
    def change(self) -> float:
        """Share of the voxels' volume that the surface has more, or less where below 0."""
        return self.volume / self.voxel_volume - 1.0 if self.voxel_volume else 0.0

    @property
    def warnings(self) -> tuple[str, ...]:
        """What was lost, gained, parted or joined, each in one line."""
        told = []
        if abs(self.change) > TOLERANCE:
            told.append(
                f"the surface of {self.segment!r} has {volume_text(self.volume)}, its voxels "
                f"{volume_text(self.voxel_volume)} ({self.change:+.0%}){self._by_values}"
            )
        if self.thin.changed_most_at is not None:
            place = ", ".join(f"{along:.1f}" for along in self.thin.changed_most_at)
            told.append(
                f"{self.thin.changed_parts} of {self.thin.parts} thin parts of {self.segment!r} "
                f"{'change' if self.thin.changed_parts > 1 else 'changes'} by more than "
                f"{TOLERANCE:.0%}, most by {self.thin.changed_most:+.3g} mm³ at ({place}) mm LPS"
            )
        if self.bodies != self.voxel_bodies:
            told.append(
                f"the surface of {self.segment!r} has {_bodies(self.bodies)}, its voxels "
                f"{_bodies(self.voxel_bodies)}; a smaller step keeps what is thin together"
            )
        if self.touching_edges:
            told.append(
                f"voxels of {self.segment!r} touch at {self.touching_edges} "
                f"edge{'s' if self.touching_edges > 1 else ''} without sharing "
                "a face: four triangles meet there, which some programs call not manifold"
            )
        return tuple(told)

    @property
    def _by_values(self) -> str:
        """What the values say, where that is not what the voxels say."""
        if abs(self.expected_volume - self.voxel_volume) <= TOLERANCE * self.voxel_volume:
            return ""
        assumed = "the threshold is halfway" if self.halfway else "the brightest of them are full"
        volume = volume_text(self.expected_volume)
        return f"; by the scan's values they stand for {volume} if {assumed}"

    def of(self, count: int) -> str:
        """Returns the same as ``str``, with the segment's name, of so many in the scene."""
        of = "" if count == 1 else f" of {count}"
        return f"segment {self.segment!r}{of}, {self}"

    def __str__(self) -> str:
        """Returns triangles, area, volume and bodies of the surface, and those of the voxels."""
        return (
            f"{self.triangles} triangles, {self.area / 100.0:.3g} cm², "
            f"{volume_text(self.volume)} in {_bodies(self.bodies)} "
            f"(voxels: {volume_text(self.voxel_volume)} in {_bodies(self.voxel_bodies)})"
        )

    def as_dict(self) -> dict[str, object]:
        """Returns all of it for a JSON file: lengths in mm, with the warnings."""
        return {**asdict(self), "change": self.change, "warnings": list(self.warnings)}


def thin_summary(places: NDArray[np.float64], volumes: NDArray[np.float64]) -> ThinSummary:
    """Returns what is kept of thin parts.

    Args:
        places: Where each lies, in the patient, LPS [mm], shape [count, 3].
        volumes: What is expected and what is kept of each [mm³], shape [count, 2].
    """
    expected, kept = volumes.T
    difference = kept - expected
    changed = np.abs(difference) > TOLERANCE * np.abs(expected)
    most = int(np.argmax(np.abs(np.where(changed, difference, 0.0)))) if changed.any() else None
    x, y, z = places[most].tolist() if most is not None else (0.0, 0.0, 0.0)
    return ThinSummary(
        parts=len(places),
        expected_volume=float(expected.sum()),
        volume=float(kept.sum()),
        changed_parts=int(changed.sum()),
        changed_most_at=None if most is None else (x, y, z),
        changed_most=0.0 if most is None else float(difference[most]),
    )


def _bodies(count: int) -> str:
    return f"{count} {'body' if count == 1 else 'bodies'}"
