"""Zip archives of DICOM: read like folders, and safe whatever is in them."""

from __future__ import annotations

import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import palpate
import pytest
from palpate.base.errors import VolumeFormatError
from palpate.base.progress import silent
from palpate.io import archive as io_archive
from palpate.io.browse import browsed


def archive_of(folder: Path, *, under: str = "STUDY/") -> Path:
    """Packs the files of a folder, in a folder of the archive."""
    target = folder.parent / "head.zip"
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as archive:
        for path in folder.iterdir():
            archive.write(path, f"{under}{path.name}")
    return target


def test_an_archive_is_read_like_its_folder(write_series: Any) -> None:
    folder = write_series(description="")
    packed, plain = palpate.read(archive_of(folder)), palpate.read(folder)
    np.testing.assert_array_equal(packed.array, plain.array)
    np.testing.assert_array_equal(packed.patient_from_grid, plain.patient_from_grid)
    assert packed.name == "head"


def test_one_of_several_series_can_be_chosen(write_series: Any) -> None:
    write_series(uid="1.2.3", prefix="a")
    folder = write_series(uid="1.2.4", prefix="b")
    path = archive_of(folder)
    with pytest.raises(VolumeFormatError, match=r"head\.zip holds 2 series"):
        palpate.read(path)
    assert palpate.read(path, series="1.2.4").traits.series == "1.2.4"


def test_no_name_leads_out_of_the_archive(
    write_series: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    room = tmp_path / "room" / "for" / "it"
    room.mkdir(parents=True)
    monkeypatch.setattr("tempfile.tempdir", str(room))
    folder = write_series()
    path = archive_of(folder, under="../../../")
    before = sorted(file for file in tmp_path.rglob("*") if file != path)
    assert palpate.read(path).dimensions == (4, 3, 4)
    # nothing was left anywhere, nor written beside
    assert sorted(file for file in tmp_path.rglob("*") if file != path) == before


def test_what_unpacks_to_far_more_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "bomb.zip"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("zeros", bytes(50 << 20))
    with pytest.raises(VolumeFormatError, match=r"unpacks to 50 MiB .* allowed: at most 200 times"):
        palpate.read(path)


@pytest.mark.parametrize(
    ("limit", "value", "said"),
    [("MOST_ENTRIES", 3, "holds 4 files; allowed: at most 3"),
     ("MOST_BYTES", 1000, r"would unpack to 0\.0 GiB; allowed")],
)  # fmt: skip
def test_archives_are_bounded(
    write_series: Any, monkeypatch: pytest.MonkeyPatch, limit: str, value: int, said: str
) -> None:
    monkeypatch.setattr(io_archive, limit, value)
    path = archive_of(write_series())
    with pytest.raises(VolumeFormatError, match=said), io_archive.unpacked(path, silent):
        pass


def test_damaged_archives_are_refused(write_series: Any) -> None:
    path = archive_of(write_series())
    content = bytearray(path.read_bytes())
    content[60:90] = bytes(30)
    path.write_bytes(content)
    with pytest.raises(VolumeFormatError, match=r"damaged or unusual archive .* allowed"):
        palpate.read(path)


def test_encrypted_archives_are_refused(write_series: Any) -> None:
    path = archive_of(write_series())
    content = path.read_bytes()
    # the flag of encryption of each entry, in its own header and in the directory
    for mark, offset in ((b"PK\x03\x04", 6), (b"PK\x01\x02", 8)):
        parts = content.split(mark)
        flagged = [part[: offset - 4] + b"\x01" + part[offset - 3 :] for part in parts[1:]]
        content = mark.join([parts[0], *flagged])
    path.write_bytes(content)
    with pytest.raises(VolumeFormatError, match="is encrypted; allowed"):
        palpate.read(path)


def test_an_archive_without_images_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "notes.zip"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("notes.txt", "taken on Monday")
    with pytest.raises(VolumeFormatError, match=r"notes\.zip holds no DICOM images"):
        palpate.read(path)


# --- image files ------------------------------------------------------------------------


def packed(target: Path, *files: Path, below: Path) -> Path:
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as archive:
        for file in files:
            archive.write(file, file.relative_to(below).as_posix())
    return target


@pytest.mark.parametrize("name", ["ct.nii.gz", "ct.nii", "ct.nrrd", "ct.mha", "ct.mhd", "ct.nhdr"])
def test_an_image_file_is_read_out_of_an_archive(
    write_image: Any, small_values: Any, tmp_path: Path, name: str
) -> None:
    path = write_image(small_values, name, spacing=(1.0, 2.0, 3.0))
    files = [file for file in tmp_path.iterdir() if file.is_file()]
    archive = packed(tmp_path / "study.zip", *files, below=tmp_path.parent)
    expected, volume = palpate.read(path), palpate.read(archive)
    np.testing.assert_array_equal(volume.array, expected.array)
    np.testing.assert_array_equal(volume.patient_from_grid, expected.patient_from_grid)
    assert volume.name == "ct"


def test_one_of_several_image_files_is_chosen_by_its_name(
    write_image: Any, small_values: Any, tmp_path: Path
) -> None:
    files = [write_image(small_values + n, f"{n}.nii.gz") for n in (1, 2)]
    archive = packed(tmp_path / "study.zip", *files, below=tmp_path)
    with pytest.raises(VolumeFormatError, match=r"holds 2 image files; .* 1\.nii\.gz, 2\.nii\.gz"):
        palpate.read(archive)
    with pytest.raises(VolumeFormatError, match=r"none is '3\.nii\.gz'"):
        palpate.read(archive, series="3.nii.gz")
    with browsed(archive) as choices:
        assert [(one.path, one.series, one.size) for one in choices] == [
            (archive, f"{n}.nii.gz", (7, 6, 5)) for n in (1, 2)
        ]
        assert all(one.picture().size > 1 for one in choices)
    volume = palpate.read(archive, series="2.nii.gz")
    np.testing.assert_array_equal(volume.array, small_values + 2)
    assert volume.source is not None
    assert dict(volume.source.options) == {"series": "2.nii.gz"}


def test_dicom_goes_before_image_files_unless_one_is_named(
    write_series: Any, write_image: Any, small_values: Any, tmp_path: Path
) -> None:
    folder = write_series()
    mask = write_image(small_values, "mask.nii.gz")
    archive = packed(tmp_path / "study.zip", *folder.iterdir(), mask, below=tmp_path)
    assert palpate.read(archive).dimensions == (4, 3, 4)
    assert palpate.read(archive, series="mask.nii.gz").dimensions == (7, 6, 5)


@pytest.mark.parametrize(
    ("field", "said"),
    [
        ("ElementDataFile = /etc/passwd", "names voxels in '/etc/passwd'; allowed: in the same"),
        ("ElementDataFile = ../secret.raw", "names voxels in '../secret.raw'"),
        ("ElementDataFile = ../slice%d.raw 1 4 1", "names voxels in '../slice1.raw'"),
        ("ElementDataFile = slice%d.raw 1 9 1", "names 9 files for 4 slices"),
        ("ElementDataFile = LIST", "names 0 files for 4 slices"),
        ("ElementDataFile = LIST" + 4 * "\n/etc/passwd", "names voxels in '/etc/passwd'"),
    ],
)
def test_a_header_in_an_archive_names_no_file_elsewhere(
    tmp_path: Path, field: str, said: str
) -> None:
    path = tmp_path / "scan.mhd"
    path.write_text(
        f"ObjectType = Image\nNDims = 3\nDimSize = 4 4 4\nElementType = MET_UCHAR\n{field}\n"
    )
    archive = packed(tmp_path / "study.zip", path, below=tmp_path)
    with pytest.raises(VolumeFormatError) as caught:
        palpate.read(archive)
    assert said in str(caught.value)
    with browsed(archive) as (choice,):
        assert said in str(choice.refused)
    # it is named as what it is for the person, not as where it was unpacked
    assert str(caught.value).startswith(f"{archive}: scan.mhd")


def test_names_that_lead_elsewhere_or_stand_in_the_way_do_no_harm(
    write_series: Any, tmp_path: Path
) -> None:
    slices = [file.read_bytes() for file in sorted(write_series().iterdir())]
    names = ["../a", "/b", "C:\\c", "same", "SAME", "x" * 250, ".hidden", "a/./../../d"]
    archive = tmp_path / "odd.zip"
    with zipfile.ZipFile(archive, "w") as packing:
        for number, content in enumerate(slices * 2):
            packing.writestr(names[number], content)
    assert palpate.read(archive).dimensions == (4, 3, 4)
