"""Dates of DICOM as people write them."""

from __future__ import annotations

import re

__all__ = ["written_date"]


def written_date(told: str) -> str:
    """Returns a date of DICOM (PS3.5, DA: 20000131) as 2000-01-31; as it is where it is none."""
    parts = re.fullmatch(r"(\d{4})\.?([01]\d)\.?([0-3]\d)", told.strip())
    return told if parts is None else "-".join(parts.groups())
