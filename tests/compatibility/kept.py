"""What 0.1 has kept beside recordings: how it was made, and what each file is to bring back.

Together with ``sessions.py`` this is the only place here that knows the inside of the package.
"""

from __future__ import annotations

import json
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np
import SimpleITK
from numpy.typing import NDArray
from palpate import Scene, Session, SessionOptions, Volume, read, read_labels
from palpate.cli.commands import run as command
from palpate.saved.autosave import autosave_of, note_scene
from palpate.saved.journal import Journal, journal_place
from palpate.saved.recent import note_recent, recent_scans
from palpate.saved.scene_file import SavedScene, open_scene, save_scene
from palpate.scenarios.drive import Drive
from palpate.scenarios.needle import drive_needle
from palpate.scenarios.run import read_run, write_run
from palpate.server.messages.segment_list import SegmentList
from palpate.server.resume import kept_port, note_port
from palpate.session.model_options import ModelOptions, Prony
from palpate.session.needle import TISSUES
from palpate.volumes.material import LinearMaterial, Material, Region
from palpate.volumes.mesh_read import read_mesh
from palpate.volumes.scan_hash import scan_hash
from palpate.volumes.second_scan import SecondScan

from .sessions import Place, bone, plate, pose_of, scan, second_values, soft

__all__ = [
    "FILES",
    "FIXTURES",
    "LOOKS",
    "MADE_IN",
    "SECOND_PLACE",
    "STANDING",
    "Journal",
    "SavedScene",
    "autosave_of",
    "command",
    "done_before_the_crash",
    "edited_for_a_scene",
    "journal_place",
    "kept_port",
    "looks_again",
    "made_by_recipe",
    "open_scan",
    "open_scene",
    "read_run",
    "recent_scans",
    "save_scene",
    "scan_hash",
    "second_scan",
    "told",
    "told_of_journal",
    "told_of_model",
    "told_of_run",
    "told_of_scene",
    "told_of_values",
    "write_notes",
    "write_scans",
    "write_scenario",
]

FIXTURES = Path(__file__).parent / "fixtures"
FILES = FIXTURES / "files"
MADE_IN = "/tmp/palpate-0.1"  # noqa: S108  # a place that is on every machine
"""Where 0.1 made the files; some name it as the place of the scan."""
STANDING = SessionOptions(real_time=False)

SECOND_PLACE = pose_of((3.0, -2.0, 1.5), turned=True)

LOOKS = [
    {
        "id": number,
        "touchable": number != 2,
        "locked": number == 2,
        "look": {
            "name": name,
            "colour": colour,
            "visible": number != 4,
            "shown_as": shown_as,
            "opacity": 0.5 + 0.0625 * number,
            "smoothing": number,
            "surface_from": "bits" if number == 2 else "intensities",
            "wireframe": number == 3,
            "ambient": 0.75,
            "specular": 0.25,
            "chosen": True,
        },
    }
    for number, name, colour, shown_as in [
        (1, "skull, left", [0.5, 0.25, 0.125], "both"),
        (2, "Gewebe ß", [0.25, 0.5, 0.75], "volume"),
        (3, "plate", [1.0, 0.0, 0.5], "surface"),
        (4, "skull, right", [0.0, 1.0, 0.25], "volume"),
    ]
]
"""Names and colours, as pages have them kept."""


# --- scans ------------------------------------------------------------------------------


def write_scans(folder: Path) -> None:
    """Writes the scan, a second one, and the first once more without a layout of its own."""
    volume = _straight_scan()
    _write(folder / "scan.nrrd", volume.array, volume)
    second = Volume(second_values(), spacing=(2.0, 2.5, 3.0), origin=(1.0, 2.0, 3.0))
    _write(folder / "second.nrrd", second.array, second)
    (folder / "second.raw").write_bytes(second.array.astype(">i2").tobytes())


def _straight_scan() -> Volume:
    """Returns the scan with the patient's axes: what its file says is read without a rounding."""
    return scan(np.eye(3))


def _write(path: Path, values: NDArray[np.int16], volume: Volume) -> None:
    image = SimpleITK.GetImageFromArray(values)
    image.SetSpacing(volume.spacing)
    image.SetOrigin(volume.origin)
    image.SetDirection(volume.direction.ravel().tolist())
    SimpleITK.WriteImage(image, str(path), useCompression=True)


def open_scan(folder: Path) -> Volume:
    """Reads the scan."""
    return read(folder / "scan.nrrd", unit="HU")


def second_scan(folder: Path) -> SecondScan:
    """Reads the second scan, and tells where it lies."""
    return SecondScan(read(folder / "second.nrrd"), SECOND_PLACE)


# --- what is told -----------------------------------------------------------------------


def told(session: Session) -> list[dict[str, Any]]:
    """Returns all that is known of the segments of a session, voxels by their hash."""
    known = [
        "id",
        "voxels",
        "volume",
        "grid",
        "bounds",
        "touchable",
        "locked",
        "range",
        "made_by",
        "feel",
        "pose",
        "material",
    ]
    rows = [
        {name: dict[str, Any](each)[name] for name in known}
        | {"mask": _hash(session.segment(each["id"]).mask())}
        | {"regions": [_region(one) for one in session.regions(each["id"])]}
        for each in session.segments()
    ]
    found: list[dict[str, Any]] = _plain({"rows": rows})["rows"]
    return found


def told_of_values(session: Session) -> str:
    """Returns a hash of the scan's values where edits have changed them.

    ``picture_changes`` is to have been called before the edits were made.
    """
    values = session.scene.volume.array.copy()
    for change in session.picture_changes():
        for box in change["voxels"]:
            if box["stored"] is not None:
                (i, j, k), (to_i, to_j, to_k) = box["low"], box["high"]
                shape = (to_k - k, to_j - j, to_i - i)
                stored = np.frombuffer(box["stored"], "<i2").reshape(shape)
                values[k:to_k, j:to_j, i:to_i] = stored
    return _hash(values)


def told_of_model(session: Session) -> dict[str, Any]:
    """Returns what is chosen of the model of deformation."""
    state = session.deformation()
    options = state["options"]
    return _plain(
        {
            "model": state["model"],
            "force_source": state["force_source"],
            "options": options._asdict() | {"prony": options.prony},
        }
    )


def _region(region: Region) -> list[Any]:
    return [region.treatment, region.box, region.shared_with]


def _plain(value: dict[str, Any]) -> dict[str, Any]:
    """Returns what JSON makes of it; infinity and NaN stay."""
    plain: dict[str, Any] = json.loads(json.dumps(value))
    return plain


def _hash(array: NDArray[Any]) -> str:
    return sha256(np.ascontiguousarray(array).tobytes()).hexdigest()


def looks_again(session: Session, looks: list[dict[str, Any]]) -> Any:
    """Has a server take looks that were kept; returns what it keeps of them."""
    segments = SegmentList(session)
    segments.restore(json.dumps(looks).encode())
    return json.loads(segments.kept())


# --- a session that crashes -------------------------------------------------------------


def done_before_the_crash(session: Session) -> None:
    """Does one of everything that a journal keeps; the last stroke is not ended."""
    volume = session.scene.volume
    place = Place(volume)
    session.picture_changes()
    tissue = session.add_segment(soft(volume))
    session.fill_box(1, low=(15, 14, 12), high=(19, 24, 20), solid=False)
    session.fill_box(1, low=(0, 0, 30), high=(6, 5, 34), solid=True)
    session.undo()
    session.fill_box(tissue, low=(30, 30, 2), high=(40, 36, 12), solid=False)
    thin = session.add_segment(plate(volume))
    session.move_segment(thin, pose_of((0.5, 0.25, 0.0)), goes_on=True)
    session.move_segment(thin, pose_of((0.5, 0.25, 2.0), turned=True))
    session.set_feel(thin, stiffness=0.25, friction_static=0.5, friction_kinetic=0.375)
    session.cut(1, place(23.0, 20.0, 10.0), (1.0, 0.0, 0.0))
    session.set_touchable(tissue, touchable=False)
    session.add_segment(volume.threshold(1000.0, name="kernel"))
    session.remove_segment(5)
    session.undo()
    session.undo()
    session.redo()
    session.replace_segment(tissue, volume.threshold(-10.0, 250.0, name="soft"))
    # the drill changes the scan's values, too
    session.place(place(20.0, 20.0, 24.0))
    session.set_tool("drill", radius=2.0, segment_ids=[1])
    session.stroke(on=True)
    session.hand(place(20.0, 20.0, 11.0))
    session.let_pass(0.3)
    session.stroke(on=False)
    session.set_tool("eraser", radius=2.0, segment_ids=[1])
    session.place(place(18.0, 20.0, 24.0))
    session.stroke(on=True)
    session.hand(place(18.0, 20.0, 15.0))
    session.let_pass(0.3)


# --- a scene ----------------------------------------------------------------------------


def edited_for_a_scene(session: Session) -> None:
    """Makes one of everything that a scene keeps, in a session with the bone."""
    volume = session.scene.volume
    place = Place(volume)
    tissue = session.add_segment(soft(volume))
    thin = session.add_segment(plate(volume))
    session.move_segment(thin, pose_of((0.5, 0.25, 2.0), turned=True))
    session.cut(1, place(23.0, 20.0, 10.0), (1.0, 0.0, 0.0))
    session.set_tool("drill", radius=2.0, segment_ids=[1])
    session.place(place(20.0, 20.0, 24.0))
    session.stroke(on=True)
    session.hand(place(20.0, 20.0, 11.0))
    session.let_pass(0.3)
    session.stroke(on=False)
    session.set_feel(1, stiffness=0.5, friction_static=0.25, friction_kinetic=0.125)
    session.set_material(1, LinearMaterial((0.0, 900.0), Material(4.0e3), Material(9.0e6)))
    session.set_material(tissue, "liver")
    session.set_material(4, Material(5.0e3, 0.4, 1000.0, 0.25, 0.5))
    box = ((1, 2, 3), (4, 5, 6))
    session.set_regions(tissue, [Region("rigid", shared_with=1), Region("empty", box=box)])
    session.set_touchable(tissue, touchable=False)
    session.set_locked(tissue, locked=True)
    session.set_deformation(
        "lattice", ModelOptions(edge=11, prony=Prony(0.4, 2.0), yield_strain=0.05)
    )
    session.set_force_source("voxels")


# --- the state folder, a scenario, a recipe ---------------------------------------------


def write_notes(folder: Path, scene: SavedScene) -> None:
    """Writes the lists of the state folder: what was open, of which scan scenes are, ports."""
    note_recent(read(folder / "second.raw", raw="4x5x10,int16,big", voxel_size=(2.0, 2.5, 3.0)))
    note_recent(open_scan(folder))
    note_recent(scene.volume, scene.path)
    note_scene(scene.scan, scene.path)
    note_scene(scene.scan, Path("passing.palpate"), passing=True)
    note_port("scan", 20123)


def write_scenario(path: Path) -> None:
    """Drives a needle through the soft tissue, and writes the run."""
    volume = _straight_scan()
    place = Place(volume)
    drive = Drive(
        start=place(8.3, 9.4, 15.0), target=place(8.3, 9.4, 4.0), speed=60.0, rest_secs=0.02
    )
    layers = [(soft(volume), TISSUES["liver"]), (bone(volume), None)]
    write_run(drive_needle(volume, layers, drive), path)


def told_of_run(path: Path) -> dict[str, Any]:
    """Returns what is read of a scenario's run."""
    run = read_run(path)
    samples = {name: _hash(column) for name, column in sorted(run.samples.items())}
    return _plain(
        {
            "scenario": run.scenario,
            "scan": run.scan,
            "layers": run.layers,
            "radius": run.radius,
            "over": run.over,
            "ticks": len(run.phase),
            "samples": samples,
            "events": [vars(event) for event in run.events],
            "wall_at": run.wall_at,
            "violations": run.violations,
        }
    )


def made_by_recipe(folder: Path) -> dict[str, Any]:
    """Runs the recipe of a folder, and returns what its files hold."""
    assert command(["run", str(folder / "recipe.yaml")]) == 0
    volume = open_scan(folder)
    mesh = read_mesh(folder / "bone.stl", frame="LPS", unit="mm").mesh
    labels = SimpleITK.GetArrayFromImage(SimpleITK.ReadImage(str(folder / "labels.nii.gz")))
    return {
        "segments": {
            label.segment.name: _hash(label.segment.mask())
            for label in read_labels(folder / "all.seg.nrrd", volume).labels
        },
        "labels": _hash(labels.astype(np.uint8)),
        "vertices": _hash(mesh.vertices.astype(np.float32)),
        "triangles": _hash(mesh.triangles.astype(np.uint32)),
        "report": (folder / "report.html").exists(),
    }


# --- what files bring back --------------------------------------------------------------


def told_of_journal(folder: Path) -> dict[str, Any]:
    """Brings back what the journal below a folder has: what is there, and each step back."""
    volume = open_scan(folder)
    with Session(Scene(volume, [bone(volume)]), options=STANDING) as session:
        session.picture_changes()
        journal = Journal(session, folder=folder / "state", tell=lambda _: None)
        journal.start()
        offer = journal.offer
        if offer is None:
            return {"segments": None}
        journal.decide(bring_back=True)
        second = journal.second
        found = {
            "file": journal.path.name,
            "steps": offer.steps,
            "lost_bytes": offer.lost_bytes,
            "looks": json.loads(journal.looks or b"null"),
            "second": None if second is None else _told_of_second(second),
            "segments": told(session),
            "values": told_of_values(session),
        }
        return {**found, "before": _steps_back(session)}


def _steps_back(session: Session) -> list[list[dict[str, Any]]]:
    """Takes one step after the other back; returns numbers and voxels of segments after each."""
    found = []
    while session.undo():
        short = ("id", "mask", "pose")
        found.append([{name: each[name] for name in short} for each in told(session)])
    return found


def _told_of_second(second: SecondScan) -> dict[str, Any]:
    volume = second.volume
    return _plain(
        {
            "name": volume.name,
            "values": _hash(volume.array),
            "spacing": volume.spacing,
            "origin": volume.origin,
            "second_from_first": second.second_from_first.tolist(),
        }
    )


def told_of_scene(path: Path) -> dict[str, Any]:
    """Opens a scene; returns all that is in it."""
    saved = open_scene(path)
    volume, scene = saved.volume, saved.scene()
    with Session(scene, options=STANDING) as session:
        saved.restore(session)
        # what is pressed and moved comes to rest
        session.let_pass(0.1)
        second = scene.second
        return _plain(
            {
                "name": volume.name,
                "unit": volume.unit,
                "modality": volume.modality,
                "dimensions": volume.dimensions,
                "spacing": volume.spacing,
                "origin": volume.origin,
                "direction": volume.direction.tolist(),
                "hash": scan_hash(volume).hex(),
                "view": saved.view,
                "looks": json.loads(saved.looks),
                "second": None if second is None else _told_of_second(second),
                "told": saved.messages,
                "segments": told(session),
                "values": told_of_values(session),
                "model": told_of_model(session),
                "can_undo": session.frame()["can_undo"],
            }
        )
