"""What a session can do with matter that gives way: materials, regions, models, what is felt."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from typing import Any

from palpate.base.errors import OptionError
from palpate.session.model_options import ModelOptions
from palpate.session.part import SessionPart, given
from palpate.volumes.material import (
    ForceSource,
    LinearMaterial,
    Material,
    Region,
    require_hounsfield,
)

__all__ = ["SessionMatter"]

USUAL = ModelOptions()


class SessionMatter(SessionPart):
    """Matter of a session."""

    def __init__(self) -> None:
        """Begins without regions."""
        self._regions: dict[int, tuple[Region, ...]] = {}

    def set_deformation(
        self, model: str | None, options: ModelOptions = USUAL, *, undoable: bool = True
    ) -> None:
        """Chooses the model by which matter gives way under the probe; None makes all hard.

        Segments without a material stay hard (``set_material``). What the probe moves from
        contact to release is one step of undo.

        Args:
            model: One of ``palpate.session.model_options.deformation_models()``.
            options: What of it is not as usual.
            undoable: Whether undo takes the choice back.

        Raises:
            OptionError: There is no such model, or it cannot be so.
        """
        with given():
            self._internal.set_deformation(model, options, undoable)

    def set_material(
        self,
        segment_id: int,
        material: Material | LinearMaterial | str | None,
        *,
        undoable: bool = True,
    ) -> None:
        """Tells what a segment is made of.

        Its friction is felt where the segment has none of its own (``set_feel``).

        Args:
            segment_id: Which one.
            material: Constants, or a name of ``palpate.volumes.material.material_presets()``;
                None is hard matter.
            undoable: Whether undo takes it back.

        Raises:
            OptionError: There is no such segment or name, no matter has such constants, or they
                follow HU and the scan's values are not known to be HU.
        """
        require_hounsfield(material, unit=self.scene.volume.unit)
        self._make_of(segment_id, material, undoable=undoable)

    def _make_of(
        self,
        segment_id: int,
        material: Material | LinearMaterial | str | None,
        *,
        undoable: bool,
    ) -> None:
        with given():
            match material:
                case str():
                    self._internal.set_material(segment_id, undoable, name=material)
                case LinearMaterial(interval, low, high):
                    self._internal.set_material(
                        segment_id, undoable, linear=(interval, tuple(low), tuple(high))
                    )
                case None:
                    self._internal.set_material(segment_id, undoable)
                case Material():
                    self._internal.set_material(segment_id, undoable, constant=tuple(material))

    def set_regions(self, segment_id: int, regions: Sequence[Region]) -> None:
        """Tells how regions of a segment with a material take part. Undo leaves them as they are.

        Args:
            segment_id: Which one.
            regions: Of several that hold a voxel the last counts; what is in none gives way.

        Raises:
            OptionError: There is no such segment, or a region or its treatment is none.
        """
        before = self.regions(segment_id)
        # known before the engine tells of a change: who looks then sees it
        self._regions[segment_id] = tuple(regions)
        try:
            self._tell_regions(segment_id)
        except OptionError:
            self._regions[segment_id] = before
            raise

    def regions(self, segment_id: int) -> tuple[Region, ...]:
        """Returns how regions of a segment take part."""
        return self._regions.get(segment_id, ())

    def _tell_regions(self, segment_id: int) -> None:
        with given():
            self._internal.set_regions(
                segment_id,
                [(each.treatment, each.box, each.shared_with) for each in self.regions(segment_id)],
            )

    @contextmanager
    def _keeping_regions(self) -> Iterator[None]:
        """Tells those of segments again that come back meanwhile: the engine forgets them."""
        before = self._there()
        yield
        for segment_id in (self._there() - before) & self._regions.keys():
            # what one is shared with may be gone
            with suppress(OptionError):
                self._tell_regions(segment_id)

    def _new(self, segment_id: int) -> int:
        """Returns the number of a segment that was made: another one may have had it."""
        if self._regions.pop(segment_id, ()):
            self._tell_regions(segment_id)
        return segment_id

    def _there(self) -> set[int]:
        """Returns the segments that are there; none where no regions are known."""
        if not self._regions:
            return set()
        return {state["id"] for state in self._internal.segments_state()}

    def set_force_source(self, source: ForceSource) -> None:
        """Chooses what a tool feels of matter that gives way.

        Args:
            source: ``"matter"`` (at first) is the model's own contact force; ``"voxels"`` are hard
                until the model has moved them away, as in the thesis (5.23).

        Raises:
            OptionError: It is neither.
        """
        with given():
            self._internal.set_force_source(source)

    def deformation(self) -> dict[str, Any]:
        """Returns how the deformation goes.

        Returns:
            ``model`` (None where nothing gives way), its ``options`` (``ModelOptions``),
            ``force_source``, ``force`` of the matter on the tool [N, scene], felt or not,
            ``answers`` so far, ``slips`` (of these, those in which particles slipped), whether
            the next one is ``late`` (then matter is as hard as its voxels); of the last answer
            ``iterations``, ``residual`` (what is left of unbalanced force, as a share of the
            contact's), ``nodes``, ``moved_voxels`` (not as at rest) and, of these,
            ``lasting_voxels`` that stay so; ``bonds_broken`` and ``work_broken`` [N·mm] since the
            start.
        """
        state = self._internal.deformation()
        return state | {"options": ModelOptions.of_state(state["options"])}

    def show_model_parts(self, *, on: bool) -> None:
        """Has ``model_parts`` return the nodes or particles of the model, or no more."""
        self._internal.show_model_parts(on)

    def model_parts(self) -> dict[str, Any] | None:
        """Returns the newest nodes or particles of the model with their strains.

        The keys are the fields of ``protocol.MatterParts``. None where they are not shown, or
        were returned before.
        """
        return self._internal.model_parts()
