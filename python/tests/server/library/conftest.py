"""A folder of DICOM that several tests of the library open."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest


@pytest.fixture
def study(write_series: Any) -> Path:
    """A folder with two series of four slices, and one that is a single picture."""
    write_series(uid="1.2.3", prefix="a", description="thin", PatientName="Doe^Jane")
    write_series(uid="1.2.4", prefix="b", description="thick")
    folder: Path = write_series(
        uid="1.2.5", prefix="c", description="scout", positions=[(0.0, 0.0, 0.0)]
    )
    return folder
