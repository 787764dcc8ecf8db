"""A pressed organ moves as a whole behind the box in which it deforms (thesis 5.29)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from palpate.session.model_options import ModelOptions
from palpate.session.scripted_path import ScriptedPath
from palpate.session.session import Session, SessionOptions
from palpate.session.touch_settings import TouchSettings
from palpate.volumes.phantom import phantom
from palpate.volumes.scene import Scene

OFFLINE = SessionOptions(real_time=False)
"""Every run of the same session gives the same."""


def test_the_liver_of_the_phantom_gives_as_a_whole_and_bone_holds_it() -> None:
    made = phantom((100, 70, 135), seed=3)
    volume = made.volume
    liver = made.part("liver")
    bone = volume.offered_bone()
    solid = liver.mask()
    # the front of the liver, in the middle of it
    z, x = (round(float(each.mean())) for each in np.nonzero(solid)[::2])
    y = int(np.flatnonzero(solid[z, :, x])[0])
    front = (volume.patient_from_grid @ (x + 0.5, y, z + 0.5, 1.0))[:3]

    def felt(*, whole: bool, scene: Scene) -> np.ndarray:
        def at(depth: float) -> tuple[float, float, float]:
            return (float(front[0]), float(front[1] - 6.0 + depth), float(front[2]))

        path = ScriptedPath(at(-10.0)).move(at(-2.0), seconds=0.3).move(at(8.0), seconds=0.5)
        with Session(scene, device=path.hold(3.0), options=OFFLINE) as session:
            session.settings(TouchSettings(probe_radius=6.0))
            session.set_material(1, "liver")
            session.set_deformation("lattice", ModelOptions(edge=11, whole_segment=whole))
            recording = session.run(2.8)
            assert session.deformation()["options"].whole_segment == whole
        forces: NDArray[np.float64] = np.linalg.norm(recording.forces, axis=1)
        # rest is rest
        assert np.ptp(forces[-500:]) < 0.01 * forces[-1]
        return forces

    alone, joined = (felt(whole=each, scene=Scene(volume, [liver])) for each in (False, True))
    # fat of 2 kPa, 20 mm thick, holds all of the liver by some N/mm, and the probe presses by 0.06:
    # it gives a little more than an endless body, by a few hundredths at most
    assert 0.95 * alone[-1] < joined[-1] < alone[-1]
    again = felt(whole=True, scene=Scene(volume, [liver]))
    np.testing.assert_array_equal(again, joined)
    held = felt(whole=True, scene=Scene(volume, [liver, bone]))
    assert held[-1] > 0.2 * alone[-1]
