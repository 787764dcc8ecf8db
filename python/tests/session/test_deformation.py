"""Matter that gives way, from Python: materials, models, the force in a session and its replay."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from palpate import protocol
from palpate.base.errors import OptionError
from palpate.server.messages.soft_tissue import material_of, wanted_material
from palpate.session.edited_values import EditedValues
from palpate.session.model_options import ModelOptions, Prony, deformation_models, offered_models
from palpate.session.recording import Recording
from palpate.session.scripted_path import ScriptedPath
from palpate.session.session import Session, SessionOptions
from palpate.session.touch_settings import TouchSettings
from palpate.volumes.material import LinearMaterial, Material, Region, material_presets
from palpate.volumes.scene import Scene
from palpate.volumes.volume import Volume, VolumeTraits

TOP = 24.0
"""Upper end of the soft block [mm]."""
DEEP = 1.5
"""How far it is pressed [mm]."""
BALL = 3.0
"""Radius of the probe [mm]: soft tissue is pressed by no smaller one."""
OFFLINE = SessionOptions(real_time=False)
"""Every run of the same session gives the same."""
GEL = Material(young=2.0e4, poisson=0.45, friction=0.0)
"""Soft, and never breaks."""


def scene(unit: str = "HU") -> Scene:
    values = np.full((48, 48, 48), -1000, dtype=np.int16)
    values[: int(TOP)] = 50
    volume = Volume(values, spacing=(1.0, 1.0, 1.0), traits=VolumeTraits(unit=unit))
    return Scene(volume, [volume.threshold(0.0, 100.0, name="gel")])


def pressed(
    material: Material | LinearMaterial | str | None, model: str | None, *, locked: bool = False
) -> Recording:
    path = ScriptedPath((24.3, 24.4, TOP + BALL + 6.0))
    path = path.move((24.3, 24.4, TOP + BALL - DEEP), seconds=1.0)
    path = path.move((24.3, 24.4, TOP + BALL - DEEP), seconds=0.6)
    with Session(scene(), device=path, options=OFFLINE) as session:
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
    with Session(scene(), device=path, options=OFFLINE) as session:
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
    given = scene()
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

    with Session(scene(), device=path, options=OFFLINE) as session:
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
    with Session(scene(), device=ScriptedPath((24.0, 24.0, 30.0)), options=OFFLINE) as session:
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
        with Session(scene(), device=path, options=OFFLINE) as session:
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


@pytest.mark.parametrize(
    ("region", "message"),
    [
        (Region("soft"), '"soft" given; allowed: deformable, rigid, empty'),  # type: ignore[arg-type]
        (Region("rigid", box=((0, 0, 0), (1, 1, 1)), shared_with=1), "one of them"),
        (Region("rigid", shared_with=9), "segment 9"),
    ],
)
def test_what_is_no_region_is_refused(region: Region, message: str) -> None:
    with (
        Session(scene(), device=ScriptedPath((24.0, 24.0, 30.0))) as session,
        pytest.raises(OptionError, match=message),
    ):
        session.set_regions(1, [region])


def test_regions_are_known_and_come_back_with_their_segment() -> None:
    whole, shared = Region("rigid"), Region("empty", shared_with=2)
    with Session(scene(), device=ScriptedPath((24.0, 24.0, 30.0)), options=OFFLINE) as session:
        other = session.add_segment(session.segment(1))
        assert (session.regions(1), session.regions(other)) == ((), ())
        session.set_regions(1, [whole, shared])
        with pytest.raises(OptionError, match="segment 9"):
            session.set_regions(1, [Region("rigid", shared_with=9)])
        assert session.regions(1) == (whole, shared)
        session.remove_segment(1)
        session.run(0.1)
        assert session.undo()
        assert session.regions(1) == (whole, shared)
        made = session.add_segment(session.segment(other))
        session.set_regions(made, [whole])
        assert session.undo()
        # another change ends what redo could bring back: a new segment under its number has none
        session.fill_box(other, low=(0, 0, 0), high=(2, 2, 2), solid=False)
        again = session.add_segment(session.segment(other))
        assert (again, session.regions(again)) == (made, ())


def test_the_table_of_presets_is_that_of_the_code() -> None:
    page = (Path(__file__).parents[3] / "docs/understand/deformation.md").read_text()
    soft = [
        preset
        for preset in material_presets()
        if not preset.needs_hounsfield and preset.high.young < 1e7
    ]
    assert len(soft) == 13
    for preset in soft:
        young, poisson, density, fracture_energy, _, stiffening = preset.low
        low, high = preset.young_range
        assumed = ", assumed" if preset.source.endswith("assumed") else ""
        row = (
            f"| `{preset.name}` | {young / 1e3:g} | {low / 1e3:g} to {high / 1e3:g} "
            f"| {poisson:g} | {density / 1e3:g} | {fracture_energy:g}{assumed} "
            f"| {stiffening:g} |"
        )
        assert row in page, row


def test_materials_are_named_with_their_sources() -> None:
    presets = {preset.name: preset.source for preset in material_presets()}
    assert {"liver", "skin", "cortical-bone", "thesis-bone"} <= set(presets)
    assert all(presets.values())
    models = {model.name: model for model in offered_models()}
    assert list(models) == deformation_models()
    assert set(models) == {"lattice", "fcc-lj", "cuboid-lj", "global-lj"}
    assert [name for name, model in models.items() if model.bonded] == ["lattice"]
    # more would be cut off in the page's panel
    assert max(len(model.title) for model in models.values()) < 26
    assert models["lattice"].boxes == (9, 21, 41)
    assert models["lattice"].fades == ((0.01, 0.95), (0.01, 1000.0))
    assert models["lattice"].yields == (0.005, 0.5)
    assert (models["fcc-lj"].fades, models["fcc-lj"].yields) == (None, None)
    assert models["fcc-lj"].binding == (0.0, 0.0, 2.0)
    assert models["fcc-lj"].walls
    particles = {
        name: (model.layers, model.calibration, model.motion) for name, model in models.items()
    }
    assert particles == {
        "lattice": (None, False, False),
        "fcc-lj": (8, True, True),
        # it has no energy to be at rest in
        "cuboid-lj": (8, True, False),
        "global-lj": (None, True, False),
    }
    assert models["global-lj"].boxes is None
    assert models["global-lj"].binding == (0.01, 0.3, 2.0)
    bone = next(preset for preset in material_presets() if preset.name == "thesis-bone")
    # 5.28.3
    assert bone.needs_hounsfield
    assert (bone.low.young, bone.high.young) == pytest.approx((5e9, 21e9))


def pressing(deep: float = DEEP) -> Session:
    """A session that presses the gel for 1.6 s, and is away from it 0.6 s later."""
    path = ScriptedPath((24.3, 24.4, 30.0))
    path = path.move((24.3, 24.4, TOP - deep), seconds=1.0)
    path = path.move((24.3, 24.4, TOP - deep), seconds=0.6)
    path = path.move((24.3, 24.4, TOP + 20.0), seconds=0.4)
    path = path.move((24.3, 24.4, TOP + 20.0), seconds=0.6)
    session = Session(scene(), device=path, options=OFFLINE)
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
    moved = np.frombuffer(displaced["moved"], "<f2").reshape(-1, 4)
    assert not moved[:, 3].any()
    return float(np.abs(moved[:, :3]).max(initial=0.0))


def test_the_picture_is_told_where_matter_stands_while_it_is_pressed() -> None:
    with pressing() as session:
        told = displacements(session, 1.2)
        assert len(told) > 5
        assert tuple(told[-1]["size"]) == (21, 21, 21)
        assert len(told[-1]["moved"]) == 8 * 21**3
        # a hand that rests: what cannot be seen is not told
        last = displacements(session, 0.35)
        assert len(last) < 5
        # voxels have followed, and what they do not show yet is less than one of them
        assert 0.1 < farthest([*told, *last][-1]) <= 1.0
        # and nothing is left once it has gone
        after = displacements(session, 1.0)
        assert (tuple(after[-1]["size"]), after[-1]["moved"]) == ((0, 0, 0), b"")
        displaced = session.whole_surfaces()["displaced"]
        assert displaced is not None
        assert tuple(displaced["size"]) == (0, 0, 0)


def test_without_its_model_matter_stands_in_its_voxels_again() -> None:
    with pressing() as session:
        assert farthest(displacements(session, 1.3)[-1]) > 0.1
        session.set_deformation(None)
        told = displacements(session, 0.05)
        assert [tuple(each["size"]) for each in told] == [(0, 0, 0)]


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
    with Session(scene(), device=ScriptedPath((24.0, 24.0, 30.0)), options=OFFLINE) as session:
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
    with Session(scene(), device=ScriptedPath((24.0, 24.0, 30.0)), options=OFFLINE) as session:
        with pytest.raises(OptionError, match=message):
            session.set_deformation(model, options)
        assert session.deformation()["model"] is None


def held(model: str, options: ModelOptions, seconds: float = 1.55) -> float:
    """Returns the force [N] of the gel on a tool that presses it, so long after it sets out."""
    with pressing() as session:
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
    with Session(scene(), device=path, options=OFFLINE) as session:
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
    loose = held("fcc-lj", ModelOptions(edge=9))
    bound = held("fcc-lj", ModelOptions(edge=9, binding=1.0))
    # a spring as stiff as a link on each particle; by how much it counts depends on the dent
    assert bound > 1.1 * loose > 0.0


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


def test_segments_say_what_they_are_made_of() -> None:
    with Session(scene(), device=ScriptedPath((24.0, 24.0, 30.0))) as session:
        assert material_of(session.segments()[0]) is None
        session.set_material(1, "liver")
        liver = material_of(session.segments()[0])
        assert liver is not None
        assert liver.preset == "liver"
        assert liver.low.young == pytest.approx(5500.0)
        wanted = protocol.SetMaterial(
            1,
            None,
            protocol.Constants(7000.0, 0.3, 1000.0, None, friction=0.1, stiffening=3.0),
            undoable=True,
        )
        session.set_material(1, wanted_material(wanted))
        own = material_of(session.segments()[0])
        assert own is not None
        assert own.preset is None
        assert own.low == own.high
        assert (own.low.poisson, own.low.fracture_energy, own.low.stiffening) == (0.3, None, 3.0)
        session.set_material(1, wanted_material(protocol.SetMaterial(1, None, None, undoable=True)))
        assert material_of(session.segments()[0]) is None
        # each of them is a step of undo; what a page asks for by itself is none
        session.set_material(1, "fat", undoable=False)
        session.set_deformation("lattice")
        assert session.undo()
        assert session.deformation()["model"] is None
        assert session.undo()
        own = material_of(session.segments()[0])
        assert own is not None
        assert own.low.young == 7000.0


@pytest.mark.parametrize("material", ["thesis-bone", LinearMaterial((0.0, 900.0), GEL, GEL)])
def test_what_follows_hu_is_refused_where_values_are_not_known_to_be_hu(
    material: LinearMaterial | str,
) -> None:
    name = material if isinstance(material, str) else "LinearMaterial"
    with Session(scene(unit=""), options=OFFLINE) as session:
        refused = f"{name}.* not known to be HU; allowed: .* liver, .*`unit=HU`"
        with pytest.raises(OptionError, match=refused):
            session.set_material(1, material)
        assert session.segments()[0]["material"] is None
        session.set_material(1, "liver")
    with Session(scene(), options=OFFLINE) as session:
        session.set_material(1, material)
        assert session.segments()[0]["material"] is not None


@pytest.mark.parametrize(
    ("material", "message"),
    [
        ("cheese", 'material "cheese" given; allowed: thesis-bone,'),
        (Material(young=-1.0), "Young's modulus -1 Pa given"),
        (Material(young=1e4, poisson=0.5), "Poisson's ratio 0.5 given"),
        (LinearMaterial((60.0, 10.0), GEL, GEL), "intensities from 60 to 10 given"),
    ],
)
def test_what_is_no_material_is_refused(
    material: Material | LinearMaterial | str, message: str
) -> None:
    with Session(scene(), device=ScriptedPath((24.0, 24.0, 30.0))) as session:
        with pytest.raises(OptionError, match=message):
            session.set_material(1, material)
        with pytest.raises(OptionError, match="segment 7"):
            session.set_material(7, "liver")
        with pytest.raises(OptionError, match='"jelly" given; allowed: lattice'):
            session.set_deformation("jelly")
