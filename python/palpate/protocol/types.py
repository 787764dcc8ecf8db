"""Named types of the messages between engine and page, with their bounds.

Points and vectors are (x, y, z) in the scene frame, LPS [mm]; forces [N]; stiffness [N/mm]; times
[s]. The sentence after a name is written into the page's source too.
"""

from __future__ import annotations

from typing import Annotated, Literal

import msgspec

from palpate.volumes import appearance

__all__ = [
    "BeforeOrAfter",
    "Calibration",
    "ClipPlanes",
    "Colour",
    "Coordinate",
    "ForceSource",
    "Friction",
    "GridPlace",
    "Index",
    "KeptName",
    "KeptValue",
    "LightAmount",
    "LightFactor",
    "LinearColour",
    "Message",
    "ModelName",
    "Motion",
    "Name",
    "NeedleEventKind",
    "NodeCount",
    "PointPair",
    "Pose",
    "RegistrationKind",
    "RegistrationMetric",
    "RegistrationStart",
    "SegmentId",
    "ShapeKind",
    "Share",
    "ShownAs",
    "SmoothingDegree",
    "StepKind",
    "Stiffness",
    "SurfaceSource",
    "TissueName",
    "ToolKind",
    "Treatment",
    "Value",
    "Vector",
]

Coordinate = Annotated[float, msgspec.Meta(ge=-1e6, le=1e6)]
"""A coordinate of a vector; the bounds exclude NaN, infinity and absurd distances."""

Vector = tuple[Coordinate, Coordinate, Coordinate]
"""x, y, z in the scene frame, LPS [mm]; forces [N]."""

ClipPlanes = Annotated[list[tuple[Vector, Coordinate]], msgspec.Meta(max_length=16)]
"""Planes: a unit normal toward what is cut away, and ``normal · point`` of their points [mm]."""

PointPair = tuple[Vector, Vector]
"""The same place in two scans."""

Value = Annotated[float, msgspec.Meta(ge=-1e9, le=1e9)]
"""A value of the scan, in its unit; the bounds exclude NaN and infinity."""

Name = Annotated[str, msgspec.Meta(min_length=1, max_length=100)]
"""Name of a segment."""

KeptName = Annotated[
    str, msgspec.Meta(min_length=1, max_length=80, pattern=r"^[a-z]{1,24}(\.[0-9a-f]{1,40})?\Z")
]
"""Name of a part of what is kept with a scan, such as "clip" or "mark.1f"."""

KeptValue = Annotated[str, msgspec.Meta(min_length=1, max_length=65536)]
"""A part of what is kept with a scan, as JSON; only pages understand it."""

SegmentId = Annotated[int, msgspec.Meta(ge=1, le=255)]
"""Number of a segment; also its value in ``/api/labels``."""

Share = appearance.Share
"""A fraction, 0 to 1."""

Colour = appearance.Colour
"""Red, green, blue, sRGB, each 0 to 1."""

LightAmount = Annotated[float, msgspec.Meta(ge=0.0, le=16.0)]
"""Red, green or blue light, linear; 1 is white."""

LinearColour = tuple[LightAmount, LightAmount, LightAmount]
"""Red, green, blue, linear."""

Stiffness = Annotated[float, msgspec.Meta(gt=0.0, le=10.0)]
"""Stiffness of the spring between probe and device [N/mm]."""

Friction = Annotated[float, msgspec.Meta(ge=0.0, le=2.0)]
"""A Coulomb coefficient."""

ShownAs = appearance.ShownAs
"""How a segment is drawn: from its voxels, as a surface, or both."""

SurfaceSource = appearance.SurfaceSource
"""What a surface is made from: the scan's values where a threshold made the segment, or its voxels.
"""

LightFactor = appearance.LightFactor
"""Factor of the light of one segment, relative to that of the picture."""

SmoothingDegree = appearance.SmoothingDegree
"""Number of times that vertices of a surface are moved to the mean of their neighbours."""

ShapeKind = Literal[
    "keep-largest",
    "drop-small",
    "fill-holes",
    "between-slices",
    "grow",
    "shrink",
    "smooth",
    "median",
    "joint",
    "open",
    "close",
    "hollow-inside",
    "hollow-outside",
    "unite",
    "subtract",
    "intersect",
]
"""Operation on the shape of a segment; see ``segmentation.changed_shape``."""

StepKind = Literal[ShapeKind, "by-hand"]
"""Step of a segment: a change of its shape, or what was painted, erased or drilled."""

RegistrationKind = Literal["rigid", "affine", "bspline"]
"""Transform of a registration: rigid, affine, or deformable as well."""

RegistrationMetric = Literal["automatic", "mutual-information", "correlation", "mean-squares"]
"""Similarity of two scans; automatic depends on their modalities."""

RegistrationStart = Literal["as-it-stands", "centre", "moments", "landmarks"]
"""Start of a registration: the current place of the second scan; centres of the grids or of bright
voxels; pairs of points."""

BeforeOrAfter = Literal["before", "after"]

ToolKind = Literal["none", "eraser", "adder", "drill", "needle", "painter"]
"""Tool at the probe; none changes nothing."""

TissueName = Literal["skin", "fat", "muscle", "liver"]
"""Tissue of a segment for a needle; bone is not among them, since a needle does not puncture it."""

NeedleEventKind = Literal["punctured", "crossed", "stopped", "withdrawn"]
"""Event of a needle: it punctures a segment, crosses into one that it has punctured or out of all,
is stopped, or is withdrawn."""

Treatment = Literal["deformable", "rigid", "empty"]
"""How a region takes part in deformation: it deforms, is rigid, or counts as empty."""

ForceSource = Literal["matter", "voxels"]
"""Source of the force of soft tissue on a tool: the model, or voxels that are rigid until moved."""

Calibration = Literal["young", "wave-speed"]
"""How the stiffness of particles follows from the material: from Young's modulus or wave speed."""

Motion = Literal["scaled-time", "fire"]
"""How particles come to rest: in scaled time with damping, or by FIRE."""

ModelName = Annotated[str, msgspec.Meta(min_length=1, max_length=40)]
"""Name of a deformation model."""

Index = Annotated[int, msgspec.Meta(ge=-(2**31), lt=2**31)]
"""Place of a voxel or a patch along one axis."""

NodeCount = Annotated[int, msgspec.Meta(ge=0, le=1024)]
"""Nodes of a box along one axis."""

GridPlace = tuple[Index, Index, Index]
"""A voxel or a patch of a grid, along x, y, z."""

Pose = Annotated[list[Coordinate], msgspec.Meta(min_length=16, max_length=16)]
"""A rigid transform of the scene, row-major, shape [4, 4], translation in mm."""


class Message(msgspec.Struct, frozen=True, forbid_unknown_fields=True, tag_field="type"):
    """Base of all messages: a map with its type's name under ``type``."""
