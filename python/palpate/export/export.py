"""Export: a scene's segments and scan as files that other programs read.

Every file appears under its name when it is whole. DICOM objects refer to the files that the scan
was read from; unless identity is kept for an archive that knows the patient, the scan goes along,
and all of them are de-identified together.
"""

from __future__ import annotations

from collections.abc import Sequence
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from palpate.base.errors import OptionError
from palpate.base.given import path_of
from palpate.base.progress import Progress, silent
from palpate.base.whole_file import whole_file, whole_folder
from palpate.export.image import write_label_map, write_scan
from palpate.export.kinds import Kind, check_export, kind_of
from palpate.export.masks import written_segments
from palpate.export.numbering import changed_numbers, numbers_of, unique_names
from palpate.export.seg_nrrd import write_seg_nrrd
from palpate.volumes.scene import Scene, SceneSegment, require_scene

if TYPE_CHECKING:
    # what makes DICOM is imported where DICOM is made
    from pydicom.dataset import Dataset

    from palpate.export.deidentify import Deidentifier
    from palpate.export.dicom_source import DicomSource

__all__ = ["export_scene"]


def export_scene(
    scene: Scene,
    path: str | PathLike[str],
    *,
    kind: Kind | None = None,
    only: Sequence[str] | None = None,
    keep_identity: bool = False,
    pixels_checked: bool = False,
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
        pixels_checked: Whether a person has looked for text in the pixels of images that are
            declared to have some, or are of a kind that often has.
        progress: Takes the progress.

    Returns:
        Sentences on what was left out or lost.

    Raises:
        OptionError: It cannot be written in this form; the message says what is allowed.
        StillIdentifiedError: De-identified files would still contain the patient's name.
        OSError: The file cannot be written; an existing one stays as it was.
    """
    require_scene(scene)
    target = path_of(path)
    chosen = kind_of(target, has_segments=len(scene) > 0) if kind is None else kind
    check_export(target, chosen, keep_identity=keep_identity)
    progress(f"writing {target.name}", None)
    if chosen == "scan":
        write_scan(scene.volume, target)
        return []
    if chosen == "dicom" and len(scene) == 0:
        return _export_folder(
            scene, [], target, keep=keep_identity, checked=pixels_checked, progress=progress
        )
    segments, told = written_segments(scene, only)
    match chosen:
        case "seg-nrrd":
            told += write_seg_nrrd(segments, scene.volume, target)
        case "labels":
            told += write_label_map(segments, scene.volume, target)
        case "dicom":
            told += _export_folder(
                scene,
                segments,
                target,
                keep=keep_identity,
                checked=pixels_checked,
                progress=progress,
            )
        case _:
            told += _export_object(scene, segments, target, kind=chosen, progress=progress)
    return told


def _export_object(
    scene: Scene, segments: list[SceneSegment], path: Path, *, kind: Kind, progress: Progress
) -> list[str]:
    """Writes one DICOM object that refers to the scan's files; returns what it has otherwise."""
    from palpate.export.dicom_object import save_dicom
    from palpate.export.dicom_source import dicom_source

    with dicom_source(scene.volume, complete=False, progress=progress) as source:
        progress(f"writing {path.name}", None)
        made = _make(kind, segments, scene, source=source)
    with whole_file(path) as unfinished:
        save_dicom(made, unfinished)
    return _changes_told(kind, segments)


def _make(
    kind: Kind, segments: list[SceneSegment], scene: Scene, *, source: DicomSource
) -> Dataset:
    from palpate.export.dicom_contours import make_rtstruct
    from palpate.export.dicom_seg import make_seg

    if kind == "rtstruct":
        return make_rtstruct(segments, scene.volume, source)
    seg_kind: Literal["BINARY", "LABELMAP"] = "BINARY" if kind == "dicom-seg" else "LABELMAP"
    return make_seg(segments, scene.volume, source, kind=seg_kind)


def _changes_told(kind: Kind, segments: list[SceneSegment]) -> list[str]:
    """Says which names and numbers of segments a DICOM object has in another form."""
    from palpate.export.dicom_seg import MOST_LABEL

    numbers = {
        "dicom-labelmap": numbers_of(segments, most=MOST_LABEL)[0],
        "rtstruct": numbers_of(segments)[0],
    }.get(kind, list(range(1, len(segments) + 1)))
    return [*changed_numbers(segments, numbers), *unique_names(segments)[1]]


def _export_folder(
    scene: Scene,
    segments: list[SceneSegment],
    path: Path,
    *,
    keep: bool,
    checked: bool,
    progress: Progress,
) -> list[str]:
    """Writes everything that DICOM can represent of a scene into a new folder."""
    from palpate.export.deidentify import Deidentifier
    from palpate.export.dicom_contours import make_rtstruct
    from palpate.export.dicom_scan import make_series
    from palpate.export.dicom_seg import make_seg
    from palpate.export.dicom_source import dicom_source

    if keep and not segments and not scene.volume.edited:
        raise OptionError(
            "the scan is as it was read, and there are no segments to write; allowed: a scan "
            "with segments, or without `keep_identity=True` to share the scan"
        )
    lost: list[str] = []
    with (
        dicom_source(scene.volume, complete=not keep, progress=progress) as source,
        whole_folder(path) as folder,
    ):
        share = None if keep else Deidentifier(source.images, pixels_checked=checked)
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
        if share is not None:
            share.write_report(folder / "deidentification.csv")
    return lost


def _copy_scan(
    source: DicomSource, folder: Path, share: Deidentifier, *, progress: Progress
) -> None:
    """Writes the files that the scan was read from, de-identified, with their own pixels."""
    import pydicom

    from palpate.export.dicom_source import IDENTIFIERS
    from palpate.io.dicom.header import damage_told

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
    from palpate.export.dicom_object import save_dicom

    save_dicom(made if share is None else share.apply(made), path)
