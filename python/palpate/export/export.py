"""Export: a scene's segments and scan as files that other programs read.

Every file appears under its name when it is whole. DICOM objects refer to the files that the scan
was read from; unless identity is kept for an archive that knows the patient, the scan goes along,
and all of them are de-identified together.
"""

from __future__ import annotations

from collections.abc import Sequence
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Literal, get_args

from palpate.base.errors import OptionError
from palpate.base.progress import Progress, silent
from palpate.base.whole_file import whole_file, whole_folder
from palpate.export.deidentify import Deidentifier
from palpate.export.dicom_contours import make_rtstruct
from palpate.export.dicom_object import save_dicom
from palpate.export.dicom_scan import make_series
from palpate.export.dicom_seg import MOST_LABEL, make_seg
from palpate.export.dicom_source import IDENTIFIERS, DicomSource, dicom_source
from palpate.export.image import IMAGE_SUFFIXES, write_label_map, write_scan
from palpate.export.masks import written_segments
from palpate.export.numbering import changed_numbers, numbers_of, unique_names
from palpate.export.seg_nrrd import write_seg_nrrd
from palpate.io.dicom.header import damage_told
from palpate.volumes.scene import Scene, SceneSegment, require_scene

if TYPE_CHECKING:
    from pydicom.dataset import Dataset

__all__ = ["KINDS", "Kind", "check_export", "export_scene", "kind_of"]

Kind = Literal["seg-nrrd", "labels", "scan", "dicom-seg", "dicom-labelmap", "rtstruct", "dicom"]
"""What to write: segments for 3D Slicer; a label map; the scan with its edits; one DICOM object; or
a folder of DICOM with all of these."""
KINDS: tuple[Kind, ...] = get_args(Kind)

ENDINGS: dict[Kind, tuple[str, ...]] = {
    "seg-nrrd": (".seg.nrrd",),
    "labels": IMAGE_SUFFIXES,
    "scan": IMAGE_SUFFIXES,
    "dicom-seg": (".dcm",),
    "dicom-labelmap": (".dcm",),
    "rtstruct": (".dcm",),
    "dicom": ("",),
}
"""File name extensions of each kind."""


def kind_of(path: Path, *, has_segments: bool) -> Kind:
    """Returns the kind for a name; for an image, labels where there are segments, else the scan.

    Raises:
        OptionError: The extension is not known.
    """
    name = path.name.lower()
    if name.endswith(".seg.nrrd"):
        return "seg-nrrd"
    if name.endswith(IMAGE_SUFFIXES):
        return "labels" if has_segments else "scan"
    if name.endswith(".dcm"):
        return "dicom-seg"
    if "." in name:
        endings = ", ".join((".seg.nrrd", *IMAGE_SUFFIXES, ".dcm"))
        raise OptionError(
            f"{path.name!r} given; allowed: a name with {endings}, or a new folder for DICOM"
        )
    return "dicom"


def check_export(path: Path, kind: Kind, *, keep_identity: bool) -> None:
    """Refuses what could not be written, before anything is computed.

    Raises:
        OptionError: The name does not fit, its folder does not exist, or a DICOM object would refer
            to nothing.
    """
    if kind not in KINDS:
        raise OptionError(f"kind {kind!r} given; allowed: {', '.join(KINDS)}")
    if not path.name.lower().endswith(ENDINGS[kind]):
        endings = ", ".join(ENDINGS[kind])
        raise OptionError(f"{path.name!r} given for {kind}; allowed: a name with {endings}")
    if not path.absolute().parent.is_dir():
        raise OptionError(f"folder {str(path.parent)!r} given; allowed: one that exists")
    if ENDINGS[kind] == (".dcm",) and not keep_identity:
        raise OptionError(
            f"{path.name!r} would refer to a scan that names the patient; allowed: with "
            "--keep-identity for an archive that has the scan, or a new folder (a name without an "
            "ending), into which the scan goes along, all de-identified"
        )


def export_scene(
    scene: Scene,
    path: str | PathLike[str],
    *,
    kind: Kind | None = None,
    only: Sequence[str] | None = None,
    keep_identity: bool = False,
    progress: Progress = silent,
) -> list[str]:
    """Writes a scene's segments, its scan, or both, for other programs.

    Args:
        scene: The scan and its segments; ``Session.scene_now`` returns those of a session.
        path: The new file, or for DICOM with all its files a new folder.
        kind: What to write; the default depends on the name of ``path``.
        only: Names of the segments to write; the default is all.
        keep_identity: Whether DICOM objects keep the patient's name and refer to the scan as it is
            in the archive; else the scan is written beside them and all files are de-identified.
        progress: Takes the progress.

    Returns:
        Sentences on what was left out or lost.

    Raises:
        OptionError: It cannot be written in this form; the message says what is allowed.
        StillIdentifiedError: De-identified files would still contain the patient's name.
        OSError: The file cannot be written; an existing one stays as it was.
    """
    require_scene(scene)
    target = Path(path)
    chosen = kind_of(target, has_segments=len(scene) > 0) if kind is None else kind
    check_export(target, chosen, keep_identity=keep_identity)
    progress(f"writing {target.name}", None)
    if chosen == "scan":
        write_scan(scene.volume, target)
        return []
    if chosen == "dicom" and len(scene) == 0:
        return _export_folder(scene, [], target, keep=keep_identity, progress=progress)
    segments, told = written_segments(scene, only)
    match chosen:
        case "seg-nrrd":
            told += write_seg_nrrd(segments, scene.volume, target)
        case "labels":
            told += write_label_map(segments, scene.volume, target)
        case "dicom":
            told += _export_folder(scene, segments, target, keep=keep_identity, progress=progress)
        case _:
            with dicom_source(scene.volume, complete=False, progress=progress) as source:
                progress(f"writing {target.name}", None)
                made = _make(chosen, segments, scene, source=source)
            with whole_file(target) as unfinished:
                save_dicom(made, unfinished)
            told += _changes_told(chosen, segments)
    return told


def _make(
    kind: Kind, segments: list[SceneSegment], scene: Scene, *, source: DicomSource
) -> Dataset:
    if kind == "rtstruct":
        return make_rtstruct(segments, scene.volume, source)
    seg_kind: Literal["BINARY", "LABELMAP"] = "BINARY" if kind == "dicom-seg" else "LABELMAP"
    return make_seg(segments, scene.volume, source, kind=seg_kind)


def _changes_told(kind: Kind, segments: list[SceneSegment]) -> list[str]:
    """Says which names and numbers of segments a DICOM object has in another form."""
    numbers = {
        "dicom-labelmap": numbers_of(segments, most=MOST_LABEL)[0],
        "rtstruct": numbers_of(segments)[0],
    }.get(kind, list(range(1, len(segments) + 1)))
    return [*changed_numbers(segments, numbers), *unique_names(segments)[1]]


def _export_folder(
    scene: Scene, segments: list[SceneSegment], path: Path, *, keep: bool, progress: Progress
) -> list[str]:
    """Writes everything that DICOM can represent of a scene into a new folder."""
    if keep and not segments and not scene.volume.edited:
        raise OptionError(
            "the scan is as it was read, and there are no segments to write; allowed: with "
            "--segments FILE or --threshold LOW,HIGH, or without --keep-identity to share the scan"
        )
    lost: list[str] = []
    with (
        dicom_source(scene.volume, complete=not keep, progress=progress) as source,
        whole_folder(path) as folder,
    ):
        share = None if keep else Deidentifier(source.images)
        if share is not None:
            _copy_scan(source, folder / "scan", share, progress=progress)
        if scene.volume.edited:
            (folder / "edited").mkdir()
            count = scene.volume.shape[0]
            for number, made in enumerate(make_series(scene.volume, source)):
                progress(f"writing {count} edited slices", number / count)
                _save(made, folder / "edited" / f"{number + 1:05}.dcm", share)
            if scene.volume.exact is not None:
                lost.append(
                    f"values of edited slices are rounded to steps of {scene.volume.slope:.4g}; "
                    ".nrrd keeps them"
                )
        if segments:
            progress("writing segments", None)
            lost += _changes_told("dicom-seg", segments)
            made = make_seg(segments, scene.volume, source, kind="BINARY")
            _save(made, folder / "segments.dcm", share)
            _save(make_rtstruct(segments, scene.volume, source), folder / "structures.dcm", share)
    return lost


def _copy_scan(
    source: DicomSource, folder: Path, share: Deidentifier, *, progress: Progress
) -> None:
    """Writes the files that the scan was read from, de-identified, with their own pixels."""
    import pydicom

    folder.mkdir()
    for number, (path, headers) in enumerate(zip(source.files, source.images, strict=True)):
        progress(f"writing {len(source.files)} files of the scan", number / len(source.files))
        with damage_told(path):
            image = pydicom.dcmread(path)
        for name in (*IDENTIFIERS, "SOPInstanceUID", "SOPClassUID"):
            # where files lack them they were made up
            setattr(image, name, headers.get(name))
        _save(image, folder / f"{number + 1:05}.dcm", share)


def _save(made: Dataset, path: Path, share: Deidentifier | None) -> None:
    save_dicom(made if share is None else share.apply(made), path)
