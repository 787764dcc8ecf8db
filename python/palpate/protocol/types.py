"""Named types of the messages between engine and page, with their bounds.

Points and vectors are (x, y, z) in the scene frame, LPS [mm]; forces [N]; stiffness [N/mm];
times [s]. The sentence after a name is told to the page too.
"""

from __future__ import annotations

from typing import Annotated, Literal

import msgspec

from palpate.volumes import appearance

__all__ = [
    "BeforeOrAfter",
    "Calibration",
    "Colour",
    "Coordinate",
    "ForceSource",
    "Friction",
    "GridPlace",
    "Index",
    "LightFactor",
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
    "Stiffness",
    "SurfaceSource",
    "TissueName",
    "ToolKind",
    "Treatment",
    "Value",
    "Vector",
]

Coordinate = Annotated[float, msgspec.Meta(ge=-1e6, le=1e6)]
"""A number of a vector; the bounds keep NaN, infinity and absurd distances out."""

Vector = tuple[Coordinate, Coordinate, Coordinate]
"""x, y, z in the scene frame, LPS [mm]; forces [N]."""

PointPair = tuple[Vector, Vector]
"""The same place in two scans."""

Value = Annotated[float, msgspec.Meta(ge=-1e9, le=1e9)]
"""A value of the scan, in its unit; the bounds keep NaN and infinity out."""

Name = Annotated[str, msgspec.Meta(min_length=1, max_length=100)]
"""What a person calls a segment."""

SegmentId = Annotated[int, msgspec.Meta(ge=1, le=255)]
"""A segment's number; also its value in ``/api/labels``."""

Share = appearance.Share
"""A part of a whole, 0..1."""

Colour = appearance.Colour
"""Red, green, blue, sRGB, each 0..1."""

Stiffness = Annotated[float, msgspec.Meta(gt=0.0, le=10.0)]
"""Of the spring between probe and device [N/mm]."""

Friction = Annotated[float, msgspec.Meta(ge=0.0, le=2.0)]
"""A Coulomb coefficient."""

ShownAs = appearance.ShownAs
"""Whether a segment is drawn from its voxels, as a surface, or in both ways."""

SurfaceSource = appearance.SurfaceSource
"""What a surface is made from: the scan's values where a threshold made the segment, or bits."""

LightFactor = appearance.LightFactor
"""On the light of one segment: 1 is that of the picture."""

SmoothingDegree = appearance.SmoothingDegree
"""How often the vertices of a surface are moved to the mean of their neighbours."""

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
"""How the shape of a segment is changed; see ``segmentation.changed_shape``."""

RegistrationKind = Literal["rigid", "affine", "bspline"]
"""How freely a scan is moved: turned and shifted; scaled and sheared too; bent as well."""

RegistrationMetric = Literal["automatic", "mutual-information", "correlation", "mean-squares"]
"""What tells that two scans are alike; automatic goes by their modalities."""

RegistrationStart = Literal["as-it-stands", "centre", "moments", "landmarks"]
"""Where a search begins: where the second scan stands; middles of the grids or of what is bright;
pairs of points."""

BeforeOrAfter = Literal["before", "after"]

ToolKind = Literal["none", "eraser", "adder", "drill", "needle", "painter"]
"""What the probe does to voxels while it is pressed; none leaves them as they are."""

TissueName = Literal["skin", "fat", "muscle", "liver"]
"""What a segment is for a needle; bone is none of them, since no needle punctures it."""

NeedleEventKind = Literal["punctured", "crossed", "stopped", "withdrawn"]
"""What happens to a needle: it goes into a segment, comes into one that it has punctured or out of
all, comes to one that stops it, or is out."""

Treatment = Literal["deformable", "rigid", "empty"]
"""How matter takes part: it gives, stays where it is, or is as if it were not there."""

ForceSource = Literal["matter", "voxels"]
"""What a tool feels of matter that gives way: the model's force, or its voxels until they move."""

Calibration = Literal["young", "wave-speed"]
"""How the stiffness of particles follows from the material: by E, or by the speed of waves."""

Motion = Literal["scaled-time", "fire"]
"""How particles come to rest: in scaled time with friction, or FIRE."""

ModelName = Annotated[str, msgspec.Meta(min_length=1, max_length=40)]
"""A model of deformation."""

Index = Annotated[int, msgspec.Meta(ge=-(2**31), lt=2**31)]
"""A voxel's or a patch's place along one axis."""

NodeCount = Annotated[int, msgspec.Meta(ge=0, le=1024)]
"""Nodes of a box along one axis."""

GridPlace = tuple[Index, Index, Index]
"""A voxel or a patch of a grid, along x, y, z."""

Pose = Annotated[list[Coordinate], msgspec.Meta(min_length=16, max_length=16)]
"""A rigid transform of the scene, row-major, shape [4, 4], translation in mm."""


class Message(msgspec.Struct, frozen=True, forbid_unknown_fields=True, tag_field="type"):
    """Base of all messages: a map with its type's name under ``type``."""
