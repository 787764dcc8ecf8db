"""Scenes that options ask for: a scan with segments, a mesh and a second scan, or a saved scene."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from palpate.base.console import warn
from palpate.base.errors import MeshFormatError, OptionError, PalpateError, SceneFormatError
from palpate.base.hints import prefixed, retold
from palpate.base.progress import Progress
from palpate.base.typed_numbers import Bounds, parse_threshold
from palpate.cli.flags import of_import
from palpate.io.reading import read
from palpate.volumes.scene import Scene
from palpate.volumes.second_scan import doubts_of, placed, read_transform
from palpate.volumes.volume import Volume

if TYPE_CHECKING:
    from palpate.io.request import ReadRequest
    from palpate.saved.opening import Opening
    from palpate.volumes.mesh_read import Frame, MeshFile, Unit

__all__ = [
    "add_labels",
    "add_mesh",
    "add_second",
    "further_scan",
    "measured_scene",
    "mesh_file",
    "saved_scene",
    "scene_at",
    "scene_of",
    "wanted_scene",
]


def wanted_scene(
    volume: Volume,
    *,
    bounds: Bounds | None,
    label_map: Path | None,
    resample: bool = False,
    another_patient: bool = False,
    progress: Progress,
) -> Scene:
    """Returns a scan with the segments asked for, and no others.

    Raises:
        EmptySegmentError: The threshold asked for selects nothing.
        VolumeFormatError: The label map cannot be read.
        OptionError: The label map does not fit the scan.
    """
    scene = Scene(volume)
    if bounds is not None:
        scene.add(volume.threshold(*bounds, name="threshold"))
    if label_map is not None:
        add_labels(
            scene,
            label_map,
            resample=resample,
            another_patient=another_patient,
            progress=progress,
        )
    return scene


def scene_of(
    volume: Volume,
    *,
    bounds: Bounds | None,
    label_map: Path | None,
    resample: bool = False,
    another_patient: bool = False,
    progress: Progress,
) -> Scene:
    """Returns a scene with the segments asked for, or with the one offered as bone.

    Raises:
        EmptySegmentError: The threshold asked for selects nothing.
        VolumeFormatError: The label map cannot be read.
        OptionError: The label map does not fit the scan.
    """
    scene = wanted_scene(
        volume,
        bounds=bounds,
        label_map=label_map,
        resample=resample,
        another_patient=another_patient,
        progress=progress,
    )
    if bounds is None and label_map is None:
        from palpate.saved.opening import offer_bone

        told = offer_bone(scene)
        if told is not None:
            warn(told)
    return scene


def add_labels(
    scene: Scene,
    path: Path,
    *,
    resample: bool,
    another_patient: bool = False,
    progress: Progress,
) -> None:
    """Adds the segments of a file or folder, and says what was changed or left out."""
    from palpate.labels.labels import read_labels

    found = read_labels(
        path,
        scene.volume,
        resample=resample,
        another_patient=another_patient,
        progress=progress,
    )
    for label in found.labels:
        # smooth bodies are read at a glance; until its surface is made, one is drawn from voxels
        scene.add(label.segment, colour=label.colour, shown_as="surface")
    for warning in found.warnings:
        warn(f"{path.name}: {warning}")


def add_second(
    scene: Scene,
    path: Path | None,
    transform: Path | None,
    *,
    series: str | None = None,
    frame: int | None = None,
    progress: Progress,
) -> None:
    """Shows a second scan with the first, where a transform says that it lies.

    Raises:
        OptionError: There is a transform, series or frame and no scan, or it cannot be used.
        VolumeFormatError: The scan or the transform cannot be read.
    """
    if path is None:
        _refuse_alone({"--transform": transform, "--with-series": series, "--with-frame": frame})
        return
    volume = _second_read(path, series=series, frame=frame, progress=progress)
    known = None if transform is None else read_transform(transform)
    scene.second = placed(scene.volume, volume, known)
    for warning in (*doubts_of(scene.volume, scene.second), *volume.warnings):
        warn(f"{path.name}: {of_import(warning, path)}")


def further_scan(path: Path, progress: Progress) -> Volume:
    """Reads a scan for which the command has no options of reading.

    Raises:
        PalpateError: It cannot be read, or there are several.
    """
    try:
        return read(path, progress=progress)
    except PalpateError as error:
        raise type(error)(of_import(str(error), path)) from None


def _refuse_alone(options: Mapping[str, object]) -> None:
    """Refuses options of a second scan where there is none."""
    for name, given in options.items():
        if given is not None:
            raise OptionError(f"{name} {given} given; allowed: together with --with")


def _second_read(
    path: Path, *, series: str | None, frame: int | None, progress: Progress
) -> Volume:
    try:
        return read(path, series=series, frame=frame, progress=progress)
    except PalpateError as error:
        # here the options of the second scan are called otherwise than those of the first
        raise type(error)(_of_second(str(error), path)) from None


def _of_second(message: str, path: Path) -> str:
    """Returns a message of the second scan with options that are its own."""
    own = {"series": "--with-series", "frame": "--with-frame"}

    def tell(name: str, value: str) -> str:
        return f"{own[name]} {value}" if name in own else f"`{name}={value}`"

    return of_import(retold(message, tell), path)


def saved_scene(path: Path, progress: Progress) -> Opening:
    """Returns a scene that was saved.

    Raises:
        SceneFormatError: It cannot be opened; its last autosave is named then.
    """
    from palpate.saved.autosave import with_autosave
    from palpate.saved.opening import Opening
    from palpate.saved.scene_file import open_scene

    try:
        saved = open_scene(path, progress=progress)
        return Opening(saved.scene(), saved, saved.messages)
    except SceneFormatError as error:
        raise with_autosave(error, path) from None


def scene_at(
    path: Path,
    reading: ReadRequest,
    *,
    bounds: Bounds | None,
    label_map: Path | None,
    resample: bool = False,
    another_patient: bool = False,
    offered: bool = False,
    progress: Progress,
) -> Scene:
    """Returns a saved scene, or a scan with the segments asked for, and says what is to be known.

    Args:
        path: The scene or the scan.
        reading: How a scan is read.
        bounds: Threshold of a segment to make.
        label_map: File of segments.
        resample: Whether they may lie on another grid.
        another_patient: Whether they may be another patient's.
        offered: Whether a scan without segments gets the one offered as bone.
        progress: Takes the progress.

    Raises:
        OptionError: Options of scans are given with a scene, or the segments do not fit the scan.
        PalpateError: It cannot be read.
    """
    from palpate.io.request import ReadRequest
    from palpate.saved.ending import is_scene

    if is_scene(path):
        of_scans = (bounds is not None, label_map is not None, resample, another_patient)
        if reading != ReadRequest() or any(of_scans):
            raise OptionError(f"{path} is a scene: options of scans are allowed with scans only")
        return _edited_saved_scene(path, progress)
    volume = reading.read(path, progress)
    for warning in volume.warnings:
        warn(warning)
    make = scene_of if offered else wanted_scene
    return make(
        volume,
        bounds=bounds,
        label_map=label_map,
        resample=resample,
        another_patient=another_patient,
        progress=progress,
    )


def measured_scene(
    path: Path,
    reading: ReadRequest,
    *,
    threshold: str | None,
    segments: Path | None,
    resample: bool,
    another_patient: bool,
    progress: Progress,
) -> Scene:
    """Returns the scene of a command that measures segments, of which there must be some.

    Raises:
        OptionError: No segments are asked for, or those do not fit the scan.
        PalpateError: It cannot be read.
    """
    from palpate.saved.ending import is_scene

    bounds = parse_threshold(threshold)
    if not is_scene(path) and segments is None and bounds is None:
        raise OptionError(
            "no segments given; allowed: --segments FILE or --threshold LOW,HIGH, or a saved scene"
        )
    return scene_at(
        path,
        reading,
        bounds=bounds,
        label_map=segments,
        resample=resample,
        another_patient=another_patient,
        progress=progress,
    )


def _edited_saved_scene(path: Path, progress: Progress) -> Scene:
    """Returns the scan of a scene that was saved, with its edits and segments, and says its doubts.

    Raises:
        SceneFormatError: It cannot be opened.
    """
    from palpate.saved.edited_scene import edited_scene
    from palpate.saved.scene_file import open_scene

    saved = open_scene(path, progress=progress)
    scene, notes = edited_scene(saved)
    for note in (*saved.volume.warnings, *notes):
        warn(note)
    return scene


def mesh_file(path: Path, *, frame: str | None, unit: str | None, close: bool) -> MeshFile:
    """Reads a mesh and warns of what was repaired.

    Raises:
        OptionError: The frame or the unit is not known.
    """
    from palpate.volumes.mesh_read import closed, read_mesh

    frames: dict[str | None, Frame | None] = {None: None, "LPS": "LPS", "RAS": "RAS"}
    units: dict[str | None, Unit | None] = {None: None, "mm": "mm", "m": "m"}
    if frame not in frames:
        raise OptionError(f"frame {frame!r} given; allowed: LPS, RAS")
    if unit not in units:
        raise OptionError(f"unit {unit!r} given; allowed: mm, m")
    file = read_mesh(path, frame=frames[frame], unit=units[unit])
    if close:
        file = closed(file)
    for note in file.notes:
        warn(f"{file.name}: {note}")
    return file


def add_mesh(
    scene: Scene, path: Path, *, frame: str | None, unit: str | None, spacing: float | None
) -> None:
    """Adds a closed mesh as an object with voxels of its own [mm], shown as a surface.

    Raises:
        OptionError: Its frame or its unit is not known, or the spacing is not allowed.
        MeshFormatError: It holds no mesh, or is open.
        EmptySegmentError: It is thinner than a voxel everywhere.
    """
    from palpate.volumes.mesh_read import object_of_mesh, suitable_spacing

    try:
        file = mesh_file(path, frame=frame, unit=unit, close=False)
    except OptionError as error:
        # here the options of a mesh are called otherwise than in `palpate surface`
        raise OptionError(prefixed(str(error), "mesh")) from None
    if file.holes:
        raise MeshFormatError(
            f"{file.name!r} has {file.holes} hole{'s' if file.holes > 1 else ''}, so no inside; "
            "allowed: a closed mesh (`palpate surface voxels --close` makes a label map of it)"
        )
    edge = suitable_spacing(file.mesh, scene.volume) if spacing is None else spacing
    segment = object_of_mesh(file, edge)
    scene.add(segment, shown_as="surface")
    typer.echo(f"{file.name}: {segment.voxel_count} voxels of {edge:.3g} mm, {segment.volume_text}")
