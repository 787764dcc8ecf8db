"""Values of DICOM slices: rescaled one by one, padding made air, in every transfer syntax."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import palpate
import pytest
import SimpleITK
from palpate.base.errors import VolumeFormatError
from palpate.io.dicom.header import read_header
from palpate.io.dicom.pixels import stored_pixels
from pydicom import dcmread

SLICES = [100 * k + np.arange(12).reshape(3, 4) for k in range(4)]
"""What is stored in the slices that a test writes."""


def test_each_slice_has_its_own_slope_and_intercept(write_series: Any) -> None:
    def scaled(number: int, dataset: Any) -> None:
        dataset.RescaleSlope, dataset.RescaleIntercept = 0.5 + number, -3.25 * number

    volume = palpate.read(write_series(each=scaled, Modality="PT"))
    expected = [(0.5 + k) * stored - 3.25 * k for k, stored in enumerate(SLICES)]
    values = volume.array * volume.slope + volume.intercept
    # 65536 steps over the range
    np.testing.assert_allclose(values, expected, atol=(1088.0 + 10.0) / 65535.0)


def test_whole_slopes_of_slices_stay_exact(write_series: Any) -> None:
    def scaled(number: int, dataset: Any) -> None:
        dataset.RescaleSlope, dataset.RescaleIntercept = 1 + number, -1000 - number

    volume = palpate.read(write_series(each=scaled))
    expected = [(1 + k) * stored - 1000 - k for k, stored in enumerate(SLICES)]
    assert (volume.slope, volume.intercept) == (1.0, 0.0)
    np.testing.assert_array_equal(volume.array, expected)


def test_padding_of_ct_becomes_air(write_series: Any) -> None:
    volume = palpate.read(write_series(PixelPaddingValue=103))
    expected = np.array(SLICES) - 1024
    expected[1, 0, 3] = -1000
    np.testing.assert_array_equal(volume.array, expected)


def test_a_range_of_padding_becomes_the_lowest_value_where_air_has_none(
    write_series: Any,
) -> None:
    folder = write_series(
        Modality="MR", scale=(1.0, 0.0), PixelPaddingValue=105, PixelPaddingRangeLimit=0
    )
    values = palpate.read(folder).array
    assert values.min() == 106
    assert (values[0] == 106).all()
    np.testing.assert_array_equal(values[2:], SLICES[2:])


def test_padding_given_without_its_sign_is_found(write_series: Any) -> None:
    def signed(number: int, dataset: Any) -> None:
        dataset.PixelRepresentation = 1
        stored = SLICES[number].astype("<i2")
        stored[0, 0] = -2000
        dataset.PixelData = stored.tobytes()
        dataset.add_new("PixelPaddingValue", "US", 65536 - 2000)

    volume = palpate.read(write_series(each=signed))
    assert (volume.array[:, 0, 0] == -1000).all()
    assert volume.range[0] == -1023.0


def test_low_values_that_are_bright_are_turned_around_but_not_hu(write_series: Any) -> None:
    bright_low = {"PhotometricInterpretation": "MONOCHROME1", "BitsStored": 12, "HighBit": 11}
    hu = palpate.read(write_series("ct", **bright_low))
    np.testing.assert_array_equal(hu.array, np.array(SLICES) - 1024)
    assert "HU are kept as they are" in hu.notes[0]
    mr = palpate.read(write_series("mr", Modality="MR", scale=(1.0, 0.0), **bright_low))
    np.testing.assert_array_equal(mr.array, 4095 - np.array(SLICES))
    assert "turned around" in mr.warnings[0]


def test_bits_above_those_in_use_are_left_out_and_signs_carried(write_series: Any) -> None:
    def overlaid(number: int, dataset: Any) -> None:
        dataset.BitsStored, dataset.HighBit, dataset.PixelRepresentation = 12, 11, 1
        # twelve bits of a negative number, an overlay in the highest bit
        stored = (SLICES[number] - 500).astype("<i2").view("<u2") & 0x0FFF
        dataset.PixelData = (stored | 0x8000).astype("<u2").tobytes()

    volume = palpate.read(write_series(each=overlaid, scale=(1.0, 0.0)))
    np.testing.assert_array_equal(volume.array, np.array(SLICES) - 500)


def test_unsigned_values_beyond_int16_are_exact(write_series: Any) -> None:
    def high(number: int, dataset: Any) -> None:
        dataset.PixelData = (60000 + SLICES[number]).astype("<u2").tobytes()

    volume = palpate.read(write_series(each=high))
    values = volume.array.astype(float) * volume.slope + volume.intercept
    np.testing.assert_array_equal(values, 60000 - 1024 + np.array(SLICES))


def test_what_ends_the_reading_ends_the_work(write_series: Any) -> None:
    class EnoughError(Exception):
        pass

    def stop(what: str, _: float | None) -> None:
        if what.startswith("reading"):
            raise EnoughError

    with pytest.raises(EnoughError):
        palpate.read(write_series(), progress=stop)


def test_memory_is_told_before_pixels_are_read(write_series: Any) -> None:
    said: list[str] = []
    palpate.read(write_series(), progress=lambda what, _: said.append(what))
    assert "reading 4 files, 0 MiB" in said


@pytest.mark.data
def test_damaged_compressed_slices_are_left_out_or_refused_by_name(
    data_folder: Path, tmp_path: Path
) -> None:
    source = data_folder / "totalseg_tests" / "example_ct_dicom"
    for number, path in enumerate(sorted(source.iterdir())[:4]):
        content = path.read_bytes()
        (tmp_path / f"{number}.dcm").write_bytes(
            content[: len(content) // (2 if number == 2 else 1)]
        )
    assert "1 of 4 slices is bad and was left out: 2.dcm (not to be decoded)" in (
        palpate.read(tmp_path).warnings
    )
    content = (tmp_path / "1.dcm").read_bytes()
    (tmp_path / "1.dcm").write_bytes(content[: len(content) // 2])
    with pytest.raises(VolumeFormatError, match=r"[12]\.dcm .*allowed: complete"):
        palpate.read(tmp_path)


SAME_AS_ITK = [
    "693_J2KR", "693_UNCI", "693_UNCR", "JLSL_16_15_1_1F", "JPEG-LL", "JPEG2000_UNC", "MR2_J2KI",
    "MR2_J2KR", "MR2_UNCR", "bad_sequence", "emri_small", "emri_small_RLE",
    "emri_small_big_endian", "emri_small_jpeg_2k_lossless", "emri_small_jpeg_ls_lossless",
    "explicit_VR-UN",
]  # fmt: skip


SINGLE_BITS = [
    "liver_rle", "liver_deflate", "liver_j2k", "liver_expb", "liver_nonbyte_aligned",
    "liver_nonbyte_aligned_deflate", "liver_nonbyte_aligned_rle", "liver_nonbyte_aligned_j2k",
]  # fmt: skip
ELSEWHERE = ["eCT_Supplemental", "emri_small_jpeg_2k_lossless_too_short", "liver"]
"""As volumes, refused, and what single bits are compared with: see test_io_scans too."""


@pytest.mark.data
def test_no_transfer_syntax_is_left_out(data_folder: Path) -> None:
    there = {path.stem for path in (data_folder / "pydicom_transfer_syntaxes").glob("*.dcm")}
    assert there == {*SAME_AS_ITK, *SINGLE_BITS, *ELSEWHERE}


@pytest.mark.data
@pytest.mark.parametrize("name", SAME_AS_ITK)
def test_transfer_syntaxes_give_what_itk_gives(data_folder: Path, name: str) -> None:
    path = data_folder / "pydicom_transfer_syntaxes" / f"{name}.dcm"
    header = read_header(path)
    assert header is not None
    stored = stored_pixels(path, shape=(-1, header.rows, header.columns))
    slope, intercept = header.frames[0].scale or (1.0, 0.0)
    expected = SimpleITK.GetArrayFromImage(SimpleITK.ReadImage(str(path)))
    np.testing.assert_allclose(stored * slope + intercept, expected)


@pytest.mark.data
@pytest.mark.parametrize("name", SINGLE_BITS)
def test_single_bits_are_the_same_in_every_syntax(data_folder: Path, name: str) -> None:
    folder = data_folder / "pydicom_transfer_syntaxes"
    rows, columns = (510, 510) if "nonbyte" in name else (512, 512)
    plain = dcmread(folder / "liver.dcm").pixel_array
    stored = stored_pixels(folder / f"{name}.dcm", shape=(-1, rows, columns))
    # those of 510 rows and columns are cut from the others
    np.testing.assert_array_equal(stored, plain[:, :rows, :columns])
