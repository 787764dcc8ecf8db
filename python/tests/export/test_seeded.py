"""De-identification by seeds: marked strings in all of a file are nowhere in what is shared."""

from __future__ import annotations

import csv
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from palpate.cli.commands import run
from palpate.export.clean_pixels import HiddenBytesError, cleaned_codestreams, cleaned_values
from palpate.export.code_strings import is_term
from palpate.export.deidentify import StillIdentifiedError
from palpate.export.export import export_scene
from palpate.export.identity_words import IdentityWords
from palpate.io.reading import read
from palpate.volumes.scene import Scene
from pydicom import dcmread
from pydicom.dataset import Dataset, FileDataset
from pydicom.pixels import pixel_array  # type: ignore[attr-defined]
from seeds import TEXTS, seeded_series, spellings

# seeds break rules on values
pytestmark = pytest.mark.filterwarnings("ignore::UserWarning")

WriteSeries = Callable[..., Path]


@pytest.fixture
def seeds() -> set[str]:
    return {"19730623"}


@pytest.fixture
def seeded(write_series: WriteSeries, seeds: set[str]) -> Path:
    return seeded_series(write_series, seeds)


NAMES = (
    "liver", "tumour of Li", "肝臓 山田", "Lesion Alvarez", "Ñusta cyst", "by Mueller", "by Muller",
    "MRN 778899", "seen 8.10.04", "seen 10/08/2004", "8. Okt. 2004", "October 8th", "2004年10月8日",
    "08-Oct-2004", "20041008", "bo's knee",
)  # fmt: skip
LEFT = (
    "Li", "山田", "Alvarez", "Álvarez", "Ñusta", "Nusta", "Mueller", "Muller", "778899", "8.10.04",
    "10/08/2004", "Okt", "October", "10月", "08-Oct", "20041008",
)  # fmt: skip


def shared(folder: Path, out: Path, names: tuple[str, ...] = ("part",)) -> Scene:
    volume = read(folder)
    scene = Scene(volume, [volume.threshold(low - 1023.0, name=n) for low, n in enumerate(names)])
    export_scene(scene, out)
    return scene


def test_no_seed_is_in_what_is_shared(seeded: Path, seeds: set[str], tmp_path: Path) -> None:
    assert len(seeds) > 1500
    shared(seeded, tmp_path / "shared", NAMES)
    content = {path: path.read_bytes() for path in (tmp_path / "shared").rglob("*.*")}
    looked_for = {spelling for seed in seeds for spelling in spellings(seed)}
    # the test sees seeds where they are
    raw = b"".join(path.read_bytes() for path in seeded.iterdir())
    assert sum(spelling in raw for spelling in looked_for) > 1500
    for path, held in content.items():
        lower = held.upper()
        assert [each for each in looked_for if each.upper() in lower] == [], path
    texts = b"".join(content.values()).decode("utf-8", "replace")
    for path in content:
        if path.suffix == ".dcm":
            for element in dcmread(path).iterall():
                texts += f"\n{element.value}" if element.VR in TEXTS else ""
    assert [
        word for word in ("Alvarez", "ALVAREZ", "山田", "太郎", "778899") if word in texts
    ] == []


def dumped(program: str, path: Path) -> bytes:
    """Returns all that another program tells of a file, in capitals."""
    options = ["--print"] if program == "gdcmdump" else []
    command = [str(Path(sys.executable).parent / program), *options, str(path)]
    ended = subprocess.run(command, capture_output=True, check=False)
    told = (ended.stdout + ended.stderr).upper()
    assert b"(0010,0010)" in told.replace(b"0X", b""), told[-500:]
    return told


@pytest.mark.long
@pytest.mark.parametrize("program", ["dcdump", "gdcmdump"])
def test_other_programs_find_no_seed_in_what_is_shared(
    program: str, seeded: Path, seeds: set[str], tmp_path: Path
) -> None:
    shared(seeded, tmp_path / "shared", NAMES)
    looked_for = {spelling.upper() for seed in seeds for spelling in spellings(seed)}
    # the program shows what there is
    before = b"".join(dumped(program, path) for path in seeded.iterdir())
    assert sum(each in before for each in looked_for) > 1200
    made = list((tmp_path / "shared").rglob("*.dcm"))
    assert len(made) == 4
    for path in made:
        told = dumped(program, path)
        assert [each for each in looked_for if each in told] == [], path
        assert [one for one in (b"ALVAREZ", b"778899", "山田".encode()) if one in told] == [], path


def test_names_of_segments_are_cleaned(seeded: Path, tmp_path: Path) -> None:
    shared(seeded, tmp_path / "shared", NAMES)
    segments = dcmread(tmp_path / "shared" / "segments.dcm").SegmentSequence
    rois = dcmread(tmp_path / "shared" / "structures.dcm").StructureSetROISequence
    for named in ([one.SegmentLabel for one in segments], [one.ROIName for one in rois]):
        assert named[0] == "liver"
        assert named[1] == "tumour of ANONYMIZED"
        told = "\n".join(named).replace("liver", "")
        assert [word for word in LEFT if word in told] == []


def test_pixels_and_places_stay_as_they_were(seeded: Path, tmp_path: Path) -> None:
    scene = shared(seeded, tmp_path / "shared")
    again = read(tmp_path / "shared" / "scan")
    np.testing.assert_array_equal(again.array, scene.volume.array)
    np.testing.assert_allclose(again.spacing, scene.volume.spacing)
    assert list(dcmread(next((tmp_path / "shared/scan").iterdir())).ImageType)[:3] == [
        "ORIGINAL",
        "PRIMARY",
        "AXIAL",
    ]


def test_a_report_lists_what_was_done(seeded: Path, tmp_path: Path) -> None:
    shared(seeded, tmp_path / "shared")
    with (tmp_path / "shared" / "deidentification.csv").open(encoding="utf-8") as file:
        rows = {row["name"]: row for row in csv.DictReader(file)}
    assert rows["PatientBirthDate"]["done"] == "emptied"
    assert rows["SOPInstanceUID"]["done"] == "given a new UID"
    assert rows["private"]["done"] == "removed"
    assert rows["PixelData"]["attribute"] == "(7fe0,0010)"
    assert rows["PixelData"]["done"] == "unused bits cleared"
    assert int(rows["ImageType"]["times"]) >= 2


@pytest.mark.parametrize(
    ("told", "refused"),
    [
        ({"BurnedInAnnotation": "YES"}, "have text"),
        ({"BurnedInAnnotation": "yes "}, "have text"),
        ({"BurnedInAnnotation": "Y"}, "have text"),
        ({"Modality": "US"}, "often has text"),
        ({"Modality": "OT"}, "often has text"),
        ({"Modality": "US", "BurnedInAnnotation": "NO"}, None),
        ({"Modality": "MR"}, None),
    ],
)
def test_text_in_pixels_is_asked_about(
    told: dict[str, str], refused: str | None, write_series: WriteSeries, tmp_path: Path
) -> None:
    scene = Scene(read(write_series(**told)))
    if refused is not None:
        with pytest.raises(StillIdentifiedError, match=refused):
            export_scene(scene, tmp_path / "shared")
    export_scene(scene, tmp_path / "shared", pixels_checked=refused is not None)
    assert (tmp_path / "shared" / "scan").is_dir()


def test_the_command_asks_for_a_look_at_pixels(
    write_series: WriteSeries, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = write_series(Modality="US", BurnedInAnnotation="YES")
    command = ["export", str(folder), "--as", "dicom", "-o", str(tmp_path / "shared")]
    assert run(command) == 2
    assert "--pixels-checked once you have looked" in capsys.readouterr().err
    assert run([*command, "--pixels-checked"]) == 0


def test_words_of_a_name_are_found_in_texts_of_any_form() -> None:
    source = Dataset()
    source.PatientName = "Strauß-Weiß^Zoë^^Dr."
    words = IdentityWords([source])
    for text in ("STRAUSS", "weiss", "zoe's", "Zoe\u0308"):
        assert words.cleaned(f"knee {text}").startswith("knee ANONYMIZED"), text
    for text in ("Dr", "left kidney", "version 1.2", "T1 2 3", "L4-L5", "4 mm", "zoeppritz"):
        assert words.cleaned(text) == text


def test_code_strings_are_terms_or_are_not() -> None:
    for term in ("CT_SOM5", "SMITH", "JOHN", "QIICR QIN IOWA", "O'NEIL", "Ö"):
        assert not is_term(term)
    for term in (
        "HELICAL MODE",
        "ISO_15444_1",
        "MONOCHROME2",
        "ISO_IR 192",
        "SEMIAUTOMATIC",
        "HFS",
    ):
        assert is_term(term)


@pytest.mark.parametrize("signed", [0, 1])
@pytest.mark.parametrize("high", [11, 15, 13])
def test_bits_outside_of_values_are_cleared(signed: int, high: int) -> None:
    image = Dataset()
    image.Rows, image.Columns, image.BitsAllocated, image.BitsStored = 2, 4, 16, 12
    image.HighBit, image.PixelRepresentation = high, signed
    shown = np.arange(8, dtype=np.int32) * 500 - (2048 if signed else 0)
    clean = (shown << (high - 11)).astype(np.int64)
    held = (clean & ((1 << (high + 1)) - 1) | (0xFFFF << (high + 1))) & 0xFFFF
    held |= (1 << (high - 11)) - 1
    got = cleaned_values(held.astype("<u2").tobytes() + b"SEED", image)
    found = np.frombuffer(got, "<i2" if signed else "<u2") >> (high - 11)
    np.testing.assert_array_equal(found, shown)
    if not signed:
        np.testing.assert_array_equal(np.frombuffer(got, "<u2"), clean)


def jpeg(comment: bytes) -> bytes:
    """A codestream of JPEG's form: comment, application segments, a scan, and another comment."""

    def part(marker: int, content: bytes) -> bytes:
        return bytes([0xFF, marker]) + (len(content) + 2).to_bytes(2, "big") + content

    scan = part(0xDA, b"\1\1\0\0\x3f\0") + b"\x12\xff\x00\x34\xff\xd0\x56"
    adobe = b"Adobe\0\x64\0\0\0\0\1"
    before = part(0xE0, b"JFIF" + comment) + part(0xEE, adobe) + part(0xFE, comment)
    scans = part(0xDB, b"\0" * 65) + scan + part(0xFE, comment) + scan
    return b"\xff\xd8" + before + scans + b"\xff\xd9"


def test_comments_of_jpeg_are_cleared_and_nothing_else_is() -> None:
    held = bytearray(jpeg(b"SEEDCOM") + b"\0SEED" + jpeg(b"SEEDCOM"))
    cleaned_codestreams(held)
    assert bytes(held) == jpeg(bytes(7)).replace(b"JFIF", bytes(4)) + bytes(5) + jpeg(
        bytes(7)
    ).replace(b"JFIF", bytes(4))


def test_what_is_no_known_codestream_is_not_shared() -> None:
    for held in (b"SEED", b"\xff\xd8\xff\xfe", jpeg(b"x")[:-3]):
        with pytest.raises(HiddenBytesError, match="may hide texts"):
            cleaned_codestreams(bytearray(held))


def test_comments_in_real_codestreams_are_cleared_and_pictures_stay(
    data_folder: Path,
) -> None:
    from palpate.export.clean_pixels import cleaned_pixels

    looked = 0
    for path in sorted((data_folder / "pydicom_transfer_syntaxes").rglob("*.dcm")):
        if path.stem in {"emri_small_jpeg_2k_lossless_too_short", "bad_sequence"}:
            continue
        image = dcmread(path)
        if (
            "PixelData" not in image
            or not image.file_meta.TransferSyntaxUID.is_transfer_syntax
            or "rle" in path.stem.lower()
            or not image.file_meta.TransferSyntaxUID.is_compressed
        ):
            continue
        before = _pixels(image)
        held, _ = cleaned_pixels(image)
        assert len(held) == len(image.PixelData)
        image.PixelData = held
        np.testing.assert_array_equal(_pixels(image), before)
        assert b"Kakadu" not in held
        looked += 1
    assert looked >= 3


def _pixels(image: FileDataset) -> Any:
    return pixel_array(image, raw=True)
