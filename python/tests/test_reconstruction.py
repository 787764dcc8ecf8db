"""Reconstruction of ellipsoids whose line integrals are known exactly, in HU."""

from __future__ import annotations

import sys
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import palpate
import pytest
import SimpleITK
from numpy.typing import NDArray
from palpate.cli import run
from palpate.errors import OptionError, VolumeFormatError
from palpate.projections import integrals_of, read_projections
from palpate.reconstruction import WATER, Beam, Scanner, reconstruct

Values = NDArray[np.float64]

needs_rtk = pytest.mark.skipif(
    find_spec("itk") is None, reason="RTK is not installed: pip install 'palpate[reconstruct]'"
)

BODY = ((0.0, 0.0, 0.0), (42.0, 34.0, 60.0), 1.0)
"""Middle and half axes in the patient [mm], attenuation added to that of air [of water]."""
PARTS = (BODY, ((16.0, -10.0, 8.0), (9.0, 7.0, 8.0), 0.8), ((-18.0, 8.0, -10.0), (8.0,) * 3, -0.5))

SIZE, VOXEL = (48, 44, 24), (2.0, 2.0, 2.0)
SHAPE = (120, 40, 80)
SCANNERS = {
    "cone": ((2.0, 2.5), (600.0, 900.0), 360.0),
    "parallel": ((1.3, 1.6), (0.0, 0.0), 180.0),
}


def scanner_of(beam: Beam) -> Scanner:
    pixel, (near, far), arc = SCANNERS[beam]
    return Scanner(
        beam=beam,
        angles=(arc / SHAPE[0] * np.arange(SHAPE[0])).tolist(),
        pixel=pixel,
        source_to_axis=near,
        source_to_detector=far,
    )


def projected(scanner: Scanner) -> Values:
    """Line integrals through the parts, by where rays meet each ellipsoid."""
    _, rows, columns = SHAPE
    u = scanner.pixel[0] * (np.arange(columns) - 0.5 * (columns - 1))
    v = scanner.pixel[1] * (np.arange(rows) - 0.5 * (rows - 1))
    images = []
    for angle in np.radians(scanner.angles):
        # the device: y is the axis; the source goes from +z toward +x
        toward = np.array([np.sin(angle), 0.0, np.cos(angle)])
        across = np.array([np.cos(angle), 0.0, -np.sin(angle)])
        pixels = u[None, :, None] * across + v[:, None, None] * np.array([0.0, 1.0, 0.0])
        if scanner.beam == "cone":
            start = np.broadcast_to(scanner.source_to_axis * toward, pixels.shape)
            ends = pixels + (scanner.source_to_axis - scanner.source_to_detector) * toward
            way = ends - start
        else:
            start, way = pixels, np.broadcast_to(-toward, pixels.shape)
        way = way / np.linalg.norm(way, axis=-1, keepdims=True)
        images.append(sum(_through(part, start, way) for part in PARTS))
    found: Values = np.array(images)
    return found


def _through(
    part: tuple[tuple[float, ...], tuple[float, ...], float], start: Values, way: Values
) -> Values:
    (x, y, z), (a, b, c), density = part
    # patient to device: x, z, -y
    middle, axes = np.array([x, z, -y]), np.array([a, c, b])
    p, d = (start - middle) / axes, way / axes
    dd, pd, pp = (d * d).sum(-1), (p * d).sum(-1), (p * p).sum(-1)
    root = np.maximum(pd * pd - dd * (pp - 1.0), 0.0)
    length: Values = 2.0 * np.sqrt(root) / dd
    return density * WATER * length


def truth() -> Values:
    """HU of the phantom at the middles of voxels."""
    z, y, x = np.indices(SIZE[::-1])
    points = (np.stack([x, y, z], axis=-1) - 0.5 * (np.array(SIZE) - 1)) * VOXEL
    water = np.zeros(points.shape[:-1])
    for middle, axes, density in PARTS:
        water += density * ((((points - middle) / axes) ** 2).sum(-1) <= 1.0)
    values: Values = 1000.0 * (water - 1.0)
    return values


def flat(values: Values) -> NDArray[np.bool_]:
    """Voxels whose neighbours all have the same value: borders are as sharp as voxels are."""
    same = np.ones(values.shape, bool)
    for axis in range(3):
        for step in (-2, -1, 1, 2):
            same &= np.roll(values, step, axis=axis) == values
    same[:4] = same[-4:] = False
    return same


@needs_rtk
@pytest.mark.parametrize("beam", ["parallel", "cone"])
def test_a_phantom_comes_back_in_hounsfield_units(beam: Beam) -> None:
    scanner = scanner_of(beam)
    found = reconstruct(projected(scanner), scanner, size=SIZE, voxel=VOXEL)
    assert found.unit == "HU"
    assert found.dimensions == SIZE
    np.testing.assert_allclose(found.patient_from_grid[:3, 3], [-48.0, -44.0, -24.0])
    values, right = found.slope * found.array + found.intercept, truth()
    inner = flat(right) & (right > -900.0)
    rmse = float(np.sqrt(((values - right)[inner] ** 2).mean()))
    assert rmse < 25.0, f"{beam}: {rmse:.1f} HU"


@needs_rtk
def test_the_command_writes_a_scan_that_opens(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    images = projected(scanner_of("parallel"))
    counts = (1e5 * np.exp(-images)).astype(np.float32)
    path, out = tmp_path / "sinograms.nrrd", tmp_path / "scan.nii.gz"
    SimpleITK.WriteImage(SimpleITK.GetImageFromArray(counts.transpose(1, 0, 2)), str(path))
    options = ["--beam", "parallel", "--arc", "180", "--sinograms", "--intensities", "1e5"]
    geometry = ["--pixel", "1.3,1.6", "--size", "48,44,24", "--voxel", "2,2,2"]
    assert run(["reconstruct", str(path), "-o", str(out), *options, *geometry]) == 0
    scan = palpate.read(out)
    assert scan.dimensions == SIZE
    here = flat(truth()) & (truth() == 0.0)
    assert abs(float(np.median(scan.array[here]))) < 15.0
    assert f"{out}: 48 x 44 x 24 voxels" in capsys.readouterr().out


def test_counts_become_line_integrals() -> None:
    counts = np.array([1000.0, 1000.0 / np.e, 0.0], np.float32)
    found = integrals_of(counts, 1000.0)
    np.testing.assert_allclose(found[:2], [0.0, 1.0], atol=1e-6)
    assert np.isfinite(found[2])
    with pytest.raises(OptionError, match="intensities of 0 given"):
        integrals_of(counts, 0.0)


def test_stacks_are_read_from_files_and_folders(tmp_path: Path) -> None:
    stack = np.arange(3 * 4 * 5, dtype=np.uint16).reshape(3, 4, 5)
    for name in ("stack.nrrd", "stack.tif"):
        SimpleITK.WriteImage(SimpleITK.GetImageFromArray(stack), str(tmp_path / name))
        np.testing.assert_array_equal(read_projections(tmp_path / name), stack)
    turned = read_projections(tmp_path / "stack.nrrd", sinograms=True)
    np.testing.assert_array_equal(turned, stack.transpose(1, 0, 2))
    folder = tmp_path / "folder"
    folder.mkdir()
    for number, image in enumerate(stack):
        SimpleITK.WriteImage(SimpleITK.GetImageFromArray(image), str(folder / f"{number}.tif"))
    np.testing.assert_array_equal(read_projections(folder), stack)
    (tmp_path / "none.nrrd").write_text("no image")
    with pytest.raises(VolumeFormatError, match="cannot be read"):
        read_projections(tmp_path / "none.nrrd")


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"beam": "fan"}, "beam 'fan' given; allowed: parallel, cone"),
        ({"angles": [0.0, 1.0]}, "2 angles and 120 projections given"),
        ({"angles": np.linspace(0.0, 199.0, 120).tolist()}, "an arc of 200.672 degrees given"),
        ({"angles": [0.0, 5.0, *range(118)]}, "uneven angles given; allowed: even ones over 360"),
        ({"pixel": (0.0, 1.0)}, "allowed: lengths above 0"),
        ({"source_to_axis": 950.0}, "source at 950 mm from the axis and 900 mm"),
    ],
)
def test_geometry_that_cannot_be_is_refused(change: dict[str, object], said: str) -> None:
    scanner = scanner_of("cone")
    with pytest.raises(OptionError, match=said):
        Scanner(**{**scanner.__dict__, **change}).check(SHAPE)


def test_without_rtk_it_says_what_to_install(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setitem(sys.modules, "itk", None)
    path, out = tmp_path / "stack.nrrd", tmp_path / "scan.nii.gz"
    SimpleITK.WriteImage(SimpleITK.GetImageFromArray(np.ones((10, 4, 5), np.float32)), str(path))
    geometry = ["--pixel", "1,1", "--size", "8,8,4", "--voxel", "1,1,1"]
    command = ["reconstruct", str(path), "-o", str(out), "--beam", "parallel"]
    assert run([*command, *geometry]) == 2
    assert "RTK is not installed; allowed: with it" in capsys.readouterr().err
    assert run([*command, *geometry[:2], "--size", "8,8", *geometry[4:]]) == 2
    assert "size '8,8' given; allowed: 3 numbers with commas" in capsys.readouterr().err
    assert not out.exists()
