"""What ``palpate bench fuzz-import`` damages: small files of every format, real or made here.

What is made is the same to the bit on every run, but for scenes: a case follows from its seed.
"""

from __future__ import annotations

import shutil
import zipfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from palpate.base.errors import OptionError
from palpate.base.nibabel import nibabel
from palpate.base.simpleitk import simpleitk
from palpate.bench.fuzz_dicom import dicom_folders, segments_of_ct
from palpate.io.dicom.series import is_dicom
from palpate.io.image_file import FORMATS
from palpate.saved.scene_file import save_scene
from palpate.session.appearance import appearances_of, keep_appearances
from palpate.session.session import Session, SessionOptions
from palpate.volumes.scene import Scene
from palpate.volumes.volume import Volume

__all__ = ["Sample", "samples_in"]

LARGEST_SAMPLE = 600_000
"""Largest file [bytes]; larger ones take long and would be damaged in the same places."""
MOST_OF_A_FOLDER = 6
ENDINGS = tuple(ending for some in FORMATS.values() for ending in some)
MESHES = (".stl", ".ply", ".obj", ".glb")
DETACHED = (".raw", ".zraw")
OF_NIBABEL = (
    "minc1_1_scale.mnc", "minc1_4d.mnc", "minc1-no-att.mnc", "tiny.mnc", "minc2_1_scale.mnc",
    "phantom_EPI_asc_CLEAR_2_1.PAR", "phantom_EPI_asc_CLEAR_2_1.REC",
    "phantom_varscale.PAR", "phantom_varscale.REC",
    "example4d+orig.HEAD", "example4d+orig.BRIK.gz", "scaled+tlrc.HEAD", "scaled+tlrc.BRIK",
    "test.mgz",
)  # fmt: skip
"""nibabel's own test files of formats that it does not write."""
RECIPE = """import:
  path: scan.mha
  unit: HU
segment:
  - threshold: [200, 400]
    keep-largest: true
    name: ball
surface:
  - segment: ball
    out: ball.stl
export:
  - out: labels.nii.gz
    only: [ball]
report: report.html
"""


@dataclass(frozen=True)
class Sample:
    """A real file, and how it is read."""

    path: Path
    kind: str
    """scan, series, archive, labels, mesh, pictures, scene, recipe, neuro (read with nibabel),
    dicom (scans of other forms than slices of CT and MR) or segments (of DICOM)."""
    scan: Path | None = None
    """Scan to which labels belong."""
    beside: tuple[Path, ...] = ()
    """Files that lie undamaged beside it."""
    as_folder: bool = False
    """Whether its folder is read."""

    @property
    def said(self) -> str:
        """Name in reports."""
        return f"{self.kind} {self.path.parent.name}/{self.path.name}"


def samples_in(folder: Path, made: Path) -> list[Sample]:
    """Lists small real files below a folder with the ways to read them, always in the same order.

    Formats that are missing are written into ``made``.

    Raises:
        OptionError: There is no file.
    """
    files = sorted(
        path
        for path in folder.rglob("*")
        if path.is_file() and 0 < path.stat().st_size <= LARGEST_SAMPLE
    )
    dicom = [path for path in files if is_dicom(path)]
    images = [path for path in files if path.name.lower().endswith(ENDINGS)]
    scans = sorted({path.parent for path in dicom if path.parent.name in ("image", "ct-3slice")})
    samples = [Sample(path, "scan", beside=_detached(path)) for path in [*dicom, *images]]
    samples += [
        Sample(path, "series", beside=_first_files(path.parent), as_folder=True)
        for path in dicom
        if path.parent in scans
    ]
    samples += [
        Sample(path, "labels", scan)
        for path in [*dicom, *images]
        for scan in scans
        if scan.parent in path.parents and path.parent != scan
    ]
    samples += [Sample(path, "mesh") for path in files if path.suffix in MESHES]
    for scan in scans:
        samples.append(Sample(_archive(scan, made / f"{scan.parent.name}.zip"), "archive"))
    small = [path for path in images if path.name.endswith(".nii.gz")][:1]
    samples += [
        Sample(path, "scan", beside=_detached(path))
        for image in small
        for path in _rewritten(image, made)
    ]
    if not samples:
        raise OptionError(
            f"{folder} holds no scan, label or mesh of at most {LARGEST_SAMPLE} bytes; "
            "allowed: a folder with some"
        )
    return samples + _made(made) + _neuro(made / "neuro") + _dicom(made / "dicom")


def _first_files(folder: Path) -> tuple[Path, ...]:
    return tuple(sorted(folder.iterdir())[:MOST_OF_A_FOLDER])


def _detached(header: Path) -> tuple[Path, ...]:
    """Lists files beside a header that hold its voxels."""
    return tuple(path for ending in DETACHED if (path := header.with_suffix(ending)).is_file())


def _archive(folder: Path, target: Path) -> Path:
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as archive:
        for path in _first_files(folder):
            # one moment for all: the same bytes on every run
            archive.writestr(zipfile.ZipInfo(path.name), path.read_bytes())
    return target


def _made(made: Path) -> list[Sample]:
    """Writes pictures, a scene, a recipe and a label map with its table."""
    sitk = simpleitk()
    values = np.arange(12 * 10 * 8, dtype=np.int16).reshape(8, 10, 12)
    pages, picture, scene, recipe, scan, labels = (
        made / name
        for name in ("p.tif", "p.png", "s.palpate", "r.yaml", "labels/scan.mha", "labels/a.mha")
    )
    scan.parent.mkdir()
    sitk.WriteImage(sitk.GetImageFromArray(values), str(pages))
    sitk.WriteImage(sitk.GetImageFromArray(values[0].astype(np.uint8)), str(picture))
    sitk.WriteImage(sitk.GetImageFromArray(values), str(scan))
    sitk.WriteImage(sitk.GetImageFromArray(values // 300), str(labels))
    volume = Volume(values, spacing=(1.0, 1.0, 2.0))
    with Session(
        Scene(volume, [volume.threshold(500.0)]), options=SessionOptions(real_time=False)
    ) as session:
        looks = keep_appearances(session, appearances_of(session).__getitem__)
        save_scene(scene, session, looks=looks, copy=True)
    recipe.write_text(RECIPE, "utf-8")
    table = scan.with_name("a.csv")
    table.write_text("id,structure,red,green,blue\n1,one,1,0,0\n2,two,0,1,0.5\n", "utf-8")
    return [
        Sample(pages, "pictures"),
        Sample(picture, "pictures"),
        Sample(scene, "scene"),
        Sample(recipe, "recipe"),
        Sample(labels, "labels", scan, beside=(table,)),
        Sample(table, "labels", scan, beside=(labels,)),
    ]


def _rewritten(image: Path, made: Path) -> Iterator[Path]:
    """Writes a corner of an image in each format."""
    sitk = simpleitk()
    corner = sitk.ReadImage(str(image))[:16, :16, :16]
    for name in ("a.nii", "b.mha", "c.nrrd", "d.mhd", "e.nhdr"):
        sitk.WriteImage(corner, str(made / name), name == "c.nrrd")
        yield made / name


# --- formats that are read with nibabel ---------------------------------------------------


def _neuro(made: Path) -> list[Sample]:
    """Writes files of each format that nibabel writes, and copies its own of the others.

    Headers and voxels of a pair are damaged in turn.
    """
    made.mkdir()
    library = nibabel()
    values = np.arange(6 * 5 * 4 * 3, dtype=np.int16).reshape(6, 5, 4, 3)
    affine = np.diag([-2.0, -2.0, 3.0, 1.0])
    for kind, names in (
        (library.Nifti2Image, ("a.nii", "b.nii.gz")),
        (library.Nifti2Pair, ("c.hdr",)),
        (library.AnalyzeImage, ("d.hdr",)),
        (library.MGHImage, ("f.mgh", "g.mgz")),
    ):
        for name in names:
            image = kind(values[..., 0] if name in ("d.hdr", "f.mgh") else values, affine)
            library.save(image, made / name)
    own = Path(str(library.__file__)).parent / "tests" / "data"
    for name in OF_NIBABEL:
        # a package may leave its tests out
        if (own / name).is_file():
            shutil.copyfile(own / name, made / name)
    files = sorted(made.iterdir())
    return [Sample(path, "neuro", beside=_pair_of(path, files)) for path in files]


def _pair_of(path: Path, files: Sequence[Path]) -> tuple[Path, ...]:
    """Lists the other file of a pair."""
    stem = path.name.split(".")[0]
    return tuple(one for one in files if one != path and one.name.split(".")[0] == stem)


# --- objects of DICOM ---------------------------------------------------------------------


def _dicom(made: Path) -> list[Sample]:
    """Writes scans that are no plain series of CT or MR, and segments of a CT."""
    samples = [
        Sample(path, "dicom", beside=tuple(files), as_folder=True)
        for files in dicom_folders(made).values()
        for path in files
    ]
    scan, segments = segments_of_ct(made)
    return samples + [Sample(path, "segments", scan) for path in segments]
