"""Raw voxels and pictures: as the person says they are laid out."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import palpate
import pytest
import SimpleITK
from numpy.typing import NDArray
from palpate.base.errors import OptionError, PalpateError, VolumeFormatError

SIZE = (0.5, 0.75, 2.0)


def slices_into(folder: Path, values: NDArray[Any]) -> Path:
    """Writes raw slices whose names sort otherwise than their numbers."""
    folder.mkdir()
    for number, pixels in enumerate(values, 1):
        (folder / f"scan.{number}").write_bytes(pixels.tobytes())
    return folder


@pytest.mark.data
def test_the_slices_of_cthead_are_read_as_they_are(data_folder: Path) -> None:
    folder = data_folder / "cthead_stanford"
    volume = palpate.read(
        folder / "raw", raw="256x256x113,int16,big", voxel_size=(1.0, 1.0, 2.0), orientation="LPI"
    )
    stacked = palpate.read(folder / "CThead.mha")
    assert volume.dimensions == stacked.dimensions
    assert (volume.spacing, volume.orientation) == ((1.0, 1.0, 2.0), "LPI")
    # the first slice is the highest, that of the file the lowest
    np.testing.assert_array_equal(volume.array, stacked.array[::-1])


def test_numbers_in_names_are_numbers(tmp_path: Path) -> None:
    values = np.arange(12 * 6, dtype=">u2").reshape(12, 2, 3)
    folder = slices_into(tmp_path / "raw", values)
    (folder / ".hidden").touch()
    volume = palpate.read(folder, raw="3x2,uint16,big", voxel_size=SIZE)
    assert (volume.spacing, volume.orientation, volume.name) == (SIZE, "unknown", "raw")
    np.testing.assert_array_equal(volume.array, values)


@pytest.mark.parametrize("kind", ["int8", "uint8", "int16", "uint16", "int32", "float32"])
def test_one_file_with_a_header_is_read(tmp_path: Path, kind: str) -> None:
    values = np.arange(60).astype(kind).reshape(3, 4, 5)
    path = tmp_path / "scan.raw"
    path.write_bytes(b"header!" + values.tobytes())
    for size in ("5x4x3", "5x4"):
        volume = palpate.read(path, raw=f"{size},{kind},little,7", voxel_size=SIZE)
        np.testing.assert_array_equal(volume.array * volume.slope + volume.intercept, values)


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"raw": "5x4x3,int16"}, "with `voxel_size=X,Y,Z`"),
        ({"raw": "5x4x3,int16", "voxel_size": (1.0, 0.0, 1.0)}, "lengths above 0"),
        ({"raw": "5x4x3,int16", "voxel_size": (1.0, float("nan"), 1.0)}, "lengths above 0"),
        ({"raw": "5x4x2,int16", "voxel_size": SIZE}, "120 bytes; 5 x 4 x 2 int16 asks 80"),
        ({"raw": "5x5,int16", "voxel_size": SIZE}, "asks 50 and 50 for each slice more"),
        ({"raw": "5x4,int16,big,200", "voxel_size": SIZE}, "after 200 bytes asks 240"),
        ({"raw": "5x4,int12", "voxel_size": SIZE}, "raw layout '5x4,int12' given"),
        ({"raw": "0x4,int16", "voxel_size": SIZE}, "raw layout"),
        ({"raw": "scan", "voxel_size": SIZE}, "raw layout"),
        ({"raw": "5x4x3,int16", "voxel_size": SIZE, "max_voxels": 59}, "at most 59"),
    ],
)
def test_layouts_that_do_not_fit_are_refused(
    tmp_path: Path, options: dict[str, Any], said: str
) -> None:
    path = tmp_path / "scan.raw"
    path.write_bytes(np.arange(60, dtype="<i2").tobytes())
    with pytest.raises(PalpateError, match=f"{said}.*allowed|allowed.*{said}"):
        palpate.read(path, **options)


def test_a_voxel_size_is_refused_where_files_tell_theirs(write_image: Any) -> None:
    with pytest.raises(OptionError, match=r"voxel size given for .*allowed"):
        palpate.read(write_image(np.zeros((3, 4, 5), np.int16)), voxel_size=SIZE)


# --- pictures ---------------------------------------------------------------------------


def pictures(folder: Path, values: NDArray[Any], *, ending: str, colour: bool = False) -> Path:
    folder.mkdir()
    for number, pixels in enumerate(values, 1):
        image = SimpleITK.GetImageFromArray(pixels, isVector=colour)
        SimpleITK.WriteImage(image, str(folder / f"s{number}{ending}"))
    return folder


@pytest.mark.parametrize(("ending", "kind"), [(".png", "u1"), (".png", "u2"), (".TIF", "u2")])
def test_a_stack_of_pictures_is_a_scan(tmp_path: Path, ending: str, kind: str) -> None:
    values = np.arange(11 * 20).astype(kind).reshape(11, 4, 5)
    folder = pictures(tmp_path / "stack", values, ending=ending.lower())
    (folder / "notes.txt").write_text("a micro CT")
    volume = palpate.read(folder, voxel_size=SIZE)
    assert volume.spacing == SIZE
    assert volume.orientation == "unknown"
    np.testing.assert_array_equal(volume.array, values)


def test_grey_pictures_saved_as_colour_are_grey(tmp_path: Path) -> None:
    values = np.arange(60, dtype=np.uint8).reshape(3, 4, 5)
    grey = np.repeat(values[..., None], 3, axis=-1)
    volume = palpate.read(
        pictures(tmp_path / "grey", grey, ending=".png", colour=True), voxel_size=SIZE
    )
    np.testing.assert_array_equal(volume.array, values)
    grey[2, 1, 1, 0] += 1
    with pytest.raises(VolumeFormatError, match=r"s3\.png is coloured; allowed"):
        palpate.read(pictures(tmp_path / "red", grey, ending=".png", colour=True), voxel_size=SIZE)


def test_a_tiff_of_many_pages_is_a_scan(tmp_path: Path) -> None:
    values = np.arange(60, dtype=np.uint16).reshape(3, 4, 5)
    path = tmp_path / "pages.tif"
    SimpleITK.WriteImage(SimpleITK.GetImageFromArray(values), str(path))
    np.testing.assert_array_equal(palpate.read(path, voxel_size=SIZE).array, values)


def test_pictures_of_several_sizes_are_refused(tmp_path: Path) -> None:
    folder = pictures(tmp_path / "stack", np.zeros((2, 4, 5), np.uint8), ending=".png")
    odd = SimpleITK.GetImageFromArray(np.zeros((4, 6), np.uint8))
    SimpleITK.WriteImage(odd, str(folder / "s3.png"))
    with pytest.raises(VolumeFormatError, match=r"s3\.png has 6 x 4 pixels, s1\.png has 5 x 4"):
        palpate.read(folder, voxel_size=SIZE)
    with pytest.raises(OptionError, match="`voxel_size=X,Y,Z`"):
        palpate.read(folder)


def test_a_damaged_picture_is_refused(tmp_path: Path) -> None:
    folder = pictures(tmp_path / "stack", np.zeros((3, 4, 5), np.uint8), ending=".png")
    (folder / "s2.png").write_bytes((folder / "s2.png").read_bytes()[:40])
    with pytest.raises(VolumeFormatError, match=r"s2\.png cannot be read .*allowed"):
        palpate.read(folder, voxel_size=SIZE)


def test_one_picture_is_no_volume(tmp_path: Path) -> None:
    folder = pictures(tmp_path / "stack", np.zeros((1, 4, 5), np.uint8), ending=".png")
    with pytest.raises(VolumeFormatError, match="a 2-D image"):
        palpate.read(folder, voxel_size=SIZE)
