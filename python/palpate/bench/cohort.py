"""``palpate bench cohort``: what a case costs beside its steps.

Cases without steps go through the scheduler, as those of ``palpate run --workers 2`` do: what is
left is the cost of handing them out. Small phantoms then run one after the other, in one process,
and again each in a process of its own; the difference is what the processes cost. Cases that fill a
core run on one worker and on two, in turn. Of both the median of the pairs counts, so that what
else the machine does falls on both.
"""

from __future__ import annotations

from compileall import compile_dir
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory
from time import monotonic

import palpate
from palpate.base.progress import Progress, silent
from palpate.base.simpleitk import simpleitk
from palpate.bench.goals.cohort import COHORT_ROWS, EMPTY_CASES, FULL_CASES, SMALL_CASES
from palpate.bench.report import Row, rows_in
from palpate.cohort.case import Case
from palpate.cohort.case_figures import measured_segments, write_thumbnail
from palpate.cohort.limits import Limits
from palpate.cohort.matches import cases_over
from palpate.cohort.one_case import CaseResult
from palpate.cohort.output_folder import CohortFolder
from palpate.cohort.run import Outcome, run_cases
from palpate.recipes.check import read_inputs
from palpate.recipes.filled import filled, placed
from palpate.recipes.recipe import recipe_of
from palpate.recipes.run import run_recipe
from palpate.recipes.source import read_source
from palpate.volumes.phantom import phantom

__all__ = ["empty_case", "measure"]

WORKERS = 2
PHANTOMS = 10
FULL, PAIRS = 6, 3
"""Cases of a run that fill a core, and pairs of runs."""
RECIPE = """\
import:
  path: ct.nii.gz
  unit: HU
segment:
  - threshold: 250
    name: bone
export:
  - out: bone.seg.nrrd
"""
FULL_RECIPE = """\
import:
  path: ct.nii.gz
  unit: HU
segment:
  - threshold: 250
    name: bone
    smooth: 3
  - threshold: -300
    name: skin
    keep-largest: true
surface:
  - segment: skin
    out: skin.stl
"""


def empty_case(case: Case, *, recipe: str, output: str, limits: Limits) -> CaseResult:  # noqa: ARG001
    """Does nothing, in the place of a case."""
    return CaseResult(case.name, None)


def measure(count: int, progress: Progress = silent) -> list[Row]:
    """Returns the figures.

    Args:
        count: Number of cases without steps.
        progress: Takes the progress.

    Raises:
        OSError: No process can be started, or the disk is full.
    """
    # as pip leaves it; from a source folder, each process may else compile all anew
    compile_dir(Path(palpate.__file__).parent, quiet=2)
    with TemporaryDirectory() as folder:
        place = Path(folder)
        (place / "recipe.yaml").write_text(RECIPE, "utf-8")
        progress(f"{count} cases without steps", None)
        seconds = _empty_cases(place, count)
        # whoever asks for few cases wants to see that it runs
        pairs = PAIRS if count >= PHANTOMS * PAIRS else 1
        progress(f"{PHANTOMS} small phantoms", None)
        steps, overhead = _small_cases(place, pairs)
        speedup = _speedup(place / "full", pairs, progress)
    return rows_in(
        COHORT_ROWS,
        {
            EMPTY_CASES: {"case": seconds / count},
            SMALL_CASES: {"steps": steps, "overhead": overhead},
            FULL_CASES: {"speedup": speedup},
        },
    )


def _empty_cases(place: Path, count: int) -> float:
    """Returns the time that cases without steps took [s]; the start of workers does not count."""
    from palpate.cohort.cluster import cluster_client
    from palpate.cohort.dask_run import run_on_cluster

    cases = [Case(f"case-{number}", {}) for number in range(count)]
    with cluster_client(workers=WORKERS, scheduler=None) as client:
        begun = monotonic()
        outcome = run_on_cluster(
            place / "recipe.yaml",
            cases,
            CohortFolder(place / "empty"),
            client=client,
            limits=Limits(),
            told=_silent,
            warned=_unheard,
            stop=lambda: False,
            run=empty_case,
        )
        seconds = monotonic() - begun
    _require(outcome, count)
    return seconds


def _small_cases(place: Path, pairs: int) -> tuple[float, float]:
    """Returns the time of a small case: its steps in this process, and what its own adds [s]."""
    values = simpleitk().GetImageFromArray(phantom((64, 48, 64)).volume.array)
    for number in range(PHANTOMS):
        scan = place / "data" / f"p{number}" / "ct.nii.gz"
        scan.parent.mkdir(parents=True)
        simpleitk().WriteImage(values, str(scan))
    recipe, cases = place / "recipe.yaml", cases_over(str(place / "data" / "*" / "ct.nii.gz"))
    steps, overheads = [], []
    for pair in range(pairs):
        begun = monotonic()
        for case in cases:
            _in_this_process(recipe, case, place / f"here-{pair}" / case.name)
        between = monotonic()
        outcome = run_cases(
            recipe,
            cases,
            CohortFolder(place / f"out-{pair}"),
            limits=Limits(),
            told=_silent,
            stop=lambda: False,
        )
        ended = monotonic()
        _require(outcome, PHANTOMS)
        steps.append((between - begun) / PHANTOMS)
        overheads.append((ended - between) / PHANTOMS - steps[-1])
    return median(steps), median(overheads)


def _speedup(place: Path, pairs: int, progress: Progress) -> float:
    """Returns by how much two workers are faster than one, each with a thread; the median."""
    values = simpleitk().GetImageFromArray(phantom((200, 140, 270)).volume.array)
    for number in range(FULL):
        scan = place / "data" / f"p{number}" / "ct.nii.gz"
        scan.parent.mkdir(parents=True)
        simpleitk().WriteImage(values, str(scan))
    (place / "recipe.yaml").write_text(FULL_RECIPE, "utf-8")
    found = []
    for pair in range(pairs):
        seconds = {}
        # which of both comes first changes
        for workers in (1, 2) if pair % 2 else (2, 1):
            progress(f"cases that fill a core, {workers} of 2 workers", pair / pairs)
            seconds[workers] = _full_cases(place, place / f"out-{pair}-{workers}", workers)
        found.append(seconds[1] / seconds[2])
    return median(found)


def _full_cases(place: Path, out: Path, workers: int) -> float:
    """Returns the time of the cases that fill a core [s]; the start of workers does not count."""
    from palpate.cohort.cluster import cluster_client
    from palpate.cohort.dask_run import run_on_cluster

    cases = cases_over(str(place / "data" / "*" / "ct.nii.gz"))
    with cluster_client(workers=workers, scheduler=None) as client:
        begun = monotonic()
        outcome = run_on_cluster(
            place / "recipe.yaml",
            cases,
            CohortFolder(out),
            client=client,
            limits=Limits(threads=1),
            told=_silent,
            warned=_unheard,
            stop=lambda: False,
        )
        seconds = monotonic() - begun
    _require(outcome, FULL)
    return seconds


def _in_this_process(path: Path, case: Case, part: Path) -> None:
    part.mkdir(parents=True)
    source = filled(read_source(path), case.variables, scan=case.scan)
    recipe = placed(recipe_of(source), source, part)
    scene = run_recipe(recipe, read_inputs(recipe, source)).scene
    measured_segments(scene)
    write_thumbnail(scene, part / "thumbnail.jpg")


def _require(outcome: Outcome, count: int) -> None:
    if len(outcome.done) != count:
        raise RuntimeError(f"cases of the benchmark failed: {outcome.failed}")


def _silent(_: Outcome, __: CaseResult) -> None:
    """Tells nothing."""


def _unheard(_: str) -> None:
    """Tells nothing."""
