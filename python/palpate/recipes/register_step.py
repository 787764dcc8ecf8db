"""What ``palpate register`` and the step of that name do with two scans that were read."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from palpate.base.errors import PalpateError
from palpate.base.hints import prefixed
from palpate.base.progress import Progress
from palpate.base.whole_file import whole_file
from palpate.export.image import write_scan
from palpate.io.reading import read
from palpate.labels.labels import Labels, read_labels
from palpate.registration.landmarks_file import read_landmarks
from palpate.registration.registration import Registration, register
from palpate.registration.report import report_of, write_checkerboard
from palpate.registration.request import RegisterRequest
from palpate.volumes.resampled import interpolation_for
from palpate.volumes.segment import Segment
from palpate.volumes.volume import Volume

__all__ = ["Registered", "read_mask", "read_moving", "registered"]


@dataclass(frozen=True)
class Registered:
    """A registration that was found, and what was made of it."""

    found: Registration
    report: dict[str, Any]
    """As ``palpate.registration.report.report_of`` makes it."""
    written: tuple[Path, ...]
    warnings: tuple[str, ...]
    """Of the masks, and what speaks against the answer."""


def read_moving(request: RegisterRequest, *, progress: Progress) -> Volume:
    """Reads the scan that is to be registered.

    Raises:
        PalpateError: It cannot be read, or there are several.
    """
    series = None if request.moving_series is None else str(request.moving_series)
    try:
        return read(request.moving, series=series, frame=request.moving_frame, progress=progress)
    except PalpateError as error:
        raise type(error)(prefixed(str(error), "moving")) from None


def registered(
    fixed: Volume, moving: Volume, request: RegisterRequest, *, progress: Progress
) -> Registered:
    """Registers a scan to another one and writes what is asked for.

    Raises:
        PalpateError: They cannot be registered, or a file of masks or landmarks is none.
        OSError: The disk refuses a file.
    """
    pairs = None if request.landmarks is None else read_landmarks(request.landmarks)
    warnings: list[str] = []
    fixed_mask, moving_mask = (
        None if path is None else _mask(path, volume, request, warnings=warnings, progress=progress)
        for path, volume in ((request.fixed_mask, fixed), (request.moving_mask, moving))
    )
    found = register(
        fixed,
        moving,
        kind=request.kind,
        metric=request.metric,
        start=request.start,
        landmarks=pairs,
        fixed_mask=fixed_mask,
        moving_mask=moving_mask,
        options=request.search,
        progress=progress,
    )
    progress("writing", None)
    warnings += [] if found.doubt is None else [found.doubt]
    report = report_of(found, fixed, moving, landmarks=pairs)
    if request.output is not None:
        found.save(request.output)
    if request.write_inverse is not None:
        report["inverse"] = found.save_inverse(request.write_inverse, moving)
    if request.resampled is not None:
        by = interpolation_for(moving, request.interpolation)
        write_scan(found.resampled(moving, fixed, interpolation=by), request.resampled)
        report["interpolation"] = by
    if request.picture is not None:
        write_checkerboard(found, fixed, moving, path=request.picture)
    if request.report is not None:
        with whole_file(request.report) as unfinished:
            unfinished.write_text(json.dumps(report, indent=2) + "\n", encoding="utf-8")
    targets = (
        request.output,
        request.write_inverse,
        request.resampled,
        request.picture,
        request.report,
    )
    return Registered(
        found, report, tuple(path for path in targets if path is not None), tuple(warnings)
    )


def read_mask(
    path: Path, volume: Volume, request: RegisterRequest, *, progress: Progress
) -> Labels:
    """Reads the labels that make a mask.

    Raises:
        PalpateError: They cannot be read, or do not fit the scan.
    """
    return read_labels(
        path,
        volume,
        resample=request.resample,
        another_patient=request.another_patient,
        progress=progress,
    )


def _mask(
    path: Path,
    volume: Volume,
    request: RegisterRequest,
    *,
    warnings: list[str],
    progress: Progress,
) -> Segment:
    """Returns all labels of a file as one segment, and adds what is to be told of them."""
    read_from = read_mask(path, volume, request, progress=progress)
    warnings += [f"{path.name}: {warning}" for warning in read_from.warnings]
    together = np.any([one.segment.mask() != 0 for one in read_from.labels], axis=0)
    return volume.segment(together, name=path.name)
