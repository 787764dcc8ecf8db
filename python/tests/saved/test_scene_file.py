"""Scene files: what comes back from one, and what is refused."""

from __future__ import annotations

import json
import shutil
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import SimpleITK
from palpate.base.errors import SceneFormatError
from palpate.io.reading import read
from palpate.saved import scene_file
from palpate.saved.scene_file import open_scene, save_scene
from palpate.segmentation.segment_steps import HandEdit, SegmentSteps, ShapeStep
from palpate.session.model_options import ModelOptions, Prony
from palpate.session.session import Session, SessionOptions
from palpate.volumes.material import LinearMaterial, Material, Region
from palpate.volumes.scene import Scene
from palpate.volumes.second_scan import SecondScan
from palpate.volumes.volume import Volume

STANDING = SessionOptions(real_time=False)
REGIONS = [Region("rigid", shared_with=2), Region("empty", box=((1, 2, 3), (4, 5, 6)))]
CHOSEN = ModelOptions(edge=11, prony=Prony(0.4, 2.0), yield_strain=0.05)
FOLLOWS = LinearMaterial((0.0, 900.0), Material(young=4000.0), Material(young=9e6))
VIEW = {"camera": {"distance": 300.5}, "layout": "four"}


@pytest.fixture
def scan(tmp_path: Path) -> Path:
    """A scan of noise, where nothing is like anything else."""
    values = np.random.default_rng(7).integers(-1000, 2000, (20, 24, 28), np.int16)
    image = SimpleITK.GetImageFromArray(values)
    image.SetSpacing((0.7, 0.8, 2.5))
    path = tmp_path / "scans" / "noise.mha"
    path.parent.mkdir()
    SimpleITK.WriteImage(image, str(path))
    return path


def edited(volume: Volume) -> Session:
    """A session with a threshold, a mask, a moved object, edits and materials."""
    scene = Scene(volume, [volume.threshold(500.0, name="hard")])
    session = Session(scene, options=STANDING)
    mask = np.zeros(volume.shape, np.uint8)
    mask[4:9, 5:12, 6:14] = 1
    box = session.add_segment(volume.segment(mask, name="box"))
    session.fill_box(box, low=(7, 6, 5), high=(9, 8, 7), solid=False)
    pose = np.eye(4)
    pose[:3, 3] = (1.0, 2.0, 3.0)
    session.move_segment(box, pose)
    session.set_feel(box, stiffness=0.5)
    session.set_touchable(box, touchable=False)
    session.set_locked(box, locked=True)
    session.set_material(box, Material(young=5000.0, poisson=0.4, density=1000.0))
    session.set_material(1, FOLLOWS)
    lump = session.add_segment(volume.segment(mask, name="lump"))
    session.set_material(lump, "liver")
    session.set_deformation("lattice", CHOSEN)
    session.set_regions(1, REGIONS)
    session.set_force_source("voxels")
    return session


def state(session: Session) -> list[dict[str, Any]]:
    """What is known of segments, and their voxels."""
    known = ("id", "voxels", "touchable", "locked", "range", "made_by", "feel", "pose", "material")
    return [
        {name: value for name, value in each.items() if name in known}
        | {"mask": session.segment(each["id"]).mask().tolist()}
        for each in session.segments()
    ]


def same(one: Any, other: Any) -> bool:
    """Whether two things are equal; arrays by their elements."""
    return repr(one) == repr(other)


@pytest.mark.parametrize("copy", [False, True], ids=["linked", "copied"])
def test_a_scene_comes_back_as_it_was(scan: Path, tmp_path: Path, *, copy: bool) -> None:
    path = tmp_path / "scene.palpate"
    looks = b'[{"id": 1}]'
    with edited(read(scan, unit="HU")) as session:
        session.run(0.01)
        save_scene(path, session, looks=looks, view=VIEW, copy=copy)
        before, model = state(session), session.deformation()
        assert session.undo()
    if copy:
        shutil.rmtree(scan.parent)
    saved = open_scene(path)
    assert (saved.volume.name, saved.volume.unit) == ("noise", "HU")
    assert saved.view == VIEW
    assert json.loads(saved.looks) == json.loads(looks)
    with Session(Scene(saved.volume), options=STANDING) as session:
        saved.restore(session)
        session.run(0.01)
        assert same(state(session), before)
        assert session.deformation()["model"] == model["model"] == "lattice"
        assert session.deformation()["options"] == CHOSEN
        assert session.deformation()["force_source"] == "voxels"
        assert list(session.regions(1)) == REGIONS
        # what was done before it was saved is what there is
        assert not session.frame()["can_undo"]


def test_steps_of_segments_come_back_and_can_change(scan: Path, tmp_path: Path) -> None:
    path = tmp_path / "scene.palpate"
    grow = ShapeStep(kind="grow", amount=1.0)
    volume = read(scan)
    with Session(Scene(volume, [volume.threshold(1500.0)]), options=STANDING) as session:
        session.change_shape(1, grow)
        drawn = session.add_segment(volume.segment(volume.array > 1800, name="drawn"))
        session.change_shape(drawn, ShapeStep.with_other("unite", session.segment(1)))
        session.fill_box(1, low=(0, 0, 0), high=(28, 24, 3), solid=False)
        before = {number: session.steps(number) for number in (1, drawn)}
        save_scene(path, session)
    kept = before[1]
    assert kept is not None
    assert [type(step) for step in kept.steps] == [ShapeStep, HandEdit]
    saved = open_scene(path)
    with Session(Scene(saved.volume), options=STANDING) as session:
        saved.restore(session)
        assert {number: session.steps(number) for number in (1, drawn)} == before
        session.set_threshold(1, 1700.0, volume.range[1])
        cut = SegmentSteps((1700.0, volume.range[1]), kept.steps)
        assert session.steps(1) == cut
        assert not session.segment(1).mask()[:3].any()


def test_steps_that_are_damaged_are_told_of(scan: Path, tmp_path: Path) -> None:
    path = tmp_path / "scene.palpate"
    with edited(read(scan, unit="HU")) as session:
        session.change_shape(1, ShapeStep(kind="grow", amount=1.0))
        save_scene(path, session)
    with zipfile.ZipFile(path) as archive:
        members = {name: archive.read(name) for name in archive.namelist()}
    with zipfile.ZipFile(path, "w") as archive:
        for name, content in {**members, "steps.msgpack": b"damaged"}.items():
            archive.writestr(name, content)
    saved = open_scene(path)
    with (
        Session(Scene(saved.volume), options=STANDING) as session,
        pytest.raises(
            SceneFormatError, match=r"steps.msgpack is damaged: steps of segments cannot"
        ),
    ):
        saved.restore(session)


def test_a_scene_is_found_when_it_moves_with_its_scan(scan: Path, tmp_path: Path) -> None:
    with Session(Scene(read(scan)), options=STANDING) as session:
        save_scene(scan.parent / "scene.palpate", session)
    moved = tmp_path / "elsewhere"
    scan.parent.rename(moved)
    assert open_scene(moved / "scene.palpate").volume.name == "noise"
    (moved / "noise.mha").unlink()
    with pytest.raises(SceneFormatError, match=r"'noise' is not there any more.*allowed: put it"):
        open_scene(moved / "scene.palpate")


def test_a_scan_that_is_another_one_by_now_is_refused(scan: Path, tmp_path: Path) -> None:
    path = tmp_path / "scene.palpate"
    with Session(Scene(read(scan)), options=STANDING) as session:
        save_scene(path, session)
    image = SimpleITK.ReadImage(str(scan))
    image[3, 4, 5] = image[3, 4, 5] + 1
    SimpleITK.WriteImage(image, str(scan))
    with pytest.raises(SceneFormatError, match="is not as it was when the scene was saved"):
        open_scene(path)


def test_a_scene_that_cannot_be_written_leaves_the_one_before(
    scan: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "scene.palpate"
    with Session(Scene(read(scan)), options=STANDING) as session:
        save_scene(path, session)
        before = path.read_bytes()

        def full(*_: object, **__: object) -> None:
            raise OSError(28, "No space left on device")

        monkeypatch.setattr(zipfile.ZipFile, "write", full)
        with pytest.raises(OSError, match="No space left"):
            save_scene(path, session)
    assert path.read_bytes() == before
    assert sorted(each.name for each in tmp_path.iterdir()) == ["scans", "scene.palpate"]


def test_no_damage_goes_unseen(scan: Path, tmp_path: Path) -> None:
    path, damaged = tmp_path / "scene.palpate", tmp_path / "damaged.palpate"
    with edited(read(scan, unit="HU")) as session:
        save_scene(path, session, copy=True)
    whole = path.read_bytes()
    # every so many-th byte flipped, and the file cut there
    for place in range(0, len(whole), 997):
        flipped = bytearray(whole)
        flipped[place] ^= 0x55
        for given in (bytes(flipped), whole[:place]):
            damaged.write_bytes(given)
            try:
                saved = open_scene(damaged)
                with Session(Scene(saved.volume), options=STANDING) as session:
                    saved.restore(session)
                    # a byte that nobody reads, such as a date
                    assert len(session.segments()) == 3
            except SceneFormatError as error:
                assert "damaged.palpate" in str(error)  # noqa: PT017


def rewritten(path: Path, change: Callable[[dict[str, Any]], None]) -> None:
    """Changes what a scene's file says of itself."""
    with zipfile.ZipFile(path) as archive:
        members = {name: archive.read(name) for name in archive.namelist()}
    about = json.loads(members["scene.json"])
    change(about)
    members["scene.json"] = json.dumps(about).encode()
    write_members(path, members)


def older(scan: Path, folder: Path, of_before: Callable[[dict[str, Any]], None]) -> Path:
    """Saves an edited scene, and has its file say of itself what older ones did."""
    path = folder / "scene.palpate"
    with edited(read(scan, unit="HU")) as session:
        save_scene(path, session, copy=True)
    rewritten(path, of_before)
    return path


def write_members(path: Path, members: dict[str, bytes]) -> None:
    """Writes a scene's file of these."""
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in members.items():
            archive.writestr(name, content)


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        (lambda about: about.update(format="palpate-scene-9"), "allowed: 'palpate-scene-1'"),
        (lambda about: about.update(scan=3), "cannot be read"),
        (lambda about: about["scan"]["grid"].update(dimensions=[9, 9, 9]), "scan.i16 is damaged"),
        (lambda about: about["scan"]["grid"].update(spacing=[0, 1, 1]), "spacing"),
        (lambda about: about["scan"].update(hash="00"), "is not as it was"),
    ],
)
def test_what_a_scene_says_of_itself_is_checked(
    scan: Path, tmp_path: Path, change: Callable[[dict[str, Any]], None], reason: str
) -> None:
    path = tmp_path / "scene.palpate"
    with Session(Scene(read(scan)), options=STANDING) as session:
        save_scene(path, session, copy=True)
    rewritten(path, change)
    with pytest.raises(SceneFormatError, match=reason):
        open_scene(path)


def test_a_scene_of_before_options_has_its_box(scan: Path, tmp_path: Path) -> None:
    def of_before(about: dict[str, Any]) -> None:
        del about["options"]
        about["edge"] = 11

    saved = open_scene(older(scan, tmp_path, of_before))
    with Session(Scene(saved.volume), options=STANDING) as session:
        saved.restore(session)
        session.run(0.01)
        assert session.deformation()["options"] == ModelOptions(edge=11)


def test_the_strain_at_which_tissue_tore_in_older_scenes_becomes_the_energy_that_it_took(
    scan: Path, tmp_path: Path
) -> None:
    strain, never = 0.3, None

    def of_before(about: dict[str, Any]) -> None:
        assert about.pop("tears_by") == "energy"
        for each in about["materials"]:
            for constants in (each["constants"], each["high"]):
                if constants is not None:
                    constants[3] = strain
        about["materials"][1]["constants"][3] = never

    saved = open_scene(older(scan, tmp_path, of_before))
    with Session(Scene(saved.volume), options=STANDING) as session:
        saved.restore(session)
        found: list[Any] = [each["material"] for each in session.segments()]
    follows, uniform, preset = found
    # G = 4.5 μ h ε² of docs/understand/deformation.md, for bonds of h = 1 mm
    for end, young in (("low", 4000.0), ("high", 9e6)):
        shear = young / (2.0 * (1.0 + 0.45))
        assert follows[end][3] == pytest.approx(4.5 * shear * 0.001 * strain**2)
    assert uniform["low"] == pytest.approx((5000.0, 0.4, 1000.0, np.inf, 0.2, 0.0))
    # known by its name, so that it is what that is now
    assert preset["preset"] == "liver"


def test_the_stiffening_of_materials_comes_back_and_of_before_it_there_is_none(
    scan: Path, tmp_path: Path
) -> None:
    def of_before(about: dict[str, Any]) -> None:
        for each in about["materials"]:
            del each["stiffening"]

    def restored() -> list[float]:
        saved = open_scene(path)
        with Session(Scene(saved.volume), options=STANDING) as session:
            saved.restore(session)
            found: list[Any] = [each["material"] for each in session.segments()]
        ends = [material[end] for material in found[:2] for end in ("low", "high")]
        return [Material(*end).stiffening for end in ends]

    path = tmp_path / "scene.palpate"
    stiffened = Material(5e3, stiffening=6.0)
    with edited(read(scan, unit="HU")) as session:
        session.set_material(1, LinearMaterial((0.0, 900.0), Material(4e3), stiffened))
        session.set_material(2, stiffened)
        save_scene(path, session, copy=True)
    assert restored() == [0.0, 6.0, 6.0, 6.0]
    rewritten(path, of_before)
    assert restored() == [0.0, 0.0, 0.0, 0.0]


def test_options_of_particles_come_back_and_of_before_them_there_are_none(
    scan: Path, tmp_path: Path
) -> None:
    def of_before(about: dict[str, Any]) -> None:
        about["options"] = about["options"][:5]

    def restored() -> ModelOptions:
        saved = open_scene(path)
        with Session(Scene(saved.volume), options=STANDING) as session:
            saved.restore(session)
            session.run(0.01)
            options: ModelOptions = session.deformation()["options"]
            return options

    path = tmp_path / "scene.palpate"
    chosen = ModelOptions(edge=11, layers=3, calibration="wave-speed", motion="fire")
    with edited(read(scan, unit="HU")) as session:
        session.set_deformation("fcc-lj", chosen)
        save_scene(path, session, copy=True)
    assert restored() == chosen
    rewritten(path, of_before)
    assert restored() == ModelOptions(edge=11)
    rewritten(path, lambda about: about.update(options=[11, None, False, None, None, 3, "cheese"]))
    with pytest.raises(SceneFormatError, match="cannot be read"):
        open_scene(path)


@pytest.mark.parametrize("member", ["scene.json", "segments.journal"])
def test_a_member_that_is_too_large_is_not_unpacked(
    scan: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, member: str
) -> None:
    path = tmp_path / "scene.palpate"
    with Session(Scene(read(scan)), options=STANDING) as session:
        save_scene(path, session)
    monkeypatch.setattr(scene_file, "MOST_JSON_BYTES", 10_000)
    monkeypatch.setattr(scene_file, "MOST_SEGMENTS_BYTES", 10_000)
    open_scene(path)
    with zipfile.ZipFile(path) as archive:
        members = {name: archive.read(name) for name in archive.namelist()}
    members[member] = bytes(10_001)
    write_members(path, members)
    with pytest.raises(SceneFormatError, match=f"{member} is too large"):
        open_scene(path)


def with_second(scan: Path, second: Path) -> Scene:
    """A scan with another one beside it."""
    place = np.eye(4)
    place[:3, 3] = (3.0, -2.0, 1.0)
    scene = Scene(read(scan))
    scene.second = SecondScan(read(second), place)
    return scene


@pytest.fixture
def other(scan: Path) -> Path:
    """A second scan beside the first one's file."""
    image = SimpleITK.GetImageFromArray(np.arange(60, dtype=np.int16).reshape(3, 4, 5))
    path = scan.with_name("other.mha")
    SimpleITK.WriteImage(image, str(path))
    return path


@pytest.mark.parametrize("copy", [False, True], ids=["linked", "copied"])
def test_a_second_scan_comes_back_where_it_was(
    scan: Path, other: Path, tmp_path: Path, *, copy: bool
) -> None:
    path = tmp_path / "scene.palpate"
    with Session(with_second(scan, other), options=STANDING) as session:
        save_scene(path, session, copy=copy)
    if copy:
        shutil.rmtree(scan.parent)
    saved = open_scene(path)
    second = saved.scene().second
    assert second is not None
    assert second.volume.name == "other"
    np.testing.assert_array_equal(second.second_from_first[:3, 3], (3.0, -2.0, 1.0))
    np.testing.assert_array_equal(second.volume.array.ravel(), np.arange(60))
    assert saved.messages == saved.volume.warnings


def test_a_scene_without_its_second_scan_is_opened_and_says_so(
    scan: Path, other: Path, tmp_path: Path
) -> None:
    path = tmp_path / "scene.palpate"
    with Session(with_second(scan, other), options=STANDING) as session:
        save_scene(path, session)
    other.unlink()
    saved = open_scene(path)
    assert saved.scene().second is None
    (message,) = [sentence for sentence in saved.messages if sentence not in saved.volume.warnings]
    assert "the second scan is not shown" in message
    assert "'other' is not there any more" in message


def test_a_second_scan_of_no_file_goes_into_the_scene(scan: Path, tmp_path: Path) -> None:
    path = tmp_path / "scene.palpate"
    scene = Scene(read(scan))
    scene.second = SecondScan(Volume(np.ones((2, 3, 4), np.int16), spacing=(1.0, 1.0, 1.0)))
    with Session(scene, options=STANDING) as session:
        save_scene(path, session)
    with zipfile.ZipFile(path) as archive:
        assert archive.getinfo("second.i16").file_size == 48
        assert "scan.i16" not in archive.namelist()
    second = open_scene(path).second
    assert second is not None
    assert second.volume.array.sum() == 24


@pytest.mark.parametrize("kind", ["f4", "i4", "f8"])
def test_values_beyond_16_bits_come_back_with_their_scene(tmp_path: Path, kind: str) -> None:
    values = np.random.default_rng(5).choice([0.0007, 0.003, 70000.0, 2.0**25 + 1.0], (9, 8, 7))
    values = values.astype(kind)
    if kind == "f4":
        values[0, 0, :2] = np.nan
    scan = Volume(values, spacing=(1.0, 1.0, 2.0))
    scene = Scene(scan, [scan.threshold(1.0)])
    scene.second = SecondScan(scan)
    path = tmp_path / "kept.palpate"
    with Session(scene, options=STANDING) as session:
        save_scene(path, session)
    again = open_scene(path)
    assert again.second is not None
    for opened in (again.volume, again.second.volume):
        np.testing.assert_array_equal(opened.values(), scan.values())
        assert opened.values().dtype == scan.values().dtype
        np.testing.assert_array_equal(opened.array, scan.array)


def test_a_type_of_values_that_is_none_is_refused(tmp_path: Path) -> None:
    scan = Volume(np.random.default_rng(5).normal(size=(9, 8, 7)), spacing=(1.0, 1.0, 2.0))
    path = tmp_path / "kept.palpate"
    with Session(Scene(scan), options=STANDING) as session:
        save_scene(path, session)
    with zipfile.ZipFile(path) as archive:
        members = {name: archive.read(name) for name in archive.namelist()}
    members["scene.json"] = members["scene.json"].replace(b'"<f4"', b'"|O4"')
    with zipfile.ZipFile(path, "w") as archive:
        for name, content in members.items():
            archive.writestr(name, content)
    with pytest.raises(SceneFormatError, match=r"values of type '\|O4' given; allowed: \|u1, "):
        open_scene(path)
