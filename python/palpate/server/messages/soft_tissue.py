"""Messages on soft tissue: models and materials to choose from, and what segments are made of."""

from __future__ import annotations

import math
from collections.abc import Iterable

import msgspec

from palpate import protocol
from palpate.server.messages.outbox import Outbox
from palpate.server.messages.table import MessageTable, Runs
from palpate.session.model_options import ModelOptions, Prony, offered_models
from palpate.session.segment_state import SegmentState
from palpate.session.session import Session
from palpate.volumes.material import Material, Region, material_presets

__all__ = [
    "ModelParts",
    "SoftTissueMessages",
    "material_of",
    "models",
    "presets",
    "regions_of",
    "wanted_material",
]


class SoftTissueMessages:
    """Does what pages ask of deformation."""

    def __init__(self, session: Session) -> None:
        """Sets models and materials of a session."""
        self._session = session

    def add_to(self, table: MessageTable) -> None:
        """Adds the rows of soft tissue."""
        table.add(protocol.SetDeformation, self._set_deformation, runs=Runs.IN_ORDER)
        table.add(protocol.SetForceSource, self._set_force_source, runs=Runs.IN_ORDER)
        table.add(protocol.SetMaterial, self._set_material, runs=Runs.IN_ORDER)
        table.add(protocol.SetRegions, self._set_regions, runs=Runs.IN_ORDER)

    def _set_deformation(self, wanted: protocol.SetDeformation, _: Outbox) -> None:
        self._session.set_deformation(
            wanted.model, _wanted_options(wanted.options), undoable=wanted.undoable
        )

    def _set_force_source(self, wanted: protocol.SetForceSource, _: Outbox) -> None:
        self._session.set_force_source(wanted.source)

    def _set_material(self, wanted: protocol.SetMaterial, _: Outbox) -> None:
        self._session.set_material(wanted.id, wanted_material(wanted), undoable=wanted.undoable)

    def _set_regions(self, wanted: protocol.SetRegions, _: Outbox) -> None:
        self._session.set_regions(wanted.id, _wanted_regions(wanted))


class ModelParts:
    """The parts of the model of deformation, published to the pages that draw them."""

    def __init__(self, session: Session) -> None:
        """Begins with no page that draws them."""
        self._session = session
        self._pages: set[Outbox] = set()

    def add_to(self, table: MessageTable) -> None:
        """Adds the row by which pages ask for the parts."""
        table.add(protocol.ShowParts, self._show, runs=Runs.ON_LOOP)

    def leave(self, page: Outbox) -> None:
        """Forgets a page that has gone."""
        self._pages.discard(page)
        self._apply()

    def publish(self) -> None:
        """Publishes the parts where they have changed."""
        parts = self._session.model_parts() if self._pages else None
        if parts is not None:
            message = msgspec.convert(parts, protocol.MatterParts)
            for page in self._pages:
                page.put(message)

    def _show(self, message: protocol.ShowParts, page: Outbox) -> None:
        if message.on:
            self._pages.add(page)
        else:
            self._pages.discard(page)
        self._apply()

    def _apply(self) -> None:
        self._session.show_model_parts(on=bool(self._pages))


def presets() -> list[protocol.MaterialPreset]:
    """Lists the materials that have a name."""
    return [
        protocol.MaterialPreset(
            name=preset.name,
            source=preset.source,
            needs_hounsfield=preset.needs_hounsfield,
            low=_constants(preset.low),
            high=_constants(preset.high),
        )
        for preset in material_presets()
    ]


def models() -> list[protocol.DeformationModel]:
    """Lists the models of deformation."""
    return [
        protocol.DeformationModel(
            name=each.name,
            title=each.title,
            bonded=each.bonded,
            boxes=None if each.boxes is None else protocol.Boxes(*each.boxes),
            binding=None if each.binding is None else protocol.Shares(*each.binding),
            walls=each.walls,
            fades=None
            if each.fades is None
            else protocol.Fading(*(protocol.Range(*each) for each in each.fades)),
            yields=None if each.yields is None else protocol.Range(*each.yields),
            layers=each.layers,
            calibration=each.calibration,
            motion=each.motion,
            whole_segment=each.whole_segment,
        )
        for each in offered_models()
    ]


def _wanted_options(wanted: protocol.ModelOptions) -> ModelOptions:
    """Returns the options of a model that a page asks for."""
    prony = None if wanted.prony is None else Prony(wanted.prony.share, wanted.prony.time)
    return ModelOptions(
        edge=wanted.edge,
        binding=wanted.binding,
        walls=wanted.walls,
        prony=prony,
        yield_strain=wanted.yield_strain,
        layers=wanted.layers,
        calibration=wanted.calibration,
        motion=wanted.motion,
        whole_segment=wanted.whole_segment,
    )


def material_of(state: SegmentState) -> protocol.SegmentMaterial | None:
    """Returns what a segment of ``Session.segments`` is made of; None where it is rigid."""
    material = state["material"]
    if material is None:
        return None
    return protocol.SegmentMaterial(
        preset=material["preset"],
        low=_constants(Material(*material["low"])),
        high=_constants(Material(*material["high"])),
    )


def wanted_material(wanted: protocol.SetMaterial) -> Material | str | None:
    """Returns the material that a page asks for; None is a rigid segment."""
    if wanted.preset is not None or wanted.constants is None:
        return wanted.preset
    constants = msgspec.structs.asdict(wanted.constants)
    breaking = constants.pop("fracture_energy")
    return Material(**constants, fracture_energy=math.inf if breaking is None else breaking)


def regions_of(regions: Iterable[Region]) -> list[protocol.MatterRegion]:
    """Returns regions of a segment as they are published."""
    return [
        protocol.MatterRegion(treatment=each.treatment, shared_with=each.shared_with, box=each.box)
        for each in regions
    ]


def _wanted_regions(wanted: protocol.SetRegions) -> list[Region]:
    """Returns the regions that a page asks for."""
    return [
        Region(each.treatment, box=each.box, shared_with=each.shared_with)
        for each in wanted.regions
    ]


def _constants(material: Material) -> protocol.Constants:
    breaking = material.fracture_energy
    return protocol.Constants(
        young=material.young,
        poisson=material.poisson,
        density=material.density,
        fracture_energy=breaking if math.isfinite(breaking) else None,
        friction=material.friction,
        stiffening=material.stiffening,
    )
