"""How regions of segments take part in deformation, kept beside the engine.

The engine forgets the regions of a segment that is removed. They are kept here, so that undo and
redo bring them back with their segment.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress

from palpate.base.errors import OptionError
from palpate.session.engine import Engine, option_errors
from palpate.volumes.material import Region

__all__ = ["Regions"]


class Regions:
    """The regions of all segments of a session."""

    def __init__(self, engine: Engine) -> None:
        """Starts without regions."""
        self._engine = engine
        self._regions: dict[int, tuple[Region, ...]] = {}

    def of(self, segment_id: int) -> tuple[Region, ...]:
        """Returns the regions of a segment."""
        return self._regions.get(segment_id, ())

    def assign(self, segment_id: int, regions: Sequence[Region]) -> None:
        """Sets the regions of a segment.

        Raises:
            OptionError: There is no such segment, or a region is not valid.
        """
        before = self.of(segment_id)
        # stored before the engine reports a change: whoever reads them then finds the new ones
        self._regions[segment_id] = tuple(regions)
        try:
            self._pass_on(segment_id)
        except OptionError:
            self._regions[segment_id] = before
            raise

    def clear_for_new(self, segment_id: int) -> int:
        """Drops the regions that an earlier segment of this number had; returns the number."""
        if self._regions.pop(segment_id, ()):
            self._pass_on(segment_id)
        return segment_id

    @contextmanager
    def restored(self) -> Iterator[None]:
        """Passes regions to the engine again for segments that come back inside the block."""
        before = self._present()
        yield
        for segment_id in (self._present() - before) & self._regions.keys():
            # a segment that a region refers to may be gone
            with suppress(OptionError):
                self._pass_on(segment_id)

    def _pass_on(self, segment_id: int) -> None:
        with option_errors():
            self._engine.set_regions(
                segment_id,
                [(each.treatment, each.box, each.shared_with) for each in self.of(segment_id)],
            )

    def _present(self) -> set[int]:
        """Returns the numbers of all segments; none where no regions are known."""
        if not self._regions:
            return set()
        return {state["id"] for state in self._engine.segments_state()}
