"""``palpate bench segment``: times of a threshold, region growing and many segments.

A threshold is requested in a running session with a surface, as a page does, until its whole
surface is delivered. The scan is the LIDC chest, interpolated to 275 slices; its files are in the
system's cache. On a machine that other programs use, processor time says more.
"""

from __future__ import annotations

import time
from statistics import median

import numpy as np

from palpate.base.progress import Progress, silent
from palpate.base.simpleitk import simpleitk
from palpate.bench.goals.segmenting import SEGMENT_ROWS
from palpate.bench.haptics_data import AMOS, LIDC, LIDC_LABELS, data_file
from palpate.bench.report import Row, row_of
from palpate.io.reading import read
from palpate.labels.labels import read_labels
from palpate.segmentation.operations import grown
from palpate.session.picture_change import SurfacePatch
from palpate.session.session import Session
from palpate.volumes.scene import Scene
from palpate.volumes.volume import Volume

__all__ = ["drawn_out", "measure", "rows_of", "surface_seconds"]

SLICES = 275
RUNS = 3
"""Number of runs, of which the median counts."""

BONE = 250.0
OTHER_BONE = 200.0
"""Threshold before, so that a different surface has to be made [HU]."""

CLICK = (-83.0, 278.0, 1170.0)
"""Point in the liver of AMOS 0336, off its centre, in the patient, LPS [mm]."""

AMOS_LABELS = "amos_0336/labels_from_meshes.nii.gz"
LIVER_LABEL = 6

PATIENCE = 120.0
"""Longest wait for a surface [s]."""


def measure(*, runs: int = RUNS, progress: Progress = silent) -> list[Row]:
    """Runs all measurements.

    Raises:
        MissingDataError: A data set is missing.
    """
    lidc, amos, liver, labels = (data_file(name) for name in (LIDC, AMOS, AMOS_LABELS, LIDC_LABELS))
    report: dict[str, float] = {}
    progress("threshold", None)
    chest = read(lidc)
    report |= surface_seconds(drawn_out(chest, SLICES), (OTHER_BONE, BONE), runs=runs)
    progress("growing", None)
    report |= _grown(read(amos), simpleitk().ReadImage(str(liver)), runs)
    progress("loading segments", None)
    taken, worked = [], []
    for _ in range(runs):
        began, worked_before = time.perf_counter(), time.process_time()
        found = read_labels(labels, chest).labels
        scene = Scene(chest)
        for one in found:
            scene.add(one.segment)
        with Session(scene):
            taken.append(time.perf_counter() - began)
            worked.append(time.process_time() - worked_before)
    report |= {"loaded": median(taken), "loaded_worked": median(worked)}
    report["bytes"] = float(sum(one.segment.memory_bytes for one in found))
    report["count"] = float(len(found))
    return rows_of(report)


def rows_of(report: dict[str, float]) -> list[Row]:
    """Returns the rows of a report."""
    return [row_of(goal, report) for goal in SEGMENT_ROWS]


def drawn_out(volume: Volume, slices: int) -> Volume:
    """Returns a scan with another number of slices over the same length, interpolated."""
    ends = len(volume.array) - 1
    values = np.empty((slices, *volume.shape[1:]), np.int16)
    for number in range(slices):
        place = ends * number / (slices - 1)
        lower = min(int(place), ends - 1)
        share = place - lower
        values[number] = np.rint(
            volume.array[lower] * (1.0 - share) + volume.array[lower + 1] * share
        )
    x, y, z = volume.spacing
    return Volume(
        values,
        spacing=(x, y, z * ends / (slices - 1)),
        origin=volume.origin,
        direction=volume.direction,
        slope=volume.slope,
        intercept=volume.intercept,
        traits=volume.traits,
    )


def surface_seconds(
    volume: Volume, thresholds: tuple[float, float], *, runs: int
) -> dict[str, float]:
    """Returns the times of a threshold and its surface [s], and the number of triangles.

    Raises:
        RuntimeError: The surface does not arrive.
    """
    first, wanted = thresholds
    scene = Scene(volume)
    scene.add(volume.threshold(first))
    made, shown = [], []
    with Session(scene) as session:
        session.picture_changes()
        session.show_surface(1)
        heard = _next_surface(session, 0)
        for _ in range(runs):
            began = time.perf_counter()
            segment = volume.threshold(wanted)
            made.append(time.perf_counter() - began)
            session.replace_segment(1, segment)
            heard = _next_surface(session, heard)
            shown.append(time.perf_counter() - began)
            (surface,) = session.whole_surfaces()["surfaces"]
            session.replace_segment(1, volume.threshold(first))
            heard = _next_surface(session, heard)
    triangles = sum(_triangles(patch) for patch in surface["patches"])
    return {"threshold": median(made), "surface": median(shown), "triangles": float(triangles)}


def _next_surface(session: Session, heard: int) -> int:
    """Waits until surfaces have followed a change completely; returns the new count of changes."""
    ends = time.perf_counter() + PATIENCE
    while time.perf_counter() < ends:
        heard = session.wait_for_changes(heard, 0.1)
        if any(change["surfaces"] for change in session.picture_changes()):
            return heard
    raise RuntimeError(f"no surface came within {PATIENCE:g} s")


def _triangles(patch: SurfacePatch) -> int:
    """Returns the number of triangles of a patch, packed as in ``protocol.SurfacePatch``."""
    wide = len(patch["vertices"]) // 6 > 1 << 16
    return len(patch["triangles"]) // (12 if wide else 6)


def _grown(volume: Volume, marked: object, runs: int) -> dict[str, float]:
    taken, worked = [], []
    for _ in range(runs):
        began, worked_before = time.perf_counter(), time.process_time()
        found = grown(volume, [CLICK]).mask() != 0
        taken.append(time.perf_counter() - began)
        worked.append(time.process_time() - worked_before)
    liver = simpleitk().GetArrayFromImage(marked) == LIVER_LABEL
    both = int(np.count_nonzero(found & liver))
    dice = 2.0 * both / (int(np.count_nonzero(found)) + int(np.count_nonzero(liver)))
    return {"grown": median(taken), "grown_worked": median(worked), "dice": dice}
