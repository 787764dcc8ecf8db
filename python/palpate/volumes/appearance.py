"""How a segment is shown: the one structure that scenes, journals and messages share."""

from __future__ import annotations

from typing import Annotated, Literal

import msgspec

__all__ = [
    "DEFAULT_SMOOTHING",
    "Colour",
    "LightFactor",
    "SegmentAppearance",
    "Share",
    "ShownAs",
    "SmoothingDegree",
    "SurfaceSource",
]

Share = Annotated[float, msgspec.Meta(ge=0.0, le=1.0)]
"""A part of a whole, 0..1."""

Colour = tuple[Share, Share, Share]
"""Red, green, blue, sRGB, each 0..1."""

ShownAs = Literal["volume", "surface", "both"]
"""Drawn from voxels, as a surface, or in both ways."""

SurfaceSource = Literal["intensities", "bits"]
"""What a surface is made from: values of the scan, or bits of the segment, which have stairs."""

LightFactor = Annotated[float, msgspec.Meta(ge=0.0, le=3.0)]
"""On the light of one segment: 1 is that of the picture."""

SmoothingDegree = Annotated[int, msgspec.Meta(ge=0, le=12)]
"""How often the vertices of a surface are moved to the mean of their neighbours."""

DEFAULT_SMOOTHING: SmoothingDegree = 3
"""Takes the steps of voxels away and keeps what is larger than a few of them."""


class SegmentAppearance(msgspec.Struct, frozen=True):
    """How a segment is shown.

    ``opacity``, ``smoothing``, ``surface_from`` and ``wireframe`` are those of its surface;
    ``ambient`` and ``specular`` are factors on its light. What is hidden cannot be touched, unless
    it is ``touched_while_hidden``. Names of fields are serialised.
    """

    name: str
    colour: Colour
    visible: bool
    touched_while_hidden: bool
    shown_as: ShownAs
    opacity: Share
    smoothing: SmoothingDegree
    surface_from: SurfaceSource
    wireframe: bool
    ambient: LightFactor
    specular: LightFactor
