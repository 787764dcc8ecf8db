"""What segments are made of, from Python: materials by name or by constants, and zones."""

from __future__ import annotations

from pathlib import Path

import pytest
from made_gel import GEL, gel_scene
from palpate import protocol
from palpate.base.errors import OptionError
from palpate.server.messages.soft_tissue import material_of, wanted_material
from palpate.session.model_options import deformation_models, offered_models
from palpate.session.scripted_path import ScriptedPath
from palpate.session.session import Session, SessionOptions
from palpate.volumes.material import LinearMaterial, Material, Region, material_presets

OFFLINE = SessionOptions(real_time=False)
"""Every run of the same session gives the same."""


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
        Session(gel_scene(), device=ScriptedPath((24.0, 24.0, 30.0))) as session,
        pytest.raises(OptionError, match=message),
    ):
        session.set_regions(1, [region])


def test_regions_are_known_and_come_back_with_their_segment() -> None:
    whole, shared = Region("rigid"), Region("empty", shared_with=2)
    with Session(gel_scene(), device=ScriptedPath((24.0, 24.0, 30.0)), options=OFFLINE) as session:
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


def test_segments_say_what_they_are_made_of() -> None:
    with Session(gel_scene(), device=ScriptedPath((24.0, 24.0, 30.0))) as session:
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
    with Session(gel_scene(unit=""), options=OFFLINE) as session:
        refused = f"{name}.* not known to be HU; allowed: .* liver, .*`unit=HU`"
        with pytest.raises(OptionError, match=refused):
            session.set_material(1, material)
        assert session.segments()[0]["material"] is None
        session.set_material(1, "liver")
    with Session(gel_scene(), options=OFFLINE) as session:
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
    with Session(gel_scene(), device=ScriptedPath((24.0, 24.0, 30.0))) as session:
        with pytest.raises(OptionError, match=message):
            session.set_material(1, material)
        with pytest.raises(OptionError, match="segment 7"):
            session.set_material(7, "liver")
        with pytest.raises(OptionError, match='"jelly" given; allowed: lattice'):
            session.set_deformation("jelly")
