"""Segments from files lie voxel on voxel in the scan, with the names and colours of the file."""

from __future__ import annotations

import gzip
from pathlib import Path
from typing import Any

import numpy as np
import palpate
import pytest
import SimpleITK
from numpy.typing import NDArray
from palpate.base.errors import OptionError, PalpateError, VolumeFormatError
from palpate.base.progress import silent
from palpate.cli.scenes import add_labels
from palpate.labels.dicom_seg import colour_of_lab
from palpate.volumes.anatomical_colour import colour_of_name
from palpate.volumes.scene import Scene
from palpate.volumes.volume import Volume
from pydicom import dcmread

SHAPE = (5, 6, 7)
SPACING = (0.5, 0.75, 2.0)
ORIGIN = (10.0, -20.0, 30.0)


@pytest.fixture
def scan() -> Volume:
    """An empty scan whose axes all differ."""
    return Volume(np.zeros(SHAPE, np.int16), spacing=SPACING, origin=ORIGIN)


def image_of(values: NDArray[Any], *, layers: bool = False) -> Any:
    image = SimpleITK.GetImageFromArray(values, isVector=layers)
    image.SetSpacing(SPACING)
    image.SetOrigin(ORIGIN)
    return image


def some_labels() -> NDArray[np.uint8]:
    return np.asarray(np.random.default_rng(5).integers(0, 4, SHAPE), np.uint8)


# --- label maps ---------------------------------------------------------------------------


def test_segments_of_an_opened_map_begin_as_surfaces(scan: Volume, tmp_path: Path) -> None:
    path = tmp_path / "labels.nrrd"
    SimpleITK.WriteImage(image_of(some_labels()), str(path))
    scene = Scene(scan)
    add_labels(scene, path, resample=False, progress=silent)
    assert [segment.shown_as for segment in scene] == ["surface"] * 3


def test_a_label_map_gives_its_labels(scan: Volume, tmp_path: Path) -> None:
    labels = some_labels()
    SimpleITK.WriteImage(image_of(labels), str(tmp_path / "organs.nrrd"))
    (tmp_path / "organs.csv").write_text("id,structure\n1,liver\n3,aorta\n")
    found = palpate.read_labels(tmp_path / "organs.nrrd", scan).labels
    assert [label.segment.name for label in found] == ["liver", "label 2", "aorta"]
    for value, label in enumerate(found, 1):
        np.testing.assert_array_equal(label.segment.mask(), labels == value)
    assert found[0].colour == colour_of_name("liver")
    assert found[1].colour is None


@pytest.mark.parametrize("axes", [(True, False, False), (False, True, True), (True, True, True)])
def test_a_cropped_map_that_runs_the_other_way_lies_in_its_place(
    scan: Volume, tmp_path: Path, axes: tuple[bool, bool, bool]
) -> None:
    labels = some_labels()
    # SimpleITK turns values and place together
    part = SimpleITK.Flip(image_of(labels)[1:6, 2:, 1:4], axes)
    swapped = SimpleITK.PermuteAxes(part, (2, 0, 1))
    SimpleITK.WriteImage(swapped, str(tmp_path / "part.nrrd"))
    expected = np.zeros(SHAPE, np.uint8)
    expected[1:4, 2:, 1:6] = labels[1:4, 2:, 1:6]
    found = palpate.read_labels(tmp_path / "part.nrrd", scan)
    assert found.warnings == ("the map has 3 x 5 x 4 voxels, the scan 7 x 6 x 5",)
    for value, label in enumerate(found.labels, 1):
        np.testing.assert_array_equal(label.segment.mask(), expected == value)


@pytest.mark.parametrize(
    ("shift", "said"),
    [
        ((0.0, 0.0, 0.0), None),
        # headers are rounded
        ((0.003, 0.0, 0.01), None),
        ((0.1, 0.0, 0.0), "up to 0.1 mm off"),
        ((0.0, 0.12, 0.4), "up to 0.42 mm off"),
    ],
)
@pytest.mark.parametrize("name", ["map.nrrd", "map.seg.nrrd"])
def test_a_map_that_lies_a_little_off_is_moved_onto_the_scan_and_that_is_told(
    scan: Volume,
    tmp_path: Path,
    name: str,
    shift: tuple[float, float, float],
    said: str | None,
) -> None:
    image = image_of(some_labels())
    image.SetOrigin(np.add(ORIGIN, shift).tolist())
    if "seg" in name:
        image.SetMetaData("Segment0_Name", "one")
        image.SetMetaData("Segment0_LabelValue", "1")
        image.SetMetaData("Segment0_Layer", "0")
    SimpleITK.WriteImage(image, str(tmp_path / name))
    for resample in (False, True):
        found = palpate.read_labels(tmp_path / name, scan, resample=resample)
        np.testing.assert_array_equal(found.labels[0].segment.mask(), some_labels() == 1)
        if said is None:
            assert found.warnings == ()
        else:
            (told,) = found.warnings
            assert said in told


@pytest.mark.parametrize(
    "change", [{"SetSpacing": (0.5, 0.75, 2.2)}, {"SetOrigin": (10.25, -20.0, 30.0)},
               {"SetDirection": (0.98, -0.199, 0, 0.199, 0.98, 0, 0, 0, 1)}]
)  # fmt: skip
def test_a_map_on_another_grid_is_refused(
    scan: Volume, tmp_path: Path, change: dict[str, tuple[float, ...]]
) -> None:
    image = image_of(some_labels())
    for name, value in change.items():
        getattr(image, name)(value)
    SimpleITK.WriteImage(image, str(tmp_path / "other.nrrd"))
    with pytest.raises(OptionError, match=r"lies on another grid than the scan; allowed"):
        palpate.read_labels(tmp_path / "other.nrrd", scan)


@pytest.mark.parametrize("kind", ["map.nrrd", "map.seg.nrrd", "folder"])
def test_a_map_on_another_grid_is_resampled_where_that_is_asked_for(
    tmp_path: Path, kind: str
) -> None:
    # a ball, on a scan's grid and on a finer one that is turned and shifted against it
    scan = Volume(np.zeros((30, 32, 34), np.int16), spacing=(1.0, 1.1, 1.2), origin=(5.0, 6.0, 7.0))
    middle, radius = np.array([22.0, 23.0, 24.0]), 9.0
    turn = np.array([[0.8, -0.6, 0.0], [0.6, 0.8, 0.0], [0.0, 0.0, 1.0]])
    corner = middle - turn @ (20.0, 20.0, 20.0)
    z, y, x = np.mgrid[0:40, 0:40, 0:40]
    ball = ((x - 20.0) ** 2 + (y - 20.0) ** 2 + (z - 20.0) ** 2 <= radius**2).astype(np.uint8)
    image = SimpleITK.GetImageFromArray(3 * ball)
    image.SetDirection(turn.ravel().tolist())
    image.SetOrigin(corner.tolist())
    path = tmp_path / kind
    if kind == "folder":
        path.mkdir()
        SimpleITK.WriteImage(image, str(path / "ball.nii.gz"))
    else:
        if kind == "map.seg.nrrd":
            for name, value in (("Name", "ball"), ("LabelValue", "3"), ("Layer", "0")):
                image.SetMetaData(f"Segment0_{name}", value)
        SimpleITK.WriteImage(image, str(path))
    with pytest.raises(OptionError, match="others with `resample=True`"):
        palpate.read_labels(path, scan)
    found = palpate.read_labels(path, scan, resample=True)
    assert "it lies on another grid" in found.warnings[-1]
    (label,) = found.labels
    z, y, x = np.indices(scan.shape)
    places = np.stack([x, y, z], axis=-1) * scan.spacing + scan.origin
    away = np.linalg.norm(places - middle, axis=-1)
    got = label.segment.mask() != 0
    # half a diagonal of a voxel of the map is what the nearest one may be off
    assert got[away < radius - 0.9].all()
    assert not got[away > radius + 0.9].any()


def test_what_is_resampled_beyond_the_scan_is_counted(tmp_path: Path) -> None:
    scan = Volume(np.zeros((4, 4, 4), np.int16), spacing=(1.0, 1.0, 1.0))
    labels = np.zeros((2, 2, 8), np.uint8)
    labels[0, 0, :] = 1
    image = SimpleITK.GetImageFromArray(labels)
    image.SetSpacing((0.8, 1.7, 1.7))
    image.SetMetaData("Segment0_Name", "rod")
    SimpleITK.WriteImage(image, str(tmp_path / "rod.seg.nrrd"))
    found = palpate.read_labels(tmp_path / "rod.seg.nrrd", scan, resample=True)
    # centres at 0, 0.8, …, 5.6 mm; the scan ends at 3.5 mm
    assert found.warnings[0] == "3 voxels of segments lie outside the scan (38 %): rod (38 %)"
    (label,) = found.labels
    assert label.segment.mask()[0, 0].tolist() == [1, 1, 1, 1]


@pytest.mark.data
def test_frames_of_another_grid_are_resampled(data_folder: Path) -> None:
    folder = data_folder / "dcmqi_seg"
    scan = palpate.read(folder / "ct-3slice")
    (expected,) = palpate.read_labels(folder / "liver.dcm", scan).labels
    # every second voxel of the scan's slices: their centres lie on those of the whole scan
    part = np.ascontiguousarray(scan.array[:, ::2, ::2])
    x, y, z = scan.spacing
    coarse = Volume(part, spacing=(2 * x, 2 * y, z), origin=scan.origin, direction=scan.direction)
    with pytest.raises(OptionError, match="another grid"):
        palpate.read_labels(folder / "liver.dcm", coarse)
    found = palpate.read_labels(folder / "liver.dcm", coarse, resample=True)
    assert "it lies on another grid" in found.warnings[-1]
    mask = expected.segment.mask()[:, ::2, ::2]
    np.testing.assert_array_equal(found.labels[0].segment.mask() != 0, mask != 0)


def test_a_scan_is_no_label_map(tmp_path: Path) -> None:
    values = np.arange(512, dtype=np.int16).reshape(8, 8, 8)
    scan = Volume(np.zeros((8, 8, 8), np.int16), spacing=SPACING, origin=ORIGIN)
    SimpleITK.WriteImage(image_of(values), str(tmp_path / "scan.nrrd"))
    with pytest.raises(OptionError, match="511 different values, as scans do; allowed"):
        palpate.read_labels(tmp_path / "scan.nrrd", scan)


def test_names_and_colours_of_a_nifti_table_are_taken(scan: Volume, tmp_path: Path) -> None:
    plain = tmp_path / "plain.nii"
    SimpleITK.WriteImage(image_of(some_labels()), str(plain))
    content = plain.read_bytes()
    table = (
        b'<CaretExtension><VolumeInformation Index="0"><LabelTable>'
        b'<Label Key="2" Red="0.25" Green="0.5" Blue="1.0" Alpha="1"><![CDATA[left lung]]></Label>'
        b"</LabelTable></VolumeInformation></CaretExtension>"
    )
    size = -(-(len(table) + 8) // 16) * 16
    header = bytearray(content[:348])
    header[108:112] = np.float32(352 + size).tobytes()
    extension = np.array([size, 30], "<i4").tobytes() + table.ljust(size - 8, b"\0")
    path = tmp_path / "organs.nii.gz"
    path.write_bytes(gzip.compress(bytes(header) + b"\1\0\0\0" + extension + content[352:]))
    found = palpate.read_labels(path, scan).labels
    assert [label.segment.name for label in found] == ["label 1", "left lung", "label 3"]
    assert found[1].colour == (0.25, 0.5, 1.0)


def test_a_folder_of_masks_gives_a_segment_each(scan: Volume, tmp_path: Path) -> None:
    labels = some_labels()
    for name, mask in (("aorta", labels == 1), ("liver", labels == 2), ("spleen", labels == 9)):
        image = image_of(mask.astype(np.uint8))
        SimpleITK.WriteImage(image, str(tmp_path / f"{name}.nii.gz"))
    (tmp_path / "statistics.json").write_text("{}")
    found = palpate.read_labels(tmp_path, scan)
    assert [label.segment.name for label in found.labels] == ["aorta", "liver"]
    assert [label.colour for label in found.labels] == [
        colour_of_name("aorta"), colour_of_name("liver")
    ]  # fmt: skip
    np.testing.assert_array_equal(found.labels[1].segment.mask(), labels == 2)
    assert found.warnings == ("1 segment is empty: spleen",)


# --- Slicer -------------------------------------------------------------------------------


def segmentation(values: NDArray[Any], path: Path, **fields: str) -> Path:
    image = image_of(values, layers=values.ndim == 4)
    for name, value in fields.items():
        image.SetMetaData(name, value)
    SimpleITK.WriteImage(image, str(path), useCompression=True)
    return path


def test_overlapping_segments_of_slicer_are_kept(scan: Volume, tmp_path: Path) -> None:
    first, second = some_labels(), np.roll(some_labels(), 1, axis=2)
    path = segmentation(
        np.stack([first, second], axis=-1), tmp_path / "two.seg.nrrd",
        Segment0_Name="skull", Segment0_LabelValue="1", Segment0_Layer="0",
        Segment0_Color="0.5 0.25 1",
        Segment1_Name="brain", Segment1_LabelValue="1", Segment1_Layer="1",
        Segment2_Name="none", Segment2_LabelValue="9", Segment2_Layer="0",
    )  # fmt: skip
    found = palpate.read_labels(path, scan)
    assert [label.segment.name for label in found.labels] == ["skull", "brain"]
    assert found.labels[0].colour == (0.5, 0.25, 1.0)
    assert found.warnings == ("1 segment is empty: none",)
    np.testing.assert_array_equal(found.labels[0].segment.mask(), first == 1)
    np.testing.assert_array_equal(found.labels[1].segment.mask(), second == 1)
    assert (found.labels[0].segment.mask() & found.labels[1].segment.mask()).any()


def test_a_single_layer_of_slicer_is_read(scan: Volume, tmp_path: Path) -> None:
    labels = some_labels()
    path = segmentation(labels, tmp_path / "one.seg.nrrd", Segment0_Name="bone",
                        Segment0_LabelValue="2")  # fmt: skip
    (label,) = palpate.read_labels(path, scan).labels
    np.testing.assert_array_equal(label.segment.mask(), labels == 2)


def test_damaged_segmentations_are_refused(scan: Volume, tmp_path: Path) -> None:
    path = segmentation(some_labels(), tmp_path / "one.seg.nrrd", Segment0_Layer="3")
    with pytest.raises(VolumeFormatError, match="names layer 3 of 1; allowed"):
        palpate.read_labels(path, scan)
    path.write_bytes(path.read_bytes()[:-20])
    with pytest.raises(VolumeFormatError, match="allowed"):
        palpate.read_labels(path, scan)


# --- DICOM segmentations ------------------------------------------------------------------


@pytest.mark.filterwarnings("ignore:::pydicom")
def test_what_a_damaged_file_tells_as_its_modality_is_shortened(
    scan: Volume, write_series: Any
) -> None:
    # a wrong length makes the rest of the file its modality
    path = next(write_series(Modality="RTSTRUCT" + "x" * 3000).iterdir())
    with pytest.raises(OptionError, match=r"modality 'RTSTRUCT.*; allowed: SEG or RT") as caught:
        palpate.read_labels(path, scan)
    assert len(str(caught.value)) < 100 + len(str(path))


@pytest.fixture
def liver_scan(data_folder: Path) -> Volume:
    return palpate.read(data_folder / "dcmqi_seg" / "ct-3slice")


def expected_mask(path: Path, value: int) -> NDArray[np.bool_]:
    return np.asarray(SimpleITK.GetArrayFromImage(SimpleITK.ReadImage(str(path))) == value)


@pytest.mark.data
@pytest.mark.parametrize(
    "name", ["dcmqi_seg/liver.dcm", *(f"pydicom_transfer_syntaxes/liver{kind}.dcm" for kind in (
        "", "_deflate", "_expb", "_j2k", "_rle", "_nonbyte_aligned", "_nonbyte_aligned_rle"))]
)  # fmt: skip
def test_a_binary_segmentation_is_what_dcmqi_makes_of_it(
    data_folder: Path, liver_scan: Volume, name: str
) -> None:
    (label,) = palpate.read_labels(data_folder / name, liver_scan).labels
    assert label.segment.name == "Liver"
    expected = expected_mask(data_folder / "dcmqi_seg" / "liver_seg.nrrd", 1)
    np.testing.assert_array_equal(label.segment.mask(), expected)
    # DICOM's liver is brown
    red, green, blue = label.colour or (0.0, 0.0, 0.0)
    assert red > green > blue


@pytest.mark.data
def test_overlapping_segments_of_dicom_are_kept(data_folder: Path, liver_scan: Volume) -> None:
    folder = data_folder / "dcmqi_seg"
    found = palpate.read_labels(folder / "partial_overlaps.dcm", liver_scan).labels
    names = ["GREEN", "ORANGE", "PURPLE", "LIGHT_BLUE", "DARK_BLUE"]
    assert [label.segment.name for label in found] == names
    files = [folder / f"partial_overlaps-{number}.nrrd" for number in (1, 2, 3)]
    for value, label in enumerate(found, 1):
        expected = np.any([expected_mask(file, value) for file in files], axis=0)
        np.testing.assert_array_equal(label.segment.mask(), expected)


@pytest.mark.data
@pytest.mark.parametrize("kind", ["noppv", "ppv5"])
def test_a_label_map_with_missing_frames_is_read(data_folder: Path, kind: str) -> None:
    folder = data_folder / "dcmqi_seg"
    scan = palpate.read(folder / "24x38x3" / "image")
    (label,) = palpate.read_labels(folder / f"sparse-labelmap-{kind}.dcm", scan).labels
    assert label.segment.name == "Liver"
    expected = expected_mask(folder / f"sparse_labelmap_{kind}_seg.nrrd", 1)
    np.testing.assert_array_equal(label.segment.mask(), expected)


@pytest.mark.data
def test_fractions_are_cut_at_half_and_told(
    data_folder: Path, liver_scan: Volume, tmp_path: Path
) -> None:
    dataset = dcmread(data_folder / "dcmqi_seg" / "liver.dcm")
    solid = dataset.pixel_array.astype(bool)
    fractions = np.where(solid, 100, 99).astype(np.uint8)
    dataset.SegmentationType, dataset.MaximumFractionalValue = "FRACTIONAL", 200
    dataset.BitsAllocated, dataset.BitsStored, dataset.HighBit = 8, 8, 7
    dataset.PixelData = fractions.tobytes()
    dataset.save_as(tmp_path / "fractional.dcm")
    found = palpate.read_labels(tmp_path / "fractional.dcm", liver_scan)
    assert found.warnings == ("fractions of voxels are cut at 50 %",)
    assert found.labels[0].segment.voxel_count == solid.sum()


@pytest.mark.data
def test_a_segmentation_of_another_scan_is_refused(data_folder: Path, liver_scan: Volume) -> None:
    path = data_folder / "dcmqi_seg" / "24x38x3" / "seg" / "label.seg"
    with pytest.raises(OptionError, match="is not of this scan"):
        palpate.read_labels(path, liver_scan)
    with pytest.raises(OptionError, match="lies on another grid"):
        palpate.read_labels(path, liver_scan, another_patient=True)


def test_colours_of_cielab_are_those_of_srgb() -> None:
    assert colour_of_lab([65535, 32896, 32896]) == pytest.approx((1.0, 1.0, 1.0), abs=2e-3)
    assert colour_of_lab([0, 32896, 32896]) == pytest.approx((0.0, 0.0, 0.0), abs=1e-3)
    # CIELab of pure red under D50: 54.29, 80.81, 69.89
    red = [round(54.29 / 100 * 65535), round((80.81 + 128) * 257), round((69.89 + 128) * 257)]
    assert colour_of_lab(red) == pytest.approx((1.0, 0.0, 0.0), abs=1e-2)


# --- anything -----------------------------------------------------------------------------


@pytest.mark.data
def test_the_structures_of_lidc_have_their_names(data_folder: Path) -> None:
    folder = data_folder / "lidc0001_totalseg"
    found = palpate.read_labels(folder / "mask.nii.gz", palpate.read(folder / "cxr.nii.gz")).labels
    assert len(found) == 89
    liver = next(label for label in found if label.segment.name == "liver")
    assert 1000.0 < liver.segment.volume_ml < 2500.0
    assert liver.colour == colour_of_name("liver")


@pytest.mark.data
def test_other_files_are_refused(data_folder: Path, scan: Volume, tmp_path: Path) -> None:
    for path, said in (
        (data_folder / "dcmqi_seg" / "ct-3slice" / "01.dcm", "modality 'CT'; allowed: SEG"),
        (tmp_path, "holds no masks; allowed"),
    ):
        with pytest.raises(PalpateError, match=said):
            palpate.read_labels(path, scan)
    with pytest.raises(FileNotFoundError, match="does not exist; allowed"):
        palpate.read_labels(tmp_path / "none", scan)
