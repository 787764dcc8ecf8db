"""The deformation model as ``_core`` returns it: typed dictionaries.

Points are (x, y, z) in the scene, LPS [mm]; forces [N] in scene axes.
"""

from __future__ import annotations

from typing import Literal, TypedDict

from palpate.volumes.material import ForceSource

__all__ = [
    "Calibration",
    "DeformationReport",
    "DeformationState",
    "ModelOffer",
    "ModelParts",
    "Motion",
    "OptionsState",
    "PronyState",
]

Triple = tuple[float, float, float]
Limits = tuple[float, float]

Calibration = Literal["young", "wave-speed"]
"""How the stiffness of particles follows from the material: from Young's modulus, or from the speed
of longitudinal waves as in the thesis (5.14)."""

Motion = Literal["scaled-time", "fire"]
"""How particles come to rest: by damped motion in scaled time (thesis 5.17), or by FIRE."""


class PronyState(TypedDict):
    """Stress relaxation: a fraction of the force decays with a time constant."""

    share: float
    """0 to 1."""
    time: float
    """[s]."""


class OptionsState(TypedDict):
    """Options of a deformation model; see ``palpate.session.model_options.ModelOptions``."""

    edge: int | None
    binding: float | None
    walls: bool
    prony: PronyState | None
    yield_strain: float | None
    layers: int | None
    calibration: Calibration | None
    motion: Motion | None
    whole_segment: bool


class DeformationReport(TypedDict):
    """State of the deformation model, without its options."""

    model: str | None
    """Name of the model; None where every segment is rigid."""
    force_source: ForceSource
    force: list[float]
    """Force of the tissue on the tool [N], whether it is sent or not."""
    answers: int
    """Answers of the model since the session's start."""
    late: bool
    """Whether the next answer is late; a hand at rest feels the last one meanwhile."""
    slips: int
    """Answers in which particles slipped."""
    iterations: int
    """Of the last answer, as are the next five."""
    residual: float
    """Unbalanced force, relative to the contact force."""
    settling: bool
    """Whether the tissue is not at rest yet, so that the force still changes (lattice only)."""
    small_box: bool
    """Whether the computer is too slow for the model's box, and a smaller one is used."""
    nodes: int
    """Nodes or particles that took part."""
    moved_voxels: int
    """Voxels displaced from rest."""
    lasting_voxels: int
    """Those of them that plastic deformation keeps displaced."""
    bonds_broken: int
    """Since the session's start."""
    work_broken: float
    """Work that breaking these bonds took [N·mm]."""


class DeformationState(DeformationReport):
    """State of the deformation model, with its options as the engine returns them."""

    options: OptionsState


class ModelParts(TypedDict):
    """Nodes or particles of the model for display; packed as in ``protocol.MatterParts``."""

    origin: Triple
    size: Triple
    apart: float
    """Distance of neighbours at rest [mm]."""
    places: bytes
    """x, y, z as uint16 each: place = origin + number / 65535 * size."""
    strains: bytes
    """An int8 each: strain = number / 127 * 0.5, negative in compression."""


class ModelOffer(TypedDict):
    """A deformation model and its options; see ``palpate.session.model_options.Model``."""

    name: str
    title: str
    bonded: bool
    boxes: tuple[int, int, int] | None
    binding: Triple | None
    walls: bool
    fades: tuple[Limits, Limits] | None
    yields: Limits | None
    layers: int | None
    calibration: bool
    motion: bool
    whole_segment: bool
