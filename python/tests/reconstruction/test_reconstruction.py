"""Reconstruction of ellipsoids whose line integrals are known exactly, in HU."""

from __future__ import annotations

import sys
from dataclasses import replace
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import palpate
import pytest
import SimpleITK
from palpate.base.errors import OptionError, VolumeFormatError
from palpate.cli.commands import run
from palpate.reconstruction.beams import Beam
from palpate.reconstruction.projections import (
    are_projections,
    integrals_of,
    read_projections,
    stack_at,
)
from palpate.reconstruction.reconstruction import reconstruct
from palpate.reconstruction.request import ReconstructionRequest, grid_of, suggested
from palpate.reconstruction.scanner import Scanner, fitted_grid
from projected_phantom import SHAPE, SIZE, VOXEL, flat, projected, scanner_of, truth

needs_rtk = pytest.mark.skipif(
    find_spec("itk") is None, reason="RTK is not installed: pip install 'palpate[reconstruct]'"
)


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


@pytest.mark.parametrize("arc", [180.0, 360.0])
def test_parallel_beams_need_no_library(arc: float, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "itk", None)
    half = scanner_of("parallel")
    scanner = replace(half, angles=(arc / SHAPE[0] * np.arange(SHAPE[0])).tolist())
    images = projected(scanner)
    shares: list[float] = []

    def progress(_: str, share: float | None, /) -> None:
        if share is not None:
            shares.append(share)

    found = reconstruct(images, scanner, size=SIZE, voxel=VOXEL, progress=progress)
    values, right = found.slope * found.array + found.intercept, truth()
    inner = flat(right) & (right > -900.0)
    rmse = float(np.sqrt(((values - right)[inner] ** 2).mean()))
    assert rmse < 25.0, f"{rmse:.1f} HU"
    np.testing.assert_allclose(shares, np.arange(15) / 15)
    # a detector that stands aside sees the same
    aside = replace(scanner, offset=(2.6, 3.2))
    if arc == 360.0:
        moved = np.roll(images, (-2, -2), axis=(1, 2))
        again = reconstruct(moved, aside, size=SIZE, voxel=VOXEL)
        np.testing.assert_allclose(
            again.array[4:-4][inner[4:-4]], found.array[4:-4][inner[4:-4]], atol=60
        )
    # a window smooths, and keeps the mean
    soft = reconstruct(images, scanner, size=SIZE, voxel=VOXEL, hann=0.5)
    assert abs(float(np.mean(soft.array[inner]) - np.mean(found.array[inner]))) < 10.0
    assert float(np.std(soft.array[inner])) <= float(np.std(found.array[inner])) + 1.0


@needs_rtk
def test_parallel_beams_are_as_the_library_has_them(monkeypatch: pytest.MonkeyPatch) -> None:
    scanner = scanner_of("parallel")
    images = projected(scanner)
    by_rtk = reconstruct(images, scanner, size=SIZE, voxel=VOXEL)
    monkeypatch.setattr("palpate.reconstruction.reconstruction._has_rtk", lambda: False)
    own = reconstruct(images, scanner, size=SIZE, voxel=VOXEL)
    inner = flat(truth()) & (truth() > -900.0)
    assert float(np.abs(by_rtk.array - own.array)[inner].mean()) < 10.0


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


def test_what_is_not_stated_is_all_that_the_detector_sees() -> None:
    # 80 x 1.3 mm across, 40 x 1.6 mm along the axis
    grid = fitted_grid(SHAPE, scanner_of("parallel"))
    assert grid.size == (80, 80, 40)
    assert grid.voxel == (1.3, 1.3, 1.6)
    # at the axis a pixel is two thirds as large; rays to its sides come slantwise
    cone = fitted_grid(SHAPE, scanner_of("cone"))
    np.testing.assert_allclose(cone.voxel, [2.0 / 1.5, 2.0 / 1.5, 2.5 / 1.5])
    assert cone.size == (80, 80, 40)
    assert fitted_grid(SHAPE, scanner_of("parallel"), size=(52, 52, 32)).voxel == (2.0, 2.0, 2.0)
    assert fitted_grid(SHAPE, scanner_of("parallel"), voxel=(2.0, 2.0, 2.0)).size == (52, 52, 32)
    fine = Scanner(beam="parallel", angles=range(360), pixel=(0.1, 0.1))
    large = fitted_grid((360, 2048, 2048), fine)
    assert large.size == (512, 512, 512), "no more than a usual scan has"
    with pytest.raises(OptionError, match="2 or more along each axis"):
        fitted_grid(SHAPE, scanner_of("parallel"), size=(0, 8, 8))


@needs_rtk
def test_it_tells_how_far_it_is_and_stops_when_asked() -> None:
    scanner = scanner_of("parallel")
    images = projected(scanner)
    shares: list[float] = []

    def progress(_: str, share: float | None, /) -> None:
        if share is not None:
            shares.append(share)
        if share is not None and share > 0.5:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        reconstruct(images, scanner, size=SIZE, voxel=VOXEL, progress=progress)
    # a few of the projections, seen from both sides, at a time
    np.testing.assert_allclose(shares, np.arange(len(shares)) * 8 / 240)


def test_projections_are_known_by_their_names(tmp_path: Path) -> None:
    stack = np.arange(10 * 4 * 5, dtype=np.uint16).reshape(10, 4, 5)
    image = SimpleITK.GetImageFromArray(stack)
    image.SetSpacing((0.4, 0.6, 1.0))
    for name in (
        "head.nrrd",
        "head_proj.nrrd",
        "Sinogram-1.mha",
        "projected.mha",
        "any.tif",
        "sino.tif",
    ):
        SimpleITK.WriteImage(image, str(tmp_path / name))
    (tmp_path / "projections.zip").write_bytes(b"PK")
    known = {path.name for path in tmp_path.iterdir() if are_projections(path)}
    assert known == {"head_proj.nrrd", "Sinogram-1.mha", "sino.tif"}
    folder = tmp_path / "projections"
    folder.mkdir()
    for number, slice_ in enumerate(stack):
        SimpleITK.WriteImage(SimpleITK.GetImageFromArray(slice_), str(folder / f"{number}.tif"))
        assert are_projections(folder) == (number >= 7)
    np.testing.assert_array_equal(read_projections(folder), stack)
    # slices of a scan may be TIFFs too
    assert not are_projections(folder.rename(tmp_path / "slices"))

    told = stack_at(tmp_path / "head_proj.nrrd")
    assert (told.name, told.shape, told.pixel) == ("head_proj", (10, 4, 5), (0.4, 0.6))
    likely = suggested(told)
    assert (likely.beam, likely.arc, likely.intensities) == ("cone", 360.0, 65535.0)
    likely = suggested(stack_at(tmp_path / "Sinogram-1.mha"))
    assert (likely.beam, likely.arc, likely.sinograms) == ("parallel", 180.0, True)
    # one image for each of four rows
    with pytest.raises(OptionError, match="4 angles and 4 projections given"):
        grid_of(told, ReconstructionRequest(beam="parallel", pixel=(1.0, 1.0), sinograms=True))


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
    with pytest.raises(VolumeFormatError, match="is no readable nrrd file"):
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
    distances = ["--source-axis", "600", "--source-detector", "900"]
    command = ["reconstruct", str(path), "-o", str(out), "--beam", "cone", *distances]
    assert run([*command, *geometry]) == 2
    assert "RTK is not installed; allowed: with it" in capsys.readouterr().err
    assert run([*command, *geometry[:2], "--size", "8,8", *geometry[4:]]) == 2
    assert "size '8,8' given; allowed: 3 numbers, X,Y,Z" in capsys.readouterr().err
    assert not out.exists()
