"""Files that try to harm: refused in words, or read with a true warning, and never more.

The files of ``cases/hostile`` ended the process, hung, took gigabytes, read other files or were
mended in silence once; they stand for their kinds.
"""

from __future__ import annotations

import os
import re
import socket
import struct
import zipfile
import zlib
from pathlib import Path

import numpy as np
import palpate
import pytest
from palpate.base.errors import OptionError, PalpateError, VolumeFormatError
from palpate.io.browse import browsed, previews

META = """ObjectType = Image
NDims = 3
BinaryData = True
BinaryDataByteOrderMSB = False
TransformMatrix = 1 0 0 0 1 0 0 0 1
Offset = 0 0 0
ElementSpacing = 1 1 1
DimSize = 8 8 8
ElementType = MET_SHORT
ElementDataFile = LOCAL
"""
NRRD = """NRRD0004
type: short
dimension: 3
space: left-posterior-superior
sizes: 8 8 8
space directions: (1,0,0) (0,1,0) (0,0,1)
space origin: (0,0,0)
endian: little
encoding: raw

"""
VOXELS = np.arange(512, dtype="<i2").tobytes()

REFUSED = {
    "meta/fs.mhd": "allowed: one place for a number",
    "meta/nd.mha": "NDims '99'; allowed: 2 to 10",
    "meta/ndn.mha": "NDims '-3'; allowed: 2 to 10",
    "meta/p0.mhd": "from 0 to 7 by 0",
    "meta/lists.mhd": "names 1 files for 8 slices",
    "meta/ps.mhd": "names 5 files for 8 slices",
    "meta/zpb.zip": "allowed: in the same file, or in files beside it",
    "nrrd/fw.nhdr": "'%999999999d'",
    "nifti/pix_nan.nii": "voxels of nan x nan x nan mm by its qform",
    "nifti/pix_zero.nii": "voxels of 0 x 0 x 0 mm by its qform",
    "nifti/quat_nan.nii": "quaternion has the length nan",
    "nifti/slope_1_inter_nan.nii": "slope but invalid intercept nan",
    "nifti/vox_nan.nii": "voxels from byte nan on",
    "dicom/ipp_nan": "a position of nan",
    "dicom/spacing_nan": "a pixel spacing of nan",
    "dicom/slope_1e300": "slope and intercept of 1e+300",
    "dicom/j2k_lying_dims": "its compressed images have 60000 x 60000",
    "dicom/jpegls_junk": "its compressed images have 60000 x 60000",
}
"""Each with what its message says."""


@pytest.fixture
def hostile(data_folder: Path) -> Path:
    """The folder of hostile files."""
    return data_folder.parent / "cases" / "hostile"


@pytest.mark.data
@pytest.mark.parametrize("name", REFUSED)
def test_a_hostile_file_is_refused_in_words(hostile: Path, name: str) -> None:
    with pytest.raises(VolumeFormatError) as refusal:
        palpate.read(hostile / name)
    assert REFUSED[name] in str(refusal.value)
    assert "\n" not in str(refusal.value)


@pytest.mark.data
def test_frames_that_are_not_there_are_not_waited_for(hostile: Path) -> None:
    with pytest.raises(PalpateError, match="truncated"):
        palpate.read(hostile / "dicom" / "nframes_2e9" / "0.dcm")


@pytest.mark.data
@pytest.mark.parametrize("name", [".", "meta", "nrrd", "nifti", "dicom"])
def test_a_folder_of_hostile_files_is_listed(hostile: Path, name: str) -> None:
    with browsed(hostile / name) as choices:
        assert choices
        # what can be told from headers alone says so in the list
        assert sum(choice.refused is not None for choice in choices) >= len(choices) // 3
        list(previews(choices))


def test_headers_as_they_should_be_are_read(tmp_path: Path) -> None:
    (tmp_path / "a.mha").write_bytes(META.encode() + VOXELS)
    (tmp_path / "a.nrrd").write_bytes(NRRD.encode() + VOXELS)
    for number in range(8):
        (tmp_path / f"s{number}.raw").write_bytes(VOXELS[128 * number :][:128])
    named = META.replace("LOCAL", "s%d.raw 0 7 1")
    (tmp_path / "b.mhd").write_text(named)
    listed = "".join(f"s{number}.raw\n" for number in range(8))
    (tmp_path / "c.mhd").write_text(META.replace("LOCAL", "LIST") + listed)
    (tmp_path / "d.nhdr").write_text(NRRD.rstrip() + "\ndata file: s%d.raw 0 7 1\n")
    (tmp_path / "e.nhdr").write_text(NRRD.rstrip() + f"\ndata file: LIST\n{listed}")
    for name in ("a.mha", "a.nrrd", "b.mhd", "c.mhd", "d.nhdr", "e.nhdr"):
        values = palpate.read(tmp_path / name).array
        assert values.tobytes() == VOXELS, name


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("NDims = 3", "NDims = 0"),
        ("NDims = 3", "NDims = 3.5"),
        ("NDims = 3", "NDims = 3\nNDims = 4"),
        ("DimSize = 8 8 8", "DimSize = 8 8"),
        ("DimSize = 8 8 8", "DimSize = 8 8 -8"),
        ("DimSize = 8 8 8", "DimSize = 8 8 99999999999999999999"),
        ("DimSize = 8 8 8", "DimSize = 8 8 100000"),
        ("ElementSpacing = 1 1 1", "ElementSpacing = 0 1 1"),
        ("ElementSpacing = 1 1 1", "ElementSpacing = nan 1 1"),
        ("ElementSpacing = 1 1 1", "ElementSpacing = 1 1 1e300"),
        ("Offset = 0 0 0", "Offset = inf 0 0"),
        ("TransformMatrix = 1", "TransformMatrix = 1 2"),
        ("ElementType = MET_SHORT", "ElementType = MET_OTHER"),
        ("LOCAL", "/etc/services"),
        ("LOCAL", "../a.raw"),
        ("LOCAL", "C:a.raw"),
        ("LOCAL", "%n"),
        ("LOCAL", "s%d.raw 0 4000000000 1"),
        ("LOCAL", "s%d%d.raw 0 7 1"),
        ("LOCAL", "s%99d.raw 0 7 x"),
        ("LOCAL", "LIST 7D"),
        ("LOCAL", "missing.raw"),
        ("ElementDataFile", "elementdatafile"),
        ("ObjectType", "\n" * (2 << 20) + "ObjectType"),
    ],
)
def test_a_metaimage_header_is_held_against_its_file(tmp_path: Path, old: str, new: str) -> None:
    path = tmp_path / "a.mha"
    path.write_bytes(META.replace(old, new).encode() + VOXELS)
    with pytest.raises(VolumeFormatError, match="allowed: "):
        palpate.read(path)


@pytest.mark.parametrize(
    ("new", "said"),
    [
        ("BinaryData = {}", "BinaryData '{}'; allowed: True or False"),
        ("BinaryData = False\nCompressedData = True", "BinaryData False and CompressedData True"),
        # more than the 255 that MetaIO has room for
        (f"BinaryData = True\nName = {'9' * 300}", "a Name of 300 letters"),
    ],
)
def test_words_that_end_metaio_are_refused_before_it_sees_them(
    tmp_path: Path, new: str, said: str
) -> None:
    path = tmp_path / "a.mha"
    path.write_bytes(META.replace("BinaryData = True", new).encode() + VOXELS)
    with pytest.raises(VolumeFormatError, match=re.escape(said)):
        palpate.read(path)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("dimension: 3", "dimension: 17"),
        ("dimension: 3", "dimension: -1"),
        ("sizes: 8 8 8", "sizes: 8 8 0"),
        ("sizes: 8 8 8", "sizes: 8 8 4000000000"),
        ("type: short", "type: block"),
        ("encoding: raw", "encoding: gzip"),
        ("encoding: raw", "encoding: other"),
        ("encoding: raw", "encoding: raw\nline skip: -4"),
        ("encoding: raw", "encoding: raw\nbyte skip: 1e9"),
        ("space origin: (0,0,0)", "space origin: (0,0,inf)"),
        ("(1,0,0)", "(1e300,0,0)"),
        ("encoding: raw", "encoding: raw\ndata file: /etc/services"),
        ("encoding: raw", "encoding: raw\ndata file: s%d.raw 0 7 0"),
        ("encoding: raw", "encoding: raw\ndata file: s%s.raw 0 7 1"),
        ("encoding: raw", "encoding: raw\ndata file: s%d.raw 0 7 1 9"),
        ("encoding: raw", "encoding: raw\ndata file: LIST\ns1.raw"),
    ],
)
def test_a_nrrd_header_is_held_against_its_file(tmp_path: Path, old: str, new: str) -> None:
    path = tmp_path / "a.nrrd"
    path.write_bytes(NRRD.replace(old, new).encode() + VOXELS)
    with pytest.raises(VolumeFormatError, match="allowed: "):
        palpate.read(path)


def test_slices_that_are_too_short_are_not_filled_up(tmp_path: Path) -> None:
    for number in range(8):
        (tmp_path / f"s{number}.raw").write_bytes(VOXELS[: 50 if number == 3 else 200])
    (tmp_path / "a.mhd").write_text(META.replace("LOCAL", "s%d.raw 0 7 1"))
    (tmp_path / "a.nhdr").write_text(NRRD.rstrip() + "\ndata file: s%d.raw 0 7 1\n")
    for name in ("a.mhd", "a.nhdr"):
        with pytest.raises(VolumeFormatError, match=r"s3\.raw is truncated"):
            palpate.read(tmp_path / name)


def nifti(**changes: tuple[str, int, object]) -> bytes:
    """Returns a NIfTI-1 file of 8 x 8 x 8 voxels, with numbers put at places of its header."""
    head = bytearray(352)
    fields: dict[str, tuple[str, int, object]] = {
        "size": ("<i", 0, 348),
        "dim": ("<8h", 40, (3, 8, 8, 8, 1, 1, 1, 1)),
        "type": ("<2h", 70, (4, 16)),
        "pixdim": ("<8f", 76, (1, 1, 1, 1, 1, 1, 1, 1)),
        "offset": ("<f", 108, 352.0),
        "scale": ("<2f", 112, (1.0, 0.0)),
        "codes": ("<2h", 252, (1, 0)),
        "magic": ("4s", 344, b"n+1\0"),
    }
    for form, place, value in (fields | changes).values():
        struct.pack_into(form, head, place, *(value if isinstance(value, tuple) else (value,)))
    return bytes(head) + VOXELS


def test_a_nifti_header_is_held_against_its_file(tmp_path: Path) -> None:
    path = tmp_path / "a.nii"
    path.write_bytes(nifti())
    assert palpate.read(path).array.tobytes() == VOXELS
    # NaN stands for "no scale" where nibabel writes it
    path.write_bytes(nifti(scale=("<2f", 112, (np.nan, np.nan))))
    assert palpate.read(path).array.tobytes() == VOXELS
    wrong: list[tuple[str, int, object]] = [
        ("<8h", 40, (3, 8, 8, 32000, 1, 1, 1, 1)),
        ("<8h", 40, (3, 8, -8, 8, 1, 1, 1, 1)),
        ("<8h", 40, (99, 8, 8, 8, 1, 1, 1, 1)),
        ("<f", 80, 0.0),
        ("<f", 80, 1e30),
        ("<f", 84, np.inf),
        ("<f", 108, -5.0),
        ("<f", 108, 1e30),
        ("<6f", 256, (0, 0, 0, np.inf, 0, 0)),
    ]
    for change in wrong:
        path.write_bytes(nifti(changed=change))
        with pytest.raises(VolumeFormatError, match="allowed: "):
            palpate.read(path)
    for rows in ((0.0,) * 12, (1, 0, 0, np.nan, 0, 1, 0, 0, 0, 0, 1, 0)):
        path.write_bytes(nifti(codes=("<2h", 252, (0, 1)), rows=("<12f", 280, rows)))
        with pytest.raises(VolumeFormatError, match="by its sform"):
            palpate.read(path)
    # nibabel takes it as no slope at all; that is said
    path.write_bytes(nifti(scale=("<2f", 112, (np.inf, 0.0))))
    assert any("slope of the values is inf" in told for told in palpate.read(path).warnings)


def test_an_archive_names_no_file_outside_whatever_stands_before(tmp_path: Path) -> None:
    secret = tmp_path / "secret.raw"
    secret.write_bytes(VOXELS)
    for before in ("", "\n" * 70_000, "Comment = " + "x" * 70_000 + "\n"):
        for place in (str(secret), f"../{secret.name}"):
            packed = tmp_path / "a.zip"
            with zipfile.ZipFile(packed, "w") as archive:
                archive.writestr("a.mhd", before + META.replace("LOCAL", place))
            with pytest.raises(VolumeFormatError, match="beside it"):
                palpate.read(packed)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="this system has no named pipes")
def test_devices_pipes_and_sockets_are_no_files(tmp_path: Path) -> None:
    pipe, address = tmp_path / "pipe.nii", tmp_path / "socket.mha"
    os.mkfifo(pipe)
    volume = palpate.Volume(np.zeros((4, 4, 4), np.int16), spacing=(1.0, 1.0, 1.0))
    with socket.socket(socket.AF_UNIX) as listener:
        listener.bind(str(address))
        for path in (pipe, address, Path("/dev/zero")):
            with pytest.raises(OptionError, match="is a device, a pipe or a socket"):
                palpate.read(path)
            with pytest.raises(OptionError, match="is a device, a pipe or a socket"):
                palpate.read_labels(path, volume)
            with (
                pytest.raises(OptionError, match="is a device, a pipe or a socket"),
                browsed(path) as _,
            ):
                pass
    mesh = tmp_path / "pipe.stl"
    os.mkfifo(mesh)
    with pytest.raises(OptionError, match="is a device, a pipe or a socket"):
        palpate.read_mesh(mesh)
    # in a folder they are passed over
    (tmp_path / "a.mha").write_bytes(META.encode() + VOXELS)
    assert palpate.read(tmp_path).array.tobytes() == VOXELS


def test_a_picture_is_no_larger_than_its_file_can_be(tmp_path: Path) -> None:
    def chunk(kind: bytes, body: bytes) -> bytes:
        check = struct.pack(">I", zlib.crc32(kind + body))
        return struct.pack(">I", len(body)) + kind + body + check

    head = struct.pack(">IIBBBBB", 60_000, 60_000, 8, 0, 0, 0, 0)
    path = tmp_path / "a.png"
    path.write_bytes(
        b"\x89PNG\r\n\x1a\n"
        + chunk(b"IHDR", head)
        + chunk(b"IDAT", zlib.compress(bytes(70_000)))
        + chunk(b"IEND", b"")
    )
    with pytest.raises(VolumeFormatError, match=r"announces 60000 x 60000 pixels"):
        palpate.read(path, voxel_size=(1.0, 1.0, 1.0))
