"""The engine. Arrays are [z, y, x], x fastest; points (x, y, z), LPS [mm]; forces [N]."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

__all__ = [
    "Ground",
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
    "drive_drill",
    "drive_needle",
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
_Solid = tuple[float, float, float, float, float]
_Columns = dict[str, NDArray[Any]]

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
        settings: Mapping[str, Any] | None = None,
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

    def place(self, x: float, y: float, z: float) -> _Triple:
        """Puts probe, device and hand at a point, or in the free voxel nearest to it.

        Returns:
            Where they are.
        """

    def view(self, right: _Triple, up: _Triple) -> None:
        """Turns the device's axes to those of the view; ``up`` is straightened."""

    def settings(self, changes: Mapping[str, Any] | None = None) -> dict[str, Any]:
        """Changes the fields of ``TouchSettings`` that are given; returns what holds."""

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

    def set_locked(self, segment_id: int, locked: bool) -> None:
        """Locks the voxels of a segment or lets them be changed; this is not undone."""

    def threshold(self, low: float, high: float, segment_id: int | None = None) -> int:
        """Makes a touchable segment of the voxels with low <= value <= high, edits included.

        With ``segment_id`` that segment gets these voxels. Returns the segment's number.
        """

    def fill_box(self, segment_id: int, low: _Voxel, high: _Voxel, solid: bool) -> None:
        """Makes the voxels from ``low`` up to, but without, ``high`` solid or free."""

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

    def picture_changes(self) -> list[dict[str, Any]]:
        """What changed since the call before: the fields of ``protocol.Changed``."""

    def whole_surfaces(self) -> dict[str, Any]:
        """All surfaces as they are now, in the same form."""

    def set_deformation(
        self,
        model: str | None,
        options: tuple[
            int | None,
            float | None,
            bool,
            tuple[float, float] | None,
            float | None,
            int | None,
            str | None,
            str | None,
        ],
        undoable: bool,
    ) -> None:
        """Chooses the model by which matter gives way; None makes all matter hard.

        ``options``: edge, binding, walls, share and time [s] of what fades, yield strain, layers,
        calibration and motion.
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
        """Tells what a segment is made of, in SI; without anything it is hard."""

    def set_regions(
        self,
        segment_id: int,
        regions: list[
            tuple[str, tuple[tuple[int, int, int], tuple[int, int, int]] | None, int | None]
        ],
    ) -> None:
        """Tells how regions of a segment take part: treatment, box of voxels, other segment."""

    def set_force_source(self, source: str) -> None:
        """Chooses what a tool feels of matter that gives way: ``matter`` or ``voxels``."""

    def deformation(self) -> dict[str, Any]:
        """How the deformation goes."""

    def show_model_parts(self, on: bool) -> None:
        """Has ``model_parts`` give the nodes or particles of the model, or no more."""

    def model_parts(self) -> dict[str, Any] | None:
        """The newest of them, once: the fields of ``protocol.MatterParts``."""

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
        """Chooses the tool for the next strokes; None empties the hand.

        ``tissues`` are those of a needle, one for each segment; ``paint`` is how deep a painter
        paints [mm], None all of its ball, and whether segments may overlap.

        ``air`` is what the scan reads where the drill was, ``energy`` its work per volume
        [mJ/mm³]; None is -1000 and bone by HU.
        """

    def needle_events(self) -> list[tuple[str, int, float, float, float]]:
        """Kind, segment, time [s], depth [mm], force [N] of what happened to the needle."""

    def withdraw_needle(self) -> bool:
        """Takes the needle out on the way that it went in; False where none is in."""

    def stroke(self, on: bool) -> None:
        """Begins a stroke of the chosen tool, or ends it."""

    def look_at_journal(self, path: Path, scan_hash: bytes) -> tuple[int, int] | None:
        """Counts the steps of a journal and the bytes that are lost; None without a file."""

    def begin_journal(self, path: Path, scan_hash: bytes) -> None:
        """Begins a journal in a new file, with what is there now."""

    def keep_state(self, path: Path, scan_hash: bytes) -> None:
        """Writes what is there now into a new file; a journal that runs goes on."""

    def recover_journal(self, path: Path, scan_hash: bytes) -> tuple[int, int, list[bytes]]:
        """Does again what a journal says and goes on with it; steps, lost bytes, notes."""

    def note_in_journal(self, note: bytes) -> None:
        """Keeps bytes beside the voxels, where there is a journal."""

    def end_journal(self) -> None:
        """Writes what waits and closes the journal."""

    def undo(self) -> bool:
        """Takes the newest change back; False where there is none."""

    def redo(self) -> bool:
        """Does the last undone change again; False where there is none."""

    def segment(self, segment_id: int) -> Segment:
        """The voxels of a segment as they are now."""

    def segments_state(self) -> list[dict[str, Any]]:
        """``id``, ``voxels``, ``touchable``, ``locked``, ``pending`` and ``range`` of each segment.

        ``range`` follows edits, undo and redo: None once the voxels are not that threshold;
        ``made_by`` is the threshold that made them, whatever edits did since.
        """

    def frame(self) -> dict[str, Any]:
        """The fields of ``protocol.State``, ``notices`` and ``segments_version``.

        ``force`` and the samples are what was sent to the device; ``notices`` holds pairs
        (level, text).
        """

    def lateness(self) -> dict[str, dict[str, Any]]:
        """Pace of each thread since the start: counts, worst, and a histogram of lateness.

        ``lateness`` counts begun ticks by ``lateness_bins_us`` (upper ends), the rest last.
        """

    def start_recording(self) -> None:
        """Keeps every tick from now on; a recording that runs is thrown away."""

    def stop_recording(self) -> tuple[_Columns, _Columns | None]:
        """The recording by columns, empty where none ran, and what else a replay needs.

        Columns of the ticks: ``tick``, ``time``, ``device``, ``hand``, ``proxy``, ``force``,
        ``sent_force``, ``contact``, ``touched``, ``command``; and the inputs of the tick:
        ``reading``, ``read_at``, ``position_in_device``, ``velocity_in_device``,
        ``orientation``, ``buttons``, ``hand_target``, ``hand_number``, ``has_room``. Points and
        forces have shape [count, 3], quaternions [count, 4]. ``sent_force`` is what was last
        sent when the tick began, one or two ticks behind ``force``.
        """

    def run(self, seconds: float) -> None:
        """Computes so many seconds of a session without ``real_time``."""

    def stop(self) -> None:
        """Zero force, then no threads, in less than a second; again it does nothing."""

def build() -> str:
    """Names the build by all that decides what a tick computes."""

def replay_recording(recording: _Columns, tape: _Columns) -> dict[str, Any]:
    """Computes the ticks of a recording again, from columns as ``stop_recording`` gives them.

    Returns:
        ``ticks`` (columns of what was computed), ``first_row`` (where in the recording they
        begin), ``recorded_hash``, ``replayed_hash``, ``different`` (how many ticks),
        ``first_difference`` (tick, time, probe [mm], force [N]) or None, and ``end``: ("whole" |
        "lost" | "commands", last tick, ticks lost).

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
        """Takes 1 to 255 segments, and the thresholds that made them, where such did.

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
) -> dict[str, Any]:
    """Times a point on the same path in both, by turns, and single cold updates.

    Returns:
        ``small_per_second``, ``large_per_second``, ``ratio``, ``contact_share``, and as of
        ``TouchBench.run`` the times of ``small_cold`` and ``large_cold``.

    Raises:
        ValueError: There is no surface, or something given is not allowed.
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
    """Tissues by name, each by the figures of ``palpate.session.needle.Tissue`` in their order."""

def drive_needle(
    volume: Volume, layers: list[tuple[Segment, _Tissue | None]], drive: _Drive
) -> dict[str, Any]:
    """Drives a needle through layers; without a tissue they are hard."""

def drive_drill(
    volume: Volume,
    bone: Segment,
    drive: _Drive,
    radius: float,
    air: float | None,
    energy: float | None,
) -> dict[str, Any]:
    """Drives a drill of a radius [mm] into bone."""

def press(
    volume: Volume,
    layers: list[tuple[Segment, str | None]],
    drive: _Drive,
    deepest: float,
    radius: float,
    model: str,
) -> dict[str, Any]:
    """Presses a ball so far along its way [mm] into layers; without a material they are hard."""

def touch_quality_cases() -> list[str]:
    """Names of the cases of ``bench_touch_quality``, in the order of their report."""

def bench_touch_quality(
    case: str,
    touch: Literal[
        "exact",
        "exact, intensities",
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
) -> dict[str, Any]:
    """Makes runs of random moves, each checked; numbers give the same runs on any threads.

    Returns:
        ``moves``, ``contacts`` (of these), ``edits``, ``poses`` (steps of objects), ``cuts``
        (forces that fell at once since they would have pulled), and ``violation``: None, or ``run``,
        ``move`` (moves before it), ``model``, ``guarantee`` (its number), ``what``, ``plan``.

    Raises:
        ValueError: There is no such model, or the numbers are not allowed.
    """

def material_presets() -> list[tuple[str, str, bool, _Solid, _Solid]]:
    """Name, source, whether it follows HU, and the constants at the ends of its HU."""

def deformation_models() -> list[dict[str, Any]]:
    """The models, with what each offers to choose; ``model_options.Model`` has the fields."""

def press_block(
    nodes: tuple[int, int, int],
    spacing: float,
    young: float,
    poisson: float,
    low: tuple[float, float, float],
    high: tuple[float, float, float],
    tolerance: float,
    iterations: int,
) -> dict[str, Any]:
    """Presses a whole block of the bonded lattice between plates that it sticks to.

    Args:
        nodes: Along x, y, z, 3 to 129; the block ends at its outer nodes.
        spacing: Between nodes [mm].
        young: [Pa].
        poisson: Taken to the nearest from 0.25 to 0.45.
        low: How far the plate at the lower end of z moves [mm].
        high: And the one at the upper end.
        tolerance: Unbalanced force at rest, as a share of the force on a plate.
        iterations: At most.

    Returns:
        ``moved`` (displacement of each node [mm], shape [nodes, 3], x fastest), ``force`` (on the
        lower plate [N]), ``iterations``, ``residual``.

    Raises:
        ValueError: Something given is not allowed.
    """

def bench_lattice_frames(
    count: int, poisson: float, soft: int, ratio: float, iterations: int
) -> dict[str, Any]:
    """Presses and slides a ball in a box of ``count``³ nodes, a quarter of a node a frame.

    ``soft`` layers of matter lie over matter ``ratio`` times stiffer.

    Returns:
        ``seconds`` of each frame on a core, ``worst_error`` of the force beside that at residual
        1e-6, and ``worst_exact``, the largest residual of that one.

    Raises:
        ValueError: Something given is not allowed.
    """

def bench_lattice_cost(count: int, updates: float) -> float:
    """Returns the time of an iteration for a node [s], over so many updates of nodes."""

def bench_lattice_force(count: int, iterations: int) -> float:
    """Returns the force on a ball 1 mm deep in a box of ``count``³ nodes 1 mm apart [N]."""

def bench_lj_pairs(
    cells: int, temperature: float, warm_up: int, steps: int, seed: int
) -> dict[str, Any]:
    """Runs an FCC crystal of Lennard-Jones particles on one thread; units a = D = m = 1.

    Returns:
        ``side`` of the periodic box, ``positions`` and ``velocities`` at the start, shape [n, 3],
        ``step``, ``seconds`` of the timed steps, ``pairs_per_second``, ``builds`` of the lists,
        and energies per particle: ``potential_at_start``, ``potential_after_warm_up``,
        ``total_at_end``.

    Raises:
        ValueError: Something given is not allowed.
    """

def particle_limits() -> dict[str, float]:
    """Tells what the thesis' particles cannot do.

    Returns:
        Of FCC: ``young_110`` and ``young_111`` over E along [100], and ``poisson``. Kinetic
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
) -> dict[str, Any]:
    """Strokes a segment that gives way, servo and model as fast as they can.

    With ``ticks_in_step`` for each second all loops take turns, and the counts are always the same.

    Returns:
        Of each sample: ``ticks``, ``contacts``, ``answers``, ``seconds``; ``nodes`` and
        ``iterations`` of the last answer; ``violations``.

    Raises:
        ValueError: There is no surface, no such model, or something given is not allowed.
    """

def bench_matter_stress(
    model: str, seed: int, first: int, count: int, ticks: int, threads: int
) -> dict[str, Any]:
    """Works in blocks that give way, with every guarantee checked at each tick.

    Returns:
        ``ticks``, ``contacts``, ``bits`` (voxels around the probe that changed), ``edits``,
        ``answers``, ``in_bone``, ``drilled``, ``punctures``, ``rests``, and ``violation``: None, or ``run``,
        ``tick``, ``guarantee`` (its number), ``what``.

    Raises:
        ValueError: There is no such model, or something given is not allowed.
    """
