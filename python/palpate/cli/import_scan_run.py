"""What ``palpate import`` does once its options are understood: reading, listing, writing."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Literal

from palpate.base.errors import OptionError, PalpateError, SeriesChoiceError, VolumeFormatError
from palpate.base.file_suffixes import IMAGE_SUFFIXES
from palpate.base.progress import Progress
from palpate.base.replacing import check_replaceable
from palpate.base.whole_file import whole_folder
from palpate.cli.scenes import scene_of, wanted_scene
from palpate.export.export import export_scene
from palpate.io.browse import Choice, browsed, choices_among
from palpate.io.dicomweb.address import WebAddress
from palpate.io.dicomweb.series import RemoteSeries, fetch_series
from palpate.io.reading import list_series
from palpate.io.request import ReadRequest
from palpate.saved.ending import ENDING
from palpate.saved.scene_file import save_scene
from palpate.session.appearance import appearances_of, keep_appearances
from palpate.session.session import Session, SessionOptions
from palpate.volumes.scene import Scene
from palpate.volumes.volume import Volume

__all__ = [
    "Target",
    "Writing",
    "bring",
    "check_target",
    "read_or_list",
    "read_remote",
    "write_import",
]

Target = Literal["image", "scene", "folder"]
"""What a name asks for."""


def check_target(out: Path, *, paths: Sequence[Path], segments: Path | None) -> Target:
    """Returns what a name asks for; refuses what could not be written, before anything is read.

    Raises:
        OptionError: It ends with nothing known, its folder is not there, or the segments beside it
            would replace a file.
    """
    if not out.absolute().parent.is_dir():
        raise OptionError(f"folder {str(out.parent)!r} given; allowed: one that exists")
    name = out.name.lower()
    target: Target = "folder"
    if name.endswith(ENDING):
        target = "scene"
    elif name.endswith(IMAGE_SUFFIXES) and not name.endswith(".seg.nrrd"):
        target = "image"
    if target == "image" and segments is not None:
        check_replaceable(beside_of(out))
    if target == "folder" and paths:
        endings = ", ".join((*IMAGE_SUFFIXES, ENDING))
        raise OptionError(
            f"{out.name!r} given; allowed: a name with {endings} (palpate export writes DICOM and "
            ".seg.nrrd)"
        )
    return target


def read_or_list(
    paths: Sequence[Path], reading: ReadRequest, *, choose: bool, progress: Progress
) -> Volume | list[Choice]:
    """Reads the scan at these places, or lists the scans where there are several.

    Raises:
        SeriesChoiceError: There are several, and one has to be chosen.
        PalpateError: It cannot be read.
    """
    try:
        return reading.read(paths, progress)
    except SeriesChoiceError:
        if choose or reading.series is not None or reading.frame is not None:
            raise
    if len(paths) > 1:
        return choices_among(paths, progress=progress)
    with browsed(paths[0], progress=progress) as choices:
        return choices


def read_remote(
    address: WebAddress, one: RemoteSeries, reading: ReadRequest, *, progress: Progress
) -> Volume:
    """Brings a server's series, reads it, and leaves nothing of its files.

    Raises:
        DicomWebError: The server does not send it.
        SeriesChoiceError: It holds several volumes, such as times, or not the one asked for.
        PalpateError: It cannot be read.
    """
    with TemporaryDirectory(prefix="palpate-") as passing:
        folder = Path(passing) / "scan"
        folder.mkdir()
        fetch_series(address, one, folder, progress=progress)
        try:
            volume = reading.read([folder], progress)
        except SeriesChoiceError:
            found = list_series(folder, progress=progress)
            asked = "" if reading.series is None else f", and none is {reading.series!r}"
            named = "; ".join(
                f"[{number}] {each.description}" for number, each in enumerate(found, 1)
            )
            raise SeriesChoiceError(
                f"series {one.uid} holds {len(found)} volumes{asked}; choose one with --volume "
                f"NUMBER: {named}"
            ) from None
        except PalpateError as error:
            raise type(error)(str(error).replace(str(folder), f"series {one.uid}")) from None
    # there is nothing left to read it from again
    volume.source = None
    return volume


def bring(
    address: WebAddress, one: RemoteSeries, out: Path, *, progress: Progress
) -> dict[str, Any]:
    """Brings the files of a server's series into a new folder; returns what is there, for JSON.

    Raises:
        DicomWebError: The server does not send them.
        OptionError: There are files in the folder already.
        OSError: The disk refuses them; then nothing is left behind.
    """
    with whole_folder(out) as folder:
        files = fetch_series(address, one, folder, progress=progress)
    try:
        volumes = len(list_series(out, progress=progress))
    except VolumeFormatError:
        # what is no scan may be wanted all the same
        volumes = 0
    size = sum(path.stat().st_size for path in out.iterdir())
    return {"folder": str(out), "uid": one.uid, "files": files, "bytes": size, "volumes": volumes}


@dataclass(frozen=True, kw_only=True)
class Writing:
    """What is written of a scan."""

    out: Path
    target: Target
    segments: Path | None = None
    resample: bool = False
    """Whether segments may lie on another grid."""
    another_patient: bool = False
    """Whether DICOM segments may be of another patient, study or frame of reference."""


def write_import(volume: Volume, wanted: Writing, *, progress: Progress) -> list[dict[str, Any]]:
    """Writes a scan and, where given, its segments; returns the files, ready for JSON.

    A scene has both, and the bone that ``palpate open`` would offer where no segments are given.
    Beside an image segments become a ``.seg.nrrd``.

    Raises:
        OptionError: The segments do not belong to the scan.
        OSError: The disk refuses it; what was there is as it was.
    """
    out, file = wanted.out, wanted.segments
    make = scene_of if wanted.target == "scene" else wanted_scene
    scene = make(
        volume,
        bounds=None,
        label_map=file,
        resample=wanted.resample,
        another_patient=wanted.another_patient,
        progress=progress,
    )
    if wanted.target == "scene":
        progress(f"writing {out.name}", None)
        _write_scene(scene, out)
        return [_written(out, f"scan and {_counted(scene)}")]
    export_scene(scene, out, kind="scan", progress=progress)
    files = [_written(out, "scan")]
    if file is not None:
        export_scene(scene, beside_of(out), kind="seg-nrrd", progress=progress)
        files.append(_written(beside_of(out), _counted(scene)))
    return files


def beside_of(out: Path) -> Path:
    """Returns where the segments of a scan are written: beside it, under its name."""
    ending = next(each for each in IMAGE_SUFFIXES if out.name.lower().endswith(each))
    return out.with_name(f"{out.name[: -len(ending)]}.seg.nrrd")


def _write_scene(scene: Scene, out: Path) -> None:
    # it stands alone: what it was read from may be a download, or a disc that goes back
    with Session(scene, options=SessionOptions(real_time=False)) as session:
        looks = keep_appearances(session, appearances_of(session).__getitem__)
        save_scene(out, session, looks=looks, copy=True)


def _written(path: Path, holds: str) -> dict[str, Any]:
    return {"file": str(path), "holds": holds, "bytes": path.stat().st_size}


def _counted(scene: Scene) -> str:
    return "1 segment" if len(scene) == 1 else f"{len(scene)} segments"
