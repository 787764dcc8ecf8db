"""Feel bone without a device: press a scripted path on a scan and check what was felt.

    python examples/feel_bone.py                  # the built-in phantom
    python examples/feel_bone.py head.mha 1300    # a scan, and where its bone begins

The path comes from the back toward the middle of the bone (the back of a skull, a spine),
presses 5 mm deep, slides 10 mm toward the head, and leaves. Points are in LPS [mm]: -y is
toward the front, +z toward the head.
"""

from __future__ import annotations

import sys

import numpy as np
import palpate

STIFFNESS = 0.5
"""Of the spring between probe and device [N/mm]."""

TOWARD_FRONT = np.array([0.0, -1.0, 0.0])
TOWARD_HEAD = np.array([0.0, 0.0, 1.0])


def main(arguments: list[str]) -> None:
    """Presses on bone and prints what was felt."""
    # a scan, and its bone
    volume = palpate.read(arguments[0]) if arguments else palpate.phantom().volume
    bone = volume.threshold(float(arguments[1])) if arguments[1:] else volume.offered_bone()
    print(volume, bone, sep="\n")

    # a path that presses on it
    surface = point_on(bone)
    path = (
        palpate.ScriptedPath(surface - 20.0 * TOWARD_FRONT)
        .move(surface + 5.0 * TOWARD_FRONT, seconds=1.0)
        .move(surface + 5.0 * TOWARD_FRONT + 10.0 * TOWARD_HEAD, seconds=1.0)
        .move(surface - 20.0 * TOWARD_FRONT, seconds=1.0)
        .hold(0.2)
    )

    # a session that follows it, computed at once instead of by the clock
    # without smoothing the spring is that from device to probe, which is checked below
    touch = palpate.TouchSettings(stiffness=STIFFNESS, damping=0.0, smoothing="off")
    options = palpate.SessionOptions(real_time=False, touch=touch)
    with palpate.Session(palpate.Scene(volume, [bone]), device=path, options=options) as session:
        recording = session.run(path.duration)

    strongest = np.linalg.norm(recording.forces, axis=1).max()
    print(f"in contact for {recording.contacts.mean():.0%} of {recording.times[-1]:.1f} s")
    print(f"strongest force {strongest:.2f} N, deepest {recording.depths.max():.2f} mm")
    check(recording, bone)
    print("the probe stayed outside the bone, and force = stiffness x depth")


def point_on(bone: palpate.Segment) -> np.ndarray:
    """Returns the hindmost point of the bone on the line through its middle [patient]."""
    volume = bone.volume
    z, y, x = np.nonzero(bone.mask())
    voxels = np.column_stack([x, y, z]) + 0.5
    points = voxels @ volume.patient_from_grid[:3, :3].T + volume.patient_from_grid[:3, 3]

    # within a voxel's width of the line from the back through the middle
    aside = np.abs(points - points.mean(axis=0))
    width = max(volume.spacing)
    near = points[(aside[:, 0] <= width) & (aside[:, 2] <= width)]
    assert len(near), "no bone on the line through its middle: choose another threshold"
    hindmost: np.ndarray = near[near[:, 1].argmax()]
    return hindmost


def check(recording: palpate.Recording, bone: palpate.Segment) -> None:
    """Checks what must always hold."""
    assert not bone.contains(recording.positions).any(), "the probe was in the bone"
    assert recording.contacts.any(), "the probe never touched the bone"

    # while nothing limits the force it is the spring's, from device to probe
    touching = recording.contacts
    spring = STIFFNESS * (recording.positions - recording.devices)
    np.testing.assert_allclose(recording.forces[touching], spring[touching], atol=1e-9)

    # away from the bone there is no force
    assert not recording.contacts[-1]
    assert not recording.forces[-1].any()


if __name__ == "__main__":
    main(sys.argv[1:])
