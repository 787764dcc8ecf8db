"""Deformation models of soft tissue: their names, the options of each, and those chosen.

``docs/understand/deformation.md`` explains the options.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

from palpate import _core
from palpate.session.deformation_state import (
    Calibration,
    DeformationReport,
    Motion,
    OptionsState,
)

__all__ = [
    "Boxes",
    "Deformation",
    "Fading",
    "Model",
    "ModelOptions",
    "Prony",
    "Range",
    "Shares",
    "deformation_models",
    "offered_models",
]


class Prony(NamedTuple):
    """Stress relaxation: a fraction of the force decays while tissue is held."""

    share: float
    """Fraction of the initial force that decays, 0 to 1."""
    time: float
    """Time constant [s]."""


class ModelOptions(NamedTuple):
    """Options of a deformation model; None is the model's default.

    Scene files store them in this order: new options are added at the end, with a default.
    """

    edge: int | None = None
    """Nodes or cells along each edge of the model's box."""
    binding: float | None = None
    """Stiffness of springs to the initial positions, relative to that of a link (thesis 5.12)."""
    walls: bool = False
    """Whether particles are kept out of empty voxels (thesis 5.13)."""
    prony: Prony | None = None
    """Stress relaxation; None for elastic tissue."""
    yield_strain: float | None = None
    """Strain beyond which deformation is plastic; None where it is always elastic."""
    layers: int | None = None
    """Layers, from the tool outward, in which an answer is computed (thesis 5.21)."""
    calibration: Calibration | None = None
    motion: Motion | None = None
    whole_segment: bool = False
    """Whether the body behind the box gives as the whole segment does (thesis 5.29)."""

    @classmethod
    def of_state(cls, state: OptionsState) -> ModelOptions:
        """Returns the options that the engine reports."""
        prony = state["prony"]
        return cls(
            edge=state["edge"],
            binding=state["binding"],
            walls=state["walls"],
            prony=None if prony is None else Prony(**prony),
            yield_strain=state["yield_strain"],
            layers=state["layers"],
            calibration=state["calibration"],
            motion=state["motion"],
            whole_segment=state["whole_segment"],
        )


class Deformation(DeformationReport):
    """State of the deformation model, with its options."""

    options: ModelOptions


class Boxes(NamedTuple):
    """Allowed sizes of a model's box: nodes or cells along each edge, odd numbers."""

    least: int
    usual: int
    most: int


class Shares(NamedTuple):
    """Allowed fractions, and the default."""

    least: float
    usual: float
    most: float


class Range(NamedTuple):
    """Allowed numbers, where there is no default."""

    least: float
    most: float


class Fading(NamedTuple):
    """Allowed stress relaxation."""

    shares: Range
    """Fractions of the force that can decay."""
    times: Range
    """Time constants [s]."""


@dataclass(frozen=True)
class Model:
    """A deformation model and the options it has."""

    name: str
    title: str
    """Name to display."""
    bonded: bool
    """Whether it consists of nodes and breakable bonds; else of particles."""
    boxes: Boxes | None
    """None where it always deforms all tissue."""
    binding: Shares | None
    """Allowed springs to the initial positions; None where it has none."""
    walls: bool
    """Whether particles can be kept out of empty voxels."""
    fades: Fading | None
    """Stress relaxation; None where it has none."""
    yields: Range | None
    """Allowed yield strains; None where it is always elastic."""
    layers: int | None
    """Most layers, the default is 1; None where it has none."""
    calibration: bool
    """Whether there is a choice of ``calibration``."""
    motion: bool
    """Whether there is a choice of ``motion``."""
    whole_segment: bool
    """Whether the whole segment can be behind its box."""


def offered_models() -> list[Model]:
    """Returns all deformation models."""
    return [
        Model(
            name=each["name"],
            title=each["title"],
            bonded=each["bonded"],
            boxes=None if each["boxes"] is None else Boxes(*each["boxes"]),
            binding=None if each["binding"] is None else Shares(*each["binding"]),
            walls=each["walls"],
            fades=None if each["fades"] is None else Fading(*(Range(*r) for r in each["fades"])),
            yields=None if each["yields"] is None else Range(*each["yields"]),
            layers=each["layers"],
            calibration=each["calibration"],
            motion=each["motion"],
            whole_segment=each["whole_segment"],
        )
        for each in _core.deformation_models()
    ]


def deformation_models() -> list[str]:
    """Returns the names of all deformation models."""
    return [model.name for model in offered_models()]
