"""How constant the force at a still hand is while soft tissue is pressed, on few cores.

Run: ``taskset -c 0 python scripts/measure_rest.py [MATERIAL ...]``, and without ``taskset``.
A device presses a block by steps of 0.5 mm, and then stands still; the force is looked at each
10 ms. Say with the figures how many cores there were and what else ran.
"""

from __future__ import annotations

import os
import sys

import numpy as np
from palpate.session.scripted_path import ScriptedPath
from palpate.session.session import Session, SessionOptions
from palpate.session.touch_settings import TouchSettings
from palpate.volumes.scene import Scene
from palpate.volumes.volume import Volume

TOP = 24.0
"""Upper end of the block [mm]."""
BALL = 3.0
"""Radius of the probe [mm]."""
STILL = 4.0
"""How long the hand stands still [s]."""
PARTS = ((0.5, 1.0), (1.0, 2.0), (2.0, 4.0))
"""Parts of that time [s]."""


def scene() -> Scene:
    """Returns a soft block of 48 mm with 24 mm of air above it, in voxels of 1 mm."""
    values = np.full((48, 48, 48), -1000, dtype=np.int16)
    values[: int(TOP)] = 50
    volume = Volume(values, spacing=(1.0, 1.0, 1.0))
    return Scene(volume, [volume.threshold(0.0, 100.0, name="block")])


def pressing(depth: float) -> tuple[ScriptedPath, float]:
    """Returns the path of the device and the time at which it comes to stand still [s]."""
    path = ScriptedPath((24.3, 24.4, TOP + BALL + 2.0))
    path = path.move((24.3, 24.4, TOP + BALL + 0.2), seconds=0.3)
    for step in range(1, round(2.0 * depth) + 1):
        path = path.move((24.3, 24.4, TOP + BALL - 0.5 * step), seconds=0.01).hold(0.02)
    return path.hold(STILL + 1.0), path.duration


def main(materials: list[str]) -> None:
    """Prints for each material and depth how far the force goes up and down in each part."""
    print(f"cores: {len(os.sched_getaffinity(0))}")
    for material in materials:
        for depth in (3.0, 6.0, 12.0):
            path, still = pressing(depth)
            with Session(scene(), device=path, options=SessionOptions()) as session:
                session.settings(TouchSettings(probe_radius=BALL))
                session.set_material(1, material)
                session.set_deformation("lattice")
                recording = session.run(still + STILL)
                answers = session.deformation()["answers"]
            forces = np.linalg.norm(recording.forces, axis=1)[::10]
            since = recording.times[::10] - still
            told = []
            for begin, end in PARTS:
                part = forces[(since >= begin) & (since < end)]
                spread = 100.0 * float(np.ptp(part)) / max(float(part.mean()), 1e-9)
                told.append(f"{begin:g} to {end:g} s: {spread:.2f} %")
            rate = answers / (still + STILL)
            print(
                f"{material}, {depth:g} mm: {forces[-1]:.3f} N; {'; '.join(told)}; "
                f"{rate:.0f} answers a second"
            )


if __name__ == "__main__":
    main(sys.argv[1:] or ["liver", "muscle", "skin"])
