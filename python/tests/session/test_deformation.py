"""Matter that gives way, from Python: materials, models, the force in a session and its replay."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from made_gel import GEL, TOP, gel_scene
from palpate.base.errors import OptionError
from palpate.session.edited_values import EditedValues
from palpate.session.model_options import ModelOptions, Prony
from palpate.session.recording import Recording
from palpate.session.scripted_path import ScriptedPath
from palpate.session.session import Session, SessionOptions
from palpate.session.touch_settings import TouchSettings
from palpate.volumes.material import LinearMaterial, Material, Region

DEEP = 1.5
"""How far it is pressed [mm]."""
BALL = 3.0
"""Radius of the probe [mm]: soft tissue is pressed by no smaller one."""
OFFLINE = SessionOptions(real_time=False)
"""Every run of the same session gives the same."""


def pressed(
    material: Material | LinearMaterial | str | None, model: str | None, *, locked: bool = False
) -> Recording:
    path = ScriptedPath((24.3, 24.4, TOP + BALL + 6.0))
    path = path.move((24.3, 24.4, TOP + BALL - DEEP), seconds=1.0)
    path = path.move((24.3, 24.4, TOP + BALL - DEEP), seconds=0.6)
    with Session(gel_scene(), device=path, options=OFFLINE) as session:
        session.settings(TouchSettings(probe_radius=BALL))
        session.set_material(1, material)
        session.set_deformation(model)
        session.set_locked(1, locked=locked)
        recording = session.run(1.5)
        answers = session.deformation()["answers"]
    assert (answers > 10) == (model is not None and material is not None and not locked)
    return recording


def test_soft_matter_pushes_less_than_hard_matter_and_as_its_stiffness_says() -> None:
    hard = pressed(None, None).forces[-1][2]
    soft = pressed(GEL, "lattice").forces[-1][2]
    stiffer = pressed(GEL._replace(young=4.0e4), "lattice").forces[-1][2]
    assert 0.0 < soft < 0.2 * hard
    # twice as stiff, less what the coupling gives way itself
    assert 1.7 < stiffer / soft < 2.05


def test_a_point_presses_soft_tissue_as_a_ball_and_hard_tissue_as_a_point() -> None:
    path = ScriptedPath((24.3, 24.4, TOP + BALL + 2.0))
    for depth in (2.0, 4.0, 6.0, 8.0):
        path = path.move((24.3, 24.4, TOP + BALL - depth), seconds=0.1)
        path = path.move((24.3, 24.4, TOP + BALL - depth), seconds=0.4)
    with Session(gel_scene(), device=path, options=OFFLINE) as session:
        assert session.frame()["probe_radius"] == 0.0
        session.set_material(1, GEL)
        session.set_deformation("lattice")
        forces = [session.run(0.5).forces[-1][2] for _ in range(4)]
        assert session.frame()["probe_radius"] == BALL
        # a point slipped between the nodes from 4 mm on, and felt nothing any more
        assert all(4.0 * less > more > 1.2 * less for less, more in pairwise(forces))
        session.set_deformation(None)
        session.run(0.1)
        assert session.frame()["probe_radius"] == 0.0


def test_files_hold_pressed_tissue_at_rest() -> None:
    path = ScriptedPath((24.3, 24.4, TOP + BALL + 6.0))
    path = path.move((24.3, 24.4, TOP + BALL - 3.0), seconds=1.0)
    path = path.move((24.3, 24.4, TOP + BALL - 3.0), seconds=0.6)
    given = gel_scene()
    values, mask = given.volume.array.copy(), next(iter(given)).segment.mask().copy()
    with Session(given, device=path, options=OFFLINE) as session:
        session.settings(TouchSettings(probe_radius=BALL))
        session.set_material(1, GEL)
        session.set_deformation("lattice")
        session.picture_changes()
        session.run(1.5)
        shown = EditedValues(values)
        for change in session.picture_changes():
            for box in change["voxels"]:
                if box["stored"] is not None:
                    shown.write(box["low"], box["high"], box["stored"])
        assert (shown.values != values).any()
        now = session.scene_now(shown.values)
        assert (now.volume.array == values).all()
        assert (next(iter(now)).segment.mask() == mask).all()


def test_what_is_locked_is_hard() -> None:
    hard = pressed(None, None).forces
    np.testing.assert_allclose(pressed(GEL, "lattice", locked=True).forces, hard, atol=1e-9)


def test_no_force_comes_before_the_matter_is_touched_and_none_pulls() -> None:
    recording = pressed(GEL, "lattice")
    assert recording.forces[:, 2].min() >= 0.0
    free = recording.devices[:, 2] > TOP + BALL + 2.0
    assert free.sum() > 200
    assert not recording.forces[free].any()


def test_a_session_with_soft_matter_is_replayed_to_the_bit() -> None:
    replayed = pressed(GEL, "lattice").replay()
    assert replayed.is_equal
    assert replayed.stopped == ""


def test_without_a_model_or_a_material_matter_is_hard() -> None:
    hard = pressed(None, None).forces
    assert np.array_equal(pressed(GEL, None).forces, hard)
    assert np.array_equal(pressed(None, "lattice").forces, hard)


def test_the_friction_of_a_material_holds_a_sliding_probe_back_and_is_replayed() -> None:
    path = ScriptedPath((14.3, 24.4, 30.0))
    path = path.move((14.3, 24.4, TOP - DEEP), seconds=0.3)
    path = path.move((34.3, 24.4, TOP - DEEP), seconds=1.2)

    def held(recording: Recording) -> float:
        along, _, up = recording.forces[-1]
        return float(-along / up)

    with Session(gel_scene(), device=path, options=OFFLINE) as session:
        assert held(session.run(0.6)) == pytest.approx(0.0, abs=0.01)
        session.set_material(1, GEL._replace(friction=0.5))
        rough = session.run(0.3)
        # a probe that slides is held by four fifths
        assert held(rough) == pytest.approx(0.4, abs=0.01)
        assert rough.replay().is_equal
        session.set_feel(1, friction_static=0.1, friction_kinetic=0.1)
        assert held(session.run(0.2)) == pytest.approx(0.1, abs=0.01)
        session.set_feel(1)
        assert session.undo()
        assert held(session.run(0.2)) == pytest.approx(0.0, abs=0.01)


def test_what_is_felt_of_soft_matter_can_be_chosen() -> None:
    with Session(gel_scene(), device=ScriptedPath((24.0, 24.0, 30.0)), options=OFFLINE) as session:
        assert session.deformation()["force_source"] == "matter"
        session.set_force_source("voxels")
        assert session.deformation()["force_source"] == "voxels"
        with pytest.raises(OptionError, match='"skin" given; allowed: matter, voxels'):
            session.set_force_source("skin")  # type: ignore[arg-type]
        assert session.deformation()["force_source"] == "voxels"


def test_a_dent_comes_back_and_parts_can_be_rigid() -> None:
    rigid = Region("rigid", box=((0, 0, 0), (48, 48, int(TOP) - 2)))
    path = ScriptedPath((24.3, 24.4, 30.0))
    path = path.move((24.3, 24.4, TOP - DEEP), seconds=1.0)
    path = path.move((24.3, 24.4, TOP - DEEP), seconds=0.5)
    path = path.move((24.3, 24.4, 34.0), seconds=0.7)
    forces, moved = [], []
    for regions, removed in (([], False), ([rigid], False), ([rigid], True)):
        with Session(gel_scene(), device=path, options=OFFLINE) as session:
            session.set_material(1, GEL)
            session.set_regions(1, regions)
            if removed:
                # the engine forgets them then, and is told again
                session.remove_segment(1)
                session.run(0.05)
                assert session.undo()
            session.set_deformation("lattice")
            forces.append(session.run(1.4).forces[-1][2])
            moved.append(session.deformation()["moved_voxels"])
            session.run(1.5)
            assert session.deformation()["moved_voxels"] == 0
    assert moved[0] > 0
    # two layers over what is rigid
    assert min(forces[1:]) > 1.2 * forces[0] > 0.0


def pressing(deep: float = DEEP) -> Session:
    """A session that presses the gel for 1.6 s, and is away from it 0.6 s later."""
    path = ScriptedPath((24.3, 24.4, 30.0))
    path = path.move((24.3, 24.4, TOP - deep), seconds=1.0)
    path = path.move((24.3, 24.4, TOP - deep), seconds=0.6)
    path = path.move((24.3, 24.4, TOP + 20.0), seconds=0.4)
    path = path.move((24.3, 24.4, TOP + 20.0), seconds=0.6)
    session = Session(gel_scene(), device=path, options=OFFLINE)
    session.set_material(1, GEL)
    session.set_deformation("lattice")
    session.picture_changes()
    return session


def displacements(session: Session, seconds: float) -> list[Any]:
    """Returns what the picture is told of where matter stands in so long."""
    session.run(seconds)
    changes = session.picture_changes()
    return [change["displaced"] for change in changes if change["displaced"] is not None]


def farthest(displaced: Any) -> float:
    moved = np.frombuffer(b"".join(box["moved"] for box in displaced), "<f2").reshape(-1, 4)
    assert not moved[:, 3].any()
    return float(np.abs(moved[:, :3]).max(initial=0.0))


def test_the_picture_is_told_where_matter_stands_while_it_is_pressed() -> None:
    with pressing() as session:
        told = displacements(session, 1.2)
        assert len(told) > 5
        (pressed,) = told[-1]
        assert tuple(pressed["size"]) == (21, 21, 21)
        assert len(pressed["moved"]) == 8 * 21**3
        # a hand that rests: what cannot be seen is not told
        last = displacements(session, 0.35)
        assert len(last) < 5
        # voxels have followed, and what they do not show yet is less than one of them
        assert 0.1 < farthest([*told, *last][-1]) <= 1.0
        # and nothing is left once it has gone
        after = displacements(session, 1.0)
        assert after[-1] == []
        assert session.whole_surfaces()["displaced"] == []


def test_without_its_model_matter_stands_in_its_voxels_again() -> None:
    with pressing() as session:
        assert farthest(displacements(session, 1.3)[-1]) > 0.1
        session.set_deformation(None)
        told = displacements(session, 0.05)
        assert told == [[]]


def test_the_parts_of_a_model_are_shown_on_request_alone() -> None:
    with pressing() as session:
        session.run(0.9)
        assert session.model_parts() is None
        session.show_model_parts(on=True)
        session.run(0.3)
        parts = session.model_parts()
        assert parts is not None
        strains = np.frombuffer(parts["strains"], np.int8)
        assert len(strains) == session.deformation()["nodes"] > 1000
        assert len(parts["places"]) == 6 * len(strains)
        # pressed under the tool
        assert strains.min() < -5
        assert session.model_parts() is None
        session.show_model_parts(on=False)
        session.run(0.1)
        assert session.model_parts() is None


def test_a_model_takes_the_boxes_that_it_offers() -> None:
    with Session(gel_scene(), device=ScriptedPath((24.0, 24.0, 30.0)), options=OFFLINE) as session:
        session.set_material(1, GEL)
        session.set_deformation("lattice", ModelOptions(edge=9))
        session.run(0.2)
        assert session.deformation()["options"] == ModelOptions(edge=9)
        with pytest.raises(OptionError, match="a box of 10 along each edge given for lattice"):
            session.set_deformation("lattice", ModelOptions(edge=10))
        with pytest.raises(OptionError, match="a box given for global-lj; allowed: none"):
            session.set_deformation("global-lj", ModelOptions(edge=9))
        assert session.deformation()["model"] == "lattice"


@pytest.mark.parametrize(
    ("model", "options", "message"),
    [
        ("lattice", ModelOptions(binding=0.5), "binding given for lattice; allowed: none"),
        ("lattice", ModelOptions(walls=True), "walls given for lattice; allowed: none"),
        ("fcc-lj", ModelOptions(binding=-0.5), "binding of -0.5 given for fcc-lj; allowed: 0 to 2"),
        ("global-lj", ModelOptions(walls=True), "walls given for global-lj; allowed: none"),
        (
            "fcc-lj",
            ModelOptions(whole_segment=True),
            "the whole segment given for fcc-lj; allowed: none",
        ),
        (
            "global-lj",
            ModelOptions(prony=Prony(0.5, 1.0)),
            "a force that fades given for global-lj",
        ),
        (
            "fcc-lj",
            ModelOptions(yield_strain=0.1),
            "a yield strain given for fcc-lj; allowed: none",
        ),
        (
            "lattice",
            ModelOptions(yield_strain=0.0),
            "a yield strain of 0 given for lattice; allowed: 0.005 to 0.5",
        ),
        ("fcc-lj", ModelOptions(layers=9), "layers of 9 given for fcc-lj; allowed: 1 to 8"),
        ("global-lj", ModelOptions(layers=2), "layers given for global-lj; allowed: none"),
        ("lattice", ModelOptions(calibration="young"), "calibration given for lattice"),
        ("cuboid-lj", ModelOptions(motion="fire"), "motion given for cuboid-lj; allowed: none"),
        (
            "fcc-lj",
            ModelOptions(calibration="cheese"),  # type: ignore[arg-type]
            'calibration "cheese" given; allowed: young, wave-speed',
        ),
        (
            "fcc-lj",
            ModelOptions(motion="clock"),  # type: ignore[arg-type]
            'motion "clock" given; allowed: scaled-time, fire',
        ),
        ("fcc-lj", ModelOptions(binding=float("nan")), "binding of NaN given"),
        ("lattice", ModelOptions(prony=Prony(1.0, 1.0)), "a share that fades of 1 given"),
        ("lattice", ModelOptions(prony=Prony(0.5, 0.0)), "a time of fading of 0 s given"),
    ],
)
def test_what_a_model_does_not_offer_is_refused(
    model: str, options: ModelOptions, message: str
) -> None:
    with Session(gel_scene(), device=ScriptedPath((24.0, 24.0, 30.0)), options=OFFLINE) as session:
        with pytest.raises(OptionError, match=message):
            session.set_deformation(model, options)
        assert session.deformation()["model"] is None


def held(model: str, options: ModelOptions, seconds: float = 1.55, deep: float = DEEP) -> float:
    """Returns the force [N] of the gel on a tool that presses it, so long after it sets out."""
    with pressing(deep) as session:
        session.set_deformation(model, options)
        session.run(seconds)
        return float(np.linalg.norm(session.deformation()["force"]))


def test_a_force_that_fades_is_felt_fading() -> None:
    fades = ModelOptions(prony=Prony(0.6, 0.2))
    # just pressed in, and half a second later
    elastic = [held("lattice", ModelOptions(), seconds) for seconds in (1.05, 1.55)]
    fading = [held("lattice", fades, seconds) for seconds in (1.05, 1.55)]
    assert abs(elastic[1] - elastic[0]) < 0.05 * elastic[0]
    # at once it is 1 / (1 - 0.6) = 2.5 times as stiff, but it fades while it is pressed in, too
    assert fading[0] > 1.2 * elastic[0]
    # two and a half time constants later: 92 % of what fades has faded
    assert fading[1] < 0.85 * fading[0]
    # as stiff as asked in the end, and no less
    assert fading[1] > 0.95 * elastic[1]


def test_what_yields_stays_dented_as_one_step_of_undo() -> None:
    path = ScriptedPath((14.3, 24.4, 30.0))
    path = path.move((14.3, 24.4, TOP - 2 * DEEP), seconds=1.0)
    path = path.move((34.3, 24.4, TOP - 2 * DEEP), seconds=2.0)
    path = path.move((34.3, 24.4, 34.0), seconds=0.7)
    with Session(gel_scene(), device=path, options=OFFLINE) as session:
        session.settings(TouchSettings(probe_radius=3.0))
        session.set_material(1, GEL)
        session.set_deformation("lattice", ModelOptions(yield_strain=0.05), undoable=False)
        whole = session.segment(1).mask()
        session.run(5.0)
        dented = session.segment(1).mask()
        changed = int((whole != dented).sum())
        # a groove of 20 mm, some voxels wide, without a break
        assert changed > 100
        assert not dented[int(TOP) - 1, 24, 14:35].any()
        now = session.deformation()
        assert now["moved_voxels"] == now["lasting_voxels"] > 0
        # it lasts, and is the only step beside the material
        session.run(1.0)
        assert np.array_equal(session.segment(1).mask(), dented)
        assert session.undo()
        session.run(0.2)
        assert np.array_equal(session.segment(1).mask(), whole)
        assert session.deformation()["moved_voxels"] == 0
        assert session.redo()
        session.run(0.2)
        assert np.array_equal(session.segment(1).mask(), dented)
        assert session.undo()
        assert session.undo()
        assert not session.undo()


def test_springs_to_where_particles_rest_make_them_stiffer() -> None:
    # a ball of 3 mm, 1 mm deep: deeper, the crystal slips, and each way to rest may end elsewhere
    loose = held("fcc-lj", ModelOptions(edge=9), deep=-2.0)
    bound = held("fcc-lj", ModelOptions(edge=9, binding=1.0), deep=-2.0)
    # a spring as stiff as a link on each particle
    assert bound > 1.5 * loose > 0.0


def test_layers_calibrations_and_motions_are_felt_in_a_session() -> None:
    def felt(**options: Any) -> float:
        # a ball of 3 mm, 1 mm deep; deeper, the crystal slips, and each way to rest may end in
        # another one
        with pressing(deep=-2.0) as session:
            session.set_deformation("fcc-lj", ModelOptions(edge=9, **options))
            session.run(1.55)
            now = session.deformation()
            assert now["options"] == ModelOptions(edge=9, **options)
            assert now["slips"] == 0
            assert session.undo()
            assert session.deformation()["options"] == ModelOptions()
            return float(np.linalg.norm(now["force"]))

    usual = felt()
    assert felt(layers=1, calibration="young", motion="scaled-time") == usual
    # the same rest, reached on other ways
    for options in ({"layers": 3}, {"motion": "fire"}):
        other = felt(**options)
        assert other != usual
        assert other == pytest.approx(usual, rel=0.002)
    # D is 2.36 times the usual with this ratio of Poisson; the coupling gives way to it
    assert 1.9 < felt(calibration="wave-speed") / usual < 2.36


@pytest.mark.long
def test_walls_keep_particles_out_of_empty_voxels() -> None:
    def highest(options: ModelOptions) -> float:
        with pressing() as session:
            session.set_deformation("fcc-lj", options)
            session.show_model_parts(on=True)
            session.run(1.5)
            parts = session.model_parts()
            assert parts is not None
            shares = np.frombuffer(parts["places"], "<u2").reshape(-1, 3) / 65535
            places = parts["origin"] + shares * parts["size"]
            return float(places[:, 2].max())

    # matter bulges beside the tool where it may; a wall is the face of the lattice's cells, half a
    # voxel below the top, and what rests below it may come up to it
    assert highest(ModelOptions()) > TOP
    assert highest(ModelOptions(walls=True)) < TOP - 0.25
