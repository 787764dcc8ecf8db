"""Tilted and uneven stacks become right grids on which every value stands at its place."""

from __future__ import annotations

from typing import Any

import numpy as np
import palpate
import pytest
import SimpleITK
from numpy.typing import NDArray
from palpate.base.errors import VolumeFormatError
from palpate.base.progress import silent
from palpate.io.dicom.geometry import Stack, grid_of
from palpate.io.dicom.resample import resample

Points = NDArray[np.float64]

TILT = np.radians(18.5)
TILTED = (1.0, 0.0, 0.0, 0.0, float(np.cos(TILT)), float(-np.sin(TILT)))


def test_a_tilted_series_grows_sideways_and_says_so(write_series: Any) -> None:
    positions = [(0.0, 0.0, 4.0 * k) for k in range(6)]
    volume = palpate.read(write_series(positions=positions, orientation=TILTED))
    # 20 mm along the table, 20 sin 18.5 degrees = 6.35 mm sideways: 13 rows of 0.5 mm more
    assert volume.dimensions == (4, 3 + 13, 6)
    assert volume.spacing == pytest.approx((0.75, 0.5, 4.0 * np.cos(TILT)))
    (warning,) = volume.warnings
    assert "tilted by 18.5 degrees" in warning
    assert "4 x 16 x 6 voxels on a right grid" in warning
    assert "uneven" not in warning
    # the last slice is as it was; each stands where its own header says
    grid_from_patient = np.linalg.inv(volume.patient_from_grid)
    for number, position in enumerate(positions):
        x, y, z = (grid_from_patient @ (*position, 1.0))[:3] - 0.5
        assert (x, z) == pytest.approx((0.0, number), abs=1e-6)
        row = int(np.ceil(y - 1e-6))
        between = (row - y) * 4.0
        # values rise by 4 a row
        expected = 100 * number - 1024 + between
        assert volume.array[number, row, 0] == pytest.approx(expected, abs=0.51)
        assert (volume.array[number, :row] == -1000).all()
        assert (volume.array[number, row + 3 :] == -1000).all()


def test_missing_slices_are_filled_between_their_neighbours_and_told(write_series: Any) -> None:
    positions = [(0.0, 0.0, z) for z in (0.0, 2.5, 5.0, 10.0, 12.5)]
    volume = palpate.read(write_series(positions=positions))
    assert volume.dimensions == (4, 3, 6)
    assert volume.spacing == (0.75, 0.5, 2.5)
    assert "1 slice is missing, after number 3" in volume.warnings[0]
    np.testing.assert_array_equal(
        volume.array[:, 0, 0] + 1024, [0.0, 100.0, 200.0, 250.0, 300.0, 400.0]
    )


def test_uneven_steps_take_the_finest_usual_one(write_series: Any) -> None:
    heights = [*np.arange(0.0, 10.0, 1.0), *np.arange(10.0, 40.1, 3.0)]
    volume = palpate.read(write_series(positions=[(0.0, 0.0, float(z)) for z in heights]))
    assert volume.dimensions == (4, 3, 41)
    assert volume.spacing[2] == pytest.approx(1.0)
    assert "uneven: 1.00 to 3.00 mm" in volume.warnings[0]
    expected = np.interp(np.arange(41.0), heights, 100.0 * np.arange(len(heights)))
    np.testing.assert_allclose(volume.array[:, 0, 0] + 1024, expected, atol=0.5)


def test_a_wide_gap_is_not_filled(write_series: Any) -> None:
    positions = [(0.0, 0.0, z) for z in (0.0, 2.5, 5.0, 7.5, 20.0)]
    with pytest.raises(VolumeFormatError, match=r"a gap of 12\.5 mm .* allowed"):
        palpate.read(write_series(positions=positions))


def test_slices_turned_against_each_other_are_no_stack(write_series: Any) -> None:
    def turned(number: int, dataset: Any) -> None:
        angle = 0.0005 * number
        dataset.ImageOrientationPatient = [1, 0, 0, 0, np.cos(angle), np.sin(angle)]

    def clearly(number: int, dataset: Any) -> None:
        turned(24 * number, dataset)

    assert palpate.read(write_series("near", each=turned)).dimensions == (4, 3, 4)
    # each is taken for a series of its own
    with pytest.raises(VolumeFormatError, match="holds 4 series"):
        palpate.read(write_series("far", each=clearly))


def test_a_grid_that_grows_too_large_is_refused_before_pixels_are_read(
    write_series: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("palpate.io.dicom.reading.read_slices", None)
    positions = [(0.0, 0.0, 4.0 * k) for k in range(6)]
    folder = write_series(positions=positions, orientation=TILTED)
    with pytest.raises(VolumeFormatError, match="4 x 16 x 6 = 384 voxels; allowed: at most 383"):
        palpate.read(folder, max_voxels=383)


def turned_axes() -> NDArray[np.float64]:
    """Returns axes that are oblique to all of the patient's."""
    axes, _ = np.linalg.qr(np.array([[1.0, 0.3, 0.1], [0.2, 1.0, -0.4], [-0.1, 0.5, 1.0]]))
    if np.linalg.det(axes) < 0.0:
        axes[:, 0] *= -1.0
    return np.asarray(axes, np.float64)


def points_of(stack: Stack, shape: tuple[int, ...]) -> Points:
    """Returns where the pixels of a stack stand, shape [slices, rows, columns, 3]."""
    _, y, x = np.mgrid[tuple(slice(length) for length in shape)]
    in_plane = x[..., None] * stack.pixel[0] * stack.axes[:, 0]
    in_plane = in_plane + y[..., None] * stack.pixel[1] * stack.axes[:, 1]
    return np.asarray(stack.positions[:, None, None] + in_plane)


def oblique_stack(heights: Points, drift: Points) -> Stack:
    axes = turned_axes()
    positions = (5.0, -7.0, 11.0) + heights[:, None] * axes[:, 2] + drift @ axes[:, :2].T
    return Stack(tuple(range(len(heights))), (0.8, 0.6), axes, positions)


def test_what_is_linear_in_space_stays_so_on_the_grid() -> None:
    at_random = np.random.default_rng(7)
    heights = np.asarray(np.cumsum(at_random.uniform(1.0, 2.5, 12)), np.float64)
    stack = oblique_stack(heights, np.outer(heights, (0.31, -0.17)))
    points = points_of(stack, (12, 9, 10))
    rise = np.array([3.0, -2.0, 5.0])
    grid = grid_of("stack", stack, columns=10, rows=9)
    filled = resample(points @ rise, stack, grid, air=-9999.0, progress=silent)

    x, y, z = np.mgrid[tuple(slice(length) for length in grid.size)]
    index = np.stack([x, y, z], axis=-1) * grid.spacing
    stands = grid.origin + index @ grid.direction.T
    expected = (stands @ rise).transpose(2, 1, 0)
    inside = filled != -9999.0
    assert inside.mean() > 0.25
    # 1e-3: single precision of numbers up to a few hundred
    np.testing.assert_allclose(filled[inside], expected[inside], atol=1e-3)


def test_an_even_tilt_gives_what_itk_gives_through_a_shear() -> None:
    at_random = np.random.default_rng(3)
    values = at_random.uniform(-1000.0, 1000.0, (7, 11, 13)).astype(np.float32)
    heights = np.arange(0.0, 14.0, 2.0)
    slope = np.array([0.23, -0.41])
    stack = oblique_stack(heights, np.outer(heights, slope))
    grid = grid_of("stack", stack, columns=13, rows=11)
    filled = resample(values, stack, grid, air=-3000.0, progress=silent)

    # in the stack's own frame, a shear leads from the right grid to the slices
    image = SimpleITK.GetImageFromArray(values)
    image.SetSpacing((0.8, 0.6, 2.0))
    shear = SimpleITK.AffineTransform(3)
    shear.SetMatrix((1.0, 0.0, -slope[0], 0.0, 1.0, -slope[1], 0.0, 0.0, 1.0))
    origin = (np.array(grid.origin) - stack.positions[0]) @ stack.axes
    asked = SimpleITK.ResampleImageFilter()
    asked.SetSize(grid.size)
    asked.SetOutputSpacing(grid.spacing)
    asked.SetOutputOrigin(origin.tolist())
    asked.SetTransform(shear)
    asked.SetDefaultPixelValue(-3000.0)
    expected = SimpleITK.GetArrayFromImage(asked.Execute(image))
    # ITK repeats the outermost half pixel, where nothing was measured: there is air here
    known = filled != -3000.0
    assert known.mean() > 0.35
    np.testing.assert_allclose(filled[known], expected[known], atol=0.01)


def test_a_stack_written_from_end_to_start_is_the_same(write_series: Any) -> None:
    positions = [(0.0, 0.0, 4.0 * k) for k in range(6)]
    forth = palpate.read(write_series("a", positions=positions, orientation=TILTED))

    def backward(number: int, dataset: Any) -> None:
        dataset.PixelData = (100 * (5 - number) + np.arange(12, dtype="<u2")).tobytes()

    back = palpate.read(
        write_series("b", positions=positions[::-1], orientation=TILTED, each=backward)
    )
    np.testing.assert_array_equal(forth.array, back.array)
    np.testing.assert_allclose(forth.patient_from_grid, back.patient_from_grid)
