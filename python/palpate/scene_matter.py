"""What a scene file keeps of matter that gives way: materials, regions, the model."""

from __future__ import annotations

from typing import Any

import msgspec
import numpy as np

from palpate.material import ForceSource, Material, Region, Treatment
from palpate.session import Session

__all__ = ["SavedMatter", "restore_matter", "saved_matter"]


class _Material(msgspec.Struct, frozen=True):
    segment: int
    preset: str | None
    constants: list[float | None] | None
    """Fields of ``Material``; None is infinite."""


class _Region(msgspec.Struct, frozen=True):
    segment: int
    treatment: Treatment
    box: tuple[tuple[int, int, int], tuple[int, int, int]] | None
    shared_with: int | None


class SavedMatter(msgspec.Struct, frozen=True, kw_only=True):
    """As ``scene.json`` has it, beside what it has of other things."""

    materials: list[_Material]
    model: str | None
    edge: int | None
    regions: list[_Region] = []
    """Of all segments, for each in their order; files of before have none."""
    force_source: ForceSource = "matter"


def saved_matter(session: Session) -> dict[str, Any]:
    """Returns the fields of ``SavedMatter`` as they are now."""
    segments, model = session.segments(), session.deformation()
    ids = [each["id"] for each in segments]
    regions = [
        _Region(segment_id, each.treatment, each.box, each.shared_with)
        for segment_id in ids
        for each in session.regions(segment_id)
        if each.shared_with is None or each.shared_with in ids
    ]
    return {
        "materials": [made for each in segments if (made := _material_of(each)) is not None],
        "model": model["model"],
        "edge": model["edge"],
        "regions": regions,
        "force_source": model["force_source"],
    }


def restore_matter(session: Session, saved: SavedMatter) -> None:
    """Brings what was saved into a session that has the segments.

    Raises:
        OptionError: Matter or a model cannot be so.
    """
    for each in saved.materials:
        session.set_material(each.segment, _given_material(each), undoable=False)
    for segment_id in {each.segment for each in saved.regions}:
        regions = [
            Region(each.treatment, box=each.box, shared_with=each.shared_with)
            for each in saved.regions
            if each.segment == segment_id
        ]
        session.set_regions(segment_id, regions)
    session.set_deformation(saved.model, edge=saved.edge, undoable=False)
    session.set_force_source(saved.force_source)


def _material_of(state: dict[str, Any]) -> _Material | None:
    material = state["material"]
    if material is None:
        return None
    if material["preset"] is not None:
        return _Material(segment=state["id"], preset=material["preset"], constants=None)
    constants = [number if np.isfinite(number) else None for number in material["low"]]
    return _Material(segment=state["id"], preset=None, constants=constants)


def _given_material(saved: _Material) -> Material | str | None:
    if saved.constants is None:
        return saved.preset
    return Material(*(np.inf if number is None else number for number in saved.constants))
