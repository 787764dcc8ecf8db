"""What is taken out of the scan is air for picture and touch, and one undo brings it back."""

from __future__ import annotations

import numpy as np
import pytest
from palpate import Scene, Session, SessionOptions, Volume
from palpate.base.errors import OptionError
from palpate.volumes.volume import VolumeTraits

STILL = SessionOptions(real_time=False)


def scan(unit: str = "HU") -> Volume:
    """Returns a bone of 6 × 6 × 6 voxels in soft tissue of 16 × 16 × 16."""
    values = np.full((16, 16, 16), 40, np.int16)
    values[5:11, 5:11, 5:11] = 1000
    return Volume(values, spacing=(1.0, 1.0, 1.0), traits=VolumeTraits(unit=unit))


def half_of(volume: Volume) -> np.ndarray:
    mask = np.zeros(volume.shape, np.uint8)
    mask[:, :, :8] = 1
    return mask


def test_voxels_leave_the_scan_and_all_segments_and_undo_brings_them_back() -> None:
    volume = scan()
    with Session(Scene(volume, [volume.threshold(500)]), options=STILL) as session:
        before = session.segment(1).mask()
        session.remove_from_scan(volume.segment(half_of(volume), name="half"))
        assert np.array_equal(session.segment(1).mask(), before & (1 - half_of(volume)))
        assert session.undo()
        assert np.array_equal(session.segment(1).mask(), before)
        assert session.redo()
        assert session.segment(1).voxel_count == before.sum() // 2


def test_a_threshold_of_the_session_leaves_out_what_was_removed() -> None:
    volume = scan()
    with Session(Scene(volume), options=STILL) as session:
        assert session.threshold(500, 2000).voxel_count == 6**3
        session.remove_from_scan(volume.segment(half_of(volume), name="half"))
        assert session.threshold(500, 2000).voxel_count == 6**3 // 2
        assert volume.threshold(500, 2000).voxel_count == 6**3


@pytest.mark.parametrize(("unit", "left"), [("HU", 16**3 // 2), ("", 16**3)])
def test_what_is_left_is_air_or_the_lowest_value_of_the_scan(unit: str, left: int) -> None:
    volume = scan(unit)
    with Session(Scene(volume), options=STILL) as session:
        session.remove_from_scan(volume.segment(half_of(volume), name="half"))
        assert session.threshold(0, 2000).voxel_count == left


def test_a_locked_segment_keeps_its_voxels() -> None:
    volume = scan()
    with Session(Scene(volume, [volume.threshold(500)]), options=STILL) as session:
        session.set_locked(1, locked=True)
        with pytest.raises(OptionError, match="locked"):
            session.remove_from_scan(volume.segment(half_of(volume), name="half"))
        assert session.segment(1).voxel_count == 6**3
