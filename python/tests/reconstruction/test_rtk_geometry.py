"""Geometry files of RTK: a ball comes back where RTK's own words put it; what cannot be is refused.

Projections, matrices and files are made by ``rtk_words``, from the documentation of RTK alone.
"""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
import palpate
import pytest
import SimpleITK
from palpate.base.errors import OptionError, VolumeFormatError
from palpate.cli.commands import run
from palpate.recipes.recipe import read_recipe
from palpate.reconstruction import read_geometry, reconstruct
from palpate.reconstruction.projections import stack_at
from palpate.reconstruction.request import ReconstructionRequest, grid_of
from palpate.reconstruction.scanner import Scanner, fitted_grid
from rtk_words import ball_images, matrix_of, write_geometry

needs_rtk = pytest.mark.skipif(
    find_spec("itk") is None, reason="RTK is not installed: pip install 'palpate[reconstruct]'"
)

BALL, RADIUS = (20.0, 30.0, 10.0), 8.0
"""To the left, the back and the head [mm]."""
PIXEL, SHAPE = (2.0, 2.0), (48, 96)
DISTANCES = {"SourceToIsocenterDistance": 400.0, "SourceToDetectorDistance": 600.0}


def circle(count: int = 60, **stated: float) -> list[dict[str, float]]:
    return [
        {"GantryAngle": 360.0 / count * number, **DISTANCES, **stated} for number in range(count)
    ]


def flexed() -> list[dict[str, float]]:
    """A machine that bends: each of the nine parameters changes with the angle."""
    found = circle()
    for number, stated in enumerate(found):
        turn = np.radians(stated["GantryAngle"])
        stated |= {
            "GantryAngle": (stated["GantryAngle"] + 40.0 + 2.0 * np.sin(7.0 * number)) % 360.0,
            "OutOfPlaneAngle": 2.0 * np.sin(turn),
            "InPlaneAngle": 3.0 * np.cos(turn),
            "SourceToIsocenterDistance": 400.0 + 8.0 * np.cos(turn),
            "SourceToDetectorDistance": 600.0 + 12.0 * np.sin(turn),
            "SourceOffsetX": 4.0 * np.sin(turn),
            "SourceOffsetY": -3.0,
            "ProjectionOffsetX": 5.0 + 2.0 * np.cos(turn),
            "ProjectionOffsetY": -4.0 * np.sin(turn),
        }
    return found


def middle_of(scan: palpate.Volume) -> Any:
    z, y, x = np.nonzero(scan.slope * scan.array + scan.intercept > -500.0)
    return scan.patient_from_grid @ [x.mean() + 0.5, y.mean() + 0.5, z.mean() + 0.5, 1.0]


# --- where things are ---------------------------------------------------------------------


@needs_rtk
@pytest.mark.parametrize("machine", [circle, flexed])
def test_a_ball_comes_back_where_it_was(
    machine: Callable[[], list[dict[str, float]]], tmp_path: Path
) -> None:
    stated = machine()
    images = ball_images(stated, BALL, RADIUS, pixel=PIXEL, shape=SHAPE)
    shared = ["SourceOffsetY"] if machine is flexed else list(DISTANCES)
    path = write_geometry(tmp_path / "geometry.xml", stated, shared=shared)
    scanner = read_geometry(path, pixel=PIXEL)
    scan = reconstruct(images, scanner, size=(48, 48, 24), voxel=(2.0, 2.0, 2.0))
    # a quarter of a voxel
    np.testing.assert_allclose(middle_of(scan)[:3], BALL, atol=0.5)
    values = scan.slope * scan.array + scan.intercept
    assert abs(float(np.median(values[values > -200.0]))) < 15.0


def test_parallel_beams_of_a_file_come_back_where_they_were(tmp_path: Path) -> None:
    # angles are stored from 0 to 360: these go through 0
    stated = [
        {
            "GantryAngle": (300.0 + 3.0 * number) % 360.0,
            "SourceToIsocenterDistance": 1000.0,
            "SourceToDetectorDistance": 0.0,
            "ProjectionOffsetX": 6.0,
            "ProjectionOffsetY": -5.0,
        }
        for number in range(120)
    ]
    images = ball_images(stated, BALL, RADIUS, pixel=PIXEL, shape=SHAPE)
    shared = ["SourceToIsocenterDistance", "ProjectionOffsetX", "ProjectionOffsetY"]
    path = write_geometry(tmp_path / "geometry.xml", stated, shared=shared)
    # RTK leaves out what is 0
    path.write_text(path.read_text().replace("<SourceToDetectorDistance>0<", "<InPlaneAngle>0<"))
    text = path.read_text().replace("</SourceToDetectorDistance>", "</InPlaneAngle>")
    path.write_text(text)
    scanner = read_geometry(path, pixel=PIXEL)
    assert scanner.beam == "parallel"
    scan = reconstruct(images, scanner, size=(48, 48, 24), voxel=(2.0, 2.0, 2.0))
    np.testing.assert_allclose(middle_of(scan)[:3], BALL, atol=0.5)


def test_views_project_a_point_to_where_the_words_do(tmp_path: Path) -> None:
    stated = flexed()
    scanner = read_geometry(write_geometry(tmp_path / "g.xml", stated), pixel=PIXEL)
    images = ball_images(stated[::20], BALL, 3.0, pixel=(0.25, 0.25), shape=(400, 800))
    left, back, head = BALL
    for view, image in zip(scanner.views[::20], images, strict=True):
        rows, columns = np.nonzero(image)
        u, v, depth = view.matrix @ [left, head, -back, 1.0]
        # the shadow of a ball is a little longer away from the middle
        seen = 0.25 * (columns.mean() - 399.5), 0.25 * (rows.mean() - 199.5)
        np.testing.assert_allclose([u / depth, v / depth], seen, atol=0.1)


EXAMPLE = """<?xml version="1.0"?>
<!DOCTYPE RTKGEOMETRY>
<RTKThreeDCircularGeometry version="3">
  <SourceToIsocenterDistance>1000</SourceToIsocenterDistance>
  <SourceToDetectorDistance>1536</SourceToDetectorDistance>
  <Projection>
    <GantryAngle>271.847274780273</GantryAngle>
    <ProjectionOffsetX>-117.056503295898</ProjectionOffsetX>
    <ProjectionOffsetY>-1.01195001602173</ProjectionOffsetY>
    <Matrix>
          -166.5093078829                   0   -1531.42837748039   -117056.503295898
        -1.01142410874151               -1536  0.0326206557691505   -1011.95001602173
       -0.999480303105996                   0  0.0322354417240802               -1000
    </Matrix>
  </Projection>
  <Projection>
    <GantryAngle>271.852905273438</GantryAngle>
    <ProjectionOffsetX>-117.056831359863</ProjectionOffsetX>
    <ProjectionOffsetY>-1.01187002658844</ProjectionOffsetY>
    <Matrix>
        -166.660129424325                   0   -1531.41199650136   -117056.831359863
        -1.01134095059569               -1536  0.0327174625589984   -1011.87002658844
       -0.999477130482326                   0  0.0323336611415466               -1000
    </Matrix>
  </Projection>
</RTKThreeDCircularGeometry>
"""
"""That of RTK's documentation, with a flat detector."""


def test_the_example_of_the_documentation_agrees_with_itself(tmp_path: Path) -> None:
    path = tmp_path / "example.xml"
    path.write_text(EXAMPLE)
    # two projections are no scan: that is found once both were held against their matrices
    with pytest.raises(VolumeFormatError, match=r"no projection within 360\.0 degrees"):
        read_geometry(path, pixel=PIXEL)
    path.write_text(EXAMPLE.replace("-1531.41199650136", "-1531.41399650136"))
    with pytest.raises(
        VolumeFormatError,
        match=r"example.xml, projection 2: Matrix has -1531\.414 in row 1, column 3, and the "
        r"angles and distances give -1531\.412; allowed: a difference of 0\.001$",
    ):
        read_geometry(path, pixel=PIXEL)


def test_a_detector_that_stands_aside_shows_as_far_as_its_longer_side(tmp_path: Path) -> None:
    path = write_geometry(tmp_path / "g.xml", circle(ProjectionOffsetX=60.0))
    grid = fitted_grid((60, *SHAPE), read_geometry(path, pixel=PIXEL))
    # 96 + 60 mm at the detector: the outermost ray passes the axis at 400 sin(atan(156 / 600))
    edge = grid.size[0] * grid.voxel[0]
    assert abs(edge - 2.0 * 400.0 * np.sin(np.arctan(156.0 / 600.0))) < grid.voxel[0]
    # as do options without a file
    same = Scanner(
        beam="cone",
        angles=[6.0 * number for number in range(60)],
        pixel=PIXEL,
        offset=(60.0, 0.0),
        source_to_axis=400.0,
        source_to_detector=600.0,
    )
    assert fitted_grid((60, *SHAPE), same) == grid


@needs_rtk
@pytest.mark.parametrize("aside", [-50.0, 50.0])
def test_a_detector_that_stands_aside_is_completed(aside: float, tmp_path: Path) -> None:
    # wider than what all projections show: 43 mm
    stated = circle(120, ProjectionOffsetX=aside)
    images = ball_images(stated, (0.0, 0.0, 0.0), 60.0, pixel=PIXEL, shape=(8, 96))
    scanner = read_geometry(write_geometry(tmp_path / "g.xml", stated), pixel=PIXEL)
    scan = reconstruct(images, scanner, size=(72, 72, 3), voxel=(2.0, 2.0, 2.0))
    y, x = np.indices((72, 72)) - 35.5
    values = (scan.slope * scan.array + scan.intercept)[1]
    np.testing.assert_allclose(values[np.hypot(2.0 * x, 2.0 * y) < 54.0], 0.0, atol=25.0)


@needs_rtk
def test_rtk_writes_what_is_read(tmp_path: Path) -> None:
    itk = import_module("itk")
    geometry = itk.RTK.ThreeDCircularProjectionGeometry.New()
    for stated in flexed():
        geometry.AddProjection(
            *(stated[name] for name in ("SourceToIsocenterDistance", "SourceToDetectorDistance")),
            *(stated[name] for name in ("GantryAngle", "ProjectionOffsetX", "ProjectionOffsetY")),
            *(stated[name] for name in ("OutOfPlaneAngle", "InPlaneAngle")),
            *(stated[name] for name in ("SourceOffsetX", "SourceOffsetY")),
        )
    path = tmp_path / "rtk.xml"
    itk.RTK.write_geometry(geometry, str(path))
    views = read_geometry(path, pixel=PIXEL).views
    for view, stated in zip(views, flexed(), strict=True):
        np.testing.assert_allclose(view.matrix, matrix_of(stated), atol=1e-6)


def test_all_that_every_projection_shows_is_reconstructed(tmp_path: Path) -> None:
    shape = (60, *SHAPE)
    plain = read_geometry(write_geometry(tmp_path / "g.xml", circle()), pixel=PIXEL)
    same = Scanner(
        beam="cone", angles=plain.angles, pixel=PIXEL, source_to_axis=400, source_to_detector=600
    )
    assert fitted_grid(shape, plain) == fitted_grid(shape, same)
    # source and detector stand aside: the axis is seen 5 mm off the detector's middle
    aside = write_geometry(
        tmp_path / "aside.xml", circle(SourceOffsetX=20.0, ProjectionOffsetX=-5.0)
    )
    assert fitted_grid(shape, read_geometry(aside, pixel=PIXEL)).size == (89, 89, 48)
    # where the images lie around another place
    moved = read_geometry(aside, pixel=PIXEL, offset=(-5.0, 0.0))
    assert fitted_grid(shape, moved).size == (94, 94, 48)
    assert fitted_grid(shape, same).size == (95, 95, 48)
    away = write_geometry(tmp_path / "away.xml", circle(ProjectionOffsetX=97.0))
    with pytest.raises(OptionError, match="projection 1 does not show the middle of the rotation"):
        fitted_grid(shape, read_geometry(away, pixel=PIXEL))


# --- what is refused ----------------------------------------------------------------------


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('version="3"', 'version="1"', "is of version '1'; allowed: 2 or 3, as RTK reads"),
        (' version="3"', "", "states no version; allowed: 2 or 3"),
        ("RTKThree", "RTKFour", "holds 'RTKFourDCircularGeometry'; allowed: an XML file of RTK"),
        ("<Matrix>", "<Matrix", r"g\.xml is no XML \(.*\); allowed: an XML file of RTK"),
        ("<GantryAngle>6<", "<GantryAngle>6°<", "projection 2: GantryAngle '6°' given; allowed: a"),
        ("<GantryAngle>6<", "<GantryAngle>nan<", "projection 2: GantryAngle 'nan' given"),
        ("<GantryAngle>6<", "<GantryAngle>6.1<", "projection 2: Matrix has .*; allowed: a diff"),
        ("<GantryAngle>6</GantryAngle>", "", "projection 2: GantryAngle is missing; allowed: one"),
        ("GantryAngle", "GantryAngel", r"'GantryAngel' is not known here \(did you mean 'GantryA"),
        ("<Matrix>", "<Matrix>7 ", "projection 1: Matrix of 13 numbers; allowed: 3 x 4"),
        ("<Matrix>", "<Matrix><Row>", "projection 1: 'Row' is not known here.*; allowed: GantryA"),
        (
            "<GantryAngle>0<",
            "<GantryAngle>5</GantryAngle><GantryAngle>0<",
            "projection 1: GantryAngle is stated twice; allowed: once",
        ),
        (
            "<Projection>",
            "<RadiusCylindricalDetector>600</RadiusCylindricalDetector><Projection>",
            "projection 1: RadiusCylindricalDetector 600 given; allowed: 0, as .* flat",
        ),
        (
            "<Projection>",
            "<CollimationVSup>90</CollimationVSup><Projection>",
            "projection 1: CollimationVSup '90' given; allowed: none, as pixels behind a jaw",
        ),
        (
            "<!DOCTYPE RTKGEOMETRY>",
            '<!DOCTYPE RTKGEOMETRY [<!ENTITY a "6">]>',
            "declares the entity 'a'; allowed: a file without entities",
        ),
        (
            "<!DOCTYPE RTKGEOMETRY>",
            '<!DOCTYPE RTKGEOMETRY [<!ENTITY a SYSTEM "file:///etc/hostname">]>',
            "declares the entity 'a'",
        ),
    ],
)
def test_what_a_file_cannot_say_is_refused(old: str, new: str, said: str, tmp_path: Path) -> None:
    path = write_geometry(tmp_path / "g.xml", circle(), shared=list(DISTANCES))
    text = path.read_text()
    assert old in text
    everywhere = old in {"RTKThree", "GantryAngle"}
    path.write_text(text.replace(old, new, -1 if everywhere else 1), "utf-8")
    with pytest.raises(VolumeFormatError, match=said) as refused:
        read_geometry(path, pixel=PIXEL)
    assert "\n" not in str(refused.value)


def test_a_file_without_projections_is_refused(tmp_path: Path) -> None:
    path = write_geometry(tmp_path / "g.xml", circle())
    path.write_text(path.read_text().split("  <Projection>")[0] + "</RTKThreeDCircularGeometry>")
    with pytest.raises(VolumeFormatError, match="describes no projections; allowed: one or more"):
        read_geometry(path, pixel=PIXEL)
    with pytest.raises(FileNotFoundError, match=r"none.xml does not exist; allowed: an XML file"):
        read_geometry(tmp_path / "none.xml", pixel=PIXEL)
    with path.open("wb") as file:
        file.truncate((1 << 25) + 1)
    with pytest.raises(VolumeFormatError, match="has 33554433 bytes; allowed: at most 33554432"):
        read_geometry(path, pixel=PIXEL)


@pytest.mark.parametrize("version", [2, 3])
def test_jaws_that_are_open_and_older_names_are_read(version: int, tmp_path: Path) -> None:
    path = write_geometry(tmp_path / "g.xml", circle(), version=version)
    text = path.read_text().replace("GantryAngle", "Angle")
    # the largest number, as RTK rounds it
    jaw = "<CollimationUInf>1.79769313486232e+308</CollimationUInf><Angle>6<"
    path.write_text(text.replace("<Angle>6<", jaw))
    assert len(read_geometry(path, pixel=PIXEL).views) == 60


@pytest.mark.parametrize(
    ("machine", "said"),
    [
        (circle(InPlaneAngle=90.0), "projection 1: InPlaneAngle 90 given; allowed: tilts of at m"),
        (circle(OutOfPlaneAngle=11.0), "projection 1: OutOfPlaneAngle 11 given; allowed: tilts"),
        (
            circle(SourceToIsocenterDistance=600.0),
            "SourceToIsocenterDistance 600 and .* 600 given; allowed: above 0, the axis nearer",
        ),
        (circle(SourceToDetectorDistance=-600.0), "SourceToDetectorDistance -600 given; allowed"),
        (circle()[:34], r"no projection within 162\.0 degrees; allowed: gaps of at most 20 over"),
        (
            [*circle()[:59], {**circle()[59], "SourceToDetectorDistance": 0.0}],
            "projection 60: a parallel beam among cone beams",
        ),
        (
            circle(SourceToDetectorDistance=0.0, InPlaneAngle=1.0),
            "projection 1: InPlaneAngle 1 with parallel beams given; allowed: 0, as each row",
        ),
        (
            [
                {**each, "SourceToDetectorDistance": 0.0, "ProjectionOffsetY": float(number > 4)}
                for number, each in enumerate(circle())
            ],
            "projection 6: ProjectionOffsetY 1 with parallel beams given; allowed: 0",
        ),
    ],
)
def test_what_cannot_be_reconstructed_from_is_refused(
    machine: list[dict[str, float]], said: str, tmp_path: Path
) -> None:
    path = write_geometry(tmp_path / "g.xml", machine)
    with pytest.raises(VolumeFormatError, match=said):
        read_geometry(path, pixel=PIXEL)


def test_a_detector_on_its_head_is_read(tmp_path: Path) -> None:
    path = write_geometry(tmp_path / "g.xml", circle(InPlaneAngle=180.0))
    assert read_geometry(path, pixel=PIXEL).views[0].in_plane == 180.0


# --- beside options and files -------------------------------------------------------------


@pytest.fixture
def projections(tmp_path: Path) -> Path:
    """Parallel projections of a ball and their geometry."""
    stated = circle(SourceToDetectorDistance=0.0)
    write_geometry(tmp_path / "geometry.xml", stated, shared=["SourceToIsocenterDistance"])
    images = ball_images(stated, BALL, RADIUS, pixel=PIXEL, shape=SHAPE).astype(np.float32)
    path = tmp_path / "projections.mha"
    SimpleITK.WriteImage(SimpleITK.GetImageFromArray(images), str(path))
    return path


COMMON = ["--beam", "parallel", "--pixel", "2,2", "--size", "24,24,12", "--voxel", "4,4,4"]


def test_the_command_takes_the_file(
    projections: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("palpate.reconstruction.reconstruction._has_rtk", lambda: False)
    out = projections.with_name("scan.nii.gz")
    xml = projections.with_name("geometry.xml")
    command = ["reconstruct", str(projections), "-o", str(out), "--geometry", str(xml), *COMMON]
    # what agrees may be given
    assert run([*command, "--zero", "front", "--offset", "0,0"]) == 0
    np.testing.assert_allclose(middle_of(palpate.read(out))[:3], BALL, atol=1.0)
    out.unlink()
    capsys.readouterr()
    for option, value in (
        ("--arc", "360"),
        ("--first-angle", "0"),
        ("--source-axis", "400"),
        ("--source-detector", "600"),
        ("--zero", "back"),
    ):
        assert run([*command, option, value]) == 2
        told = f"{option[2:]} given with a geometry file; allowed: one of them"
        assert told in capsys.readouterr().err
    assert run([*command[:5], str(xml.with_name("none.xml")), *COMMON]) == 2
    assert "none.xml does not exist" in capsys.readouterr().err


def asked(projections: Path, **given: Any) -> ReconstructionRequest:
    beam = given.pop("beam", "parallel")
    geometry = projections.with_name("geometry.xml")
    return ReconstructionRequest(beam=beam, pixel=PIXEL, geometry=geometry, **given)


def test_a_recipe_takes_the_file_and_checks_it(projections: Path) -> None:
    recipe = projections.with_name("recipe.yaml")
    text = """reconstruct:
  path: projections.mha
  beam: parallel
  pixel: [2, 2]
  geometry: geometry.xml
segment:
  - {threshold: -300, name: ball}
"""
    recipe.write_text(text)
    found, _ = read_recipe(recipe)
    assert found.reconstruct is not None
    assert found.reconstruct.geometry == projections.with_name("geometry.xml")
    for old, new, said in (
        ("geometry.xml", "none.xml", "recipe.yaml, line 5: .*none.xml does not exist"),
        ("  pixel", "  zero: back\n  pixel", "zero given with a geometry file; allowed: one of"),
        ("parallel", "cone", "beam cone given, and .*geometry.xml describes parallel beams"),
    ):
        recipe.write_text(text.replace(old, new))
        with pytest.raises(OptionError, match=said):
            read_recipe(recipe)


def test_a_file_of_other_projections_is_refused(projections: Path) -> None:
    stack = stack_at(projections)
    with pytest.raises(
        OptionError, match=r"beam cone given, and .* describes parallel beams; allo"
    ):
        grid_of(stack, asked(projections, beam="cone"))
    write_geometry(projections.with_name("geometry.xml"), circle(59))
    with pytest.raises(
        OptionError, match=r"geometry.xml describes 59 projections, and .*projections.mha holds 60;"
    ):
        grid_of(stack, asked(projections, beam="cone"))


def test_images_lie_where_their_file_places_them(projections: Path) -> None:
    stack = stack_at(projections)
    assert stack.middle is None
    image = SimpleITK.ReadImage(str(projections))
    image.SetSpacing((2.0, 2.0, 1.0))
    # the middle is at 4, -6
    image.SetOrigin((-91.0, -53.0, 0.0))
    SimpleITK.WriteImage(image, str(projections))
    stack = stack_at(projections)
    assert stack.middle == (4.0, -6.0)
    assert asked(projections).scanner(stack).offset == (4.0, -6.0)
    assert asked(projections, offset=(4.0, -6.0)).scanner(stack).offset == (4.0, -6.0)
    with pytest.raises(OptionError, match=r"offset 1,0 given, and .* its middle at 4,-6; allowed"):
        asked(projections, offset=(1.0, 0.0)).scanner(stack)
    # without a geometry file nothing is known of where 0 is
    assert ReconstructionRequest(beam="parallel", pixel=PIXEL).scanner(stack).offset == (0.0, 0.0)
    image.SetDirection((-1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0))
    SimpleITK.WriteImage(image, str(projections))
    with pytest.raises(OptionError, match="in which its columns and rows are turned; allowed with"):
        asked(projections).scanner(stack_at(projections))
