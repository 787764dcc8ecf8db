"""How a segment is made: a source, then steps that change it, each of which can change later.

The source is a threshold of the scan, or voxels as they were drawn, grown or read. A step changes
the shape, or is what was done by hand. All steps in order, applied to the source, are the segment.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Annotated, TypeAlias

import msgspec

from palpate.base.errors import OptionError
from palpate.base.progress import Progress, silent
from palpate.base.request import Request, words
from palpate.segmentation.mask_shape import Mask
from palpate.segmentation.operations import LOGIC, ShapeKind, changed_shape, with_mask
from palpate.segmentation.voxel_set import VoxelSet
from palpate.volumes.segment import Segment

__all__ = ["HandEdit", "SegmentSteps", "ShapeStep", "Source", "Step", "apply_step", "apply_steps"]

Source: TypeAlias = tuple[float, float] | VoxelSet
"""Lowest and highest value [unit of the scan], or voxels."""


class ShapeStep(Request, frozen=True, kw_only=True, tag="shape"):
    """One change of shape: what commands, recipes, sessions and pages ask for."""

    kind: Annotated[ShapeKind, words("How the shape changes.")]
    amount: Annotated[
        float,
        words("Number of islands, least volume of islands in ml, or length in mm."),
    ] = 0.0
    other: VoxelSet | None = None
    """Voxels that are united, subtracted or intersected, as they were when this was asked for."""
    other_name: str = ""
    """What they were called."""
    on: bool = True
    """Whether it is done; else it is passed over."""

    @classmethod
    def with_other(cls, kind: ShapeKind, other: Segment) -> ShapeStep:
        """Returns a step that joins another segment as it is now."""
        return cls(kind=kind, other=VoxelSet.of(other.mask() != 0), other_name=other.name)


class HandEdit(msgspec.Struct, frozen=True, kw_only=True, tag="by-hand"):
    """What was painted, erased or drilled: the difference to what the steps before make."""

    added: VoxelSet
    removed: VoxelSet
    on: bool = True
    """Whether it is done; else it is passed over."""

    @classmethod
    def between(cls, made: Mask, now: Mask) -> HandEdit:
        """Returns what leads from one mask to another."""
        return cls(added=VoxelSet.of(now & ~made), removed=VoxelSet.of(made & ~now))


Step: TypeAlias = ShapeStep | HandEdit


class SegmentSteps(msgspec.Struct, frozen=True):
    """The source of a segment, and the steps that follow it."""

    source: Source
    steps: tuple[Step, ...] = ()

    @property
    def threshold(self) -> tuple[float, float] | None:
        """Lowest and highest value of the source; None where it is voxels."""
        return None if isinstance(self.source, VoxelSet) else self.source

    def then(self, *steps: Step) -> SegmentSteps:
        """Returns the list with further steps at its end."""
        return SegmentSteps(self.source, (*self.steps, *steps))

    def without_last_hand_edit(self) -> SegmentSteps:
        """Returns the list without what was done by hand at its end."""
        by_hand = bool(self.steps) and isinstance(self.steps[-1], HandEdit)
        return SegmentSteps(self.source, self.steps[:-1]) if by_hand else self

    def with_names(self, name: Callable[[str, str], str]) -> SegmentSteps:
        """Returns the list with other names of what was united, subtracted or intersected.

        Args:
            name: Returns a name for the one that is given first; the second is a neutral one.
        """
        steps = tuple(
            msgspec.structs.replace(each, other_name=name(each.other_name, "another segment"))
            if isinstance(each, ShapeStep) and each.other_name
            else each
            for each in self.steps
        )
        return SegmentSteps(self.source, steps)


def apply_steps(source: Segment, steps: Iterable[Step], *, progress: Progress = silent) -> Segment:
    """Returns what steps make of a segment, in order; those that are off are passed over.

    Args:
        source: What they begin with.
        steps: On the grid of the source.
        progress: Told before each step; what it raises ends the work.

    Raises:
        OptionError: A step does not fit, or nothing is left after it.
    """
    made, wanted = source, [step for step in steps if step.on]
    for number, step in enumerate(wanted):
        told = "edited by hand" if isinstance(step, HandEdit) else step.kind.replace("-", " ")
        progress(f"step {number + 1} of {len(wanted)}, {told}", None)
        made = apply_step(made, step)
        if made.voxel_count == 0:
            raise OptionError(
                f"nothing is left of {source.name} after step {number + 1}, {told}; allowed: "
                "smaller changes"
            )
    return made


def apply_step(segment: Segment, step: Step) -> Segment:
    """Returns what a step makes of a segment.

    Raises:
        OptionError: It does not fit.
    """
    if isinstance(step, HandEdit):
        mask, grid = segment.mask() != 0, segment.volume.shape
        return with_mask(segment, (mask | step.added.mask(on=grid)) & ~step.removed.mask(on=grid))
    if step.kind == "joint":
        raise OptionError("'joint' given as a step; allowed: changes of one segment")
    other = None
    if step.kind in LOGIC and step.other is not None:
        other = with_mask(segment, step.other.mask(on=segment.volume.shape), name=step.other_name)
    return changed_shape(segment, step.kind, amount=step.amount, other=other)
