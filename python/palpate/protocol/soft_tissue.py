"""Messages on soft tissue: materials, deformation models and their state."""

from __future__ import annotations

from typing import Annotated

import msgspec

from palpate.protocol.types import (
    Calibration,
    ForceSource,
    GridPlace,
    Message,
    ModelName,
    Motion,
    Name,
    NodeCount,
    SegmentId,
    Treatment,
    Vector,
)

__all__ = [
    "Boxes",
    "Constants",
    "DeformationModel",
    "Displaced",
    "MaterialPreset",
    "MatterParts",
    "MatterRegion",
    "MatterState",
    "ModelOptions",
    "Prony",
    "SegmentMaterial",
    "SetDeformation",
    "SetForceSource",
    "SetMaterial",
    "SetRegions",
    "Shares",
    "ShowParts",
]


class Constants(msgspec.Struct, frozen=True):
    """Material constants: ``young`` [Pa], ``poisson``, ``density`` [kg/m³], Coulomb ``friction``.

    A crack takes ``fracture_energy`` [J/m²]; null where tissue never tears. ``stiffening`` is the
    exponent with which tissue gets stiffer with strain, 0 for none.
    """

    young: Annotated[float, msgspec.Meta(ge=1.0, le=2e12)]
    poisson: Annotated[float, msgspec.Meta(gt=-1.0, lt=0.5)]
    density: Annotated[float, msgspec.Meta(ge=0.1, le=23_000.0)]
    fracture_energy: Annotated[float, msgspec.Meta(gt=0.0, le=1e6)] | None
    friction: Annotated[float, msgspec.Meta(ge=0.0, le=10.0)]
    stiffening: Annotated[float, msgspec.Meta(ge=0.0, le=100.0)]


class SegmentMaterial(msgspec.Struct, frozen=True):
    """Material of a segment: constants from ``low`` to ``high`` by HU, or the same in both.

    ``preset`` is its name; null where the constants were given.
    """

    preset: Name | None
    low: Constants
    high: Constants


class MatterRegion(msgspec.Struct, frozen=True):
    """A region of a segment that deforms differently; the whole segment where no part is given.

    ``shared_with``: the voxels that also belong to that segment. ``box``: voxels (x, y, z) from the
    first to one past the last. At most one of them is given.
    """

    treatment: Treatment
    shared_with: SegmentId | None
    box: tuple[GridPlace, GridPlace] | None


class MaterialPreset(msgspec.Struct, frozen=True):
    """A material with a name, and the source of its constants.

    One that ``needs_hounsfield`` is for CT only: its constants go from ``low`` to ``high``.
    """

    name: Name
    source: str
    needs_hounsfield: bool
    low: Constants
    high: Constants


class Boxes(msgspec.Struct, frozen=True):
    """Allowed sizes of a model's box: nodes or cells along each edge, odd numbers."""

    least: int
    usual: int
    most: int


class Shares(msgspec.Struct, frozen=True):
    """Allowed fractions, and the default."""

    least: float
    usual: float
    most: float


class Range(msgspec.Struct, frozen=True):
    """Allowed numbers, where there is no default."""

    least: float
    most: float


class Fading(msgspec.Struct, frozen=True):
    """Allowed stress relaxation: fractions of the force, and time constants [s]."""

    shares: Range
    times: Range


class DeformationModel(msgspec.Struct, frozen=True):
    """A deformation model and the options it has.

    ``title`` is its name to display. ``bonded`` models consist of nodes and breakable bonds, the
    others of particles. ``boxes`` is null where the model always deforms all tissue, ``binding``
    where it has no springs to the initial positions, ``fades`` where it has no stress relaxation;
    ``yields`` are allowed yield strains, null where it is always elastic. ``layers`` is the largest
    number of them, null where it has none.
    """

    name: ModelName
    title: str
    bonded: bool
    boxes: Boxes | None
    binding: Shares | None
    walls: bool
    fades: Fading | None
    yields: Range | None
    layers: int | None
    calibration: bool
    motion: bool
    whole_segment: bool


class Prony(msgspec.Struct, frozen=True):
    """Stress relaxation: the fraction of the force that decays, and the time constant [s]."""

    share: Annotated[float, msgspec.Meta(gt=0.0, lt=1.0)]
    time: Annotated[float, msgspec.Meta(gt=0.0, le=1e4)]


class ModelOptions(msgspec.Struct, frozen=True):
    """Options of a model; null is the default.

    ``edge`` counts nodes or cells along its box, ``binding`` is relative to a link's stiffness
    (thesis 5.12), ``walls`` keep particles out of empty voxels (5.13), beyond ``yield_strain``
    deformation is plastic, ``layers`` divide the work of an answer (5.21). With
    ``whole_segment`` the body behind the box gives as the whole segment does (5.29).
    """

    edge: Annotated[int, msgspec.Meta(ge=1, le=1001)] | None
    binding: Annotated[float, msgspec.Meta(ge=0.0, le=100.0)] | None
    walls: bool
    prony: Prony | None
    yield_strain: Annotated[float, msgspec.Meta(gt=0.0, le=10.0)] | None
    layers: Annotated[int, msgspec.Meta(ge=1, le=100)] | None
    calibration: Calibration | None
    motion: Motion | None
    whole_segment: bool


class MatterState(msgspec.Struct, frozen=True):
    """State of the deformation; ``model`` is the current one, null where every segment is rigid.

    ``force`` is that of the tissue on the tool [N, scene], sent where ``force_source`` says so;
    ``answers`` counts the model's answers. While the next one is ``late``, a hand at rest feels
    the last one. After an answer tissue may be ``settling`` still, so that the force changes, or
    its box a ``small_box`` because the computer is too slow for the usual one. ``nodes`` take part
    in the last answer; since the start ``bonds_broken`` bonds
    broke, which took ``work_broken`` [mJ].
    """

    model: ModelName | None
    options: ModelOptions
    force_source: ForceSource
    force: Vector
    answers: int
    late: bool
    settling: bool
    small_box: bool
    nodes: int
    bonds_broken: int
    work_broken: Annotated[float, msgspec.Meta(ge=0.0)]


class Displaced(msgspec.Struct, frozen=True):
    """Displacement of tissue from the voxels that show it, at the nodes of a box.

    Node (i, j, k) is at ``origin + step * (i, j, k)`` [grid], and ``size`` counts nodes along each
    axis. ``moved`` is the displacement at each node as little-endian
    float16: x, y, z along the axes of the grid [mm] and a zero, nodes with x fastest.
    """

    origin: Vector
    step: Vector
    size: tuple[NodeCount, NodeCount, NodeCount]
    moved: bytes


class MatterParts(Message, frozen=True, tag="matter_parts"):
    """Nodes or particles of the current model, for pages that requested them; latest wins.

    ``places`` are x, y, z as little-endian uint16 each: place = origin + number / 65535 * size
    [scene]. ``strains`` are an int8 each: strain = number / 127 * 0.5, negative in compression.
    ``apart`` is the distance of neighbours at rest [mm].
    """

    origin: Vector
    size: Vector
    apart: Annotated[float, msgspec.Meta(gt=0.0)]
    places: bytes
    strains: bytes


class SetMaterial(Message, frozen=True, tag="set_material"):
    """Sets the material of a segment, by name or by constants; with neither it is rigid.

    It is a step of undo where it is ``undoable``: what a page sends by itself is not.
    """

    id: SegmentId
    preset: Name | None
    constants: Constants | None
    undoable: bool


class SetRegions(Message, frozen=True, tag="set_regions"):
    """Sets how regions of a segment deform; the last region that contains a voxel applies to it.

    Voxels in no region deform.
    """

    id: SegmentId
    regions: Annotated[list[MatterRegion], msgspec.Meta(max_length=256)]


class SetDeformation(Message, frozen=True, tag="set_deformation"):
    """Sets the deformation model and its options; null makes every segment rigid.

    It is a step of undo where it is ``undoable``.
    """

    model: ModelName | None
    options: ModelOptions
    undoable: bool


class SetForceSource(Message, frozen=True, tag="set_force_source"):
    """Sets the source of the force of soft tissue on a tool."""

    source: ForceSource


class ShowParts(Message, frozen=True, tag="show_parts"):
    """Starts or stops sending this page the nodes or particles of the model."""

    on: bool
