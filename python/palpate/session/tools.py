"""Tools of a session: eraser, adder, drill, needle and painter, and their strokes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import astuple
from typing import Literal

from palpate.session.air import air_of
from palpate.session.engine import Engine, Point, option_errors, triple
from palpate.session.needle import NeedleEvent, Tissue
from palpate.volumes.volume import Volume

__all__ = ["SessionTools"]


CORTICAL_ENERGY = 1300.0
"""Work of the drill per volume of cortical bone [mJ/mm³] (docs/understand/tools.md)."""


class SessionTools:
    """The tool in use, and its strokes."""

    def __init__(self, engine: Engine, volume: Volume) -> None:
        """Takes the engine and the scan, whose unit decides how the drill works."""
        self._engine = engine
        self._volume = volume

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
        """Chooses the tool for the next strokes; a stroke in progress ends.

        - The eraser removes voxels from segments along the path of the probe, the adder adds them.
        - The drill removes voxels by the work of the contact force. In a scan whose unit is not HU
          every mm³ takes the work of cortical bone, and drilled voxels get the scan's lowest value.
        - The needle changes nothing. It enters segments, which are no obstacle for it until it is
          withdrawn.
        - The painter adds the touched voxels of segments to the first of them. They stay solid.

        Args:
            kind: Name of the tool; None for no tool.
            radius: Radius of the tool's ball [mm].
            segment_ids: Segments that the tool may change or enter.
            tissues: For the needle: the tissue of each of these segments.
            depth: For the painter: how deep it paints below the surface [mm]; None for its whole
                ball.
            overlaps: For the painter: whether painted voxels also stay in their segment.

        Raises:
            OptionError: Radius or depth do not fit the voxels, or there is no such segment.
        """
        with option_errors():
            if kind is None:
                self._engine.set_tool(None)
                return
            is_density = self._volume.unit == "HU"
            self._engine.set_tool(
                kind,
                radius=radius,
                segment_ids=list(segment_ids),
                air=air_of(self._volume),
                energy=None if is_density else CORTICAL_ENERGY,
                tissues=[astuple(tissue) for tissue in tissues],
                paint=(depth, overlaps),
            )

    def needle_events(self) -> list[NeedleEvent]:
        """Returns what happened to the needle since it was chosen, oldest first."""
        with option_errors():
            return [NeedleEvent(*event) for event in self._engine.needle_events()]

    def set_needle_direction(self, direction: Point | None) -> None:
        """Sets the direction in which the needle enters from now on.

        Where a direction is set, the needle enters along it through the touched point. A push more
        than 63° off it does not puncture, and neither does one where the line does not lead into
        what is touched. A needle that is inserted stays on its line.

        Args:
            direction: Inward, LPS, of any length; None for the direction of the push.

        Raises:
            OptionError: The direction is zero or not finite.
        """
        with option_errors():
            self._engine.set_needle_direction(
                None if direction is None else triple("direction", direction)
            )

    def withdraw_needle(self) -> bool:
        """Withdraws the needle along the path on which it was inserted.

        Returns:
            Whether a needle was inserted.

        Raises:
            OptionError: There is no free voxel near the entry point.
        """
        with option_errors():
            return self._engine.withdraw_needle()

    def stroke(self, *, on: bool) -> None:
        """Begins or ends a stroke of the tool; a stroke is one step of undo.

        Args:
            on: Whether a stroke begins.

        Raises:
            OptionError: A stroke is to begin, and no tool is chosen.
        """
        with option_errors():
            self._engine.stroke(on)
