"""Soft tissue in a session: materials, regions, deformation models and their force."""

from __future__ import annotations

from collections.abc import Sequence

from palpate.base.errors import OptionError
from palpate.session.deformation_state import ModelParts
from palpate.session.engine import Engine, option_errors
from palpate.session.model_options import Deformation, ModelOptions
from palpate.session.regions import Regions
from palpate.volumes.material import (
    ForceSource,
    LinearMaterial,
    Material,
    Region,
    require_hounsfield,
)

__all__ = ["SessionSoftTissue"]

DEFAULTS = ModelOptions()


class SessionSoftTissue:
    """What segments are made of, and how they deform."""

    def __init__(self, engine: Engine, regions: Regions, *, unit: str) -> None:
        """Takes the engine, the regions of segments, and the unit of the scan's values."""
        self._engine = engine
        self._regions = regions
        self._unit = unit

    def set_deformation(
        self, model: str | None, options: ModelOptions = DEFAULTS, *, undoable: bool = True
    ) -> None:
        """Chooses the model that deforms soft tissue under the probe.

        Only segments with a material deform (``set_material``); all others are rigid. What the
        probe deforms between contact and release is one step of undo.

        Args:
            model: A name of ``palpate.session.model_options.deformation_models()``; None makes
                every segment rigid.
            options: Options of the model.
            undoable: Whether the choice is a step of undo.

        Raises:
            OptionError: There is no such model, or an option is not allowed.
        """
        with option_errors():
            self._engine.set_deformation(model, options, undoable)

    def set_material(
        self,
        segment_id: int,
        material: Material | LinearMaterial | str | None,
        *,
        undoable: bool = True,
    ) -> None:
        """Sets the material of a segment.

        The friction of the material applies where the segment has none of its own (``set_feel``).

        Args:
            segment_id: Number of the segment.
            material: Constants, or a name of ``palpate.material_presets()``; None makes the segment
                rigid.
            undoable: Whether this is a step of undo.

        Raises:
            OptionError: There is no such segment or name, the constants are out of range, or they
                depend on HU and the scan's values are not known to be HU.
        """
        require_hounsfield(material, unit=self._unit)
        self.restore_material(segment_id, material, undoable=undoable)

    def restore_material(
        self,
        segment_id: int,
        material: Material | LinearMaterial | str | None,
        *,
        undoable: bool,
    ) -> None:
        """Sets a material as ``set_material``, whatever is known of the unit of the scan's values.

        Raises:
            OptionError: There is no such segment or name, or the constants are out of range.
        """
        with option_errors():
            match material:
                case str():
                    self._engine.set_material(segment_id, undoable, name=material)
                case LinearMaterial(interval, low, high):
                    self._engine.set_material(
                        segment_id, undoable, linear=(interval, tuple(low), tuple(high))
                    )
                case None:
                    self._engine.set_material(segment_id, undoable)
                case Material():
                    self._engine.set_material(segment_id, undoable, constant=tuple(material))
                case _:
                    raise OptionError(
                        f"material {material!r} given; allowed: a Material, a LinearMaterial, a "
                        "name of palpate.material_presets(), or None"
                    )

    def set_regions(self, segment_id: int, regions: Sequence[Region]) -> None:
        """Sets how regions of a segment with a material take part in deformation.

        Undo does not change regions.

        Args:
            segment_id: Number of the segment.
            regions: The last region that contains a voxel applies to it; voxels in no region
                deform.

        Raises:
            OptionError: There is no such segment, or a region or its treatment is not valid.
        """
        self._regions.assign(segment_id, regions)

    def regions(self, segment_id: int) -> tuple[Region, ...]:
        """Returns the regions of a segment; none where all of it deforms."""
        return self._regions.of(segment_id)

    def set_force_source(self, source: ForceSource) -> None:
        """Chooses where the force of soft tissue on a tool comes from.

        Args:
            source: ``"matter"``, the default, is the contact force of the model; ``"voxels"`` is
                that of voxels which are rigid until the model has displaced them (thesis 5.23).

        Raises:
            OptionError: The name is neither of them.
        """
        with option_errors():
            self._engine.set_force_source(source)

    def deformation(self) -> Deformation:
        """Returns the state of the deformation model.

        Returns:
            ``model`` (None where every segment is rigid), its ``options``, ``force_source``,
            ``force`` of the tissue on the tool [N, scene], whether it is sent or not, ``answers``
            so far, ``slips`` (answers in which particles slipped), and whether the next answer is
            ``late`` (a hand at rest feels the last one then). Of the last answer: ``iterations``,
            ``residual`` (unbalanced force relative to the contact force), whether the tissue is
            still ``settling`` or computed in a ``small_box`` on a slow computer, ``nodes``,
            ``moved_voxels`` (displaced from rest) and ``lasting_voxels`` (those of them that stay
            displaced). Since the start: ``bonds_broken`` and ``work_broken`` [N·mm].
        """
        state = self._engine.deformation()
        return {**state, "options": ModelOptions.of_state(state["options"])}

    def show_model_parts(self, *, on: bool) -> None:
        """Starts or stops making the nodes or particles of the model for ``model_parts``."""
        self._engine.show_model_parts(on)

    def model_parts(self) -> ModelParts | None:
        """Returns the newest nodes or particles of the model, with their strains.

        Returns:
            The fields of ``protocol.MatterParts``; None where they are not shown, or were returned
            before.
        """
        return self._engine.model_parts()
