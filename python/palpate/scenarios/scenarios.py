"""The scenarios of ``palpate scenario``, on the built-in phantom or on a scan (thesis 5.28.3).

``drilling`` drills into bone, or pushes it aside as particles, ``needle-skull`` passes the tissue
over a bone, ``needle-liver`` the liver in front of bone, and ``palpation`` presses soft tissue
along a line over bone, or the liver at the places of a square.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from palpate.base.errors import EmptySegmentError, OptionError
from palpate.scenarios.drilling import drive_drill, drive_rearranging_ball
from palpate.scenarios.drive import Drive
from palpate.scenarios.lines import before_body, line_into, line_through
from palpate.scenarios.needle import drive_needle
from palpate.scenarios.palpation import palpate_line, with_lump
from palpate.scenarios.press_lines import line_over, square_on
from palpate.scenarios.run import ScenarioRun
from palpate.segmentation.mask_shape import keep_largest, margin, opened
from palpate.session.needle import TISSUES, Tissue
from palpate.volumes.downsample import merged
from palpate.volumes.phantom import phantom
from palpate.volumes.scene import Scene
from palpate.volumes.segment import Segment
from palpate.volumes.split import split_around
from palpate.volumes.volume import Volume

__all__ = [
    "SCENARIOS",
    "Body",
    "NeedleScenario",
    "body_of_phantom",
    "body_of_scan",
    "run_drilling",
    "run_drilling_particles",
    "run_needle",
    "run_palpation",
    "run_palpation_map",
    "scene_of_body",
]

Mask = NDArray[np.bool_]
NeedleScenario = Literal["needle-skull", "needle-liver"]

SCENARIOS = ("drilling", "needle-skull", "needle-liver", "palpation")

BONES = ("ribs", "sternum", "spine", "pelvis", "shoulders", "femurs")
"""Parts of the phantom that are bone."""

SOFT = ("skin", "fat", "muscle", "liver")
"""Parts of the phantom with a tissue and a material of their own; all others are muscle."""

AIR_END = -300.0
"""Lowest value of a body [HU]."""

RAW_SHIFT = 1024.0
"""Offset of the values of scans without HU that begin at 0, such as CThead."""

DRILL_STIFFNESS = 4.0
"""Stiffness of the spring between drive and drill, like a firm hand [N/mm]."""

AROUND_PARTICLES = 24.0
"""Bone around a path that takes part where particles are pushed aside [mm]."""

ENERGY_ANYWHERE = 1300.0
"""Work of a drill where values are not HU: that of cortical bone [mJ/mm³]."""

LONGEST = 1000.0
"""Largest length that may be given [mm]."""


@dataclass(frozen=True, kw_only=True)
class Body:
    """A scan and masks of its tissues."""

    volume: Volume
    soft: Mapping[str, Mask]
    """Masks of deformable tissue by name; one ``soft tissue`` where tissues are not known."""
    bone: Mask
    tumour: Mask | None = None
    """Mask of a tumour that the scan does not show; None where none is known."""

    @property
    def all_soft(self) -> Mask:
        """Mask of all deformable tissue."""
        soft: Mask = np.logical_or.reduce(list(self.soft.values()))
        return soft


def body_of_phantom() -> Body:
    """Returns the phantom and its tissues."""
    made = phantom()
    bone = np.isin(made.labels, [made.names[name] for name in BONES])
    soft = {name: made.labels == made.names[name] for name in SOFT}
    known = np.isin(made.labels, [made.names[name] for name in (*SOFT, "air")]) | bone
    return Body(
        volume=made.volume,
        soft={**soft, "soft tissue": ~known},
        bone=bone,
        tumour=made.tumour().mask() != 0,
    )


def body_of_scan(
    volume: Volume,
    *,
    labels: Volume | None = None,
    liver: int = 6,
    bone: float | None = None,
) -> Body:
    """Returns body and bone of a scan by its values, and its liver by a label map.

    Args:
        volume: The scan.
        labels: Label map; without one the liver is soft tissue like all other tissue.
        liver: Number of the liver in the label map.
        bone: Lower end of bone [unit of the scan]; the default is that of ``Volume.offered_bone``.

    Raises:
        OptionError: The label map does not fit the scan.
        EmptySegmentError: There is no voxel of bone.
    """
    values = volume.intensities()
    shift = RAW_SHIFT if volume.unit != "HU" and volume.range[0] >= 0.0 else 0.0
    solid = volume.between(volume.anchors.bone if bone is None else bone, np.inf)
    body = values > AIR_END + shift
    soft = {}
    if labels is not None:
        soft["liver"] = _label(volume, labels, liver)
        solid &= ~soft["liver"]
        body &= ~soft["liver"]
    if not solid.any():
        raise EmptySegmentError("the scan has no bone; allowed: a lower `bone=VALUE`")
    return Body(volume=volume, soft={"soft tissue": body & ~solid, **soft}, bone=solid)


def scene_of_body(body: Body) -> Scene:
    """Returns a scene of a body: its bone and its known organs."""
    scene = Scene(body.volume)
    scene.add(body.volume.segment(body.bone, name="bone"), shown_as="surface")
    if "liver" in body.soft:
        liver = body.volume.segment(body.soft["liver"], name="liver")
        scene.add(liver, shown_as="surface")
    return scene


def run_needle(
    scenario: NeedleScenario, body: Body, *, speed: float = 5.0, force_limit: float = 6.0
) -> ScenarioRun:
    """Drives a needle to bone: through the liver, or through the tissue over it.

    Raises:
        OptionError: No line meets these structures.
    """
    if scenario == "needle-liver":
        if "liver" not in body.soft:
            raise OptionError("no label map given; allowed: one that has the liver")
        through, longest, other = body.soft["liver"], 300.0, "muscle"
    else:
        # a skull is close under its skin; where fat and muscle are known, bone is a little deeper
        through, longest = body.all_soft, 30.0 if "skin" in body.soft else 15.0
        other = "muscle" if "skin" in body.soft else "skin"
    layers: list[tuple[Segment, Tissue | None]] = [
        (body.volume.segment(mask, name=name), TISSUES[name if name in TISSUES else other])
        for name, mask in body.soft.items()
    ]
    layers.append((body.volume.segment(body.bone, name="bone"), None))
    start, target = line_through(body.volume, through, body.bone, longest=longest)
    start = before_body(body.volume, body.all_soft | body.bone, start)
    drive = Drive(start=start, target=target, speed=speed, force_limit=force_limit)
    return drive_needle(body.volume, layers, drive, scenario=scenario)


def run_drilling(
    body: Body,
    *,
    depth: float = 4.0,
    radius: float = 2.0,
    speed: float = 0.1,
    force_limit: float = 10.0,
) -> ScenarioRun:
    """Drives a drill straight into bone; nothing else is in its way.

    Args:
        body: The body.
        depth: Depth of the drive [mm]; the spring makes the burr lag behind it.
        radius: Radius of the burr [mm].
        speed: Speed of the drive [mm/s].
        force_limit: Force at which the drive stops [N].

    Raises:
        OptionError: There is no bone seen from the front, or an option is not allowed.
    """
    volume = body.volume
    drive = _into_bone(body, (depth, radius), (speed, force_limit))
    is_hu = volume.unit == "HU"
    return drive_drill(
        volume,
        volume.segment(body.bone, name="bone"),
        drive,
        radius=radius,
        air=None if is_hu else volume.range[0],
        energy=None if is_hu else ENERGY_ANYWHERE,
    )


def run_drilling_particles(
    body: Body,
    *,
    depth: float = 4.0,
    radius: float = 2.0,
    speed: float = 1.0,
    force_limit: float = 10.0,
    softening: float = 5000.0,
) -> ScenarioRun:
    """Presses a ball into bone of particles, which rearrange and stay so; nothing is removed.

    Args:
        body: The body.
        depth: Depth of the drive [mm]; the spring makes the ball lag behind it.
        radius: Radius of the ball [mm].
        speed: Speed of the drive [mm/s].
        force_limit: Force at which the drive stops [N].
        softening: Factor by which the particles are weaker than bone.

    Voxels longer than half of the radius are split.

    Raises:
        OptionError: There is no bone seen from the front, or an option is not allowed.
    """
    drive = _into_bone(body, (depth, radius), (speed, force_limit), clear=2.5)
    volume, bone = split_around(
        body.volume,
        body.bone,
        np.asarray(drive.start, float),
        reach=AROUND_PARTICLES + depth,
        # a ball no larger than a voxel is a particle among particles
        size=radius / 2.0,
    )
    return drive_rearranging_ball(
        volume,
        volume.segment(bone, name="bone"),
        drive,
        radius=radius,
        softening=softening,
    )


def _into_bone(
    body: Body, tool: tuple[float, float], push: tuple[float, float], *, clear: float = 1.25
) -> Drive:
    """Returns a drive of a ball into the flattest bone.

    Args:
        body: The body.
        tool: How deep the ball's face comes, and its radius [mm].
        push: Speed [mm/s] and force limit [N].
        clear: From its face to the bone at the start [voxels].
    """
    (depth, radius), (speed, force_limit) = tool, push
    _check_lengths(depth=depth, radius=radius)
    # a ball is held off by up to a voxel
    margin = radius + clear * max(body.volume.spacing)
    start, target = line_into(body.volume, body.bone, depth=depth, margin=margin)
    # the ball's face is to come that deep, not its centre
    inward = (target - start) / np.linalg.norm(target - start)
    return Drive(
        start=start,
        target=target - radius * inward,
        speed=speed,
        force_limit=force_limit,
        rest_secs=0.5,
        stiffness=DRILL_STIFFNESS,
    )


def run_palpation(
    body: Body,
    *,
    sides: Sequence[str] = ("anterior",),
    voxel: float = 2.0,
    places: int = 9,
    length: float = 40.0,
    depth: float = 2.5,
    radius: float | None = None,
    progress: Callable[[str, float | None], None] | None = None,
) -> ScenarioRun:
    """Presses soft tissue along a line over bone that is near in the middle and deep at both ends.

    Args:
        body: The body; parts that are not connected to its largest part, such as a table, are left
            out.
        sides: Sides of the patient to search for a line.
        voxel: Voxel size to which finer scans are downsampled [mm]; a finger is larger.
        places: Number of places.
        length: Length of the line [mm].
        depth: Depth of a press [mm].
        radius: Radius of the ball [mm]; the default is twice the smallest spacing after
            downsampling, the largest for which the lattice's box counts as infinite.
        progress: Called before each press.

    Raises:
        OptionError: There is no such line, or an option is not allowed.
    """
    _check_lengths(voxel=voxel, length=length, depth=depth, radius=radius)
    masks = {"soft tissue": body.all_soft, "bone": body.bone}
    volume, masks = merged(body.volume, masks, size=voxel)
    itself = _largest_part(masks["soft tissue"] | masks["bone"], volume)
    soft, bone = masks["soft tissue"] & itself, masks["bone"] & itself
    line = line_over(volume, soft, bone, length=length, count=places, sides=sides)
    # one material: what is felt is the bone, and no skin over fat
    layers: list[tuple[Segment, str | None]] = [
        (volume.segment(soft, name="soft tissue"), "muscle"),
        (volume.segment(bone, name="bone"), None),
    ]
    return palpate_line(
        volume,
        layers,
        line,
        radius=2.0 * min(volume.spacing) if radius is None else radius,
        depth=depth,
        progress=progress,
    )


def run_palpation_map(
    body: Body,
    *,
    voxel: float = 2.0,
    places: int = 5,
    width: float = 36.0,
    depth: float = 5.0,
    radius: float | None = None,
    progress: Callable[[str, float | None], None] | None = None,
) -> ScenarioRun:
    """Presses the front of the liver at the places of a square, and finds where it is stiffest.

    The liver of the phantom has a tumour that the scan does not show.

    Args:
        body: A body whose liver is known.
        voxel: Voxel size to which finer scans are downsampled [mm].
        places: Number of places in a row, and of rows.
        width: Width of the square [mm].
        depth: Depth of a press [mm].
        radius: Radius of the ball [mm]; the default is three times the smallest spacing after
            downsampling, over which steps of voxels even out.
        progress: Called before each press.

    Raises:
        OptionError: The liver is not known, the square does not fit its front, or an option is not
            allowed.
    """
    _check_lengths(voxel=voxel, width=width, depth=depth, radius=radius)
    if "liver" not in body.soft:
        raise OptionError("no label map given; allowed: one that has the liver")
    masks = {"liver": body.soft["liver"]}
    if body.tumour is not None:
        masks["tumour"] = body.tumour
    volume, masks = merged(body.volume, masks, size=voxel)
    line = square_on(volume, masks["liver"], width=width, count=places)
    # where both have a voxel it is of the last one
    layers = [(volume.segment(mask, name=name), name) for name, mask in masks.items()]
    run = palpate_line(
        volume,
        layers,
        line,
        radius=3.0 * min(volume.spacing) if radius is None else radius,
        depth=depth,
        progress=progress,
    )
    return with_lump(run, None if body.tumour is None else _middle(volume, masks["tumour"]))


def _middle(volume: Volume, mask: Mask) -> NDArray[np.float64]:
    """Returns the middle of a mask in the patient [mm]."""
    z, y, x = np.argwhere(mask).mean(axis=0) + 0.5
    middle: NDArray[np.float64] = (volume.patient_from_grid @ np.array([x, y, z, 1.0]))[:3]
    return middle


def _check_lengths(**lengths: float | None) -> None:
    """Refuses lengths that are not positive and finite [mm]."""
    for name, length in lengths.items():
        if length is not None and not 0.0 < length <= LONGEST:
            raise OptionError(f"{name} {length:g} mm given; allowed: above 0, at most {LONGEST:g}")


def _largest_part(mask: Mask, volume: Volume) -> Mask:
    """Returns the largest part of a mask, without what is connected to it by thin bridges only."""
    reach = 2.0 * max(volume.spacing)
    core = keep_largest(opened(mask, volume.spacing, reach))
    # the faces of what is kept are as they were
    return margin(core, volume.spacing, reach) & mask


def _label(volume: Volume, labels: Volume, number: int) -> Mask:
    if labels.dimensions != volume.dimensions:
        raise OptionError(
            f"label map of {labels.dimensions} voxels given; allowed: {volume.dimensions}"
        )
    mask = np.asarray(labels.array == number)
    if not mask.any():
        raise EmptySegmentError(f"label {number} has no voxel; allowed: a label of the map")
    return mask
