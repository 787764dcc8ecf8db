"""Structures of radiotherapy lie where their contours do, and what is missing of them is told."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import palpate
import pytest
from palpate.base.errors import OptionError, VolumeFormatError
from palpate.volumes.volume import Volume
from pydicom import dcmread
from pydicom.dataset import Dataset, FileDataset, FileMetaDataset
from pydicom.uid import UID, ExplicitVRLittleEndian, RTStructureSetStorage


def structures(
    path: Path,
    *rois: tuple[str, list[Any]],
    colour: Any = (255, 128, 0),
    frame: str | None = None,
) -> Path:
    """Writes contours, each as corners [mm], as structures of radiotherapy."""
    meta = FileMetaDataset()
    meta.MediaStorageSOPClassUID = RTStructureSetStorage
    meta.MediaStorageSOPInstanceUID = UID("1.2.3")
    meta.TransferSyntaxUID = ExplicitVRLittleEndian
    dataset = FileDataset("", {}, file_meta=meta, preamble=b"\0" * 128)
    dataset.SOPClassUID, dataset.SOPInstanceUID = RTStructureSetStorage, "1.2.3"
    dataset.Modality = "RTSTRUCT"
    dataset.StructureSetROISequence, dataset.ROIContourSequence = [], []
    for number, (name, contours) in enumerate(rois, 1):
        named, drawn = Dataset(), Dataset()
        named.ROINumber, named.ROIName = number, name
        if frame is not None:
            named.ReferencedFrameOfReferenceUID = frame
        drawn.ReferencedROINumber, drawn.ROIDisplayColor = number, list(colour)
        drawn.ContourSequence = []
        for corners in contours:
            contour = Dataset()
            contour.ContourGeometricType = "CLOSED_PLANAR" if len(corners) > 2 else "POINT"
            contour.ContourData = [f"{part:.6g}" for part in np.ravel(corners)]
            drawn.ContourSequence.append(contour)
        dataset.StructureSetROISequence.append(named)
        dataset.ROIContourSequence.append(drawn)
    dataset.save_as(path, enforce_file_format=True)
    return path


def square(low: float, high: float, z: float) -> list[tuple[float, float, float]]:
    return [(low, low, z), (high, low, z), (high, high, z), (low, high, z)]


@pytest.fixture
def table() -> Volume:
    """A scan of 40 x 40 x 10 voxels of 1 x 1 x 3 mm."""
    return Volume(np.zeros((10, 40, 40), np.int16), spacing=(1.0, 1.0, 3.0))


def test_a_contour_in_another_is_a_hole(table: Volume, tmp_path: Path) -> None:
    contours = [square(4.5, 30.5, z) for z in (6.0, 9.0, 12.0)]
    contours += [square(10.5, 20.5, z) for z in (6.0, 9.0, 12.0)]
    path = structures(tmp_path / "rt.dcm", ("wall", contours), ("point", [[(1.0, 1.0, 6.0)]]))
    found = palpate.read_labels(path, table)
    (label,) = found.labels
    expected = np.zeros((10, 40, 40), bool)
    expected[2:5, 5:31, 5:31] = True
    expected[2:5, 11:21, 11:21] = False
    np.testing.assert_array_equal(label.segment.mask(), expected)
    assert (label.segment.name, label.colour) == ("wall", (1.0, 128 / 255, 0.0))
    assert found.warnings == ("no closed contours: point",)


def test_what_of_structures_is_cut_off_or_missing_is_told(table: Volume, tmp_path: Path) -> None:
    def block(low: float, high: float, *heights: float) -> list[Any]:
        return [square(low, high, 3.0 * height) for height in heights]

    path = structures(
        tmp_path / "rt.dcm",
        # half of each of four planes, and one of them below the scan: 1 - 0.5 * 3 / 4
        (
            "edge",
            [[(x - 10.0, y, z) for x, y, z in each] for each in block(-0.5, 19.5, -1, 0, 1, 2)],
        ),
        ("beyond", block(100.0, 120.0, 2, 3, 4)),
        ("speck", block(4.6, 4.7, 3)),
        ("hole", block(4.5, 20.5, 1, 2, 3, 5, 6)),
        ("few", block(4.5, 20.5, 1, 2, 4)),
        ("whole", block(-0.5, 39.5, 0, 1, 2, 3)),
        ("two", [*block(1.5, 9.5, 1, 2, 3), *block(20.5, 30.5, 5, 6, 7)]),
    )
    found = palpate.read_labels(path, table)
    assert [label.segment.name for label in found.labels] == ["edge", "hole", "few", "whole", "two"]
    assert found.warnings == (
        "outside the scan: beyond",
        "smaller than a voxel, so not on the scan: speck",
        "partly outside the scan, and cut off there: edge (62 %)",
        "planes without a contour are interpolated between their neighbours: few (1)",
        "planes without a contour are left empty: hole (1)",
    )
    # and it is as told
    counts = {label.segment.name: label.segment.mask().sum(axis=(1, 2)) for label in found.labels}
    assert counts["few"][3] > 0
    assert counts["hole"][4] == 0


@pytest.mark.parametrize(
    ("given", "told"),
    [
        (rb"nan\9.5\6", "coordinates that are no numbers"),
        (rb"9.5\9.506", "a contour of 11 coordinates; allowed: three for each point"),
    ],
)
def test_contours_that_are_none_are_named(
    table: Volume, tmp_path: Path, given: bytes, told: str
) -> None:
    path = structures(tmp_path / "rt.dcm", ("fine", []), ("bad", [square(4.5, 9.5, 6.0)]))
    path.write_bytes(path.read_bytes().replace(rb"9.5\9.5\6", given))
    with pytest.raises(VolumeFormatError, match=rf"structure 'bad' of .*rt.dcm has .*{told}"):
        palpate.read_labels(path, table)


def test_slices_between_contours_take_a_shape_between(table: Volume, tmp_path: Path) -> None:
    contours = [square(4.5, 10.5, 6.0), square(4.5, 20.5, 12.0), square(4.5, 30.5, 18.0)]
    (label,) = palpate.read_labels(structures(tmp_path / "rt.dcm", ("a", contours)), table).labels
    counts = label.segment.mask().sum(axis=(1, 2)).tolist()
    # half a step before the first and, not counted itself, behind the last
    assert [counts[at] for at in (0, 1, 2, 4, 6, 7)] == [0, 36, 36, 256, 676, 0]
    # squares of pixels at one depth come and go together
    assert counts[3] == pytest.approx((36 + 256) / 2, rel=0.02)
    assert counts[5] == pytest.approx((256 + 676) / 2, rel=0.02)


def test_contours_across_the_slices_are_refused(table: Volume, tmp_path: Path) -> None:
    slanted = [(x, y, 6.0 + 0.3 * x + 0.2 * y) for x, y, _ in square(4.5, 20.5, 0.0)]
    path = structures(tmp_path / "rt.dcm", ("a", [slanted]))
    with pytest.raises(OptionError, match=r"across the scan's slices; allowed"):
        palpate.read_labels(path, table)


def turned_block() -> list[Any]:
    """A block of 16 x 16 x 16 mm around (20, 20, 15), drawn on slices that are turned about x."""
    turn = np.radians(30.0)
    down, along = (
        np.array([0.0, np.cos(turn), np.sin(turn)]),
        np.array([0.0, -np.sin(turn), np.cos(turn)]),
    )
    corners = [(x, y) for x, y, _ in square(-8.0, 8.0, 0.0)]
    return [
        [
            tuple(np.array([20.0, 20.0, 15.0]) + (x, 0.0, 0.0) + y * down + h * along)
            for x, y in corners
        ]
        for h in np.arange(-7.0, 8.0, 2.0)
    ]


def test_contours_of_another_grid_are_taken_in_one_frame_of_reference(
    table: Volume, tmp_path: Path
) -> None:
    path = structures(tmp_path / "rt.dcm", ("block", turned_block()), frame="1.2.9")
    # a scan that does not say which frame it has, and one that has another
    with pytest.raises(OptionError, match=r"across the scan's slices; allowed.*`resample=True`"):
        palpate.read_labels(path, table)
    table.traits = replace(table.traits, frame="1.2.8")
    with pytest.raises(OptionError, match=r"reference 1\.2\.9, the scan has 1\.2\.8: .*allowed"):
        palpate.read_labels(path, table)
    asked = palpate.read_labels(path, table, resample=True)
    table.traits = replace(table.traits, frame="1.2.9")
    found = palpate.read_labels(path, table)
    assert len(found.warnings) == 1
    assert "at its centre" in found.warnings[0]
    (block,) = (label.segment for label in found.labels)
    np.testing.assert_array_equal(block.mask(), asked.labels[0].segment.mask())
    # its voxels are those whose middles the block holds, but for half a voxel at its sides
    k, j, i = np.indices(table.shape)
    turn = np.radians(30.0)
    x, y, z = i - 20.0, j - 20.0, 3.0 * k - 15.0
    down, along = (
        y * np.cos(turn) + z * np.sin(turn),
        z * np.cos(turn) - y * np.sin(turn),
    )
    deep = np.maximum(np.maximum(np.abs(x), np.abs(down)), np.abs(along)) - 8.0
    assert block.mask()[deep < -0.75].all()
    assert not block.mask()[deep > 0.75].any()
    # on the scan's own slices nothing is resampled
    flat = [square(4.5, 30.5, z) for z in (6.0, 9.0, 12.0)]
    plain = structures(tmp_path / "flat.dcm", ("wall", flat), frame="1.2.9")
    assert palpate.read_labels(plain, table).warnings == ()
    bent = [[*square(4.5, 20.5, 6.0)[:3], (4.5, 20.5, 12.0)]]
    with pytest.raises(OptionError, match="in no plane; allowed"):
        palpate.read_labels(structures(tmp_path / "b.dcm", ("a", bent), frame="1.2.9"), table)


def tilted(low: float, high: float, *, up: float) -> list[Any]:
    """Squares drawn on planes at 45° to the scan's slices, in the middle of which is z = ``up``."""
    return [
        [
            (x, 20.0 + (y - offset) * 0.7, up + (y + offset) * 0.7)
            for x, y, _ in square(low, high, 0)
        ]
        for offset in range(-3, 4)
    ]


def test_what_is_lost_of_contours_aslant_is_told_with_its_share(tmp_path: Path) -> None:
    table = Volume(np.zeros((30, 40, 40), np.int16), spacing=(1.0, 1.0, 1.0))
    table.traits = replace(table.traits, frame="1.2.9")
    path = structures(
        tmp_path / "rt.dcm",
        # its middle lies on the lower face of the scan
        ("half", [[(x + 20.0, y, z) for x, y, z in each] for each in tilted(-8, 8, up=-0.5)]),
        ("whole", [[(x + 20.0, y, z) for x, y, z in each] for each in tilted(-8, 8, up=15.0)]),
        frame="1.2.9",
    )
    for resample in (False, True):
        found = palpate.read_labels(path, table, resample=resample)
        assert [label.segment.name for label in found.labels] == ["half", "whole"]
        assert "partly outside the scan, and cut off there: half (50 %)" in found.warnings


def test_a_scans_frame_of_reference_is_known(write_series: Any) -> None:
    folder = write_series(FrameOfReferenceUID="1.2.9")
    assert palpate.read(folder).traits.frame == "1.2.9"


@pytest.mark.data
def test_real_structures_have_the_volume_of_their_contours(data_folder: Path) -> None:
    path = data_folder / "dicompyler_rt" / "rtss.dcm"
    scan = Volume(
        np.zeros((120, 512, 512), np.int16),
        spacing=(1.074219, 1.074219, 3.0),
        origin=(-275.0, -524.0, -140.44),
    )
    found = palpate.read_labels(path, scan)
    assert found.warnings == ("no closed contours: Areola",)
    segments = {label.segment.name: label.segment for label in found.labels}
    dataset = dcmread(path)
    names = {roi.ROINumber: roi.ROIName for roi in dataset.StructureSetROISequence}
    for roi in dataset.ROIContourSequence:
        name = names[roi.ReferencedROINumber]
        if name not in ("Heart", "Breast", "Tumor Bed"):
            continue
        area = 0.0
        for contour in roi.ContourSequence:
            x, y, _ = np.array(contour.ContourData, float).reshape(-1, 3).T
            area += abs(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1))) / 2.0
        # middles of voxels count: within 2 % for structures of some 20 voxels and more
        assert segments[name].volume_ml == pytest.approx(area * 3.0 / 1000.0, rel=0.02)
