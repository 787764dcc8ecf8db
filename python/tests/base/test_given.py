"""What is given in Python and is no number, path or array is refused in one line."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import nibabel
import numpy as np
import palpate
import pytest
from palpate.base.counted import counted
from palpate.base.errors import PalpateError
from palpate.base.given import number, path_of, whole_number
from palpate.volumes.volume import Volume

ARRAY = np.arange(60, dtype=np.int16).reshape(3, 4, 5)
ODD: tuple[Any, ...] = ("a", b"a", None, [1], (), {}, object(), True, 1j, ARRAY, ...)


def one_line(act: Callable[[], object]) -> str:
    """Returns the message of what is refused."""
    with pytest.raises(PalpateError) as refused:
        act()
    said = str(refused.value)
    assert "allowed: " in said
    assert "\n" not in said
    assert "object at 0x" not in said
    assert len(said) < 200
    return said


@pytest.mark.parametrize("odd", ODD, ids=lambda odd: type(odd).__name__)
def test_odd_numbers_are_refused(odd: Any, tmp_path: Path) -> None:
    volume = Volume(ARRAY, spacing=(1, 1, 1))
    for act in (
        lambda: volume.threshold(odd),
        lambda: Volume(ARRAY, spacing=(1, 1, 1), slope=odd),
        lambda: Volume(ARRAY, spacing=(1, 1, 1), intercept=odd),
        lambda: Volume(ARRAY, spacing=odd),
        lambda: palpate.read(tmp_path, max_voxels=odd),
    ):
        one_line(act)
    if odd is not None:
        one_line(lambda: volume.threshold(0, odd))
        assert "frame" in one_line(lambda: palpate.read(tmp_path, frame=odd))
        assert "fill" in one_line(lambda: palpate.read(tmp_path, fill=odd))
    if not isinstance(odd, np.ndarray):
        one_line(lambda: Volume(ARRAY, spacing=(1, 1, 1), direction=odd))


@pytest.mark.parametrize("odd", [5, None, b"a", 1.5, [5], True, ARRAY[0, 0]], ids=repr)
def test_odd_paths_are_refused(odd: Any) -> None:
    volume = Volume(ARRAY, spacing=(1, 1, 1))
    for act in (
        lambda: palpate.read(odd),
        lambda: palpate.io.list_series(odd),
        lambda: palpate.read_labels(odd, volume),
        lambda: palpate.export_scene(palpate.Scene(volume), odd),
    ):
        assert "path" in one_line(act)


def test_what_numpy_has_is_a_number() -> None:
    assert number("a", np.float32(2.5)) == 2.5
    assert whole_number("a", np.int64(3)) == 3
    assert whole_number("a", 1e9) == 10**9
    assert path_of(Path("a")) == path_of("a") == Path("a")
    spacing: Any = np.ones(3)
    low: Any = np.int16(3)
    volume = Volume(ARRAY, spacing=spacing, direction=np.eye(3).tolist())
    assert volume.threshold(low, np.float64(5)).voxel_count == 3


@pytest.mark.parametrize("fill", [1e300, -1e39, np.nan, np.inf])
def test_fillings_that_are_no_value_are_refused(fill: float, tmp_path: Path) -> None:
    assert "fill is" in one_line(lambda: palpate.read(tmp_path, fill=fill))


def test_a_volume_in_the_place_of_an_array_is_named_by_its_type() -> None:
    volume: Any = Volume(ARRAY, spacing=(1, 1, 1))
    assert "mask of 'a' is of type Volume" in one_line(lambda: volume.segment(volume, name="a"))
    assert "of type Volume" in one_line(lambda: Volume(volume, spacing=(1, 1, 1)))
    assert "of type Volume" in one_line(lambda: Volume(ARRAY, spacing=volume))


def test_a_threshold_without_an_upper_limit_is_told_so() -> None:
    volume = Volume(ARRAY, spacing=(1, 1, 1))
    assert "threshold from 2000 selects no voxel" in one_line(lambda: volume.threshold(2000))


@pytest.mark.parametrize("low", [2**53, 2**53 + 1, -(2**60) - 3, 2**63 - 60])
def test_thresholds_of_large_integers_are_exact(low: int) -> None:
    values = np.arange(60, dtype=np.int64).reshape(3, 4, 5) + low
    volume = Volume(values, spacing=(1, 1, 1))
    np.testing.assert_array_equal(volume.values(), values)
    assert volume.threshold(low + 1).voxel_count == 59
    assert volume.threshold(low + 7, low + 7).voxel_count == 1
    assert volume.threshold(low + 58, low + 59).voxel_count == 2


def test_counts_agree_with_what_is_said() -> None:
    assert counted(1, "file is", "files are") == "1 file is"
    assert counted(2, "file is", "files are") == "2 files are"
    assert counted(1, "slices is", "slices are", of=9) == "1 of 9 slices is"


def test_sides_that_agree_are_said_once(tmp_path: Path) -> None:
    image = nibabel.Nifti1Image(ARRAY.T, np.eye(4))
    moved = np.eye(4)
    moved[0, 3] = 5.0
    image.set_sform(moved, 1)
    image.set_qform(np.eye(4), 1)
    nibabel.save(image, tmp_path / "a.nii")
    (told,) = [one for one in palpate.read(tmp_path / "a.nii").warnings if "disagree" in one]
    assert "axes toward RAS in both: the sform is used" in told
