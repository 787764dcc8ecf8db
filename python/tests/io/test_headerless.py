"""Files that do not tell their layout: what is likely of them, and what a layout makes of them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import SimpleITK
from numpy.typing import NDArray
from palpate.base.errors import VolumeFormatError
from palpate.io.headerless import headerless_pictures, headerless_raw, laid_out
from palpate.io.raw_voxels import RawLayout


def head(shape: tuple[int, int, int], kind: str) -> NDArray[Any]:
    """A ball in noise, as scans are: rows are alike, and low bytes are not."""
    axes = [np.linspace(-1.0, 1.0, count) for count in shape]
    z, y, x = np.meshgrid(*axes, indexing="ij")
    inside = np.clip(3.0 * (0.8 - np.sqrt(x * x + y * y + z * z)), 0.0, 1.0)
    noise = np.random.default_rng(7).normal(0.0, 0.02, shape)
    top = 250.0 if kind.endswith("1") else 3000.0
    return np.asarray(np.clip(inside + noise, 0.0, 1.0) * top).astype(kind)


@pytest.mark.data
def test_the_slices_of_cthead_are_known(data_folder: Path) -> None:
    headerless = headerless_raw(data_folder / "cthead_stanford" / "raw")
    assert headerless is not None
    assert headerless.layout == RawLayout(256, 256, None, np.dtype(">i2"), 0)
    assert (headerless.begins, headerless.files, headerless.held) == ("CThead", 113, 113 * 131072)
    size, middle = laid_out(headerless.path, headerless.layout)
    assert size == (256, 256, 113)
    assert middle.max() < 3500


@pytest.mark.parametrize(
    ("name", "shape", "kind", "header"),
    [
        ("head.raw", (20, 256, 256), "<i2", 0),
        ("head.raw", (20, 256, 256), ">i2", 0),
        ("head.bin", (64, 64, 64), "u1", 0),
        ("head.dat", (40, 40, 40), ">f4", 0),
        ("head_40x30x20_int16_be.raw", (20, 30, 40), ">i2", 348),
        ("head-40x30x20.raw", (20, 30, 40), "<u2", 0),
        ("head 40x30 float 0.5x0.5x1.25mm.vol", (20, 30, 40), "<f4", 512),
    ],
)
def test_a_layout_is_guessed_from_name_size_and_values(
    tmp_path: Path, name: str, shape: tuple[int, int, int], kind: str, header: int
) -> None:
    values = head(shape, kind)
    path = tmp_path / name
    path.write_bytes(bytes(header) + values.tobytes())
    headerless = headerless_raw(path)
    assert headerless is not None
    assert headerless.layout is not None
    size, middle = laid_out(path, headerless.layout)
    assert size == shape[::-1]
    np.testing.assert_array_equal(middle, values[shape[0] // 2])
    assert headerless.voxel == ((0.5, 0.5, 1.25) if "mm" in name else (None, None, None))


def test_slices_behind_a_header_are_guessed(tmp_path: Path) -> None:
    values = head((6, 128, 128), ">i2")
    for number, pixels in enumerate(values, 1):
        (tmp_path / f"i.{number:03}").write_bytes(bytes(3180) + pixels.tobytes())
    headerless = headerless_raw(tmp_path)
    assert headerless is not None
    assert headerless.layout == RawLayout(128, 128, None, np.dtype(">i2"), 3180)
    assert laid_out(tmp_path, headerless.layout)[0] == (128, 128, 6)


def test_what_is_something_else_is_not_taken_as_raw(tmp_path: Path, write_image: Any) -> None:
    assert headerless_raw(write_image(np.zeros((3, 4, 5), np.int16))) is None
    for name, content in (
        ("notes.md", "é" * 4095 + "a scan of a head"),
        ("short", "\0"),
        ("archive.raw", None),
    ):
        path = tmp_path / name
        if content is None:
            import zipfile

            with zipfile.ZipFile(path, "w") as archive:
                archive.writestr("a", "b" * 200)
        else:
            path.write_bytes(content.encode())
        assert headerless_raw(path) is None
    assert headerless_raw(tmp_path) is None
    # a pair of NIfTI has its voxels in a file that tells nothing
    voxels = tmp_path / "pair.img"
    voxels.write_bytes(bytes(400))
    assert headerless_raw(voxels) is not None
    voxels.with_suffix(".hdr").touch()
    assert headerless_raw(voxels) is None


def test_layouts_that_do_not_fit_say_what_would(tmp_path: Path) -> None:
    path = tmp_path / "scan.raw"
    path.write_bytes(bytes(480))
    for layout, said in (
        ("8x5x4,int16", "480 bytes; 8 x 5 x 4 int16 asks 320; allowed: 6 slices, or 160 bytes to"),
        ("8x5x6,uint8", "asks 240; allowed: 12 slices, or 240 bytes to skip, or numbers of int16"),
        ("8x7,int16", "asks 112 and 112 for each slice more; allowed: 32 bytes to skip"),
        ("8x5x6,int16,little,7", "after 7 bytes asks 487; allowed: 0 bytes to skip"),
        ("500x500,int16", "allowed: other columns and rows"),
    ):
        with pytest.raises(VolumeFormatError, match=f"{said}"):
            laid_out(path, RawLayout.of(layout))


def test_pictures_tell_their_size_and_pixels(tmp_path: Path) -> None:
    stack = head((3, 20, 30), "u1")
    for number, pixels in enumerate(stack):
        image = SimpleITK.GetImageFromArray(pixels)
        image.SetSpacing((0.5, 0.25))
        SimpleITK.WriteImage(image, str(tmp_path / f"s{number}.tif"))
    headerless = headerless_pictures(tmp_path)
    assert headerless is not None
    assert (headerless.layout, headerless.size, headerless.files) == (None, (30, 20, 3), 3)
    assert headerless.voxel[:2] == pytest.approx((0.5, 0.25))
    assert headerless.voxel[2] is None
    size, middle = laid_out(tmp_path, None)
    assert size == (30, 20, 3)
    np.testing.assert_array_equal(middle, stack[1])
    # one picture is no scan, many pages are
    assert headerless_pictures(tmp_path / "s1.tif") is None
    pages = tmp_path / "all" / "pages.tif"
    pages.parent.mkdir()
    SimpleITK.WriteImage(SimpleITK.GetImageFromArray(stack), str(pages))
    headerless = headerless_pictures(pages)
    assert headerless is not None
    assert (headerless.size, headerless.voxel) == ((30, 20, 3), (None, None, None))
