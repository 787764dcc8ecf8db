"""Messages on matter that gives way: materials, models, and what they answer."""

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
    """What matter is: ``young`` [Pa], ``poisson``, ``density`` [kg/m³], Coulomb ``friction``.

    Bonds break at ``breaking_strain``; null where none does.
    """

    young: Annotated[float, msgspec.Meta(ge=1.0, le=2e12)]
    poisson: Annotated[float, msgspec.Meta(gt=-1.0, lt=0.5)]
    density: Annotated[float, msgspec.Meta(ge=0.1, le=23_000.0)]
    breaking_strain: Annotated[float, msgspec.Meta(gt=0.0, le=1e6)] | None
    friction: Annotated[float, msgspec.Meta(ge=0.0, le=10.0)]


class SegmentMaterial(msgspec.Struct, frozen=True):
    """What a segment is made of: constants from ``low`` to ``high`` as they follow HU, or both.

    ``preset`` is its name; null where somebody chose the constants.
    """

    preset: Name | None
    low: Constants
    high: Constants


class MatterRegion(msgspec.Struct, frozen=True):
    """Some of a segment that takes part in its own way; all of it where nothing else is told.

    ``shared_with``: what belongs to that other segment too. ``box``: voxels (x, y, z) from the
    first to one past the last. At most one of them is told.
    """

    treatment: Treatment
    shared_with: SegmentId | None
    box: tuple[GridPlace, GridPlace] | None


class MaterialPreset(msgspec.Struct, frozen=True):
    """A material with a name, and where its constants are from.

    One that ``needs_hounsfield`` is for CT only: its constants go from ``low`` to ``high``.
    """

    name: Name
    source: str
    needs_hounsfield: bool
    low: Constants
    high: Constants


class Boxes(msgspec.Struct, frozen=True):
    """Boxes that a model can have, by the nodes or cells along each edge; these are odd."""

    least: int
    usual: int
    most: int


class Shares(msgspec.Struct, frozen=True):
    """Shares that can be chosen."""

    least: float
    usual: float
    most: float


class Range(msgspec.Struct, frozen=True):
    """Numbers that can be chosen where nothing is usual."""

    least: float
    most: float


class Fading(msgspec.Struct, frozen=True):
    """How a force can fade: shares of it, and time constants [s]."""

    shares: Range
    times: Range


class DeformationModel(msgspec.Struct, frozen=True):
    """A model by which matter gives way, and what it offers to choose.

    ``title`` is its name as a person reads it. ``bonded`` ones are of nodes and bonds that can
    break, the others of particles. ``boxes`` is null where it takes all matter, ``binding`` where
    nothing is bound, ``fades`` where its force cannot; ``yields`` tells strains from which on
    matter can stay as it is pressed, null where it always comes back. ``layers`` are so many at
    most, null where its work is not parted.
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


class Prony(msgspec.Struct, frozen=True):
    """A force that fades while matter is held: this share of it, by this time constant [s]."""

    share: Annotated[float, msgspec.Meta(gt=0.0, lt=1.0)]
    time: Annotated[float, msgspec.Meta(gt=0.0, le=1e4)]


class ModelOptions(msgspec.Struct, frozen=True):
    """What is chosen of a model; null is as usual.

    ``edge`` counts nodes or cells along its box, ``binding`` is a share of a link's stiffness
    (thesis 5.12), ``walls`` keep particles out of empty voxels (5.13), from ``yield_strain`` on
    matter stays as it is pressed, ``layers`` part the work of an answer (5.21).
    """

    edge: Annotated[int, msgspec.Meta(ge=1, le=1001)] | None
    binding: Annotated[float, msgspec.Meta(ge=0.0, le=100.0)] | None
    walls: bool
    prony: Prony | None
    yield_strain: Annotated[float, msgspec.Meta(gt=0.0, le=10.0)] | None
    layers: Annotated[int, msgspec.Meta(ge=1, le=100)] | None
    calibration: Calibration | None
    motion: Motion | None


class MatterState(msgspec.Struct, frozen=True):
    """Matter that gives way: ``model`` is the one at work, null where all is hard.

    ``options`` tells what of it is not as usual.
    ``force`` is that of the matter on the tool [N, scene], felt where ``force_source`` says so;
    ``answers`` counts the model's answers.
    While the next one is ``late``, matter is as hard as its voxels. ``nodes`` take part in the
    last answer; since the start ``bonds_broken`` bonds broke, which took ``work_broken`` [mJ].
    """

    model: ModelName | None
    options: ModelOptions
    force_source: ForceSource
    force: Vector
    answers: int
    late: bool
    nodes: int
    bonds_broken: int
    work_broken: Annotated[float, msgspec.Meta(ge=0.0)]


class Displaced(msgspec.Struct, frozen=True):
    """Where matter stands beside the voxels that show it, at the nodes of a box.

    Node (i, j, k) is at ``origin + step * (i, j, k)`` [grid], and ``size`` counts nodes along each
    axis, 0 where all matter stands in its voxels. ``moved`` holds how far the matter of each node
    stands from it as little-endian float16: x, y, z along the axes of the grid [mm] and a zero,
    nodes with x fastest.
    """

    origin: Vector
    step: Vector
    size: tuple[NodeCount, NodeCount, NodeCount]
    moved: bytes


class MatterParts(Message, frozen=True, tag="matter_parts"):
    """The nodes or particles of the model at work, where this page asked for them; latest wins.

    ``places`` are x, y, z as little-endian uint16 each: place = origin + number / 65535 * size
    [scene]. ``strains`` are an int8 each: strain = number / 127 * 0.5, less than zero where matter
    is pressed. ``apart`` is the distance of neighbours at rest [mm].
    """

    origin: Vector
    size: Vector
    apart: Annotated[float, msgspec.Meta(gt=0.0)]
    places: bytes
    strains: bytes


class SetMaterial(Message, frozen=True, tag="set_material"):
    """Tells what a segment is made of, by name or by constants; with neither it is hard.

    Undo takes it back where it is ``undoable``: what a page asks for by itself is not.
    """

    id: SegmentId
    preset: Name | None
    constants: Constants | None
    undoable: bool


class SetRegions(Message, frozen=True, tag="set_regions"):
    """Tells how regions of a segment take part: of several that hold a voxel the last counts.

    What is in none gives way.
    """

    id: SegmentId
    regions: Annotated[list[MatterRegion], msgspec.Meta(max_length=256)]


class SetDeformation(Message, frozen=True, tag="set_deformation"):
    """Chooses the model by which matter gives way, null makes all hard, and its options.

    Undo takes the choice back where it is ``undoable``.
    """

    model: ModelName | None
    options: ModelOptions
    undoable: bool


class SetForceSource(Message, frozen=True, tag="set_force_source"):
    """Chooses what a tool feels of matter that gives way."""

    source: ForceSource


class ShowParts(Message, frozen=True, tag="show_parts"):
    """Has this page told the nodes or particles of the model, or no more."""

    on: bool
