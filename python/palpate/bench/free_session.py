"""``palpate bench session``: the thesis' tables 5.1 to 5.4 with the models of Palpate.

A deformable segment is pressed and stroked. The servo ticks as fast as it can, and the model
answers as fast as the session asks it, at most 100 times a second. Samples last one second; mean,
minimum and maximum of all samples are reported. The segment has the thesis' soft tissue as its
material, whatever it is in the scan.
"""

from __future__ import annotations

import statistics
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from palpate import _core
from palpate.base.errors import OptionError
from palpate.base.progress import Progress, silent
from palpate.bench.goals.soft_tissue import (
    MODELS,
    NO_MODEL,
    SESSION_GROUNDS,
    SESSION_ROWS,
    session_case,
    thesis_figures,
)
from palpate.bench.haptics_data import CTHEAD, CTHEAD_BONE, LIDC, MissingDataError, data_file
from palpate.bench.report import Row, row_of
from palpate.io.reading import read
from palpate.volumes.phantom import phantom
from palpate.volumes.segment import Segment

__all__ = ["Pace", "figures", "measure"]

SEED = 1
TORSO_SIZE = (512, 512, 520)


@dataclass(frozen=True)
class Pace:
    """Duration, and whether loops alternate."""

    seconds: int = 60
    ticks_in_step: int | None = None
    """Ticks per simulated second where all loops alternate; the results are counts then."""


def measure(
    grounds: Sequence[str], pace: Pace, progress: Progress = silent, *, models: Sequence[str] = ()
) -> tuple[list[Row], list[str]]:
    """Measures scans with models; returns the rows, and the missing data sets.

    Raises:
        OptionError: A scan, a model or the pace is not allowed.
    """
    chosen = _among("data", tuple(LOADS), grounds)
    with_models = _among("model", (NO_MODEL, *MODELS), models)
    reports: dict[str, dict[str, float]] = {}
    missing = []
    for done, ground in enumerate(chosen):
        progress(f"loading {ground}", done / len(chosen))
        try:
            segment = LOADS[ground]()
        except MissingDataError as error:
            missing.append(f"{ground}: {error}")
            continue
        for nth, model in enumerate(with_models):
            case = session_case(ground, model)
            share = (done + nth / len(with_models)) / len(chosen)
            progress(f"{case}, {pace.seconds} s", share)
            reports[case] = figures(segment, model, pace) | {
                name: figure for name, (figure, _) in thesis_figures(ground, model).items()
            }
    rows = [row_of(goal, reports[goal.case]) for goal in SESSION_ROWS if goal.case in reports]
    return rows, missing


def _among(what: str, allowed: Sequence[str], wanted: Sequence[str]) -> list[str]:
    """Returns what is selected, in the order of the tables; everything where nothing is named."""
    for one in wanted:
        if one not in allowed:
            raise OptionError(f"{what} {one!r} given; allowed: {', '.join(allowed)}")
    return [one for one in allowed if not wanted or one in wanted]


def figures(segment: Segment, model: str, pace: Pace) -> dict[str, float]:
    """Returns the figures of one segment with one model.

    Raises:
        OptionError: There is no surface, or the pace is not allowed.
    """
    try:
        found = _core.bench_session(
            segment.volume._internal,  # noqa: SLF001
            segment._internal,  # noqa: SLF001
            None if model == NO_MODEL else model,
            pace.seconds,
            SEED,
            pace.ticks_in_step,
        )
    except (ValueError, OverflowError) as error:
        raise OptionError(str(error)) from None
    servo, answers = (
        [count / seconds for count, seconds in zip(found[name], found["seconds"], strict=True)]
        for name in ("ticks", "answers")
    )
    return {
        "servo": statistics.mean(servo),
        "servo_least": min(servo),
        "servo_most": max(servo),
        "answers": statistics.mean(answers),
        "answers_least": min(answers),
        "answers_most": max(answers),
        "contact_share": sum(found["contacts"]) / max(1.0, sum(found["ticks"])),
        "violations": float(found["violations"]),
        "nodes": float(found["nodes"]),
    }


LOADS: dict[str, Callable[[], Segment]] = {
    "CThead bone": lambda: read(data_file(CTHEAD)).threshold(CTHEAD_BONE),
    "LIDC bone": lambda: read(data_file(LIDC)).offered_bone(),
    "phantom 520×512×512": lambda: phantom(TORSO_SIZE).volume.offered_bone(),  # noqa: PLW0108
}
assert tuple(LOADS) == tuple(SESSION_GROUNDS)  # noqa: S101  # the order of the rows
