"""Touch without a hand: a ball presses, strokes or drills a segment, and what it feels is kept.

Runs in steps of 1 ms without a clock, so that the same touch gives the same numbers. The scene
stays as it is. Frame: scene, LPS [mm]; forces [N]; times [s].
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from palpate.base.errors import OptionError
from palpate.segmentation.measures.surface_place import SurfacePlace, direction_of, surface_places
from palpate.session.recording import Recording
from palpate.session.scripted_path import ScriptedPath
from palpate.session.session import Session, SessionOptions
from palpate.session.touch_request import TouchRequest
from palpate.session.touch_settings import TouchSettings
from palpate.volumes.scene import Scene, choose_segment, require_scene
from palpate.volumes.segment import Segment

__all__ = ["TouchResult", "touch"]

AWAY = 5.0
"""How far from the surface the ball begins and ends [mm]."""
REST = 0.3
"""How long it rests at its depth [s]."""
STEP = 1.0
"""Between two places of a stroke [mm]."""
LONGEST = 3600.0
"""What a recording keeps [s]."""
MODEL = "lattice"
"""What deforms soft tissue."""
FEWEST = 10
"""Samples from which a line is fitted."""
NEAR_LIMIT = 0.95
"""Share of the largest force of the device from which a sample says nothing of the segment."""

Column = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class TouchResult:
    """What a ball felt, tick by tick, and what follows from that."""

    segment: str
    do: str
    place: tuple[float, float, float]
    """Point on the surface [mm]."""
    inward: tuple[float, float, float]
    """Unit vector into the segment."""
    times: Column
    """Since the start [s]."""
    depths: Column
    """Of the face of the ball below the surface at the place, as the device has it [mm]."""
    forces: Column
    """On the hand against the way in [N]."""
    lateral: Column
    """On the hand across it [N]."""
    devices: Column
    """Centre of the ball as the device has it, shape [count, 3] [mm]."""
    probes: Column
    """Centre of the ball as the segment lets it be, shape [count, 3] [mm]."""
    volumes: Column
    """What a drill has removed so far [mm³]."""
    stiffness: float | None
    """Slope of force over depth on the way in [N/mm]; None of a stroke, without contact, or where
    the force does not rise."""
    residual: float | None
    """Root of the mean squared distance of the forces to that line [N]."""
    warnings: tuple[str, ...]
    """What a person should know."""

    @property
    def largest_force(self) -> float:
        """Largest force against the way in [N]."""
        return float(self.forces.max())


def touch(scene: Scene, request: TouchRequest) -> TouchResult:
    """Presses, strokes or drills a segment along a path that its own shape gives.

    A rigid segment is felt by the spring between ball and hand alone; with ``material`` it gives
    way. Other segments are not there, but for those of ``rigid``.

    Args:
        scene: The scan and its segments.
        request: Where and how.

    Raises:
        OptionError: There is no such segment or place, or a number is not allowed.
    """
    require_scene(scene)
    request.check()
    chosen = choose_segment(scene, request.segment)
    others = [choose_segment(scene, name) for name in request.rigid]
    if chosen in others:
        raise OptionError(f"{chosen.name!r} given as rigid too; allowed: other segments")
    path, place, inward, moves_in = _path(chosen, request)
    if path.duration > LONGEST:
        raise OptionError(
            f"a touch of {path.duration:.0f} s given; allowed: at most {LONGEST:g} s, by a higher "
            "speed or a smaller depth or length"
        )
    options = SessionOptions(
        real_time=False,
        start=_triple(path.points[0]),
        touch=TouchSettings(probe_radius=request.radius),
    )
    with Session(Scene(scene.volume, [chosen, *others]), device=path, options=options) as session:
        if request.material is not None:
            session.set_material(1, request.material)
            session.set_deformation(MODEL)
        if request.do == "drill":
            session.set_tool("drill", radius=request.radius, segment_ids=[1])
            session.stroke(on=True)
        recording = session.run(path.duration)
        _, most = session.device_limits
    return _felt(recording, request, (chosen, place, inward), seconds_in=moves_in, most=most)


def _path(
    segment: Segment, request: TouchRequest
) -> tuple[ScriptedPath, NDArray[np.float64], NDArray[np.float64], float]:
    """Returns the path of the ball's centre, the place, the way in, and how long that takes [s]."""
    steps = None
    if request.do == "stroke":
        # the way in does not depend on where along the stroke it is
        inward = surface_places(segment, request.at, offset=request.offset)[0].inward
        way = direction_of(segment, request.along or "axis 1+")
        way = way - (way @ inward) * inward
        size = float(np.linalg.norm(way))
        if size < 1e-3:
            raise OptionError(
                f"a stroke along {request.along or 'the longest axis'} given, which is the way in; "
                "allowed: a direction across it"
            )
        count = max(2, round(request.length / STEP) + 1)
        offs = np.linspace(-request.length / 2.0, request.length / 2.0, count)
        steps = offs[:, None] * way / size
    places = surface_places(segment, request.at, offset=request.offset, steps=steps)
    inward = places[0].inward
    centres = [
        each + (request.depth - request.radius) * inward
        for each in _smooth(places, width=2.0 * request.radius)
    ]
    begin = places[0].point - (request.radius + AWAY) * inward
    end = places[-1].point - (request.radius + AWAY) * inward
    path = ScriptedPath(begin)
    seconds_in = float(np.linalg.norm(centres[0] - begin)) / request.speed
    path = path.move(centres[0], seconds=seconds_in).hold(REST)
    for before, after in pairwise(centres):
        path = path.move(after, seconds=float(np.linalg.norm(after - before)) / request.speed)
    path = path.move(end, seconds=float(np.linalg.norm(end - centres[-1])) / request.speed)
    return path, places[len(places) // 2].point, inward, seconds_in


def _smooth(places: list[SurfacePlace], *, width: float) -> list[NDArray[np.float64]]:
    """Returns places in a row at the mean height of the surface over a width [mm].

    A ball does not follow the steps of single voxels.
    """
    inward = places[0].inward
    heights = np.array([each.point @ inward for each in places])
    reach = round(width / 2.0 / STEP)
    means = [heights[max(0, at - reach) : at + reach + 1].mean() for at in range(len(heights))]
    return [
        each.point + (mean - height) * inward
        for each, mean, height in zip(places, means, heights, strict=True)
    ]


def _felt(
    recording: Recording,
    request: TouchRequest,
    where: tuple[Segment, NDArray[np.float64], NDArray[np.float64]],
    *,
    seconds_in: float,
    most: float,
) -> TouchResult:
    segment, place, inward = where
    forces = -recording.forces @ inward
    lateral = np.linalg.norm(recording.forces + forces[:, None] * inward, axis=1)
    times = recording.times - recording.times[0]
    depths = (recording.devices - place) @ inward + request.radius
    stiffness = residual = None
    told = []
    if request.do != "stroke":
        felt = (times <= seconds_in) & (forces > 0.0) & (forces < NEAR_LIMIT * most)
        if np.count_nonzero(felt) >= FEWEST:
            stiffness, residual = _line_through(depths[felt], forces[felt])
            if stiffness * depths[felt].std() <= residual:
                # the line tells less than half of it: the segment tore, or went aside
                stiffness = residual = None
                told.append(f"the force of {segment.name} does not rise with depth: no stiffness")
            elif request.material is None:
                told.append(
                    f"{segment.name} is rigid: the stiffness is that of the spring between ball "
                    "and hand"
                )
    if not recording.contacts.any():
        told.append(f"nothing of {segment.name} was felt: the ball did not reach it")
    if (np.linalg.norm(recording.forces, axis=1) >= NEAR_LIMIT * most).any():
        told.append(f"the force reached the device's limit of {most:g} N")
    return TouchResult(
        segment=segment.name,
        do=request.do,
        place=_triple(place),
        inward=_triple(inward),
        times=times,
        depths=depths,
        forces=forces,
        lateral=lateral,
        devices=recording.devices,
        probes=recording.positions,
        volumes=recording.tool_volumes,
        stiffness=stiffness,
        residual=residual,
        warnings=tuple(told),
    )


def _line_through(depths: Column, forces: Column) -> tuple[float, float]:
    """Returns the slope of the line nearest to forces over depths, and how far they lie off it."""
    slope, height = np.polyfit(depths, forces, 1)
    off = forces - (slope * depths + height)
    return float(slope), float(np.sqrt(np.mean(off**2)))


def _triple(point: NDArray[np.float64]) -> tuple[float, float, float]:
    x, y, z = point.tolist()
    return x, y, z
