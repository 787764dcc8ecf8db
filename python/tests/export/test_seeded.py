"""De-identification by seeds: marked strings in all of a file are nowhere in what is shared."""

from __future__ import annotations

import csv
from base64 import b64encode
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from palpate.cli.commands import run
from palpate.export.clean_pixels import HiddenBytesError, cleaned_codestreams, cleaned_values
from palpate.export.code_strings import is_term
from palpate.export.deidentify import TECHNICAL, StillIdentifiedError
from palpate.export.export import export_scene
from palpate.export.identity_words import IdentityWords
from palpate.io.reading import read
from palpate.volumes.scene import Scene
from pydicom import dcmread
from pydicom.datadict import DicomDictionary  # type: ignore[attr-defined]
from pydicom.dataset import Dataset, FileDataset
from pydicom.pixels import pixel_array  # type: ignore[attr-defined]
from pydicom.tag import Tag

# seeds break rules on values
pytestmark = pytest.mark.filterwarnings("ignore::UserWarning")

WriteSeries = Callable[..., Path]

READ = (
    "PatientSex", "SpecificCharacterSet", "Modality", "PhotometricInterpretation", "SOPClassUID",
    "SOPInstanceUID", "SeriesInstanceUID", "BurnedInAnnotation", "PixelPresentation", "RescaleType",
    "LossyImageCompression", "TransferSyntaxUID", "VolumetricProperties", "PresentationLUTShape",
)  # fmt: skip
"""What is needed to read the scan: no seeds there."""
TEXTS = ("AE", "CS", "LO", "LT", "PN", "SH", "ST", "UC", "UR", "UT")
NAME = "Álvarez-Ñusta^Li Bo=山田^太郎"
ENCODINGS = ("utf-8", "latin-1", "utf-16-le", "utf-16-be", "iso2022_jp", "gb18030", "euc_kr")


def seed_of(tag: int) -> str:
    return f"SEED{tag:08X}"


def fill(dataset: Dataset, seeds: set[str], *, depth: int) -> None:
    """Puts a seed into each text, UID, day and sequence that the dictionary knows."""
    for number, (kind, _, _, retired, keyword) in DicomDictionary.items():
        tag = Tag(number)
        if not keyword or keyword in READ or tag.group in (0x0000, 0x0002, 0xFFFE, 0x7FE0):
            continue
        if (
            retired
            or "FunctionalGroup" in keyword
            or "CenterPoint" in keyword
            or tag.group in (0x0004, 0x0028)
            or tag in dataset
        ):
            continue
        seed, value = _seeded(number, kind, keyword)
        if kind == "SQ" and depth and tag.group in (0x0008, 0x0010, 0x0018, 0x0040, 0x3006):
            item = Dataset()
            _some(item, seed)
            if keyword == "RequestAttributesSequence":
                fill(item, seeds, depth=depth - 1)
            value = [item]
        if value is not None:
            dataset.add_new(number, kind, value)
            seeds.add(seed)


def _seeded(number: int, kind: str, keyword: str) -> tuple[str, object]:
    """Returns what is looked for, and the value that it stands in."""
    seed = seed_of(number)
    if kind in TEXTS:
        # what tells of methods is kept, without what names somebody
        return seed, f"ALVAREZ {number % 997}" if keyword in TECHNICAL else seed
    if kind in {"OB", "UN"}:
        return seed, seed.encode()
    if kind in {"DA", "DT"}:
        return "19730623", "19730623"
    uid = f"1.2.826.77.{number}"
    return (uid, uid) if kind == "UI" else (seed, None)


def _some(item: Dataset, seed: str) -> None:
    item.PatientComments = item.CodeMeaning = seed
    item.CodingSchemeDesignator = "99SEED"
    item.ReferringPhysicianName = f"{seed}^{seed}"
    item.private_block(0x0011, seed, create=True).add_new(1, "LT", seed)


@pytest.fixture
def seeds() -> set[str]:
    return {"19730623"}


@pytest.fixture
def seeded(write_series: WriteSeries, seeds: set[str]) -> Path:
    def each(number: int, dataset: FileDataset) -> None:
        dataset.SpecificCharacterSet = "ISO_IR 192"
        dataset.PatientName = NAME
        dataset.OtherPatientNames = ["Müller^Jürgen"]
        dataset.PatientID = "MRN/778899-X"
        dataset.StudyDate = "20041008"
        dataset.ImageType = ["ORIGINAL", "PRIMARY", "AXIAL", "SEEDTYPE"]
        dataset.FrameOfReferenceUID, dataset.StudyInstanceUID = "1.2.826.5", "1.2.826.6"
        dataset.InstanceNumber = number
        dataset.BitsStored, dataset.HighBit = 12, 11
        values = np.frombuffer(dataset.PixelData, "<u2") | np.uint16(0xA000)
        dataset.PixelData = values.tobytes() + b"SEEDPIXEL!"
        dataset.private_block(0x0009, "SEEDPRIVATE", create=True).add_new(1, "LO", "SEEDPRIVATE")
        fill(dataset, seeds, depth=2)
        dataset.file_meta.SourceApplicationEntityTitle = "SEEDMETA"
        dataset.file_meta.ImplementationVersionName = "SEEDMETA"
        dataset.preamble = b"SEEDMETA" * 16

    seeds |= {"SEEDTYPE", "SEEDPIXEL", "SEEDPRIVATE", "SEEDMETA"}
    return write_series("seeded", each=each, positions=[(0.0, 0.0, 2.0 * k) for k in range(2)])


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


def spellings(seed: str) -> set[bytes]:
    """Returns the bytes that a string may be in a file."""
    plain = set()
    for encoding in ENCODINGS:
        try:
            plain.add(seed.encode(encoding))
        except UnicodeEncodeError:
            continue
    inner = seed.encode()
    # in base64 a string has three forms, by where it begins; their ends depend on what is beside
    coded = {b64encode(b"\0" * pad + inner)[4 if pad else 0 : -4] for pad in range(3)}
    return {each for each in plain | coded if len(each) >= 6}


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
