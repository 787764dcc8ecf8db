"""``palpate bench haptics``: contact detection alone, the contact model, the complete tick.

Each works on the bone of a scan, warm, with a path that presses and slides 0.2 voxels per
update and repeats no sample; detection traverses rays of exactly 4 voxels near the surface
that meet nothing. The loops run in the engine, on one thread.

"hard proxy" is the contact model ``exact``; the thesis' models as printed follow the same
path in the same run, and the ratio is that of calls per second.
"""

from __future__ import annotations

from typing import Literal

from palpate import _core
from palpate.bench.goals import DETECTION, GOALS, IMPROVED, ORIGINAL, PROXY, RATIO, TICK
from palpate.bench.report import Row, row_of
from palpate.errors import OptionError
from palpate.progress import Progress, silent
from palpate.segment import Segment

__all__ = ["measure"]

Work = Literal["detection", "proxy", "tick"]
Model = Literal["exact", "thesis-original", "thesis-improved"]

WORK: dict[str, tuple[Work, Model]] = {
    DETECTION: ("detection", "exact"),
    PROXY: ("proxy", "exact"),
    IMPROVED: ("proxy", "thesis-improved"),
    ORIGINAL: ("proxy", "thesis-original"),
    TICK: ("tick", "exact"),
}
"""What the engine calls each case; those that are compared follow each other."""

SEED = 1


def measure(bone: Segment, *, count: int, progress: Progress = silent) -> list[Row]:
    """Measures touch on a segment.

    Args:
        bone: What is touched.
        count: Calls of each case.
        progress: Told which case is measured.

    Raises:
        OptionError: The segment has no surface, or the count is not allowed.
    """
    reports = {}
    for done, (case, (work, model)) in enumerate(WORK.items()):
        progress(f"measuring {case}", done / len(WORK))
        try:
            reports[case] = _core.bench_touch(
                bone.volume._internal,  # noqa: SLF001
                bone._internal,  # noqa: SLF001
                work,
                count,
                SEED,
                model,
            )
        except ValueError as error:
            raise OptionError(str(error)) from None
    reports[PROXY][RATIO] = reports[PROXY]["per_second"] / reports[IMPROVED]["per_second"]
    return [row_of(goal, reports[goal.case]) for goal in GOALS["haptics"]]
