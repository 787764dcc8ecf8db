"""What a press of the liver of the LIDC scan feels with all of it behind the box, and without.

Run: ``python scripts/measure_whole.py path/to/lidc0001_totalseg``. A device presses the front of
the liver, in the middle of it, by steps of 0.5 mm, and then stands still for two seconds.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import SimpleITK as sitk  # noqa: N813
from palpate.session.model_options import ModelOptions
from palpate.session.scripted_path import ScriptedPath
from palpate.session.session import Session, SessionOptions
from palpate.session.touch_settings import TouchSettings
from palpate.volumes.scene import Scene
from palpate.volumes.volume import Volume

LIVER = 5
"""Of the mask."""
BALL = 3.0
"""Radius of the probe [mm]."""
STILL = 2.0
"""How long the hand stands still [s]."""


def liver(folder: Path) -> tuple[Scene, tuple[float, float, float]]:
    """Returns the liver alone, in air, and a place on its front [mm]."""
    image = sitk.ReadImage(str(folder / "mask.nii.gz"))
    is_liver = sitk.GetArrayFromImage(image) == LIVER
    volume = Volume(np.where(is_liver, 60, -1000).astype(np.int16), spacing=image.GetSpacing())
    z = int(np.median(np.nonzero(is_liver)[0]))
    x = int(np.median(np.nonzero(is_liver[z])[1]))
    y = int(np.nonzero(is_liver[z, :, x])[0].min())
    front = tuple(index * side for index, side in zip((x, y, z), image.GetSpacing(), strict=True))
    return Scene(volume, [volume.threshold(0.0, 100.0, name="liver")]), front


def press(scene: Scene, front: tuple[float, float, float], depth: float, *, whole: bool) -> str:
    """Returns what is felt, how far the body is seen to move, and the answers of the model."""

    def before(millimetres: float) -> tuple[float, float, float]:
        return front[0], front[1] - BALL - millimetres, front[2]

    path = ScriptedPath(before(3.0)).move(before(0.2), seconds=0.2)
    for step in range(1, round(2.0 * depth) + 1):
        path = path.move(before(-0.5 * step), seconds=0.01).hold(0.02)
    still = path.duration
    with Session(scene, device=path.hold(STILL + 1.0), options=SessionOptions()) as session:
        session.settings(TouchSettings(probe_radius=BALL))
        session.set_material(1, "liver")
        session.set_deformation("lattice", ModelOptions(whole_segment=whole))
        force = float(np.linalg.norm(session.run(still + STILL).forces[-1]))
        boxes = session.whole_surfaces()["displaced"] or []
        answers = session.deformation()["answers"]
    behind = [np.abs(np.frombuffer(box["moved"], "<f2")).max() for box in boxes[1:]]
    seen = f", seen to move by {behind[0]:.2f} mm behind the box" if behind else ""
    rate = answers / (still + STILL)
    return f"{depth:g} mm: {force:.3f} N{seen}; {rate:.0f} answers a second"


def main(folder: Path) -> None:
    """Prints what is felt at two depths."""
    scene, front = liver(folder)
    for whole in (False, True):
        print("the whole segment behind the box" if whole else "the box alone")
        for depth in (4.0, 8.0):
            print(press(scene, front, depth, whole=whole))


if __name__ == "__main__":
    main(Path(sys.argv[1]))
