"""Statistics of segments for pages: the table of ``palpate statistics``, and the same as CSV."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from palpate.base.progress import Progress
from palpate.segmentation.measures.segment_statistics import statistics
from palpate.segmentation.measures.statistics_table import statistics_cells, statistics_csv
from palpate.server.job import Emit, Job
from palpate.server.messages.segment_list import SegmentList

__all__ = ["statistics_job"]


def statistics_job(segments: SegmentList, values: Callable[[], NDArray[np.int16]]) -> Job:
    """Returns the answer that measures the segments as they are now; leaving it ends the work.

    Args:
        segments: The segments of the session.
        values: Returns the stored values of the scan as edits have left them.
    """

    def work(progress: Progress, emit: Emit) -> None:
        scene, notes = segments.scene(values())
        measured = statistics(scene, progress=progress)
        emit(
            {
                "kind": "statistics",
                "cells": statistics_cells(measured),
                "csv": statistics_csv(measured),
                "notes": notes,
            }
        )

    return Job(work)
