"""Matter that gives way, as pages see it: what can be chosen, and what segments are made of."""

from __future__ import annotations

import math
from collections.abc import Iterable

import msgspec

from palpate import protocol
from palpate.session.deformation_state import ModelParts
from palpate.session.model_options import ModelOptions, Prony, offered_models
from palpate.session.segment_state import SegmentState
from palpate.volumes.material import Material, Region, material_presets

__all__ = [
    "asked_material",
    "asked_options",
    "asked_regions",
    "material_of",
    "models",
    "parts_of",
    "presets",
    "regions_of",
]


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
    """Lists the models by which matter gives way."""
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
        )
        for each in offered_models()
    ]


def asked_options(wanted: protocol.ModelOptions) -> ModelOptions:
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
    )


def material_of(state: SegmentState) -> protocol.SegmentMaterial | None:
    """Returns what a segment of ``Session.segments`` is made of; None where it is hard."""
    material = state["material"]
    if material is None:
        return None
    return protocol.SegmentMaterial(
        preset=material["preset"],
        low=_constants(Material(*material["low"])),
        high=_constants(Material(*material["high"])),
    )


def asked_material(wanted: protocol.SetMaterial) -> Material | str | None:
    """Returns the material that a page asks for; None is hard matter."""
    if wanted.preset is not None or wanted.constants is None:
        return wanted.preset
    constants = msgspec.structs.asdict(wanted.constants)
    breaking = constants.pop("breaking_strain")
    return Material(**constants, breaking_strain=math.inf if breaking is None else breaking)


def regions_of(regions: Iterable[Region]) -> list[protocol.MatterRegion]:
    """Returns regions of a segment as pages are told them."""
    return [
        protocol.MatterRegion(treatment=each.treatment, shared_with=each.shared_with, box=each.box)
        for each in regions
    ]


def asked_regions(wanted: protocol.SetRegions) -> list[Region]:
    """Returns the regions that a page asks for."""
    return [
        Region(each.treatment, box=each.box, shared_with=each.shared_with)
        for each in wanted.regions
    ]


def parts_of(parts: ModelParts) -> protocol.MatterParts:
    """Returns the parts of ``Session.model_parts`` as pages are told them."""
    return msgspec.convert(parts, protocol.MatterParts)


def _constants(material: Material) -> protocol.Constants:
    breaking = material.breaking_strain
    return protocol.Constants(
        young=material.young,
        poisson=material.poisson,
        density=material.density,
        breaking_strain=breaking if math.isfinite(breaking) else None,
        friction=material.friction,
    )
