"""What of the segments of a file is not in the scan: empty ones, and what lies beyond its grid."""

from __future__ import annotations

from dataclasses import dataclass, field

from palpate.base.counted import counted, listed, percent

__all__ = ["SegmentsTold"]


@dataclass
class SegmentsTold:
    """Gathers what to say of segments that were laid on the grid of a scan."""

    voxels: int = 0
    """Of all segments in the file."""
    outside: int = 0
    """Of those, the ones outside the scan."""
    empty: list[str] = field(default_factory=list)
    """Without a voxel in the file."""
    small: list[str] = field(default_factory=list)
    """Between the centres of the scan's voxels."""
    cut: list[tuple[float, str]] = field(default_factory=list)
    """Share outside the scan, 0..1, and name."""

    def add(self, name: str, *, voxels: int, outside: int, there: bool) -> None:
        """Takes a segment.

        Args:
            name: Of the segment.
            voxels: How many the file has.
            outside: How many of them lie outside the scan.
            there: Whether the scan has any of it.
        """
        self.voxels += voxels
        self.outside += outside
        if voxels == 0:
            self.empty.append(name)
        elif outside:
            self.cut.append((outside / voxels, name))
        elif not there:
            self.small.append(name)

    def sentences(self) -> list[str]:
        """Returns what to say, one sentence for each kind."""
        said = []
        if self.empty:
            segments = counted(len(self.empty), "segment is", "segments are")
            said.append(f"{segments} empty: {listed(self.empty)}")
        if self.small:
            said.append(f"smaller than a voxel, so not on the scan: {listed(self.small)}")
        if self.outside:
            # what is lost most comes first
            worst = sorted(self.cut, key=lambda one: -one[0])
            voxels = counted(self.outside, "voxel of segments lies", "voxels of segments lie")
            names = listed([f"{name} ({percent(share)})" for share, name in worst])
            share = percent(self.outside / self.voxels)
            said.append(f"{voxels} outside the scan ({share}): {names}")
        return said
