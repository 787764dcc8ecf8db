"""How a scan is drawn: everything but the camera.

Values are in the scan's unit, lengths in mm, colours linear RGB from 0 to 1.
"""

from __future__ import annotations

from typing import Literal

import msgspec

__all__ = [
    "Appearance",
    "Lighting",
    "Mode",
    "SecondAppearance",
    "Shown",
    "ShownSegment",
    "ShownSurface",
    "Tint",
    "Turns",
]

Colour = tuple[float, float, float]
Mode = Literal["shaded", "composite", "absorption", "emission", "mip", "minip", "average", "iso"]
Shown = Literal["solid", "tinted", "hidden"]
Tint = Literal["warm", "cool", "grey"]
Turns = Literal["together", "cells", "second"]


class Lighting(msgspec.Struct, frozen=True, kw_only=True):
    """Factors on the light of the picture, as the page has them (appearance.ts)."""

    ambient: float = 1.0
    diffuse: float = 1.0
    specular: float = 1.0
    shininess: float = 1.0
    """On the exponent of highlights."""
    edges: float = 0.94
    """Fraction of its extinction that homogeneous tissue loses (Levoy, IEEE CG&A 8, 1988)."""
    occlusion: float = 0.8
    """How much of ambient occlusion and of shadows is seen, 0 to 1."""
    shadow: float = 0.6


class ShownSegment(msgspec.Struct, frozen=True, kw_only=True):
    """A segment that does not look as the scan does."""

    id: int
    range: tuple[float, float] | None
    """Limits of the threshold that made it, both included; None where its voxels alone tell."""
    edited: bool = False
    """It was edited after its threshold."""
    shown: Shown = "solid"
    colour: Colour
    ambient: float = 1.0
    specular: float = 1.0


class ShownSurface(msgspec.Struct, frozen=True, kw_only=True):
    """A segment whose surface of triangles is drawn."""

    id: int
    colour: Colour
    opacity: float = 1.0
    """Above 0; with 1 nothing is seen behind it."""
    wireframe: bool = False
    """Only the sides of its triangles are drawn."""
    ambient: float = 1.0
    specular: float = 1.0


class SecondAppearance(msgspec.Struct, frozen=True, kw_only=True):
    """How a second scan is drawn through the first, in its own unit."""

    density: float = 1.0
    transfer: tuple[tuple[float, Colour, float], ...]
    edge_gradient: float
    window: tuple[float, float]
    iso_value: float
    iso_colour: Colour
    tissue_from: float
    tint: Tint = "warm"
    """Its colours from black to white in modes of grey."""
    opacity: float = 0.5
    """Of its colours in modes of grey, and of its iso-surface, 0 to 1; by turns it is 1."""
    turns: Turns = "together"
    """Both scans through one another, one or the other in cells, or the second where it is."""
    cells: float = 20.0
    """Edge of a cell [mm], along the first scan's axes from its corner."""


class Appearance(msgspec.Struct, frozen=True, kw_only=True):
    """Everything but the camera that decides how a scan is drawn."""

    mode: Mode = "shaded"
    density: float = 1.0
    """Factor on all extinction."""
    transfer: tuple[tuple[float, Colour, float], ...]
    """Value, colour and extinction [1/mm] of at least two points by rising value."""
    edge_gradient: float
    """Gradient from which on a boundary of tissue has its full strength [value per mm]."""
    window: tuple[float, float]
    """Width and middle of the window in modes of grey."""
    iso_value: float
    iso_colour: Colour
    tissue_from: float
    """MinIP and average count from the first to the last place of a ray with this value or more."""
    slab: float | None = None
    """Thickness of what is looked at around the middle of the view [mm]; None: everything."""
    lighting: Lighting = Lighting()
    segments: tuple[ShownSegment, ...] = ()
    """In the order in which they win where several claim a value."""
    surfaces: tuple[ShownSurface, ...] = ()
    """Of segments that the renderer has surfaces of."""
    clip: tuple[tuple[Colour, float], ...] = ()
    """Planes: unit normal toward what is cut away, ``normal · point`` of its points [mm]; LPS."""
    second: SecondAppearance | None = None
    """A second scan, where there is one."""
