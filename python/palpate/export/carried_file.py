"""Files of one scan, carried to the other one through a transform: what each of them is, and how.

A scan and a label map become images on the other grid, a label map with the same numbers; segments
become a label map or ``.seg.nrrd``; meshes and tables of marks stay what they are.
"""

from __future__ import annotations

import csv
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, get_args

import numpy as np

from palpate.base.counted import counted
from palpate.base.errors import OptionError
from palpate.base.file_suffixes import IMAGE_SUFFIXES, MESH_SUFFIXES
from palpate.base.progress import Progress, silent
from palpate.base.whole_file import check_target, whole_file
from palpate.export.export import export_scene
from palpate.export.image import write_scan
from palpate.export.mark_table import read_marks
from palpate.io.reading import UNKNOWN_UNIT, read
from palpate.labels.kind import labels_told
from palpate.labels.label_values import label_values
from palpate.labels.labels import Label, read_labels
from palpate.labels.name_table import table_beside
from palpate.labels.own_grid import has_own_grid, own_grid
from palpate.labels.seg_nrrd import is_segmentation
from palpate.registration.carry import Carrier
from palpate.volumes.label_like import MOST_LABELS
from palpate.volumes.mesh_read import Frame, Unit, read_mesh
from palpate.volumes.mesh_write import write_mesh
from palpate.volumes.resampled import interpolation_for
from palpate.volumes.scene import Scene
from palpate.volumes.volume import Volume

__all__ = [
    "CarriedKind",
    "CarryOptions",
    "carried_kind",
    "carried_table",
    "carry_file",
    "check_carried",
    "check_ending",
]

CarriedKind = Literal["scan", "labels", "segments", "mesh", "marks"]
"""Labels are a label map, segments all other files of segments."""

ENDINGS: dict[CarriedKind, tuple[str, ...]] = {
    "scan": IMAGE_SUFFIXES,
    "labels": (".seg.nrrd", *IMAGE_SUFFIXES),
    "segments": (".seg.nrrd", *IMAGE_SUFFIXES),
    "mesh": MESH_SUFFIXES,
    "marks": (".csv",),
}


@dataclass(frozen=True, kw_only=True)
class CarryOptions:
    """How files are read that do not say everything."""

    series: str | None = None
    """DICOM series of a scan."""
    of: Volume | None = None
    """The scan that segments of DICOM belong to."""
    resample: bool = False
    """Whether those may lie on another grid than the scan."""
    another_patient: bool = False
    """Whether those may be another patient's."""
    frame: Frame | None = None
    """Of a mesh whose file does not tell it."""
    unit: Unit | None = None

    def __post_init__(self) -> None:
        """Refuses what is not known.

        Raises:
            OptionError: The frame or the unit is not.
        """
        for what, given, allowed in (
            ("frame", self.frame, get_args(Frame)),
            ("unit", self.unit, get_args(Unit)),
        ):
            if given is not None and given not in allowed:
                raise OptionError(f"{what} {given!r} given; allowed: {', '.join(allowed)}")


def carried_kind(path: Path, *, progress: Progress = silent) -> CarriedKind:
    """Returns what a file is.

    Raises:
        FileNotFoundError: It does not exist.
    """
    if not path.exists():
        raise FileNotFoundError(2, "does not exist", str(path))
    if path.suffix.lower() in MESH_SUFFIXES:
        return "mesh"
    if path.suffix.lower() == ".csv":
        return "marks"
    told = labels_told(path, progress=progress)
    if told is None:
        return "scan"
    return "labels" if told.image and not is_segmentation(path) else "segments"


def check_ending(kind: CarriedKind, out: Path) -> None:
    """Refuses a name under which a file of a kind cannot be written.

    Raises:
        OptionError: The ending does not fit, or the folder does not exist.
    """
    check_target(out, ENDINGS[kind])


def carried_table(kind: CarriedKind, out: Path, *, planned: Iterable[Path]) -> Path | None:
    """Returns the table of names that comes beside a file; None where there is none.

    Args:
        kind: What is carried.
        out: The new file.
        planned: Files that will be there by then.
    """
    if kind not in ("labels", "segments") or out.name.lower().endswith(".seg.nrrd"):
        return None
    return table_beside(out, planned=planned)


def check_carried(kind: CarriedKind, out: Path, carrier: Carrier) -> None:
    """Refuses what could not be written, before anything is computed.

    Raises:
        OptionError: The ending does not fit, the folder does not exist, or a grid is missing.
    """
    check_ending(kind, out)
    if kind in ("scan", "labels", "segments"):
        carrier.require_grid()


def carry_file(
    path: Path,
    out: Path,
    carrier: Carrier,
    *,
    kind: CarriedKind,
    options: CarryOptions,
    progress: Progress = silent,
) -> tuple[str, list[str]]:
    """Carries a file through a transform.

    Args:
        path: The file of one scan.
        out: The new file.
        carrier: The transform, its direction, and the grid of the other scan.
        kind: What the file is, as ``carried_kind`` says.
        options: How it is read.
        progress: Takes the progress.

    Returns:
        What was written, in words; and sentences on what was assumed, left out or lost.

    Raises:
        PalpateError: It cannot be read, nothing of it comes to lie in the other scan, or the
            transform has no inverse there.
        OSError: The disk refuses it.
    """
    check_carried(kind, out, carrier)
    if kind == "mesh":
        file = read_mesh(path, frame=options.frame, unit=options.unit)
        moved = carrier.mesh(file)
        write_mesh(moved.mesh, out)
        count = counted(len(moved.mesh.triangles), "triangle", "triangles")
        return f"a surface of {count}", list(file.notes)
    if kind == "marks":
        table = read_marks(path)
        table.with_points(carrier.points(table.points)).write(out)
        return counted(len(table.cells), "point", "points"), []
    if kind == "segments" or out.name.lower().endswith(".seg.nrrd"):
        return _carry_segments(path, out, carrier, options=options, progress=progress)
    return _carry_image(path, out, carrier, kind=kind, options=options, progress=progress)


def _carry_image(
    path: Path,
    out: Path,
    carrier: Carrier,
    *,
    kind: CarriedKind,
    options: CarryOptions,
    progress: Progress,
) -> tuple[str, list[str]]:
    """Draws a scan or a label map on the other grid."""
    volume = read(path, series=options.series, progress=progress)
    by = interpolation_for(volume, carrier.interpolation)
    if kind == "labels" and carrier.interpolation == "automatic":
        by = "nearest"
    progress(f"writing {out.name}", None)
    carried = carrier.scan(volume, interpolation=by)
    write_scan(carried, out)
    # the unit is that of before, known or not
    told = [warning for warning in volume.warnings if warning != UNKNOWN_UNIT]
    if kind == "scan":
        return f"a scan, interpolation {by}", told
    _write_table(path, out, volume, progress=progress)
    lost = np.setdiff1d(volume.values(), carried.values())
    if lost.size:
        told.append(f"labels {', '.join(map(str, lost.tolist()))} do not reach the grid")
    return f"a label map, interpolation {by}", told


def _carry_segments(
    path: Path, out: Path, carrier: Carrier, *, options: CarryOptions, progress: Progress
) -> tuple[str, list[str]]:
    if options.of is not None and has_own_grid(path):
        raise OptionError(
            f"`of=SCAN` given for {path.name}, which tells its grid itself; allowed: with DICOM "
            "SEG and RTSTRUCT"
        )
    source = own_grid(path, progress=progress) if options.of is None else options.of
    found = read_labels(
        path,
        source,
        resample=options.resample,
        another_patient=options.another_patient,
        progress=progress,
    )
    segments, told = carrier.segments([one.segment for one in found.labels])
    scene = Scene(carrier.require_grid())
    for label, segment in zip(found.labels, segments, strict=True):
        if segment is not None:
            scene.add(segment, colour=label.colour)
    told = [*found.warnings, *told, *export_scene(scene, out, progress=progress)]
    return counted(len(scene), "segment", "segments"), told


def _write_table(path: Path, out: Path, volume: Volume, *, progress: Progress) -> None:
    """Writes names and colours of labels beside the new map."""
    found = read_labels(path, volume, progress=progress).labels
    numbers = label_values(path, volume.values(), most=MOST_LABELS)
    with (
        whole_file(table_beside(out)) as unfinished,
        unfinished.open("w", encoding="utf-8", newline="") as file,
    ):
        table = csv.writer(file)
        table.writerow(["id", "structure", "red", "green", "blue"])
        for number, one in zip(numbers, found, strict=True):
            table.writerow([number, one.segment.name, *_cells(one)])


def _cells(one: Label) -> list[str]:
    return [] if one.colour is None else [f"{part:.6g}" for part in one.colour]
