"""Soft tissue in scene files: materials, regions, the deformation model."""

from __future__ import annotations

from typing import Literal

import msgspec
import numpy as np

from palpate.session.model_options import ModelOptions
from palpate.session.segment_state import SegmentState
from palpate.session.session import Session
from palpate.volumes.material import ForceSource, LinearMaterial, Material, Region, Treatment

__all__ = ["SavedSoftTissue", "restore_soft_tissue", "saved_soft_tissue"]


_Constants = list[float | None]
"""Fields of ``Material`` without its stiffening; None is infinite."""


class _Material(msgspec.Struct, frozen=True):
    segment: int
    preset: str | None
    constants: _Constants | None
    high: _Constants | None = None
    """Constants at the upper end of ``interval``, where they depend on HU; ``constants`` then are
    those at the lower end."""
    interval: tuple[float, float] | None = None
    stiffening: tuple[float, float] = (0.0, 0.0)
    """That of ``constants`` and of ``high``; older files have none, and older programs read the
    others without it."""


class _Region(msgspec.Struct, frozen=True):
    segment: int
    treatment: Treatment
    box: tuple[tuple[int, int, int], tuple[int, int, int]] | None
    shared_with: int | None


class SavedSoftTissue(msgspec.Struct, frozen=True, kw_only=True):
    """Fields of ``scene.json`` about soft tissue."""

    materials: list[_Material]
    model: str | None
    options: ModelOptions = ModelOptions()
    edge: int | None = None
    """Edge of the model's box, in files older than ``options``."""
    regions: list[_Region] = []
    """Of all segments, for each segment in their order; older files have none."""
    force_source: ForceSource = "matter"
    tears_by: Literal["strain", "energy"] = "strain"
    """What the fourth constant of materials is; older files have the strain that bonds bear."""


def saved_soft_tissue(session: Session) -> SavedSoftTissue:
    """Returns the soft tissue of a session."""
    segments, model = session.segments(), session.deformation()
    ids = [each["id"] for each in segments]
    regions = [
        _Region(segment_id, each.treatment, each.box, each.shared_with)
        for segment_id in ids
        for each in session.regions(segment_id)
        if each.shared_with is None or each.shared_with in ids
    ]
    return SavedSoftTissue(
        materials=[made for each in segments if (made := _material_of(each)) is not None],
        model=model["model"],
        options=model["options"],
        regions=regions,
        force_source=model["force_source"],
        tears_by="energy",
    )


def restore_soft_tissue(session: Session, saved: SavedSoftTissue) -> None:
    """Restores soft tissue into a session that has the segments.

    Raises:
        OptionError: A material or the model is not allowed.
    """
    for each in saved.materials:
        # what was made of it stays so, whatever is known of the scan's unit by now
        session._soft_tissue.restore_material(  # noqa: SLF001  # a scene restores its session
            each.segment, _given_material(each, saved.tears_by), undoable=False
        )
    for segment_id in {each.segment for each in saved.regions}:
        regions = [
            Region(each.treatment, box=each.box, shared_with=each.shared_with)
            for each in saved.regions
            if each.segment == segment_id
        ]
        session.set_regions(segment_id, regions)
    options = saved.options if saved.edge is None else ModelOptions(edge=saved.edge)
    session.set_deformation(saved.model, options, undoable=False)
    session.set_force_source(saved.force_source)


def _material_of(state: SegmentState) -> _Material | None:
    material = state["material"]
    if material is None:
        return None
    if material["preset"] is not None:
        return _Material(segment=state["id"], preset=material["preset"], constants=None)
    interval = material["interval"]
    return _Material(
        segment=state["id"],
        preset=None,
        constants=_written(material["low"]),
        high=None if interval is None else _written(material["high"]),
        interval=interval,
        stiffening=(Material(*material["low"]).stiffening, Material(*material["high"]).stiffening),
    )


def _written(constants: tuple[float, ...]) -> _Constants:
    *others, _stiffening = Material(*constants)
    return [number if np.isfinite(number) else None for number in others]


def _given_material(saved: _Material, tears_by: str) -> Material | LinearMaterial | str | None:
    if saved.constants is None:
        return saved.preset
    low = _read(saved.constants, saved.stiffening[0], tears_by)
    if saved.interval is None or saved.high is None:
        return low
    return LinearMaterial(saved.interval, low, _read(saved.high, saved.stiffening[1], tears_by))


def _read(constants: _Constants, stiffening: float, tears_by: str) -> Material:
    read = Material(*(np.inf if number is None else number for number in constants))
    read = read._replace(stiffening=stiffening)
    if tears_by == "energy":
        return read
    # bonds of 1 mm that break at that strain take this energy (docs/understand/deformation.md)
    shear = read.young / (2.0 * (1.0 + read.poisson))
    return read._replace(fracture_energy=4.5 * shear * 1e-3 * read.fracture_energy**2)
