"""Readers by the names of their functions: imported where they are called, which is in a worker.

A process that only asks for a scan needs none of them, and starts sooner.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from palpate.io.dicom.header import Series
    from palpate.io.raw_scan import RawScan

__all__ = ["scan_at", "series_at"]


def scan_at(places: Sequence[Path], **options: Any) -> RawScan:  # noqa: ANN401
    """Reads a scan; see ``palpate.io.scan_at.scan_at``."""
    from palpate.io.scan_at import scan_at as read

    return read(places, **options)


def series_at(places: Sequence[Path], **options: Any) -> list[Series]:  # noqa: ANN401
    """Lists scans; see ``palpate.io.scan_at.series_at``."""
    from palpate.io.scan_at import series_at as listed

    return listed(places, **options)
