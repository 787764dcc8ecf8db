"""DICOM objects of a scan: read again as what was written, with references that hold."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import palpate
import pytest
from dicom_cases import case
from numpy.typing import NDArray
from palpate.base.errors import ConfirmationNeededError, OptionError
from palpate.cli.commands import run
from palpate.export.deidentify import StillIdentifiedError
from palpate.export.dicom_contours import outlines
from palpate.export.export import export_scene
from palpate.export.kinds import Kind
from palpate.io.reading import read
from palpate.volumes.polygon_fill import fill_polygons
from palpate.volumes.scene import Scene
from palpate.volumes.terminology import Code, Terminology, terminology_of_name
from pydicom import dcmread
from pydicom.dataset import Dataset, FileDataset
from pydicom.uid import generate_uid

STUDY: dict[str, Any] = {
    "PatientName": "Quixote^Alonso",
    "PatientID": "PID-778899",
    "PatientBirthDate": "19470916",
    "PatientSex": "M",
    "AccessionNumber": "40455667",
    "StudyID": "ST9921",
    "StudyDate": "20041008",
    "StudyTime": "101112",
    "SeriesDate": "20041009",
    "AcquisitionDate": "20041009",
    "ReferringPhysicianName": "Cervantes^Miguel",
    "OperatorsName": "Panza^Sancho",
    "InstitutionName": "Hospital of Mancha",
    "StudyDescription": "Knee of Quixote",
    "ImageComments": "Seen by Panza on 08 October",
    "DeviceSerialNumber": "SN7788",
    "StationName": "ROCINANTE",
    "Manufacturer": "Windmill",
    "SeriesNumber": 40455667,
    "ImageType": ["ORIGINAL", "PRIMARY", "AXIAL"],
    "SpecificCharacterSet": "ISO_IR 100",
}
NAMES = (
    b"quixote", b"alonso", b"778899", b"19470916", b"40455667", b"st9921", b"20041008",
    b"20041009", b"cervantes", b"panza", b"mancha", b"sn7788", b"rocinante", b"october",
)  # fmt: skip
"""By what the study above names people, places and days."""

CYST = Terminology(
    Code("49755003", "SCT", "Morphologically Abnormal Structure"),
    Code("367643001", "SCT", "Cyst"),
    side=Code("7771000", "SCT", "Left"),
    region=Code("64033007", "SCT", "Kidney"),
)

WriteSeries = Callable[..., Path]


@pytest.fixture
def folder(write_series: WriteSeries) -> Path:
    """A series of 5 slices, oblique, with private elements and nested references."""

    def named(number: int, dataset: FileDataset) -> None:
        dataset.InstanceNumber = number + 1
        dataset.private_block(0x0009, "WINDMILL", create=True).add_new(1, "LO", "Quixote's")
        item = Dataset()
        item.ReferencedSOPClassUID = dataset.SOPClassUID
        item.ReferencedSOPInstanceUID = generate_uid()
        item.PatientName = "Quixote^Alonso"
        dataset.ReferencedImageSequence = [item]

    return write_series(
        positions=[(-10.0 + 1.5 * k, -20.0, 30.0 + 2.0 * k) for k in range(5)],
        orientation=(0.8, 0.0, -0.6, 0.0, 1.0, 0.0),
        each=named,
        StudyInstanceUID=generate_uid(),
        FrameOfReferenceUID=generate_uid(),
        **STUDY,
    )


def two_parts(folder: Path, *, overlap: bool = False) -> Scene:
    """The scan of the series above with two segments."""
    scene = Scene(read(folder))
    first, second = np.zeros(scene.volume.shape, np.uint8), np.zeros(scene.volume.shape, np.uint8)
    first[1:4, :, :2] = 1
    second[2:5, 1:, 1 if overlap else 2 :] = 1
    scene.add(scene.volume.segment(first, name="liver"), colour=(0.6, 0.3, 0.2))
    scene.add(scene.volume.segment(second, name="Zyste λ of Quixote"), colour=(0.2, 0.9, 0.4))
    [*scene][1].segment.terminology = CYST
    return scene


def shown_in(made: Dataset) -> Iterator[str]:
    """UIDs of all images that an object refers to, at any depth."""
    for element in made.iterall():
        if element.keyword == "ReferencedSOPInstanceUID":
            yield str(element.value)


def instances(folder: Path) -> dict[str, Dataset]:
    found = [dcmread(path) for path in folder.iterdir()]
    return {str(each.SOPInstanceUID): each for each in found}


KEPT: tuple[Kind, ...] = ("dicom-seg", "dicom-labelmap", "rtstruct")


@pytest.mark.parametrize("kind", KEPT)
def test_an_object_for_the_archive_comes_back_and_refers_to_the_scan(
    folder: Path, tmp_path: Path, kind: Kind
) -> None:
    scene, path = two_parts(folder), tmp_path / "object.dcm"
    assert export_scene(scene, path, kind=kind, keep_identity=True) == []
    found = palpate.read_labels(path, scene.volume)
    assert found.warnings == ()
    for one, label in zip(scene, found.labels, strict=True):
        assert label.segment.name == one.name
        # CIELab in 16 bits; contours have 8 bits of each colour
        assert label.colour == pytest.approx(one.colour, abs=2e-3)
        np.testing.assert_array_equal(label.segment.mask(), one.segment.mask())
    made, scan = dcmread(path), instances(folder)
    image = next(iter(scan.values()))
    assert made.StudyInstanceUID == image.StudyInstanceUID
    assert made.FrameOfReferenceUID == image.FrameOfReferenceUID
    assert str(made.PatientName) == "Quixote^Alonso"
    assert made.SeriesInstanceUID != image.SeriesInstanceUID
    assert set(shown_in(made)) - {image.StudyInstanceUID} == set(scan)
    if kind != "rtstruct":
        codes = [label.segment.terminology for label in found.labels]
        assert codes == [terminology_of_name("liver"), CYST]


def test_frames_refer_to_the_slice_that_they_lie_on(folder: Path, tmp_path: Path) -> None:
    scene, scan = two_parts(folder), instances(folder)
    export_scene(scene, tmp_path / "seg.dcm", keep_identity=True)
    frames = dcmread(tmp_path / "seg.dcm").PerFrameFunctionalGroupsSequence
    assert len(frames) == 3 + 3
    for frame in frames:
        place = frame.PlanePositionSequence[0].ImagePositionPatient
        image = frame.DerivationImageSequence[0].SourceImageSequence[0]
        shown = scan[image.ReferencedSOPInstanceUID].ImagePositionPatient
        np.testing.assert_allclose(np.float64(place), np.float64(shown), atol=1e-6)
    export_scene(scene, tmp_path / "rt.dcm", kind="rtstruct", keep_identity=True)
    for roi in dcmread(tmp_path / "rt.dcm").ROIContourSequence:
        for contour in roi.ContourSequence:
            image = scan[contour.ContourImageSequence[0].ReferencedSOPInstanceUID]
            normal = np.cross(*np.reshape(image.ImageOrientationPatient, (2, 3)).astype(float))
            points = np.reshape(contour.ContourData, (-1, 3)).astype(float)
            off = (points - np.float64(image.ImagePositionPatient)) @ normal
            # written to 0.1 µm
            np.testing.assert_allclose(off, 0.0, atol=2e-4)


def test_names_and_numbers_that_change_in_dicom_are_told(folder: Path, tmp_path: Path) -> None:
    scene, long = two_parts(folder), "x" * 80
    for one, number in zip(scene, (40, 6), strict=True):
        one.name, one.segment.number = f"{long}{number}", number
    told, held = {}, {}
    for kind in ("dicom-seg", "dicom-labelmap", "rtstruct"):
        path = tmp_path / f"{kind}.dcm"
        told[kind] = export_scene(scene, path, kind=kind, keep_identity=True)
        held[kind] = palpate.read_labels(path, scene.volume).labels
        names = {label.segment.name for label in held[kind]}
        assert names == {"x" * 64, "x" * 60 + " (2)"}
        assert "names are made different within 64 characters" in told[kind][-1]
    # only binary segments have to be numbered from 1
    assert "label numbers change: " in told["dicom-seg"][0]
    for kind in ("dicom-labelmap", "rtstruct"):
        assert len(told[kind]) == 1
        for one in scene:
            mine = next(each for each in held[kind] if each.segment.number == one.segment.number)
            np.testing.assert_array_equal(mine.segment.mask(), one.segment.mask())


def test_segments_that_overlap_are_kept_or_refused(folder: Path, tmp_path: Path) -> None:
    scene, path = two_parts(folder, overlap=True), tmp_path / "seg.dcm"
    export_scene(scene, path, keep_identity=True)
    for one, label in zip(scene, palpate.read_labels(path, scene.volume).labels, strict=True):
        np.testing.assert_array_equal(label.segment.mask(), one.segment.mask())
    before = path.read_bytes()
    with pytest.raises(OptionError, match="share voxels, which a label map cannot tell; allowed"):
        export_scene(scene, path, kind="dicom-labelmap", keep_identity=True)
    assert path.read_bytes() == before


@pytest.mark.parametrize("seed", range(5))
def test_outlines_enclose_just_the_voxels_of_a_mask(seed: int) -> None:
    mask = (np.random.default_rng(seed).random((9, 12)) < 0.2 + 0.15 * seed).astype(np.uint8)
    loops = outlines(mask)
    np.testing.assert_array_equal(fill_polygons(loops, mask.shape), mask)
    assert all(len(loop) >= 4 for loop in loops)


def test_a_hole_stays_one(tmp_path: Path, write_series: WriteSeries) -> None:
    def larger(_: int, dataset: FileDataset) -> None:
        dataset.Rows, dataset.Columns = 9, 8
        dataset.PixelData = np.arange(72, dtype="<u2").tobytes()

    uids = {"StudyInstanceUID": generate_uid(), "FrameOfReferenceUID": generate_uid()}
    scene = Scene(read(write_series("larger", each=larger, **uids)))
    mask = np.zeros(scene.volume.shape, np.uint8)
    mask[:, 1:8, 1:7] = 1
    mask[2, 3:6, 3:5] = 0
    scene.add(scene.volume.segment(mask, name="ring"))
    path = tmp_path / "rt.dcm"
    export_scene(scene, path, kind="rtstruct", keep_identity=True)
    label = palpate.read_labels(path, scene.volume).labels[0]
    np.testing.assert_array_equal(label.segment.mask(), mask)
    contours = dcmread(path).ROIContourSequence[0].ContourSequence
    assert {contour.ContourGeometricType for contour in contours} == {"CLOSEDPLANAR_XOR"}


def edited(scene: Scene) -> tuple[Scene, NDArray[np.int16]]:
    """The same scene after a tool has left air in some voxels."""
    values = scene.volume.array.copy()
    values[1:3, 1, 1:3] = -1000 - int(scene.volume.intercept)
    return Scene(scene.volume.with_values(values), [one.segment for one in scene]), values


def test_an_edited_scan_becomes_a_derived_series(folder: Path, tmp_path: Path) -> None:
    scene, values = edited(two_parts(folder))
    export_scene(scene, tmp_path / "made", keep_identity=True)
    assert sorted(path.name for path in (tmp_path / "made").iterdir()) == [
        "edited", "segments.dcm", "structures.dcm"
    ]  # fmt: skip
    again, scan = read(tmp_path / "made" / "edited"), instances(folder)
    np.testing.assert_array_equal(
        again.array * again.slope + again.intercept,
        values * scene.volume.slope + scene.volume.intercept,
    )
    np.testing.assert_allclose(again.patient_from_grid, scene.volume.patient_from_grid, atol=1e-9)
    assert again.unit == "HU"
    made = instances(tmp_path / "made" / "edited")
    assert not set(made) & set(scan)
    assert len({each.SeriesInstanceUID for each in made.values()}) == 1
    for each in made.values():
        assert list(each.ImageType) == ["DERIVED", "SECONDARY", "AXIAL"]
        source = scan[each.SourceImageSequence[0].ReferencedSOPInstanceUID]
        np.testing.assert_allclose(
            np.float64(each.ImagePositionPatient), np.float64(source.ImagePositionPatient)
        )
        assert (each.StudyInstanceUID, each.PatientName) == (
            source.StudyInstanceUID, source.PatientName
        )  # fmt: skip
        assert "PixelPaddingValue" not in each


def test_a_tilted_scan_is_derived_on_its_right_grid(
    write_series: WriteSeries, tmp_path: Path
) -> None:
    places = [(-10.0, -20.0 + 1.0 * k, 30.0 + 2.5 * k) for k in range(4)]
    uids = {"StudyInstanceUID": generate_uid(), "FrameOfReferenceUID": generate_uid()}
    volume = read(write_series(positions=places, **uids))
    values = volume.array.copy()
    values[0, 0, 0] += 5
    scene = Scene(volume.with_values(values))
    scene.add(scene.volume.threshold(volume.range[0], name="all"))
    export_scene(scene, tmp_path / "made", keep_identity=True)
    again = read(tmp_path / "made" / "edited")
    np.testing.assert_array_equal(
        again.array * again.slope + again.intercept, values * volume.slope + volume.intercept
    )
    np.testing.assert_allclose(again.patient_from_grid, volume.patient_from_grid, atol=1e-6)
    for name in ("segments.dcm", "structures.dcm"):
        found = palpate.read_labels(tmp_path / "made" / name, volume).labels[0]
        assert found.segment.voxel_count == volume.array.size


# --- de-identified ------------------------------------------------------------------------


def test_nothing_names_the_patient_in_what_is_shared(folder: Path, tmp_path: Path) -> None:
    scene, _ = edited(two_parts(folder))
    for one, name in zip(scene, ("liver", "Zyste λ of Quixote"), strict=True):
        one.name = name
    export_scene(scene, tmp_path / "shared")
    files = list((tmp_path / "shared").rglob("*.dcm"))
    assert len(files) == 5 + 5 + 2
    known = {
        element.value
        for each in instances(folder).values()
        for element in each.iterall()
        if element.VR == "UI" and not str(element.value).startswith("1.2.840.10008.")
    }
    assert len(known) == 5 + 5 + 3
    for path in files:
        content, made = path.read_bytes(), dcmread(path)
        assert [uid for uid in known if str(uid).encode() in content] == [], path
        # new identifiers are random: one export in 300 has the digits of a number above
        for each in made.iterall():
            if each.VR == "UI":
                content = content.replace(str(each.value).encode(), b" ")
        lower = content.lower()
        assert [name for name in NAMES if name in lower] == [], path
        assert made.PatientIdentityRemoved == "YES"
        assert not any(element.tag.is_private for element in made.iterall())


def test_references_among_shared_files_hold(folder: Path, tmp_path: Path) -> None:
    scene, values = edited(two_parts(folder))
    export_scene(scene, tmp_path / "shared")
    shared = tmp_path / "shared"
    scan, changed = instances(shared / "scan"), instances(shared / "edited")
    seg, structures = dcmread(shared / "segments.dcm"), dcmread(shared / "structures.dcm")
    objects = [*scan.values(), *changed.values(), seg, structures]
    for name in ("StudyInstanceUID", "FrameOfReferenceUID", "PatientID", "PatientName"):
        assert len({str(each[name].value) for each in objects}) == 1, name
    assert len({str(each.SeriesInstanceUID) for each in objects}) == 4
    assert set(shown_in(seg)) == set(scan)
    assert set(shown_in(structures)) - {seg.StudyInstanceUID} == set(scan)
    for each in changed.values():
        assert each.SourceImageSequence[0].ReferencedSOPInstanceUID in scan
    series = seg.ReferencedSeriesSequence[0].SeriesInstanceUID
    assert {each.SeriesInstanceUID for each in scan.values()} == {series}
    # pixels are those of the source, and segments fit them
    original = {tuple(each.ImagePositionPatient): each for each in instances(folder).values()}
    for each in scan.values():
        assert each.PixelData == original[tuple(each.ImagePositionPatient)].PixelData
    again = read(shared / "scan")
    np.testing.assert_array_equal(again.array, read(folder).array)
    for name in ("segments.dcm", "structures.dcm"):
        found = palpate.read_labels(shared / name, again).labels
        for one, label in zip(scene, found, strict=True):
            np.testing.assert_array_equal(label.segment.mask(), one.segment.mask())
        assert [label.segment.name for label in found][1] == "Zyste λ of ANONYMIZED"
    np.testing.assert_array_equal(
        read(shared / "edited").array, values + round(scene.volume.intercept - again.intercept)
    )


def test_two_shares_have_nothing_in_common(folder: Path, tmp_path: Path) -> None:
    for name in ("one", "other"):
        export_scene(two_parts(folder), tmp_path / name)
    one, other = (dcmread(tmp_path / name / "segments.dcm") for name in ("one", "other"))
    assert one.StudyInstanceUID != other.StudyInstanceUID
    assert one.PatientID != other.PatientID


def test_a_series_without_uids_is_shared_with_new_ones(
    write_series: WriteSeries, tmp_path: Path
) -> None:
    def bare(_: int, dataset: FileDataset) -> None:
        del dataset.SOPInstanceUID, dataset.SOPClassUID

    scene = two_parts(write_series("bare", uid="", each=bare))
    with pytest.raises(OptionError, match="have no StudyInstanceUID and no SeriesInstanceUID"):
        export_scene(scene, tmp_path / "seg.dcm", keep_identity=True)
    export_scene(scene, tmp_path / "shared")
    seg, scan = dcmread(tmp_path / "shared" / "segments.dcm"), instances(tmp_path / "shared/scan")
    assert {each.SeriesInstanceUID for each in scan.values()} == {
        seg.ReferencedSeriesSequence[0].SeriesInstanceUID
    }
    assert set(shown_in(seg)) == set(scan)
    assert len(scan) == 4


def test_text_in_the_pixels_is_not_shared(write_series: WriteSeries, tmp_path: Path) -> None:
    scene = Scene(read(write_series(BurnedInAnnotation="YES")))
    with pytest.raises(StillIdentifiedError, match="have text in their pixels") as refused:
        export_scene(scene, tmp_path / "shared")
    # by which a page knows that it can ask its person
    assert isinstance(refused.value, ConfirmationNeededError)
    assert not (tmp_path / "shared").exists()


def test_the_command_shares_by_default(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    options = ["--threshold", "-900", "-o"]
    assert run(["export", str(folder), *options, str(tmp_path / "shared")]) == 0
    assert "8 files, 1 of 1 segments" in capsys.readouterr().out
    assert dcmread(tmp_path / "shared" / "segments.dcm").PatientIdentityRemoved == "YES"
    assert run(["export", str(folder), *options, str(tmp_path / "shared")]) == 2
    assert "is there already" in capsys.readouterr().err
    kept = [*options, str(tmp_path / "seg.dcm")]
    assert run(["export", str(folder), *kept]) == 2
    assert "--keep-identity for an archive" in capsys.readouterr().err
    assert run(["export", str(folder), *kept, "--keep-identity"]) == 0
    assert str(dcmread(tmp_path / "seg.dcm").PatientName) == "Quixote^Alonso"


# --- other programs -----------------------------------------------------------------------


def complaints(path: Path) -> list[str]:
    """Errors that dicom3tools finds in a file."""
    program = Path(sys.executable).parent / "dciodvfy"
    ended = subprocess.run([program, path], capture_output=True, text=True, check=False)
    return [line for line in ended.stderr.splitlines() if line.startswith("Error")]


OPTIONAL = (
    "PositionReferenceIndicator", "PatientSex", "StudyID", "ReferringPhysicianName", "PatientName",
    "PatientID", "PatientBirthDate", "AccessionNumber", "StudyDate", "StudyTime", "SeriesNumber",
    "InstanceNumber", "Manufacturer", "ImageType", "SliceThickness", "SeriesDate",
)  # fmt: skip
"""What scans may lack."""


@pytest.mark.data
@pytest.mark.parametrize("lacking", ["as reported", "most", "empty"])
def test_objects_of_scans_that_lack_elements_are_valid(
    data_folder: Path, tmp_path: Path, lacking: str
) -> None:
    folder = tmp_path / "mr"
    folder.mkdir()
    for path in (case(data_folder, 30) / "mr").iterdir():
        dataset = dcmread(path)
        for name in () if lacking == "as reported" else OPTIONAL:
            if lacking == "empty" and name in dataset:
                dataset[name].clear()
            elif name in dataset:
                del dataset[name]
        dataset.save_as(folder / path.name)
    volume = read(folder)
    labels = palpate.read_labels(case(data_folder, 30) / "labels.nii.gz", volume).labels
    scene = Scene(volume, [label.segment for label in labels])
    for kind in ("rtstruct", "dicom-seg"):
        made = tmp_path / f"{kind}.dcm"
        export_scene(scene, made, kind=kind, keep_identity=True)
        assert complaints(made) == []
        # and it belongs to the scan
        assert len(palpate.read_labels(made, volume).labels) == len(labels)


@pytest.mark.data
def test_other_programs_accept_and_read_what_was_written(data_folder: Path, tmp_path: Path) -> None:
    scene = Scene(read(data_folder / "dcmqi_seg" / "ct-3slice"))
    labels = palpate.read_labels(data_folder / "dcmqi_seg" / "liver.dcm", scene.volume).labels
    scene.add(labels[0].segment)
    scene.add(scene.volume.threshold(200.0, name="bone"))
    values = scene.volume.array.copy()
    values[1, 200:210, 200:210] = 0
    scene = Scene(scene.volume.with_values(values), [one.segment for one in scene])
    export_scene(scene, tmp_path / "shared")
    for name in ("segments.dcm", "structures.dcm"):
        assert complaints(tmp_path / "shared" / name) == []
    known = complaints(data_folder / "dcmqi_seg" / "ct-3slice" / "02.dcm")
    for name in ("scan/00002.dcm", "edited/00002.dcm"):
        assert set(complaints(tmp_path / "shared" / name)) <= set(known), name
    program = Path(sys.executable).parent / "segimage2itkimage"
    subprocess.run(
        [program, "--inputDICOM", tmp_path / "shared" / "segments.dcm", "--outputDirectory",
         tmp_path, "--outputType", "nrrd"],
        check=True,
        capture_output=True,
    )  # fmt: skip
    for number, one in enumerate(scene, 1):
        mask = read(tmp_path / f"{number}.nrrd", orientation=None)
        np.testing.assert_array_equal(mask.array != 0, one.segment.mask() != 0)
