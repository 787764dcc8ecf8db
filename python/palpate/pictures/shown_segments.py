"""Segments of a scene as a picture shows them: bodies and surfaces (shown_segments.ts)."""

from __future__ import annotations

from dataclasses import dataclass

from palpate import _core
from palpate.pictures.appearance import ShownSegment, ShownSurface
from palpate.pictures.felt_look import is_felt
from palpate.pictures.transfer import linear_from_srgb
from palpate.volumes.scene import Scene, SceneSegment
from palpate.volumes.surface import drawn_surface

__all__ = ["ShownBodies", "bodies_of"]


@dataclass(frozen=True)
class ShownBodies:
    """What a renderer takes of the segments of a scene."""

    voxels: tuple[tuple[int, _core.Segment], ...] = ()
    """Voxels on the grid of the scan, by the numbers that they have in the picture."""
    shown: tuple[ShownSegment, ...] = ()
    """How they look; visible ones win where several claim a value."""
    triangles: tuple[tuple[int, _core.Surface], ...] = ()
    """Surfaces, by the same numbers."""
    surfaces: tuple[ShownSurface, ...] = ()
    """How these look."""


def bodies_of(scene: Scene, *, touchable_only: bool = False) -> ShownBodies:
    """Returns the segments of a scene that do not look as the scan does.

    Args:
        scene: The scan and its segments.
        touchable_only: Segments that the probe passes through are hidden.
    """
    voxels: list[tuple[int, _core.Segment]] = []
    shown: list[ShownSegment] = []
    triangles: list[tuple[int, _core.Surface]] = []
    surfaces: list[ShownSurface] = []
    for number, one in enumerate(scene, start=1):
        # one that stands elsewhere than the scan's voxels has nothing but its surface
        own = one.segment.has_own_grid
        visible = one.visible and (is_felt(one) or not touchable_only)
        has_surface = visible and (own or one.shown_as != "volume") and one.appearance.opacity > 0.0
        if has_surface:
            look = one.appearance
            made = drawn_surface(one.segment, smoothing=look.smoothing, source=look.surface_from)
            triangles.append((number, made))
            surfaces.append(_surface(number, one))
        solid = visible and one.shown_as != "surface"
        # a hidden one looks as the scan does, but where a threshold tells it from the rest
        if not own and (solid or has_surface or one.segment.range is not None):
            voxels.append((number, one.segment._internal))  # noqa: SLF001  # what the engine takes
            shown.append(_shown(number, one, solid=solid))
    shown.sort(key=lambda each: each.shown == "hidden")
    return ShownBodies(tuple(voxels), tuple(shown), tuple(triangles), tuple(surfaces))


def _shown(number: int, one: SceneSegment, *, solid: bool) -> ShownSegment:
    body = one.segment
    return ShownSegment(
        id=number,
        range=body.made_by,
        edited=body.range is None and body.made_by is not None,
        shown="solid" if solid else "hidden",
        colour=linear_from_srgb(one.colour),
        ambient=one.appearance.ambient,
        specular=one.appearance.specular,
    )


def _surface(number: int, one: SceneSegment) -> ShownSurface:
    return ShownSurface(
        id=number,
        colour=linear_from_srgb(one.colour),
        opacity=one.appearance.opacity,
        wireframe=one.appearance.wireframe,
        ambient=one.appearance.ambient,
        specular=one.appearance.specular,
    )
