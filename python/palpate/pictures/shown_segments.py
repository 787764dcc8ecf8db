"""Segments of a scene as a picture shows them: bodies in their colours (shown_segments.ts)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from palpate import _core
from palpate.pictures.appearance import ShownSegment
from palpate.pictures.transfer import linear_from_srgb
from palpate.volumes.scene import Scene, SceneSegment
from palpate.volumes.segment import Segment
from palpate.volumes.volume import Volume

__all__ = ["ShownBodies", "bodies_of"]


@dataclass(frozen=True)
class ShownBodies:
    """What a renderer takes of the segments of a scene."""

    voxels: tuple[tuple[int, _core.Segment], ...] = ()
    """Voxels on the grid of the scan, by the numbers that they have in the picture."""
    shown: tuple[ShownSegment, ...] = ()
    """How they look; visible ones win where several claim a value."""
    told: tuple[str, ...] = ()
    """Sentences on what looks otherwise than on the page."""


def bodies_of(scene: Scene) -> ShownBodies:
    """Returns the segments of a scene that do not look as the scan does."""
    voxels: list[tuple[int, _core.Segment]] = []
    shown: list[ShownSegment] = []
    told: list[str] = []
    for number, one in enumerate(scene, start=1):
        seen = _is_seen(one)
        if not seen and one.segment.range is None:
            # a hidden one looks as the scan does, but where a threshold tells it from the rest
            continue
        body = one.segment
        if body.has_own_grid:
            body = _on_grid_of(body, scene.volume)
            told.append(f"{one.name!r} has voxels of its own and is drawn in those of the scan")
        if seen and one.shown_as != "volume" and one.appearance.opacity < 1.0:
            told.append(f"the surface of {one.name!r} is drawn opaque")
        voxels.append((number, body._internal))  # noqa: SLF001  # what the engine takes
        shown.append(_shown(number, one, body, seen=seen))
    shown.sort(key=lambda each: each.shown == "hidden")
    return ShownBodies(tuple(voxels), tuple(shown), tuple(told))


def _is_seen(one: SceneSegment) -> bool:
    """Returns whether anything of a segment is drawn."""
    return one.visible and (one.shown_as != "surface" or one.appearance.opacity > 0.0)


def _shown(number: int, one: SceneSegment, body: Segment, *, seen: bool) -> ShownSegment:
    return ShownSegment(
        id=number,
        range=body.made_by,
        edited=body.range is None and body.made_by is not None,
        shown="solid" if seen else "hidden",
        colour=linear_from_srgb(one.colour),
        ambient=one.appearance.ambient,
        specular=one.appearance.specular,
    )


def _on_grid_of(segment: Segment, volume: Volume) -> Segment:
    """Returns the voxels of a scan whose centres lie in a segment on a grid of its own."""
    mask = np.zeros(volume.shape, np.uint8)
    own_corners = np.array(list(np.ndindex(2, 2, 2))) * np.asarray(segment.volume.dimensions)
    matrix = np.linalg.inv(volume.patient_from_grid) @ segment.volume.patient_from_grid
    corners = own_corners @ matrix[:3, :3].T + matrix[:3, 3]
    low = np.maximum(np.floor(corners.min(axis=0)), 0).astype(int)
    high = np.minimum(np.ceil(corners.max(axis=0)), volume.dimensions).astype(int)
    to_patient = volume.patient_from_grid
    if (low < high).all():
        x, y = np.meshgrid(*(np.arange(low[a], high[a]) + 0.5 for a in (0, 1)))
        for z in range(low[2], high[2]):
            grid = np.stack([x, y, np.full_like(x, z + 0.5)], axis=-1).reshape(-1, 3)
            inside = segment.contains(grid @ to_patient[:3, :3].T + to_patient[:3, 3])
            mask[z, low[1] : high[1], low[0] : high[0]] = inside.reshape(x.shape)
    return volume.segment(mask, name=segment.name)
