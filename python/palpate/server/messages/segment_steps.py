"""Steps of segments in the form of messages."""

from __future__ import annotations

from collections.abc import Sequence

from msgspec.structs import replace

from palpate import protocol
from palpate.base.errors import OptionError
from palpate.segmentation.segment_steps import HandEdit, SegmentSteps, Step
from palpate.session.known_steps import Listed

__all__ = ["steps_message", "wanted_steps"]

BY_HAND = protocol.SegmentStep(kind="by-hand", amount=0.0, other=None, on=True)


def steps_message(listed: Listed) -> protocol.SegmentSteps | None:
    """Returns the list of a segment for pages; what was done by hand since is at its end."""
    if listed.steps is None:
        return None
    # what comes after a hand edit by hand is part of it
    steps = listed.steps.without_last_hand_edit() if listed.by_hand else listed.steps
    told = [_step_message(step) for step in steps.steps]
    return protocol.SegmentSteps(steps.threshold, [*told, BY_HAND] if listed.by_hand else told)


def wanted_steps(
    now: SegmentSteps | None, wanted: Sequence[protocol.WantedStep], *, name: str
) -> SegmentSteps:
    """Returns a list as a page wants it.

    Args:
        now: The list as it is.
        wanted: Which of its steps stay, in which order, and how.
        name: What messages call the segment.

    Raises:
        OptionError: The list is another one by now, or a step is wanted twice.
    """
    places = [each.index for each in wanted]
    known = [] if now is None else [_step_message(step).kind for step in now.steps]
    fit = all(
        each.index < len(known) and known[each.index] == each.kind for each in wanted
    ) and len(set(places)) == len(places)
    if now is None or not fit:
        raise OptionError(f"the steps of {name} have changed meanwhile; allowed: to try again")
    return SegmentSteps(now.source, tuple(_changed(now.steps[each.index], each) for each in wanted))


def _step_message(step: Step) -> protocol.SegmentStep:
    if isinstance(step, HandEdit):
        return replace(BY_HAND, on=step.on)
    other = None if step.other is None else step.other_name
    return protocol.SegmentStep(kind=step.kind, amount=step.amount, other=other, on=step.on)


def _changed(step: Step, wanted: protocol.WantedStep) -> Step:
    if isinstance(step, HandEdit):
        return replace(step, on=wanted.on)
    return replace(step, amount=wanted.amount, on=wanted.on)
