"""What a session can do with tools: which is in the hand, and its strokes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import astuple
from typing import Literal

from palpate.session.needle import NeedleEvent, Tissue
from palpate.session.part import SessionPart, given

__all__ = ["SessionTools"]

AIR = -1000.0
"""What a scan in HU reads where the drill has taken matter away."""

CORTICAL_ENERGY = 1300.0
"""Work of the drill per volume of cortical bone [mJ/mm³] (docs/understand/tools.md)."""


class SessionTools(SessionPart):
    """Tools of a session."""

    def set_tool(
        self,
        kind: Literal["eraser", "adder", "drill", "needle", "painter"] | None,
        *,
        radius: float = 1.0,
        segment_ids: Sequence[int] = (),
        tissues: Sequence[Tissue] = (),
        depth: float | None = None,
        overlaps: bool = False,
    ) -> None:
        """Chooses the tool for the next strokes; a stroke that is on ends.

        The eraser frees voxels of the segments along the probe's way, the adder makes them
        solid, the drill removes matter by the work that touch does on it. Where the scan's unit
        is not HU, the drill takes the same work for each mm³, that of cortical bone, and leaves
        the scan's lowest value behind. The needle changes nothing: it goes into the segments, and
        they are no obstacle for it until it is out. The painter gives what is touched of the
        segments to the first of them; what is solid stays so.

        Args:
            kind: Which tool; None empties the hand.
            radius: Of the tool's ball [mm].
            segment_ids: Segments that it may change, or go into.
            tissues: What each of them is for the needle.
            depth: How deep below the surface the painter paints [mm]; None is all of its ball.
            overlaps: Whether what is painted stays in the segments that have it, too.

        Raises:
            OptionError: Radius or depth do not fit the voxels, or there is no such segment.
        """
        with given():
            if kind is None:
                self._internal.set_tool(None)
                return
            volume = self.scene.volume
            is_density = volume.unit == "HU"
            self._internal.set_tool(
                kind,
                radius=radius,
                segment_ids=list(segment_ids),
                air=AIR if is_density else volume.range[0],
                energy=None if is_density else CORTICAL_ENERGY,
                tissues=[astuple(tissue) for tissue in tissues],
                paint=(depth, overlaps),
            )

    def needle_events(self) -> list[NeedleEvent]:
        """Returns what happened to the needle since it was taken in the hand, oldest first."""
        with given():
            return [NeedleEvent(*event) for event in self._internal.needle_events()]

    def withdraw_needle(self) -> bool:
        """Takes the needle out on the way that it went in; returns whether one was in.

        Raises:
            OptionError: There is no free voxel near where it went in.
        """
        with given():
            return self._internal.withdraw_needle()

    def stroke(self, *, on: bool) -> None:
        """Begins a stroke of the chosen tool, or ends it: it is one step of undo.

        Raises:
            OptionError: It is to begin, and no tool is chosen.
        """
        with given():
            self._internal.stroke(on)
