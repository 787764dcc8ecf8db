"""Position a plate on bone by touch, and read the gap between them (thesis, figure 4.13).

    python examples/place_plate.py                  # the built-in phantom's spine
    python examples/place_plate.py head.mha 1350    # a skull, and where its bone begins

A plate of 1.5 mm is made as a mesh, written to a file, read again as `palpate open --mesh` does,
with voxels fine enough for its thickness, and stands 12 mm behind the bone. The probe takes it in
the hand, carries it to the bone, where it stops by itself, and lets go. Points are in LPS [mm]:
+y is toward the back, +z toward the head.
"""

from __future__ import annotations

import sys
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import palpate
from palpate import Mesh, object_of_mesh, read_mesh, suitable_spacing, write_mesh

PLATE = np.array([12.0, 1.5, 24.0])
"""Edges of the plate along x, y, z [mm]."""
DISTANCE = 12.0
"""Between plate and bone to begin with [mm]."""
BACK = np.array([0.0, 1.0, 0.0])


def main(arguments: list[str]) -> None:
    """Carries a plate to bone and prints the gap."""
    volume = palpate.read(arguments[0]) if arguments else palpate.phantom().volume
    bone = volume.threshold(float(arguments[1])) if arguments[1:] else volume.offered_bone()
    place = hindmost_of(bone) + (DISTANCE + PLATE[1] / 2.0) * BACK
    with TemporaryDirectory() as folder:
        file = Path(folder) / "plate.stl"
        write_mesh(box_at(place), file)
        mesh = read_mesh(file)
        plate = object_of_mesh(mesh, suitable_spacing(mesh.mesh, volume))
    scene = palpate.Scene(volume, [bone])
    scene.add(plate, shown_as="surface")

    # behind the plate, then 25 mm toward the front: farther than there is room
    start = place + (PLATE[1] / 2.0 + 3.0) * BACK
    path = (
        palpate.ScriptedPath(start)
        .hold(0.2)
        .move(start - 25.0 * BACK, seconds=2.5)
        .move(start, seconds=1.0)
        .hold(0.5)
    )
    options = palpate.SessionOptions(real_time=False)
    with palpate.Session(scene, device=path, options=options) as session:
        gaps = [session.gap(2, 1)]
        session.let_pass(0.1)
        session.grab(2, collides=True)
        for _ in range(26):
            session.let_pass(0.1)
            gaps.append(session.gap(2, 1))
        session.grab(None)
        session.let_pass(1.3)
        final = session.gap(2, 1)
        rows = session.segments()[1]["pose"]
        assert rows is not None
        pose = np.reshape(rows, (4, 4))

    for step, gap in enumerate(gaps[::4]):
        print(f"{0.4 * step:.1f} s: {gap.minimum:5.2f} mm, mean {gap.mean:5.2f} mm")
    print(f"placed: {final.minimum:.2f} mm, mean {final.mean:.2f} mm, carried {-pose[1, 3]:.1f} mm")
    thickness = plate.volume_ml * 1000.0 / (PLATE[0] * PLATE[2])
    print(
        f"the plate is {thickness:.2f} mm thick, in a scan of {max(volume.spacing):.2f} mm voxels"
    )
    check(gaps[0], final, -pose[1, 3], voxel=max(volume.spacing))
    # the mean over all of it: its edges are not multiples of a voxel
    assert abs(thickness - PLATE[1]) < 0.1 * PLATE[1]
    print("the plate lies on the bone, and not in it")


def hindmost_of(bone: palpate.Segment) -> np.ndarray:
    """Returns the hindmost point of the bone around the line through its middle [patient]."""
    volume = bone.volume
    z, y, x = np.nonzero(bone.mask())
    voxels = np.column_stack([x, y, z]) + 0.5
    points = voxels @ volume.patient_from_grid[:3, :3].T + volume.patient_from_grid[:3, 3]
    middle = (points.min(axis=0) + points.max(axis=0)) / 2.0
    aside = np.abs(points - middle) <= PLATE / 2.0
    near = points[aside[:, 0] & aside[:, 2]]
    assert len(near), "no bone around the line through its middle: choose another threshold"
    return np.array([middle[0], near[:, 1].max(), middle[2]])


def box_at(middle: np.ndarray) -> Mesh:
    """Returns a box of the plate's size, outward triangles."""
    corners = np.array([[i & 1, i >> 1 & 1, i >> 2 & 1] for i in range(8)], np.float64) - 0.5
    sides = [(0, 4, 6, 2), (1, 3, 7, 5), (0, 1, 5, 4), (2, 6, 7, 3), (0, 2, 3, 1), (4, 5, 7, 6)]
    triangles = [triple for a, b, c, d in sides for triple in ((a, b, c), (a, c, d))]
    normals = corners / np.linalg.norm(corners, axis=1, keepdims=True)
    return Mesh(
        middle + corners * PLATE, normals.astype(np.float32), np.array(triangles, np.uint32)
    )


def check(first: palpate.Gap, final: palpate.Gap, carried: float, *, voxel: float) -> None:
    """Checks that the plate came to the bone and not into it."""
    assert first.minimum > DISTANCE - voxel
    # it stops a voxel before it would overlap, and surfaces are right to half a voxel
    assert final.minimum < 1.5 * voxel
    assert final.overlap == 0.0
    # less than the hand went: bone was in the way; and straight
    assert 0.0 < carried < 20.0


if __name__ == "__main__":
    main(sys.argv[1:])
