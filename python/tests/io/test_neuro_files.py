"""Files of neuroimaging: nibabel's own test files, and files of each format made here."""

from __future__ import annotations

import gzip
from pathlib import Path
from typing import Any

import nibabel
import numpy as np
import palpate
import pytest
import SimpleITK
from file_cases import places_differ, values_of
from palpate.base.errors import PalpateError, SeriesChoiceError
from palpate.base.progress import silent
from palpate.io.image_file import header_of, image_files, middle_of, read_file
from palpate.io.upright import upright

OWN = Path(nibabel.__file__).parent / "tests" / "data"
"""nibabel's own test files."""
ALONE = "which does not exist"
REFUSED = {
    "analyze.hdr": ALONE, "nifti1.hdr": ALONE, "nifti2.hdr": ALONE,
    "ADC_Map.PAR": "1 diffusion b value values, but expected 3",
    "phantom_truncated.PAR": "3 dynamic scan values, but expected 4",
    "bad_attribute+orig.HEAD": "improper type", "bad_datatype+orig.HEAD": "multiple data types",
    "minc2_baddim.mnc": "Could not open", "row_major.dconn.nii": "values on surfaces",
    "test.mgz": "sheared axes",
}  # fmt: skip
"""What is no scan, or none that is whole, and why; of other PAR files the voxels are not there."""


def own_files() -> list[str]:
    """Lists nibabel's own images, each pair by its header."""
    return [path.name for path in image_files(OWN, among=10_000)]


def volumes_of(image: Any, *, time_first: bool) -> list[Any]:
    """Returns all volumes of an image of nibabel, shape [x, y, z]."""
    values = np.asanyarray(image.dataobj)
    if time_first:
        return list(values)
    return [*np.moveaxis(values.reshape(*values.shape[:3], -1, order="F"), -1, 0)]


@pytest.mark.parametrize("name", own_files())
def test_own_files_of_nibabel_are_right_or_refused_for_a_true_reason(name: str) -> None:
    path = OWN / name
    is_alone = path.suffix == ".PAR" and not path.with_suffix(".REC").is_file()
    if name in REFUSED or is_alone:
        with pytest.raises(PalpateError, match=REFUSED.get(name, ALONE)) as caught:
            palpate.read(path, frame=1)
        assert "\n" not in str(caught.value)
        return
    frames = header_of(path).frames
    is_hdf = path.read_bytes()[:4] == b"\x89HDF"
    if is_hdf:
        # nibabel needs h5py for these; ITK takes the axis of time for numbers of one voxel
        image = SimpleITK.ReadImage(str(path), imageIO="MINCImageIO")
        array = SimpleITK.GetArrayFromImage(image)
        expected = [*np.moveaxis(array, -1, 0)] if frames > 1 else [array]
    else:
        image = nibabel.load(path)
        expected = [one.T for one in volumes_of(image, time_first=name == "minc1_4d.mnc")]
        if path.suffix == ".PAR":
            image.dataobj.file_like.close()
    assert len(expected) == frames
    for frame, wanted in enumerate(expected, 1):
        # as files have them: how they are stored afterwards is another matter
        scan = read_file(path, frame=frame, max_voxels=10**7, progress=silent)
        np.testing.assert_allclose(scan.values, wanted, rtol=1e-6)
        np.testing.assert_allclose(middle_of(path, frame), scan.values[len(wanted) // 2])
    volume = palpate.read(path, frame=frames, fill=0.0)
    assert is_hdf or places_differ(volume, image.affine) < 1e-3
    if frames > 1:
        with pytest.raises(
            SeriesChoiceError, match=f"{frames} volumes.*`frame=NUMBER` from 1 to {frames}"
        ):
            palpate.read(path)


def oblique() -> np.ndarray:
    """A transform to RAS with right angles."""
    axes, _ = np.linalg.qr(np.array([[-0.9, 0.3, 0.0], [0.3, 0.9, 0.2], [0.06, 0.18, -2.4]]))
    affine = np.eye(4)
    affine[:3, :3], affine[:3, 3] = axes * (0.7, 0.9, 2.5), (12.0, -30.0, 7.0)
    return affine


@pytest.mark.parametrize("kind", ["u1", "i2", "i4", "f4"])
@pytest.mark.parametrize("name", ["a.mgh", "a.mgz", "A.MGZ"])
def test_files_of_freesurfer_lie_where_nibabel_puts_them(
    tmp_path: Path, kind: str, name: str
) -> None:
    values = np.random.default_rng(7).integers(0, 200, (5, 6, 7, 3)).astype(kind)
    nibabel.save(nibabel.MGHImage(values, oblique()), tmp_path / name.lower())
    (tmp_path / name.lower()).rename(tmp_path / name)
    for frame in (1, 2, 3):
        volume = palpate.read(tmp_path / name, frame=frame, unit="HU")
        np.testing.assert_array_equal(values_of(volume), values[..., frame - 1].T)
        assert places_differ(volume, oblique()) < 1e-3
        assert volume.warnings == ()


def test_a_file_of_freesurfer_without_a_place_is_of_unknown_orientation(tmp_path: Path) -> None:
    nibabel.save(nibabel.MGHImage(np.ones((3, 4, 5), np.int16), np.eye(4)), tmp_path / "a.mgh")
    packed = bytearray((tmp_path / "a.mgh").read_bytes())
    packed[28:30] = bytes(2)  # goodRASFlag
    (tmp_path / "a.mgh").write_bytes(packed)
    assert palpate.read(tmp_path / "a.mgh").orientation == "unknown"


@pytest.mark.parametrize("kept", [20, 200, 400])
def test_truncated_files_of_freesurfer_are_refused(tmp_path: Path, kept: int) -> None:
    nibabel.save(nibabel.MGHImage(np.ones((5, 6, 7), np.int16), np.eye(4)), tmp_path / "a.mgh")
    (tmp_path / "a.mgh").write_bytes((tmp_path / "a.mgh").read_bytes()[:kept])
    with pytest.raises(PalpateError, match=r"no readable FreeSurfer|truncated"):
        palpate.read(tmp_path / "a.mgh")


@pytest.mark.parametrize("kind", [nibabel.AnalyzeImage, nibabel.Spm99AnalyzeImage])
def test_analyze_tells_sizes_of_voxels_and_no_sides(tmp_path: Path, kind: Any) -> None:
    values = np.arange(60, dtype=np.int16).reshape(3, 4, 5)
    nibabel.save(kind(values, np.diag([-1.0, 1.5, 2.5, 1.0])), tmp_path / "a.img")
    (tmp_path / "a.mat").unlink(missing_ok=True)
    volume = palpate.read(tmp_path / "a.hdr")
    np.testing.assert_array_equal(values_of(volume), values.T)
    assert volume.spacing == (1.0, 1.5, 2.5)
    assert volume.orientation == "unknown"


def test_volumes_of_five_axes_are_counted_with_the_fourth_first(tmp_path: Path) -> None:
    values = np.random.default_rng(8).integers(0, 99, (3, 4, 5, 2, 3)).astype(np.int16)
    nibabel.save(nibabel.Nifti1Image(values, np.eye(4)), tmp_path / "a.nii")
    with pytest.raises(SeriesChoiceError, match=r"5-D image of 6 volumes \(2 x 3\)"):
        palpate.read(tmp_path / "a.nii")
    for frame in range(6):
        volume = palpate.read(tmp_path / "a.nii", frame=frame + 1)
        np.testing.assert_array_equal(values_of(volume), values[..., frame % 2, frame // 2].T)


def some_file(folder: Path, kind: str) -> tuple[Path, bytes]:
    """Writes a small file of a kind; returns its path and what is behind its compression."""
    values = np.random.default_rng(9).integers(0, 99, (5, 6, 7)).astype(np.int16)
    path = folder / MADE[kind]
    made = {
        "nifti-2": nibabel.Nifti2Image,
        "mgh": nibabel.MGHImage,
        "analyze": nibabel.AnalyzeImage,
    }
    if kind in ("minc", "parrec", "afni"):
        for own in OWN.glob(f"{path.stem}.*"):
            (folder / own.name).write_bytes(own.read_bytes())
    else:
        nibabel.save(made.get(kind, nibabel.Nifti1Image)(values, oblique()), path.with_suffix(
            ".img" if kind == "analyze" else path.suffix))  # fmt: skip
    content = path.read_bytes()
    return path, gzip.decompress(content) if kind == "packed" else content


MADE = {
    "nifti": "a.nii", "packed": "a.nii.gz", "nifti-2": "a.nii", "mgh": "a.mgh",
    "analyze": "a.hdr", "minc": "tiny.mnc", "parrec": "phantom_EPI_asc_CLEAR_2_1.PAR",
    "afni": "scaled+tlrc.HEAD",
}  # fmt: skip
EXTREMES = (0, 1, 0xFFFFFFFF, 0x7F800000, 0x7FC00000, 0x7FFFFFFF, 0x80000000, 1_000_000)


@pytest.mark.parametrize("kind", MADE)
def test_headers_of_any_bytes_give_a_scan_or_one_line(tmp_path: Path, kind: str) -> None:
    path, content = some_file(tmp_path, kind)
    draw = np.random.default_rng(10)
    said = []
    for _ in range(60):
        changed = bytearray(content)
        for _ in range(int(draw.integers(1, 4))):
            place = int(draw.integers(0, min(len(content), 400) // 4)) * 4
            changed[place : place + 4] = int(draw.choice(EXTREMES)).to_bytes(4, "little")
        place = int(draw.integers(0, len(content)))
        whole = bytes(changed if draw.random() < 0.7 else changed[:place])
        path.write_bytes(gzip.compress(whole) if kind == "packed" else whole)
        for frame in (None, 1):
            try:
                middle_of(path, frame or 1)
                scan = read_file(path, frame=frame, max_voxels=10**6, progress=silent)
                upright("scan", scan, max_voxels=10**6, progress=silent)
            except PalpateError as error:
                said.append(str(error))
    assert said
    assert [one for one in said if "\n" in one or "allowed" not in one] == []


def test_short_voxels_beside_a_header_of_philips_are_refused(tmp_path: Path) -> None:
    for name in ("phantom_EPI_asc_CLEAR_2_1.PAR", "phantom_EPI_asc_CLEAR_2_1.REC"):
        (tmp_path / name).write_bytes((OWN / name).read_bytes())
    (tmp_path / "phantom_EPI_asc_CLEAR_2_1.REC").write_bytes(bytes(100))
    with pytest.raises(PalpateError, match="no readable parrec file"):
        palpate.read(tmp_path / "phantom_EPI_asc_CLEAR_2_1.PAR", frame=2)
