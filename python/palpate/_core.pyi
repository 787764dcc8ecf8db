"""The engine. Arrays are [z, y, x], x fastest; points (x, y, z), LPS [mm]; forces [N].

Functions and methods raise ValueError where an argument is not allowed.
"""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from palpate.bench.results import (
    EmbeddedResult,
    LatticeFrames,
    PairsResult,
    PressedBlock,
    SessionResult,
    SoftTissueStressResult,
    StressResult,
)
from palpate.pictures.appearance import Appearance, SecondAppearance
from palpate.pictures.camera import Camera
from palpate.scenarios.engine_run import DrillRun, NeedleRun, PressRun, RearrangingRun
from palpate.session.deformation_state import DeformationState, ModelOffer, ModelParts
from palpate.session.frame_state import FrameState, LatenessState
from palpate.session.picture_change import PictureChange, VoxelChange
from palpate.session.recording_columns import ReplayResult, TapeColumns, TickColumns
from palpate.session.segment_state import EngineSegmentState, SettingsState

__all__ = [
    "Ground",
    "Picture",
    "Renderer",
    "Segment",
    "Session",
    "Surface",
    "TouchBench",
    "Volume",
    "bench_embedded",
    "bench_lattice_cost",
    "bench_lattice_force",
    "bench_lattice_frames",
    "bench_lj_pairs",
    "bench_matter_stress",
    "bench_passivity",
    "bench_session",
    "bench_stress",
    "bench_touch_quality",
    "build",
    "deformation_models",
    "drive_drill",
    "drive_needle",
    "material_presets",
    "needle_tissues",
    "particle_limits",
    "passivity_devices",
    "phantom",
    "phantom_bones",
    "press",
    "press_block",
    "replay_recording",
    "touch_quality_cases",
    "voxelise_mesh",
]

_Triple = tuple[float, float, float]
_PaintedLine = tuple[NDArray[np.float64], _Triple, _Triple, bool]
_Voxel = tuple[int, int, int]
_Range = tuple[float, float]
_Tissue = tuple[float, float, float, float, float, float, float, float]
_Drive = tuple[_Triple, _Triple, float, float, float, float]
_Solid = tuple[float, float, float, float, float, float]
_Options = tuple[
    int | None,
    float | None,
    bool,
    tuple[float, float] | None,
    float | None,
    int | None,
    str | None,
    str | None,
    bool,
]
_Region = tuple[str, tuple[_Voxel, _Voxel] | None, int | None]

class Volume:
    """Values on a grid that stands in the patient."""

    def __init__(
        self,
        values: NDArray[np.int16],
        spacing: _Triple,
        origin: _Triple,
        direction: tuple[float, ...],
        slope: float,
        intercept: float,
    ) -> None:
        """Copies ``values``, C-contiguous; ``direction`` as ITK gives it, nine numbers by rows.

        Raises:
            ValueError: The numbers describe no grid.
        """

    @property
    def dimensions(self) -> _Voxel: ...
    @property
    def spacing(self) -> _Triple: ...
    @property
    def slope(self) -> float: ...
    @property
    def intercept(self) -> float: ...
    @property
    def patient_from_grid(self) -> NDArray[np.float64]:
        """Homogeneous matrix, shape [4, 4] [mm]."""

    def values(self) -> NDArray[np.int16]:
        """A read-only view of what is stored."""

    def stored_range(self) -> tuple[int, int]: ...
    def histogram(self, bins: int) -> tuple[float, float, NDArray[np.uint64]]:
        """Where the first bin begins, where the last ends, and the counts."""

    def threshold(self, low: float, high: float) -> Segment:
        """The voxels with low <= value <= high, in physical units."""

class Segment:
    """The solid voxels of one structure."""

    @staticmethod
    def from_mask(mask: NDArray[np.uint8]) -> Segment:
        """Solid where the mask, C-contiguous, is not 0."""

    def on_grid(self, spacing: _Triple, origin: _Triple, direction: tuple[float, ...]) -> Segment:
        """The same voxels on a grid of their own instead of a scan's."""

    @property
    def own_grid(self) -> tuple[_Triple, _Triple, list[float]] | None:
        """Spacing and origin [mm] and direction, row by row, of its own grid; None without."""

    @property
    def dimensions(self) -> _Voxel: ...
    @property
    def voxel_count(self) -> int: ...
    @property
    def bounding_box(self) -> tuple[_Voxel, _Voxel] | None:
        """Lowest voxel and one past the highest on each axis; None where nothing is solid."""

    @property
    def memory_bytes(self) -> int: ...
    def mask(self) -> NDArray[np.uint8]:
        """1 where solid, else 0."""

    def contains(self, points_in_grid: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Whether each point, shape [count, 3] in the grid frame, lies in a solid voxel."""

class Session:
    """A running session.

    A call on a session that has ended raises RuntimeError with the reason, except ``frame``,
    ``lateness``, ``stop_recording`` and ``stop``.
    """

    def __init__(
        self,
        volume: Volume,
        *,
        device: Literal["simulated", "scripted"] = "simulated",
        path: NDArray[np.float64] | None = None,
        rate_hz: int = 1000,
        device_rate_hz: int | None = None,
        real_time: bool = True,
        start: _Triple | None = None,
        settings: Mapping[str, str | float | None] | None = None,
        segments: Sequence[tuple[Segment, bool, _Range | None]] = (),
    ) -> None:
        """Starts the session.

        Args:
            volume: The scan.
            device: The simulated device with a hand, or one that follows ``path``.
            path: Rows (time, x, y, z), shape [count, 4], times rising; scene [mm].
            rate_hz: Ticks of the servo a second, 500 to 10000.
            device_rate_hz: Readings of the device a second, 500 to 10000; None is the servo's
                rate.
            real_time: Whether threads run by the clock, with real-time priority where the
                system grants it; else the session stands still until ``run``.
            start: Where probe, device and hand begin; None is in front of the scan, or where
                ``path`` begins.
            settings: Fields of ``TouchSettings``; what is None or missing is the default.
            segments: Voxels, touchable, and the threshold that they are, numbered from 1. They
                are there before the first tick and cannot be undone.

        Raises:
            ValueError: Something given is not allowed.
            RuntimeError: The system refuses a thread.
        """

    @property
    def device(self) -> str: ...
    @property
    def device_limits(self) -> tuple[float, float]:
        """The largest stiffness [N/mm] and force [N] that the device bears."""

    @property
    def device_reach(self) -> float:
        """Radius of the ball that the device reaches [device mm]."""

    @property
    def is_running(self) -> bool: ...
    def clutch(self, on: bool) -> None:
        """Has the device move without the probe, or with it again."""

    def grab(self, segment_id: int | None = None, collides: bool = False) -> None:
        """Takes a segment in the hand, or lets go of the one that is."""

    def turn_grabbed(self, x: float, y: float, z: float) -> None:
        """Turns the segment in the hand about the probe by a rotation vector [rad]."""

    def cut(self, segment_id: int, point: _Triple, normal: _Triple) -> int:
        """Parts a segment by a plane; returns the number of the part before it."""

    def cut_along(self, segment_id: int, line: _PaintedLine) -> int:
        """Parts a segment along a painted line; returns the number of the smaller part."""

    def preview_cut(self, segment_id: int, line: _PaintedLine) -> list[float]:
        """Volumes of the larger and the smaller part [mm³]."""

    def gap(self, from_id: int, to_id: int) -> _Triple:
        """Minimum and mean distance [mm] of one segment's surface to another, overlap [mm³]."""

    def hand(self, x: float, y: float, z: float) -> None:
        """Moves the target to which the hand pulls the device."""

    def press(self, origin: _Triple, direction: _Triple, pressure: float) -> None:
        """Presses with so much force [N] on what a ray of the scene meets first."""

    def lift(self) -> None:
        """Lifts the hand off what it presses."""

    def place(self, x: float, y: float, z: float) -> _Triple:
        """Puts probe, device and hand at a point, or in the free voxel nearest to it.

        Returns:
            Where they are.
        """

    def view(self, right: _Triple, up: _Triple) -> None:
        """Turns the device's axes to those of the view; ``up`` is straightened."""

    def set_clip(self, planes: Sequence[tuple[_Triple, float]]) -> None:
        """Cuts the scene for touch; planes are (normal toward what is cut away, offset [mm])."""

    def clip(self) -> list[tuple[_Triple, float]]:
        """Returns the planes that cut the scene for touch."""

    def settings(self, changes: Mapping[str, str | float | None] | None = None) -> SettingsState:
        """Changes settings by the names of ``TouchSettings``; returns all that are in effect."""

    def add_segment(
        self,
        segment: Segment,
        touchable: bool,
        threshold_range: _Range | None = None,
        undoable: bool = True,
    ) -> int:
        """Adds a segment and returns its number, 1 to 255."""

    def replace_segment(
        self, segment_id: int, segment: Segment, threshold_range: _Range | None = None
    ) -> None:
        """Puts other voxels in the place of a segment's."""

    def remove_segment(self, segment_id: int) -> None: ...
    def move_segment(
        self, segment_id: int, pose: NDArray[np.float64], goes_on: bool = False
    ) -> None:
        """Moves a segment to a pose, a homogeneous matrix, shape [4, 4] [mm]."""

    def set_feel(
        self,
        segment_id: int,
        stiffness: float | None = None,
        friction_static: float | None = None,
        friction_kinetic: float | None = None,
    ) -> None:
        """Changes how the surface of a segment feels; None is as the settings say."""

    def set_touchable(self, segment_id: int, touchable: bool) -> None:
        """Makes a segment an obstacle or none; this is not undone."""

    def set_all_touchable(self, wanted: list[tuple[int, bool]]) -> None:
        """Makes segments obstacles or none, all at once; this is not undone."""

    def set_locked(self, segment_id: int, locked: bool) -> None:
        """Locks the voxels of a segment or lets them be changed; this is not undone."""

    def threshold(self, low: float, high: float, segment_id: int | None = None) -> int:
        """Makes a touchable segment of the voxels with low <= value <= high, edits included.

        With ``segment_id`` that segment gets these voxels. Returns the segment's number.
        """

    def fill_box(self, segment_id: int, low: _Voxel, high: _Voxel, solid: bool) -> None:
        """Makes the voxels from ``low`` up to, but without, ``high`` solid or free."""

    def remove_matter(self, mask: Segment, stored: int) -> None:
        """Gives voxels of a mask one stored value, and takes them out of all segments."""

    def as_edited(self, made: Segment, low: float, high: float) -> Segment:
        """A threshold of the scan with edited voxels as their values are now."""

    def show_surface(
        self, segment_id: int, *, smoothing: int, step: int = 1, of_bits: bool = False
    ) -> None:
        """Keeps a surface of a segment: smoothing degree, edge of a cell [voxels].

        ``of_bits`` makes it from bits also where a threshold made the segment.
        """

    def wait_for_changes(self, heard: int, seconds: float) -> int:
        """Waits until the picture has changed more than ``heard`` times; returns how often."""

    def follow_edits(self, every: int) -> None:
        """Has the picture follow edits every so many-th of its frames, 1 to 4."""

    def hide_surface(self, segment_id: int) -> None:
        """Keeps no surface of a segment any more."""

    def set_labelled(self, segment_ids: list[int]) -> None:
        """Names the segments whose labels edits tell, the last of several on top."""

    def picture_changes(self) -> list[PictureChange]:
        """Changes of the picture since the previous call."""

    def values_at_rest(self) -> VoxelChange | None:
        """Stored values at rest of a box around all pressed tissue; None where none is pressed."""

    def whole_surfaces(self) -> PictureChange:
        """All current surfaces, in the same form."""

    def set_deformation(
        self,
        model: str | None,
        options: _Options,
        undoable: bool,
    ) -> None:
        """Chooses the deformation model; None makes every segment rigid.

        ``options``: the fields of ``palpate.session.model_options.ModelOptions`` in their order.
        """

    def set_material(
        self,
        segment_id: int,
        undoable: bool,
        *,
        name: str | None = None,
        constant: tuple[float, ...] | None = None,
        linear: tuple[tuple[float, float], tuple[float, ...], tuple[float, ...]] | None = None,
    ) -> None:
        """Sets the material of a segment, in SI units; without any it is rigid.

        ``name`` is that of a preset, ``constant`` the fields of ``palpate.Material``; ``linear``
        has an interval of HU and the constants at both ends.
        """

    def set_regions(
        self,
        segment_id: int,
        regions: list[_Region],
    ) -> None:
        """Sets how regions of a segment deform: treatment, box of voxels, other segment."""

    def set_force_source(self, source: str) -> None:
        """Chooses the force of soft tissue on a tool: of the model (``matter``) or ``voxels``."""

    def deformation(self) -> DeformationState:
        """State of the deformation model."""

    def show_model_parts(self, on: bool) -> None:
        """Starts or stops making ``model_parts``."""

    def model_parts(self) -> ModelParts | None:
        """The newest nodes or particles of the model; None where they were returned before."""

    def set_tool(
        self,
        kind: str | None,
        *,
        radius: float = 0.0,
        segment_ids: list[int] = ...,
        air: float | None = None,
        energy: float | None = None,
        tissues: list[_Tissue] = ...,
        paint: tuple[float | None, bool] = ...,
    ) -> None:
        """Chooses the tool for the next strokes; None for no tool.

        ``air`` is the value of drilled voxels, None for -1000; ``energy`` the drill's work per
        volume [mJ/mm³], None for that of bone by HU. ``tissues`` are those of a needle, one for
        each segment. ``paint`` is the depth of a painter [mm], None for its whole ball, and whether
        painted voxels also stay in their segment.
        """

    def needle_events(self) -> list[tuple[str, int, float, float, float]]:
        """Kind, segment, time [s], depth [mm] and force [N] of each event of the needle."""

    def set_needle_direction(self, direction: _Triple | None) -> None:
        """Sets the direction in which the needle enters; None for that of the push."""

    def withdraw_needle(self) -> bool:
        """Withdraws the needle on the path of its insertion; False where none is inserted."""

    def stroke(self, on: bool) -> None:
        """Begins or ends a stroke of the tool."""

    def look_at_journal(self, path: Path, scan_hash: bytes) -> tuple[int, int] | None:
        """Steps of a journal and damaged bytes at its end; None without a file."""

    def begin_journal(self, path: Path, scan_hash: bytes) -> None:
        """Starts a journal in a new file, with the current state."""

    def keep_state(self, path: Path, scan_hash: bytes) -> None:
        """Writes the current state into a new file; a running journal continues."""

    def recover_journal(self, path: Path, scan_hash: bytes) -> tuple[int, int, list[bytes]]:
        """Repeats the changes of a journal and continues it; steps, damaged bytes, notes."""

    def note_in_journal(self, note: bytes) -> None:
        """Writes a note into the journal, where there is one."""

    def end_journal(self) -> None:
        """Writes what is pending and closes the journal."""

    def undo(self) -> bool:
        """Undoes the last step; False where there is none."""

    def redo(self) -> bool:
        """Redoes the last undone step; False where there is none."""

    def segment(self, segment_id: int) -> Segment:
        """The current voxels of a segment."""

    def segments_state(self) -> list[EngineSegmentState]:
        """Current state of all segments."""

    def frame(self) -> FrameState:
        """Current state; ``force`` and ``samples`` are what was sent to the device."""

    def lateness(self) -> LatenessState:
        """How punctual each thread has been since the start."""

    def start_recording(self) -> None:
        """Starts to record every tick; a recording in progress is discarded."""

    def stop_recording(self) -> tuple[TickColumns, TapeColumns | None]:
        """The ticks, none where there is no recording, and what else a replay needs."""

    def run(self, seconds: float) -> None:
        """Computes so many seconds of a session without ``real_time``."""

    def stop(self) -> None:
        """Stops the force, then the threads, in less than a second; a second call does nothing."""

def build() -> str:
    """Identifies the build by everything that affects the computed ticks."""

def replay_recording(recording: TickColumns, tape: TapeColumns) -> ReplayResult:
    """Computes the ticks of a recording again.

    Raises:
        ValueError: The columns do not fit together.
    """

def phantom(dimensions: _Voxel, seed: int) -> tuple[Volume, NDArray[np.uint8], dict[str, int]]:
    """Makes the built-in trunk: the scan, its labels and the number of each part by name."""

class Ground:
    """Segments of one scan that are touched together, for ``TouchBench``."""

    def __init__(
        self,
        volume: Volume,
        segments: Sequence[Segment],
        ranges: Sequence[tuple[float, float] | None] = (),
    ) -> None:
        """Takes 1 to 255 segments, and the thresholds that made them, if any.

        Raises:
            ValueError: A segment is of another size, or there are too many.
        """

    @staticmethod
    def phantom(dimensions: _Voxel) -> Ground:
        """Makes the bones of the phantom, by their labels, without its values."""

    def embedded(self, dimensions: _Voxel) -> Ground:
        """Returns the same voxels in the middle of a larger scan, at the same place."""

    @property
    def dimensions(self) -> _Voxel: ...

class KeptSurface:
    """The surface of a segment as one mesh for files, and what it keeps of the voxels."""

    def __init__(
        self,
        segment: Segment,
        spacing: _Triple,
        origin: _Triple,
        direction: tuple[float, ...],
        step: int | None,
        smoothing: int | None,
        local: bool,
        values: tuple[Volume, tuple[float, float]] | None = None,
    ) -> None:
        """Makes it, of the same settings as ``Surface``; of degree 0 from bits, voxels' faces.

        Raises:
            ValueError: A setting is not allowed.
        """

    def mesh(self) -> tuple[NDArray[np.float64], NDArray[np.float32], NDArray[np.uint32]]:
        """Positions [patient], normals and triangles, shapes [n, 3]."""

    @property
    def triangle_count(self) -> int: ...
    def area(self) -> float:
        """[mm²]."""

    def volume(self) -> float:
        """Enclosed [mm³]."""

    @property
    def voxel_volume(self) -> float:
        """[mm³]."""

    @property
    def voxel_bodies(self) -> int: ...
    @property
    def bodies(self) -> int: ...
    @property
    def touching_edges(self) -> int: ...
    def expected_volume(self) -> float:
        """Volume that the voxels stand for [mm³], of what is thin by the scan's values."""

    @property
    def is_halfway(self) -> bool:
        """Whether most of what is thin was measured with the threshold taken for halfway."""

    def thin_parts(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """What is thin: places [patient], shape [n, 3]; volumes expected and kept, [n, 2]."""

class SecondScan:
    """A second scan that a renderer shows through the first."""

    def __init__(self, volume: Volume, second_from_first: NDArray[np.float64]) -> None:
        """Reads each value once; the matrix [4, 4] takes patient points of the first to its own.

        Raises:
            ValueError: There are too many voxels, or the matrix is none.
        """

    def moved(self, second_from_first: NDArray[np.float64]) -> SecondScan:
        """Returns the same scan elsewhere; reads nothing again.

        Raises:
            ValueError: The matrix is none.
        """

class Renderer:
    """Draws pictures of a scan, on all cores, on threads that give way to a session's."""

    def __init__(self, volume: Volume, segments: Sequence[tuple[int, Segment]] = ()) -> None:
        """Reads each value once.

        Raises:
            ValueError: There are too many voxels, or a segment is of another scan.
        """

    @staticmethod
    def of_session(session: Session, *, waits: bool = False) -> Renderer:
        """Draws what a session has, as it is now.

        Args:
            session: Whose voxels and surfaces are drawn.
            waits: Whether surfaces that are being made are waited for; else later pictures have
                them.

        Raises:
            RuntimeError: The session has ended.
        """

    def follow(self, session: Session) -> bool:
        """Takes what a session has now, and reads what was changed; true where something was."""

    def set_surfaces(self, surfaces: Sequence[tuple[int, Surface]]) -> None:
        """Takes the surfaces of segments, by their numbers."""

    def set_appearance(self, appearance: Appearance) -> None:
        """Shows the scan in another way.

        Raises:
            ValueError: It is none; the sentence tells what is allowed.
        """

    def show_second(self, scan: SecondScan | None, appearance: SecondAppearance | None) -> None:
        """Shows a second scan through the first; the first alone where either is None.

        Raises:
            ValueError: The appearance is none; the sentence tells what is allowed.
        """

    def supersede(self, number: int) -> None:
        """Gives up pictures of lower numbers that are being drawn or still wait."""

    @property
    def state(self) -> int:
        """Number of what is drawn, which rises with every change; no other renderer has it."""

    def part_edited_since(
        self, state: int, camera: Camera, size: tuple[int, int]
    ) -> tuple[int, int, int, int] | None:
        """First column and row, columns and rows of the part that shows what was edited since.

        None where all of the picture may look different: the state is not remembered, tissue is
        displaced, or surfaces are drawn, which come after the edit.
        """

    def draw(
        self,
        camera: Camera,
        size: tuple[int, int],
        *,
        part: tuple[int, int, int, int] | None = None,
        steps_per_voxel: float = 1.0,
        samples: int = 1,
        jitter: bool = False,
        haste: bool = False,
        number: int = ...,
    ) -> Picture | None:
        """Draws a picture of so many columns and rows; None where it was given up.

        Of a ``part``, first column and row, columns and rows, it is those alone, lit by the light
        of the picture before; it begins at a multiple of 4 columns and 8 rows. ``samples`` pictures are averaged, with rays through other places of each pixel; ``jitter``
        starts rays at different shares of a step; ``haste`` leaves out the occlusion by the nearest
        voxels.

        Raises:
            ValueError: Camera, size, part or steps are not allowed, or there is no appearance yet.
        """

class Picture:
    """A picture; rows from the upper edge, columns from the left."""

    @property
    def size(self) -> tuple[int, int]:
        """Columns and rows."""

    def colours(self) -> NDArray[np.float32]:
        """Linear colour multiplied by opacity, and opacity; shape [rows, columns, 4]."""

    def depths(self) -> NDArray[np.float32]:
        """Distance from the eye along the direction of view [mm], infinite where nothing is.

        Shape [rows, columns].
        """

    def segments(self) -> NDArray[np.uint8]:
        """Number of the segment at each pixel, 0 of none; shape [rows, columns]."""

    def on_screen(
        self,
        ground: tuple[tuple[float, float, float], tuple[float, float, float]] | None = None,
        bends: bool = True,
    ) -> NDArray[np.uint8]:
        """Colours on a screen: sRGB and opacity, shape [rows, columns, 4].

        ``ground``: linear colours behind, in the middle and at the edge. ``bends``: highlights are
        bent instead of clipped, as the page does but in modes of grey.
        """

class Surface:
    """The triangles of a segment."""

    def __init__(
        self,
        segment: Segment,
        spacing: _Triple,
        origin: _Triple,
        direction: tuple[float, ...],
        step: int | None,
        smoothing: int | None,
        local: bool,
        values: tuple[Volume, tuple[float, float]] | None = None,
    ) -> None:
        """Makes the whole surface; without a step or a degree of smoothing the usual one.

        From ``values``, a scan and the threshold that made the segment, where they are given.

        Raises:
            ValueError: A setting is not allowed.
        """

    @property
    def patch_count(self) -> int: ...
    @property
    def vertex_count(self) -> int: ...
    @property
    def triangle_count(self) -> int: ...
    def area(self) -> float:
        """[mm²]."""

    def volume(self) -> float:
        """Enclosed [mm³]."""

    def mesh(self) -> tuple[NDArray[np.float64], NDArray[np.float32], NDArray[np.uint32]]:
        """Positions [patient], normals and triangles of all patches as one, shapes [n, 3]."""

    def time_all(self, threads: int) -> float:
        """Makes all of it anew on so many threads; returns how long that took [s]."""

    def time_joined(self) -> float:
        """Joins the patches; returns how long that took [s]."""

    def time_drill(self, voxel: _Voxel, radius: int, threads: int) -> float:
        """Takes a ball of voxels away and back; returns how long the patches took [s]."""

def phantom_bones(dimensions: _Voxel) -> Segment:
    """Makes the bones of the phantom, by their labels, without its values."""

def voxelise_mesh(
    vertices: NDArray[np.float64],
    triangles: NDArray[np.uint32],
    dimensions: _Voxel,
    spacing: _Triple,
    origin: _Triple,
    direction: tuple[float, ...],
    shell: bool,
) -> Segment:
    """Returns the voxels of a mesh in the patient [mm], shapes [n, 3].

    Raises:
        ValueError: The mesh cannot be used, or there is no such grid.
    """

class TouchBench:
    """A probe that presses and slides over a ground, 0.2 h per update."""

    def __init__(self, ground: Ground, radius: float, count: int, seed: int) -> None:
        """Makes its path of ``count`` updates; the same seed makes the same one.

        Args:
            ground: What is touched.
            radius: Of the probe, in smallest spacings h; 0 is a point.
            count: Updates.
            seed: Of the path.

        Raises:
            ValueError: There is no surface, or something given is not allowed.
        """

    def run(
        self, work: str, model: Literal["exact", "thesis-original", "thesis-improved"] = "exact"
    ) -> dict[str, float]:
        """Times one call for each update.

        Args:
            work: "detection, 1 voxel", "... 4 voxels", "... 10 voxels": traversals of rays near
                the surface that meet nothing (a few fewer than updates). "proxy": the contact
                model alone. "tick", "tick, by bits", "tick, no smoothing", "tick, no friction": the
                servo's tick with coupling, owner of the voxel and safety stage.
            model: Every contact model gets the same path; those of the thesis a point only.

        Returns:
            ``count``, ``per_second`` (timed all together), ``median_ns``, ``p99_ns``,
            ``p999_ns``, ``max_ns`` (single calls), ``contact_share``, ``mean_visits`` (voxels
            read per call), ``mean_step`` (way per update in h; length of rays in voxels).

        Raises:
            ValueError: Something given is not allowed.
        """

def bench_embedded(
    small: Ground, large: Ground, work: str, count: int, cold_count: int, seed: int
) -> EmbeddedResult:
    """Times a point on the same path in both grounds, alternately, and single cold updates.

    Raises:
        ValueError: There is no surface, or an argument is not allowed.
    """

def passivity_devices() -> list[str]:
    """Names of the devices of ``bench_passivity``, in the order of their report."""

def bench_passivity(
    device: str,
    rate_hz: int,
    seconds: float,
    search_seconds: float,
    wall: tuple[Volume, Segment, tuple[float, float] | None] | None = None,
) -> dict[str, float]:
    """Presses, taps and slides with a simulated device on a flat wall, or on a segment.

    ``seconds`` are shared by the three motions, at the stiffness that the device begins with;
    ``search_seconds`` is the length of each motion while the largest stiffness is searched.

    Returns:
        ``stiffness`` (where the device begins), ``to_hand`` (net energy given to the hand, the
        worst of the motions), ``of_one_contact`` (largest gain of one contact),
        ``largest_force``, ``contact_share``, ``damped`` (ticks in which energy was taken
        back), ``violations``, ``largest_stiffness`` (passive without taking back), ``bound``
        (of sampling and delay, for any hand). N, mm, N·mm.

    Raises:
        ValueError: The segment has no surface, or something given is not allowed.
    """

def needle_tissues() -> list[tuple[str, _Tissue]]:
    """Presets by name, each with the fields of ``palpate.session.needle.Tissue`` in their order."""

def drive_needle(
    volume: Volume, layers: list[tuple[Segment, _Tissue | None]], drive: _Drive
) -> NeedleRun:
    """Drives a needle through layers; those without a tissue are rigid."""

def drive_drill(
    volume: Volume,
    bone: Segment,
    drive: _Drive,
    radius: float,
    air: float | None,
    energy: float | None,
) -> DrillRun:
    """Drives a drill of a radius [mm] into bone."""

def drive_rearranging_ball(
    volume: Volume,
    bone: Segment,
    drive: _Drive,
    radius: float,
    softening: float,
    is_hu: bool,
) -> RearrangingRun:
    """Presses a ball into bone of particles that rearrange, and takes it out."""

def press(
    volume: Volume,
    layers: list[tuple[Segment, str | None]],
    drive: _Drive,
    deepest: float,
    radius: float,
    model: str,
) -> PressRun:
    """Presses a ball up to ``deepest`` [mm] along its path; layers without a material are rigid."""

def touch_quality_cases() -> list[str]:
    """Names of the cases of ``bench_touch_quality``, in the order of their report."""

def bench_touch_quality(
    case: str,
    touch: Literal[
        "exact",
        "exact, intensities",
        "exact, range's end",
        "exact, r 1",
        "exact, r 2",
        "exact, r 5",
        "stairs",
        "thesis-original",
        "thesis-improved",
    ],
) -> dict[str, float]:
    """Feels bodies whose surface is known exactly; lengths in parts of h, angles in degrees.

    ``exact`` takes bodies as masks, ``exact, intensities`` as what a threshold makes of partial
    volumes; a ball ``r`` [h] is held against the dilated body. ``stairs`` is ``exact`` without
    smoothing. What counts is said in
    ``crates/engine/src/bench/quality/figures.rs``.

    Returns:
        ``direction_mean`` and ``direction_95`` (angle between the force and the way to the
        true surface), ``magnitude_rmse`` (share of the true one), ``ripple`` (root mean square
        of the magnitude's error about its mean), ``force_lag_95``, ``force_lag_max``,
        ``proxy_lag_95``, ``proxy_lag_max`` (sideways behind the nearest point of the true
        surface), ``jitter`` (largest change in a tick at rest), ``pop_throughs``,
        ``solid_share``, ``stuck`` (updates), ``force_step`` (largest change of force in a tick
        beyond the motion of the hand), ``contact_share``, ``updates``.

    Raises:
        ValueError: The case or the way of touch does not exist.
    """

def bench_stress(
    seed: int,
    first: int,
    count: int,
    model: Literal["exact", "thesis-original", "thesis-improved"],
    threads: int,
    volume: Volume | None = None,
    segment: Segment | None = None,
) -> StressResult:
    """Checks touch in runs of random moves; the same numbers give the same runs on any threads.

    Raises:
        ValueError: There is no such model, or the numbers are not allowed.
    """

def material_presets() -> list[tuple[str, str, bool, _Solid, _Solid, tuple[float, float]]]:
    """Name, source, whether it follows HU, constants at the ends of its HU, range of E [Pa]."""

def deformation_models() -> list[ModelOffer]:
    """The deformation models, with their options."""

def press_block(
    nodes: tuple[int, int, int],
    spacing: float,
    young: float,
    poisson: float,
    low: tuple[float, float, float],
    high: tuple[float, float, float],
    tolerance: float,
    iterations: int,
) -> PressedBlock:
    """Presses a block of the bonded lattice between two plates that it sticks to.

    Args:
        nodes: Along x, y, z, 3 to 129; the block ends at its outer nodes.
        spacing: Distance of nodes [mm].
        young: Young's modulus [Pa].
        poisson: Poisson's ratio; the nearest one from 0.25 to 0.49 is taken.
        low: Displacement of the plate at the lower end of z [mm].
        high: Displacement of the plate at the upper end [mm].
        tolerance: Unbalanced force at rest, relative to the force on a plate.
        iterations: Most iterations.

    Raises:
        ValueError: An argument is not allowed.
    """

def bench_lattice_frames(
    count: int, poisson: float, soft: int, ratio: float, iterations: int
) -> LatticeFrames:
    """Presses and slides a ball on a box of ``count``³ nodes, a quarter of a node each frame.

    ``soft`` layers of tissue lie over tissue that is ``ratio`` times stiffer.

    Raises:
        ValueError: An argument is not allowed.
    """

def bench_lattice_cost(count: int, updates: float) -> float:
    """Time of an iteration for one node [s], measured over so many updates of nodes."""

def bench_lattice_force(count: int, iterations: int) -> float:
    """Force on a ball 1 mm deep in a box of ``count``³ nodes 1 mm apart [N]."""

def bench_lj_pairs(
    cells: int, temperature: float, warm_up: int, steps: int, seed: int
) -> PairsResult:
    """Runs an FCC crystal of Lennard-Jones particles on one thread.

    Raises:
        ValueError: An argument is not allowed.
    """

def particle_limits() -> dict[str, float]:
    """Limits of the thesis' particles.

    Returns:
        Of FCC: ``young_110`` and ``young_111`` relative to E along [100], and ``poisson``. Kinetic
        energies of a cuboid particle [D]: ``heat_at_start``, ``heat_early`` after 10 T0,
        ``heat_late`` after 50 T0, ``heat_damped`` after 50 T0 with critical friction.
    """

def bench_session(
    volume: Volume,
    segment: Segment,
    model: str | None,
    samples: int,
    seed: int,
    ticks_in_step: int | None = None,
) -> SessionResult:
    """Strokes a deformable segment, servo and model as fast as they can.

    With ``ticks_in_step`` for each second all loops alternate, and the counts are reproducible.

    Raises:
        ValueError: There is no surface, no such model, or an argument is not allowed.
    """

def bench_matter_stress(
    model: str, seed: int, first: int, count: int, ticks: int, threads: int
) -> SoftTissueStressResult:
    """Works in deformable blocks, with every guarantee of touch checked at each tick.

    Raises:
        ValueError: There is no such model, or an argument is not allowed.
    """
