"""Steps of recipes: the options of the commands, under their names."""

from __future__ import annotations

from pathlib import Path
from typing import Literal

import msgspec

from palpate.export.export import Kind
from palpate.reconstruction.reconstruction import WATER
from palpate.reconstruction.request import ReconstructionRequest
from palpate.reconstruction.scanner import Beam, Zero
from palpate.registration.options import Kind as RegistrationKind
from palpate.registration.options import Metric

__all__ = ["ExportStep", "ImportStep", "ReconstructStep", "RegisterStep", "Step", "SurfaceStep"]


class Step(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, rename="kebab"):
    """Base of all steps: options under their names."""


class ImportStep(Step, frozen=True, kw_only=True):
    """The scan, as for ``palpate import``."""

    path: Path
    series: str | int | None = None
    frame: int | None = None
    orientation: str | None = None
    unit: str | None = None
    fill: float | None = None
    strict: bool = False
    raw: str | None = None
    voxel_size: str | None = None


class ReconstructStep(Step, frozen=True, kw_only=True):
    """The scan out of projections, as by ``palpate reconstruct``."""

    path: Path
    beam: Beam
    pixel: tuple[float, float]
    arc: float = 360.0
    first_angle: float = 0.0
    offset: tuple[float, float] = (0.0, 0.0)
    source_to_axis: float = msgspec.field(default=0.0, name="source-axis")
    source_to_detector: float = msgspec.field(default=0.0, name="source-detector")
    zero: Zero = "back"
    sinograms: bool = False
    intensities: float | None = None
    size: tuple[int, int, int] | None = None
    voxel: tuple[float, float, float] | None = None
    water: float = WATER
    hann: float = 0.0
    output: Path | None = None
    """Where the scan is written."""

    def request(self) -> ReconstructionRequest:
        """Returns how the projections were taken, and which scan is wanted of them."""
        wanted = ReconstructionRequest.__struct_fields__
        return ReconstructionRequest(**{name: getattr(self, name) for name in wanted})


class RegisterStep(Step, frozen=True, kw_only=True):
    """Another scan that is brought to the first one, as by ``palpate register``."""

    moving: Path
    moving_series: str | int | None = None
    moving_frame: int | None = None
    kind: RegistrationKind = "rigid"
    metric: Metric = "mutual-information"
    start: Literal["geometry", "centre", "moments"] = "centre"
    output: Path | None = None
    resampled: Path | None = None
    picture: Path | None = None
    go_on_with: Literal["fixed", "moving"] = "fixed"
    """The scan that segments are made of: ``moving`` on the grid of the first one."""


class SurfaceStep(Step, frozen=True, kw_only=True):
    """A surface, as of ``palpate surface export``; the only segment where none is named."""

    out: Path
    segment: str | None = None
    smoothing: int | None = None
    step: int | None = None
    source: Literal["intensities", "bits"] = msgspec.field(default="intensities", name="from")


class ExportStep(Step, frozen=True, kw_only=True):
    """A file for other programs, as of ``palpate export``."""

    out: Path
    kind: Kind | None = msgspec.field(default=None, name="as")
    only: list[str] | None = None
    keep_identity: bool = False
