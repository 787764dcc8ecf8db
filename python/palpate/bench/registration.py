"""``palpate bench register``: distance of landmarks after registration, compared with elastix.

The pair is a CT of a lung at two dates, with ten landmarks in both (elastix' own test data).
elastix runs with its default parameter maps, affine and then B-spline, in the same process; both
get the same files and no masks, and use their default start. Landmarks are not used in the search.
CT and MR are measured by ``palpate.bench.modalities``.
"""

from __future__ import annotations

import time
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from numpy.typing import NDArray

from palpate.base.errors import OptionError
from palpate.base.progress import Progress, silent
from palpate.bench.goals.registration import ELASTIX_CASE, LUNG_ROWS, registered_case
from palpate.bench.haptics_data import CTHEAD, data_file
from palpate.bench.modalities import head_of, measure_modalities
from palpate.bench.report import Row, row_of
from palpate.io.reading import read
from palpate.registration.options import KINDS
from palpate.registration.registration import register
from palpate.volumes.volume import Volume

__all__ = ["landmarks_of", "measure", "rows_of"]

FOLDER = "elastix_lung_pair"
FIXED, MOVING = "3DCT_lung_baseline", "3DCT_lung_followup"
STAGES = ("affine", "bspline")
"""Default parameter maps of elastix that are used, one after the other."""

Points = NDArray[np.float64]


def landmarks_of(path: Path, volume: Volume) -> Points:
    """Reads points that are given as indices of voxels; returns them [mm], shape [count, 3].

    Raises:
        OptionError: The file has another form.
    """
    kind, count, *lines = path.read_text(encoding="utf-8").split("\n", 2)
    places = np.array("\n".join(lines).split(), dtype=np.float64).reshape(-1, 3)
    if kind.strip() != "index" or len(places) != int(count):
        raise OptionError(f"{path} given; allowed: 'index', a count, and so many lines of X Y Z")
    corners = np.hstack([places + 0.5, np.ones((len(places), 1))])
    points: Points = (corners @ volume.patient_from_grid.T)[:, :3]
    return points


def check() -> None:
    """Checks that elastix is installed.

    Raises:
        OptionError: It is not installed.
    """
    try:
        there = find_spec("itk")
    except (ImportError, ValueError):
        there = None
    if there is None:
        raise OptionError(
            "elastix is not installed; allowed: with it (`pip install 'palpate[bench]'`)"
        )


def measure(progress: Progress = silent) -> list[Row]:
    """Registers the pair in each way; returns the distances of landmarks.

    Raises:
        MissingDataError: The pair is missing.
        OptionError: elastix is not installed.
    """
    check()
    files = [data_file(f"{FOLDER}/{name}.mha") for name in (FIXED, MOVING)]
    fixed, moving = (read(file) for file in files)
    here, there = (
        landmarks_of(data_file(f"{FOLDER}/{name}.txt"), volume)
        for name, volume in ((FIXED, fixed), (MOVING, moving))
    )
    head = head_of(data_file(CTHEAD))
    found: dict[str, tuple[Points, float]] = {}
    for kind in KINDS:
        begun = time.process_time()
        result = register(fixed, moving, kind=kind, progress=progress)
        found[registered_case(kind)] = result.points(here), time.process_time() - begun
    progress("elastix", None)
    begun = time.process_time()
    mapped = _elastix(files, here)
    found[ELASTIX_CASE] = mapped, time.process_time() - begun
    return [*rows_of(found, here, there), *measure_modalities(head, progress)]


def rows_of(found: dict[str, tuple[Points, float]], here: Points, there: Points) -> list[Row]:
    """Returns the rows of where each method moves landmarks, and of its time [s]."""
    errors = {case: np.linalg.norm(places - there, axis=1) for case, (places, _) in found.items()}
    before = float(np.linalg.norm(here - there, axis=1).mean())
    reports = {
        case: {
            "before": before,
            "mean": float(apart.mean()),
            "most": float(apart.max()),
            "ratio": float(apart.mean() / errors[ELASTIX_CASE].mean()),
            "seconds": found[case][1],
        }
        for case, apart in errors.items()
    }
    return [row_of(goal, reports[goal.case]) for goal in LUNG_ROWS]


def _elastix(files: list[Path], points: Points) -> Points:
    """Returns where elastix moves points of the fixed scan [mm]."""
    itk = import_module("itk")
    fixed, moving = (itk.imread(str(file), itk.F) for file in files)
    parameters = itk.ParameterObject.New()
    for stage in STAGES:
        chosen = dict(parameters.GetDefaultParameterMap(stage))
        chosen["RandomSeed"] = ("1",)
        parameters.AddParameterMap(chosen)
    _, transform = itk.elastix_registration_method(
        fixed, moving, parameter_object=parameters, log_to_console=False
    )
    with TemporaryDirectory() as made:
        given = Path(made) / "points.txt"
        lines = "\n".join(" ".join(map(repr, map(float, point))) for point in points)
        given.write_text(f"point\n{len(points)}\n{lines}\n", encoding="utf-8")
        itk.transformix_pointset(
            moving, transform, fixed_point_set_file_name=str(given), output_directory=made
        )
        text = (Path(made) / "outputpoints.txt").read_text(encoding="utf-8")
    return np.array([_output(line) for line in text.splitlines() if line.strip()])


def _output(line: str) -> list[float]:
    point = line.partition("OutputPoint = [")[2].partition("]")[0]
    return [float(word) for word in point.split()]
