"""MetaImage and NRRD: units of length, letters in names, axes of several volumes."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import palpate
import pytest
import SimpleITK
from file_cases import bright_middle, case_input, values_of
from palpate.base.errors import SeriesChoiceError, VolumeFormatError

VALUES = np.random.default_rng(3).integers(0, 1000, (4, 5, 6)).astype(np.int16)
"""Shape [z, y, x]."""


def nrrd(path: Path, *lines: str, kinds: str = "", values: np.ndarray = VALUES) -> Path:
    """Writes a file with spacings of 1, 1.5 and 2.5 along the axes of space."""
    sizes = " ".join(map(str, values.shape[::-1]))
    fields = [
        "NRRD0005", "type: short", f"dimension: {values.ndim}", f"sizes: {sizes}",
        "endian: little", "encoding: raw", "space: left-posterior-superior",
        "space origin: (-10,20,30)", *lines,
    ]  # fmt: skip
    if kinds:
        fields.append(f"kinds: {kinds}")
    path.write_bytes(("\n".join(fields) + "\n\n").encode() + values.tobytes())
    return path


SPACE = "space directions: (1,0,0) (0,1.5,0) (0,0,2.5)"


# --- units --------------------------------------------------------------------------------


@pytest.mark.data
@pytest.mark.parametrize("name", ["microns.nrrd", "metres.nrrd"])
def test_the_marker_of_other_units_lies_where_it_was_put(data_folder: Path, name: str) -> None:
    volume = palpate.read(case_input(data_folder, 6) / name)
    np.testing.assert_allclose(bright_middle(volume), (5.0, 6.0, 20.0), atol=1e-6)
    assert volume.spacing == pytest.approx((1.0, 1.5, 2.5))


@pytest.mark.parametrize(
    ("unit", "scale"), [("mm", 1), ("um", 1e-3), ("µm", 1e-3), ("cm", 10), ("m", 1e3), ("in", 25.4)]
)
def test_units_of_nrrd_are_those_of_the_file(tmp_path: Path, unit: str, scale: float) -> None:
    path = nrrd(tmp_path / "a.nrrd", SPACE, f'space units: "{unit}" "{unit}" "{unit}"')
    volume = palpate.read(path, unit="HU")
    assert volume.spacing == pytest.approx(tuple(np.multiply((1, 1.5, 2.5), scale)))
    assert volume.origin == pytest.approx(tuple(np.multiply((-10, 20, 30), scale)))
    assert volume.warnings == ()


def without_space(path: Path, *lines: str) -> Path:
    """Writes a file whose axes lie in no space."""
    written = nrrd(path, *lines).read_bytes()
    for field in (b"space: left-posterior-superior\n", b"space origin: (-10,20,30)\n"):
        written = written.replace(field, b"")
    path.write_bytes(written)
    return path


@pytest.mark.parametrize(("unit", "scale"), [("cm", 10.0), ("um", 1e-3), ("", 1.0)])
def test_units_of_axes_without_a_space_are_used(tmp_path: Path, unit: str, scale: float) -> None:
    axes = ("spacings: 1 1.5 2.5", f'units: "{unit}" "{unit}" "{unit}"')
    volume = palpate.read(without_space(tmp_path / "a.nrrd", *axes))
    assert volume.spacing == pytest.approx(tuple(np.multiply((1, 1.5, 2.5), scale)))


def test_a_size_of_voxels_that_is_missing_is_told(tmp_path: Path) -> None:
    (told, *_) = palpate.read(without_space(tmp_path / "a.nrrd")).warnings
    assert told == "the file tells no size of voxels: 1 mm is assumed"
    with pytest.raises(VolumeFormatError, match=r"spacings of 1 1\.5 nan; allowed: numbers"):
        palpate.read(without_space(tmp_path / "b.nrrd", "spacings: 1 1.5 nan"))


def test_a_unit_that_nobody_knows_is_told(tmp_path: Path) -> None:
    path = nrrd(tmp_path / "a.nrrd", SPACE, 'space units: "pixel" "pixel" "pixel"')
    assert "'pixel' is unknown: mm are assumed" in palpate.read(path).warnings[0]


def test_axes_in_different_units_are_refused(tmp_path: Path) -> None:
    path = nrrd(tmp_path / "a.nrrd", SPACE, 'space units: "mm" "mm" "m"')
    with pytest.raises(VolumeFormatError, match="different units, m, mm; allowed: one"):
        palpate.read(path)


@pytest.mark.parametrize(("unit", "scale"), [("um", 1e-3), ("mm", 1.0), ("cm", 10.0), ("?", 1.0)])
def test_units_of_metaimage_are_those_of_the_file(tmp_path: Path, unit: str, scale: float) -> None:
    header = (
        f"ObjectType = Image\nNDims = 3\nDistanceUnits = {unit}\n"
        "TransformMatrix = 1 0 0 0 1 0 0 0 1\nOffset = 10 20 30\n"
        "ElementSpacing = 1 1.5 2.5\nDimSize = 6 5 4\n"
        "ElementType = MET_SHORT\nElementDataFile = LOCAL\n"
    )
    (tmp_path / "a.mha").write_bytes(header.encode() + VALUES.tobytes())
    volume = palpate.read(tmp_path / "a.mha")
    assert volume.spacing == pytest.approx(tuple(np.multiply((1, 1.5, 2.5), scale)))
    assert volume.origin == pytest.approx(tuple(np.multiply((10, 20, 30), scale)))


# --- names --------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["schädel.nhdr", "schädel.mhd", "頭.nhdr", "頭.mhd"])
def test_voxels_beside_are_found_by_names_of_any_letters(tmp_path: Path, name: str) -> None:
    SimpleITK.WriteImage(SimpleITK.GetImageFromArray(VALUES), str(tmp_path / name))
    np.testing.assert_array_equal(values_of(palpate.read(tmp_path / name)), VALUES)


# --- several volumes ----------------------------------------------------------------------


@pytest.mark.parametrize("kind", ["list", "point"])
@pytest.mark.parametrize("first", [True, False])
def test_volumes_of_a_listed_axis_are_chosen(tmp_path: Path, kind: str, *, first: bool) -> None:
    several = np.stack([VALUES, VALUES + 1, VALUES * 2], axis=-1 if first else 0)
    domains, directions = ["domain"] * 3, ["(1,0,0)", "(0,1.5,0)", "(0,0,2.5)"]
    place = 0 if first else 3
    path = nrrd(
        tmp_path / "a.nrrd",
        "space directions: " + " ".join([*directions[:place], "none", *directions[place:]]),
        kinds=" ".join([*domains[:place], kind, *domains[place:]]),
        values=np.ascontiguousarray(several),
    )
    with pytest.raises(SeriesChoiceError, match="3 volumes; allowed: one of them, with `frame="):
        palpate.read(path)
    for frame, expected in enumerate((VALUES, VALUES + 1, VALUES * 2), 1):
        volume = palpate.read(path, frame=frame)
        np.testing.assert_array_equal(values_of(volume), expected)
        assert volume.spacing == (1.0, 1.5, 2.5)
        assert volume.origin == (-10.0, 20.0, 30.0)


@pytest.mark.parametrize("kind", ["vector", "RGB-color", "3-vector", "covariant-vector"])
def test_numbers_that_make_one_voxel_are_refused(tmp_path: Path, kind: str) -> None:
    path = nrrd(
        tmp_path / "a.nrrd",
        "space directions: none (1,0,0) (0,1.5,0) (0,0,2.5)",
        kinds=f"{kind} domain domain domain",
        values=np.stack([VALUES] * 3, axis=-1),
    )
    with pytest.raises(VolumeFormatError, match="3 numbers per voxel"):
        palpate.read(path)


@pytest.mark.parametrize("name", ["a.mha", "a.nrrd", "a.nii.gz"])
def test_volumes_of_a_fourth_axis_are_chosen(tmp_path: Path, name: str) -> None:
    images = [SimpleITK.GetImageFromArray(VALUES + step) for step in range(3)]
    SimpleITK.WriteImage(SimpleITK.JoinSeries(images), str(tmp_path / name))
    for frame in (1, 2, 3):
        volume = palpate.read(tmp_path / name, frame=frame)
        np.testing.assert_array_equal(values_of(volume), VALUES + frame - 1)
    for frame in (0, 4, -1):
        with pytest.raises(SeriesChoiceError, match=f"{frame} was asked for; allowed.*1 to 3"):
            palpate.read(tmp_path / name, frame=frame)
