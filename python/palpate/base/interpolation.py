"""How values between voxels are read: the choices that commands, recipes and pages share."""

from __future__ import annotations

from typing import Literal, get_args

__all__ = ["INTERPOLATIONS", "Interpolation", "InterpolationChoice"]

Interpolation = Literal["linear", "nearest", "labels"]
"""Between voxels: linear; the nearest one; or the label with the largest linear share."""
InterpolationChoice = Literal["automatic", "linear", "nearest", "labels"]
"""Automatic is nearest for label maps, else linear."""
INTERPOLATIONS: tuple[InterpolationChoice, ...] = get_args(InterpolationChoice)
