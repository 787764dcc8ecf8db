"""The sessions whose recordings are kept: one for each kind of thing that touch can meet.

All but ``live`` run without a clock, on a scan of whole numbers, so that the same build makes the
same bits again.

Frame: points are given in voxels of the scan's grid (i, j, k), and turned into the scene here.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, cast

import msgspec
import numpy as np
from numpy.typing import NDArray
from palpate import (
    Recording,
    Scene,
    ScriptedPath,
    Segment,
    Session,
    SessionOptions,
    TouchSettings,
    Volume,
)
from palpate.session.model_options import ModelOptions, Prony
from palpate.session.needle import TISSUES
from palpate.volumes.material import Material, Region
from palpate.volumes.volume import VolumeTraits

if TYPE_CHECKING:
    from palpate.session.recording_columns import TapeColumns

__all__ = ["PARTICLES", "SESSIONS", "scan", "scan_values", "second_values"]

Point = tuple[float, float, float]

DIMENSIONS = (44, 40, 36)
"""Voxels along i, j, k."""
MIDDLE = (22, 20, 10)
"""Of the bone, a ball of 10 voxels."""
SOFT_TOP = 14
"""Soft tissue fills the scan below this k."""
GEL = Material(young=2.0e4, poisson=0.45, friction=0.3)
"""Soft, and never breaks."""
USUAL = ModelOptions()


def scan_values() -> NDArray[np.int16]:
    """Returns a ball of bone that stands out of soft tissue: whole numbers alone, in HU."""
    k, j, i = np.indices(DIMENSIONS[::-1])
    squared = (i - MIDDLE[0]) ** 2 + (j - MIDDLE[1]) ** 2 + (k - MIDDLE[2]) ** 2
    soft = np.where(k < SOFT_TOP, 50, -1000)
    values: NDArray[np.int16] = np.maximum(soft, np.clip(1300 - 10 * squared, -1000, 1300)).astype(
        np.int16
    )
    return values


def second_values() -> NDArray[np.int16]:
    """Returns a small scan in which all values differ."""
    return (7 * np.arange(10 * 5 * 4) - 300).astype(np.int16).reshape(10, 5, 4)


TURNED = np.array([[0.6, -0.8, 0.0], [0.8, 0.6, 0.0], [0.0, 0.0, 1.0]])
"""Axes of a grid that are not those of the patient."""


def scan(direction: NDArray[np.float64] = TURNED) -> Volume:
    """Returns the scan."""
    return Volume(
        scan_values(),
        spacing=(1.0, 1.0, 1.25),
        origin=(-10.5, 3.25, 7.0),
        direction=direction,
        traits=VolumeTraits(name="synthetic", modality="CT", unit="HU"),
    )


@dataclass(frozen=True)
class Place:
    """Points of a scan's grid in the scene."""

    volume: Volume

    def __call__(self, i: float, j: float, k: float) -> Point:
        """Returns the point at (i, j, k), of which whole numbers are corners of voxels."""
        x, y, z = (self.volume.patient_from_grid @ (i, j, k, 1.0))[:3].tolist()
        return x, y, z

    def path(self, *stops: tuple[float, Point]) -> ScriptedPath:
        """Returns a path through points of the grid; each has the seconds that it takes."""
        path = ScriptedPath(self(*stops[0][1]))
        for seconds, point in stops[1:]:
            path = path.move(self(*point), seconds=seconds)
        return path


def bone(volume: Volume) -> Segment:
    """Returns the bone, by a threshold."""
    return volume.threshold(300.0, name="bone")


def bone_mask(volume: Volume) -> Segment:
    """Returns the same voxels as a mask: nothing is known of their values."""
    return volume.segment(bone(volume).mask(), name="bone")


def soft(volume: Volume) -> Segment:
    """Returns the soft tissue, by a threshold."""
    return volume.threshold(0.0, 299.0, name="soft")


# --- contact models, probes, the smooth force -------------------------------------------

PRESS: tuple[tuple[float, Point], ...] = (
    (0.0, (16.3, 18.4, 23.0)),
    (0.04, (17.2, 18.8, 19.5)),
    (0.08, (26.4, 22.1, 17.5)),
    (0.04, (24.2, 25.7, 16.0)),
    (0.04, (24.0, 25.0, 26.0)),
)
"""Into the bone, over it under its surface, and out again."""


def touched(
    touch: TouchSettings, *, segment: Callable[[Volume], Segment] = bone, rate: int = 1000
) -> Recording:
    """Returns a recording of ``PRESS`` with such settings."""
    volume = scan()
    options = SessionOptions(real_time=False, touch=touch, rate_hz=rate)
    path = Place(volume).path(*PRESS)
    with Session(Scene(volume, [segment(volume)]), device=path, options=options) as session:
        return session.run(path.duration)


def rough() -> Recording:
    """A probe that sticks when the recording begins, then slides, on a segment that feels so."""
    volume = scan()
    touch = TouchSettings(friction_static=0.6, friction_kinetic=0.4, stiffness=0.8, damping=0.002)
    place = Place(volume)
    path = place.path((0.0, (20.2, 18.4, 22.0)), (0.1, (20.4, 18.8, 18.5)))
    path = path.hold(0.1).move(place(25.7, 22.3, 18.0), seconds=0.3).hold(0.05)
    options = SessionOptions(real_time=False, touch=touch)
    with Session(Scene(volume, [bone(volume)]), device=path, options=options) as session:
        session.set_feel(1, stiffness=0.7)
        session.let_pass(0.15)
        session.start_recording()
        session.let_pass(0.2)
        session.set_feel(1, stiffness=0.5, friction_static=0.3, friction_kinetic=0.05)
        session.let_pass(0.1)
        session.settings(TouchSettings(friction_static=1.0, friction_kinetic=1.0, damping=0.0))
        session.set_feel(1)
        session.let_pass(0.1)
        return session.stop_recording()


def slow_device() -> Recording:
    """A device that is read every fourth tick."""
    volume = scan()
    path = Place(volume).path(*PRESS)
    options = SessionOptions(real_time=False, rate_hz=2000, device_rate_hz=500)
    with Session(Scene(volume, [bone(volume)]), device=path, options=options) as session:
        return session.run(path.duration)


def hand() -> Recording:
    """The simulated device under a hand: placed, turned, with a gain and the clutch."""
    volume = scan()
    place = Place(volume)
    options = SessionOptions(real_time=False, start=place(22.0, 20.0, 24.0))
    with Session(Scene(volume, [bone(volume)]), options=options) as session:
        session.settings(TouchSettings(gain=1.5))
        session.hand(place(21.0, 20.0, 19.0))
        session.let_pass(0.1)
        session.clutch(on=True)
        session.let_pass(0.02)
        # from here on with the clutch pressed
        session.start_recording()
        session.hand(place(18.0, 22.0, 23.0))
        session.let_pass(0.06)
        session.clutch(on=False)
        session.view(right=(0.6, 0.8, 0.0), up=(0.0, 0.0, 1.0))
        session.settings(TouchSettings(gain=2.0))
        session.hand(place(22.0, 20.0, 16.0))
        session.let_pass(0.12)
        session.place(place(24.0, 21.0, 22.5))
        session.let_pass(0.02)
        session.hand(place(23.0, 20.0, 15.0))
        session.let_pass(0.12)
        return session.stop_recording()


def live() -> Recording:
    """By the clock, with a device that has a thread of its own: no two are alike."""
    volume = scan()
    place = Place(volume)
    options = SessionOptions(start=place(22.0, 20.0, 24.0))
    with Session(Scene(volume, [bone(volume)]), options=options) as session:
        session.let_pass(0.3)
        session.start_recording()
        for step in range(8):
            session.hand(place(20.0 + 0.5 * step, 20.0, 16.0))
            session.let_pass(0.04)
            low, high = (16 + step, 16, 18), (20 + step, 22, 24)
            session.fill_box(1, low=low, high=high, solid=step % 2 == 1)
        return session.stop_recording()


def marked() -> Recording:
    """A mark after the last tick: the engine has none of its own there, and reads it."""
    recording = touched(TouchSettings(smoothing="off"))
    assert recording._tape is not None
    tape: dict[str, Any] = dict(recording._tape)
    packed = np.append(tape["commands"], np.frombuffer(msgspec.msgpack.encode("Mark"), np.uint8))
    ends = {
        name: np.append(tape[name], np.uint64(last))
        for name, last in (
            ("command_ends", len(packed)),
            ("brick_ends", len(tape["brick_index"])),
            ("share_ends", len(tape["share_index"])),
        )
    }
    changed = cast("TapeColumns", {**tape, **ends, "commands": packed})
    return Recording(recording.columns, tape=changed, about=recording.about)


# --- voxels that change -----------------------------------------------------------------


def edits() -> Recording:
    """Edits, undo and redo in the middle, a new threshold, segments that come and go."""
    volume = scan()
    path = Place(volume).path(*PRESS, (0.1, (24.0, 23.0, 16.0)), (0.1, (18.0, 18.0, 17.0)))
    options = SessionOptions(real_time=False, touch=TouchSettings(probe_radius=1.5))
    with Session(Scene(volume, [bone(volume)]), device=path, options=options) as session:
        session.start_recording()
        for step in range(16):
            session.let_pass(0.03)
            low, high = (14 + step, 14, 16), (19 + step, 27, 22)
            session.fill_box(1, low=low, high=high, solid=step % 3 == 0)
            match step:
                case 3 | 6 | 7:
                    session.undo()
                case 8:
                    session.redo()
                case 9:
                    session.replace_segment(1, volume.threshold(250.0, name="bone"))
                case 10:
                    session.set_touchable(1, touchable=False)
                case 11:
                    session.set_touchable(1, touchable=True)
                    session.settings(TouchSettings(probe_radius=2.5))
                case 12:
                    session.add_segment(soft(volume))
                case 15:
                    session.remove_segment(1)
                case _:
                    pass
        return session.stop_recording()


def mask_edits() -> Recording:
    """A mask under the smooth surface of its voxels, of which more becomes known meanwhile."""
    volume = scan()
    path = Place(volume).path(*PRESS)
    options = SessionOptions(real_time=False, touch=TouchSettings(smoothing="bits"))
    with Session(Scene(volume, [bone_mask(volume)]), device=path, options=options) as session:
        # by then the shares of its surface are known
        session.let_pass(0.05)
        session.start_recording()
        session.let_pass(0.04)
        session.fill_box(1, low=(20, 17, 16), high=(25, 21, 22), solid=False)
        session.let_pass(0.06)
        session.undo()
        session.let_pass(0.05)
        return session.stop_recording()


def worked(kind: str, *, probe: float = 1.5, **options: float) -> Recording:
    """Two strokes of a tool on the bone, with undo between them."""
    volume = scan()
    place = Place(volume)
    start = SessionOptions(
        real_time=False,
        start=place(22.0, 20.0, 24.0),
        touch=TouchSettings(probe_radius=probe, stiffness=2.0),
    )
    scene = Scene(volume, [bone(volume)])
    with Session(scene, options=start) as session:
        ids = [1]
        if kind == "painter":
            empty = np.zeros(volume.shape, np.uint8)
            ids.insert(0, session.add_segment(volume.segment(empty, name="painted")))
        session.set_tool(kind, radius=2.0, segment_ids=ids, **options)  # type: ignore[arg-type]
        session.start_recording()
        for x in (21.0, 23.0):
            session.stroke(on=True)
            session.hand(place(x, 20.0, 13.0))
            session.let_pass(0.15)
            session.stroke(on=False)
            if x == 21.0:
                session.undo()
                session.let_pass(0.03)
        return session.stop_recording()


# --- segments that move, objects in a grid of their own ---------------------------------


def pose_of(shift: Point = (0.0, 0.0, 0.0), *, turned: bool = False) -> NDArray[np.float64]:
    """Returns a rigid motion of the scene; ``turned``: about z, by numbers without a rounding."""
    pose = np.eye(4)
    if turned:
        pose[:2, :2] = [[0.8, -0.6], [0.6, 0.8]]
    pose[:3, 3] = shift
    return pose


def moved() -> Recording:
    """A segment that stands turned at first, goes elsewhere, and is taken in the hand."""
    volume = scan()
    place = Place(volume)
    path = place.path(*PRESS, (0.05, (22.0, 20.0, 26.0)), (0.2, (22.0, 20.0, 17.0)))
    options = SessionOptions(real_time=False, touch=TouchSettings(probe_radius=1.0))
    with Session(Scene(volume, [bone(volume)]), device=path, options=options) as session:
        middle = np.array(place(22.0, 20.0, 10.0))
        turned = pose_of(turned=True)
        turned[:3, 3] = middle - turned[:3, :3] @ middle
        session.move_segment(1, turned)
        session.let_pass(0.04)
        session.start_recording()
        session.let_pass(0.1)
        shifted = turned.copy()
        shifted[:3, 3] += (1.5, -0.5, 1.0)
        session.move_segment(1, shifted)
        session.let_pass(0.15)
        session.fill_box(1, low=(18, 16, 17), high=(24, 22, 22), solid=False)
        session.let_pass(0.15)
        session.undo()
        session.grab(1, collides=True)
        session.let_pass(0.1)
        session.grab(None)
        session.let_pass(0.1)
        return session.stop_recording()


def turning() -> Recording:
    """A segment that turns under the probe."""
    volume = scan()
    place = Place(volume)
    path = place.path((0.0, (22.0, 20.0, 24.0)), (0.1, (22.5, 20.5, 19.0))).hold(0.3)
    with Session(
        Scene(volume, [bone(volume)]), device=path, options=SessionOptions(real_time=False)
    ) as session:
        session.start_recording()
        session.let_pass(0.15)
        middle = np.array(place(20.0, 20.0, 10.0))
        turned = pose_of(turned=True)
        turned[:3, 3] = middle - turned[:3, :3] @ middle
        session.move_segment(1, turned)
        session.let_pass(0.2)
        return session.stop_recording()


def plate(volume: Volume) -> Segment:
    """Returns a plate over the bone, of voxels that are finer than the scan's."""
    values = np.zeros((8, 36, 36), np.int16)
    values[2:6, 2:34, 2:34] = 1
    corner = np.array(Place(volume)(22.0, 20.0, 24.0)) - 4.5
    fine = Volume(values, spacing=[0.25] * 3, origin=corner.tolist())
    return fine.threshold(1, name="plate").as_object()


def own_grid() -> Recording:
    """An object in a grid of its own, moved at the beginning and once more."""
    volume = scan()
    middle = (22.0, 20.0, 30.0)
    path = Place(volume).path((0.0, middle), (0.1, (22.0, 20.0, 18.0))).hold(0.3)
    scene = Scene(volume, [bone(volume), plate(volume)])
    with Session(scene, device=path, options=SessionOptions(real_time=False)) as session:
        session.let_pass(0.06)
        session.move_segment(2, pose_of((0.25, 0.0, 0.75)))
        # it is on its way
        session.let_pass(0.004)
        session.start_recording()
        session.let_pass(0.1)
        session.move_segment(2, pose_of((0.5, 0.25, 1.0)))
        session.let_pass(0.1)
        session.set_feel(2, stiffness=0.25)
        session.set_touchable(1, touchable=False)
        session.let_pass(0.1)
        return session.stop_recording()


# --- needles, soft tissue ---------------------------------------------------------------


def needle() -> Recording:
    """A needle in soft tissue at first, stopped by a table, pushed aside, and taken out."""
    volume = scan()
    place = Place(volume)
    path = place.path(
        (0.0, (8.3, 9.4, 16.0)),
        (0.3, (8.3, 9.4, 2.0)),
        (0.1, (10.0, 10.0, 3.0)),
        (0.15, (8.3, 9.4, 17.0)),
        (0.1, (8.3, 9.4, 10.0)),
    )
    below = np.zeros(volume.shape, np.uint8)
    below[:5] = 1
    table = volume.segment(below, name="table")
    scene = Scene(volume, [bone(volume), soft(volume), table])
    with Session(scene, device=path, options=SessionOptions(real_time=False)) as session:
        session.set_tool("needle", segment_ids=[2], tissues=[TISSUES["liver"]])
        session.stroke(on=True)
        session.let_pass(0.28)
        assert [event.kind for event in session.needle_events()] == ["punctured", "stopped"]
        session.start_recording()
        session.let_pass(0.05)
        # what can be touched is replaced while the needle is in it
        session.set_touchable(1, touchable=False)
        session.let_pass(0.22)
        assert session.needle_events()[-1].kind == "withdrawn"
        session.stroke(on=False)
        session.let_pass(0.02)
        session.stroke(on=True)
        session.let_pass(0.08)
        return session.stop_recording()


def pressed(
    model: str, *, options: ModelOptions = USUAL, source: str = "matter", rigid: int = 6
) -> Recording:
    """Soft tissue that is pressed when the recording begins, pressed deeper, and let go."""
    volume = scan()
    place = Place(volume)
    path = place.path((0.0, (9.3, 9.4, 16.0)), (0.2, (9.3, 9.4, 13.0)))
    path = path.move(place(9.8, 9.6, 12.6), seconds=0.12).move(place(9.8, 9.6, 17.0), seconds=0.1)
    touch = TouchSettings(probe_radius=1.5)
    scene = Scene(volume, [bone(volume), soft(volume)])
    with Session(
        scene, device=path, options=SessionOptions(real_time=False, touch=touch)
    ) as session:
        session.set_material(2, GEL)
        session.set_regions(2, [Region("rigid", box=((0, 0, 0), (44, 40, rigid)))])
        session.set_deformation(model, options)
        session.set_force_source(source)  # type: ignore[arg-type]
        # between two answers of the model
        session.let_pass(0.205)
        session.start_recording()
        session.let_pass(0.1)
        session.set_touchable(1, touchable=False)
        session.let_pass(0.2)
        assert session.deformation()["answers"] > 3
        return session.stop_recording()


def lattice() -> Recording:
    """Nodes and bonds, with a force that fades."""
    return pressed("lattice", options=ModelOptions(edge=11, prony=Prony(0.4, 0.2)))


def voxels_felt() -> Recording:
    """The lattice moves voxels away, and these are what is felt."""
    return pressed("lattice", source="voxels")


SESSIONS: dict[str, Callable[[], Recording]] = {
    "exact-point-intensities": lambda: touched(TouchSettings(model="exact")),
    "exact-point-bits": lambda: touched(TouchSettings(smoothing="bits")),
    "exact-point-mask": lambda: touched(TouchSettings(), segment=bone_mask),
    "exact-point-off": lambda: touched(TouchSettings(smoothing="off")),
    "exact-ball-intensities": lambda: touched(TouchSettings(probe_radius=2.0)),
    "exact-ball-off": lambda: touched(TouchSettings(probe_radius=2.0, smoothing="off")),
    "exact-4khz": lambda: touched(TouchSettings(), rate=4000),
    "thesis-original-point": lambda: touched(TouchSettings(model="thesis-original")),
    "thesis-original-ball": lambda: touched(
        TouchSettings(model="thesis-original", probe_radius=2.0)
    ),
    "thesis-improved-point": lambda: touched(TouchSettings(model="thesis-improved")),
    "thesis-improved-ball": lambda: touched(
        TouchSettings(model="thesis-improved", probe_radius=2.0)
    ),
    "friction": rough,
    "slow-device": slow_device,
    "hand": hand,
    "live": live,
    "marked": marked,
    "edits": edits,
    "mask-edits": mask_edits,
    "drill": lambda: worked("drill"),
    "eraser": lambda: worked("eraser", probe=0.0),
    "adder": lambda: worked("adder"),
    "painter": lambda: worked("painter", depth=2.0),
    "moved": moved,
    "turning": turning,
    "own-grid": own_grid,
    "needle": needle,
    "lattice": lattice,
    "lattice-rigid": lambda: pressed("lattice", rigid=13),
    "lattice-voxels": voxels_felt,
    "fcc-lj": lambda: pressed("fcc-lj", options=ModelOptions(edge=9)),
    "cuboid-lj": lambda: pressed("cuboid-lj", options=ModelOptions(edge=9)),
    "global-lj": lambda: pressed("global-lj"),
}
"""By the names of their recordings."""

PARTICLES = ("fcc-lj", "cuboid-lj", "global-lj")
"""Sessions that take seconds."""
