"""Zip archives of DICOM: read like folders, and safe whatever is in them."""

from __future__ import annotations

import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import palpate
import pytest
from palpate import io_archive
from palpate.errors import VolumeFormatError


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
    with pytest.raises(VolumeFormatError, match=said):
        palpate.read(archive_of(write_series()))


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
