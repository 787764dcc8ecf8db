"""Matter that gives way, on the page in a real browser, on the liver of a real scan.

What stands beside its voxels is drawn where it stands, as a volume and as a surface: measured along
an outline of the liver, over many rows of pixels.
"""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path

import numpy as np
import pytest
import SimpleITK
from browser import ROOT, Browser, browser, palpate
from numpy.typing import NDArray
from palpate import protocol

pytestmark = [pytest.mark.browser, pytest.mark.data]

OUTPUT = ROOT / "tests" / "output"
LIVER = 6
"""Number of the liver in the label map."""
SIZE = {"width": 1000, "height": 480}
"""Low: each picture is drawn in software until it is as fine as it gets."""
MATTER = "window.palpate.state.matter"
ROWS = range(-130, -30)
"""Rows of pixels along which the outline is read, from the picture's middle: above the probe."""


@pytest.fixture(scope="module")
def liver(data_folder: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The liver of a real scan alone, in air, as soft at its border as scans are."""
    folder = data_folder / "amos_0336"
    labels = SimpleITK.ReadImage(str(folder / "labels_from_meshes.nii.gz"))
    mask = SimpleITK.GetArrayFromImage(labels) == LIVER
    around = [np.flatnonzero(mask.any(axis=axes)) for axes in ((1, 2), (0, 2), (0, 1))]
    box = tuple(slice(max(0, each[0] - 12), each[-1] + 13) for each in around)
    image = SimpleITK.GetImageFromArray(mask[box].astype(np.float32))
    image.SetSpacing(labels.GetSpacing())
    soft = SimpleITK.SmoothingRecursiveGaussian(image, 1.5 * labels.GetSpacing()[0])
    path = tmp_path_factory.mktemp("liver") / "liver.mha"
    SimpleITK.WriteImage(SimpleITK.Cast(soft * 1100.0 - 1000.0, SimpleITK.sitkInt16), str(path))
    return path


@pytest.fixture(scope="module")
def page(liver: Path) -> Iterator[Browser]:
    """The liver on the page, seen from before and drawn by the browser.

    Displacements that a test tells the page, the engine knows nothing of.
    """
    threshold = ("--unit", "HU", "--threshold=-450")
    with palpate("open", liver, *threshold) as command, browser(drawer="browser") as opened:
        assert opened.do("open", url=command.url, **SIZE)["firstPicture"] is not None
        opened.read("window.palpate.setView('A')")
        # a voxel is a few pixels then
        opened.do("wheel", y=-900)
        opened.finish()
        yield opened


def outline(picture: NDArray[np.float64]) -> NDArray[np.float64]:
    """Returns where the liver ends at the right in each of some rows [pixels]."""
    middle = picture.shape[0] // 2
    rows = picture[middle + ROWS.start : middle + ROWS.stop]
    # the ground is nearly black
    seen = rows.max(axis=-1) > 0.25
    return np.array([np.flatnonzero(row)[-1] + 1 for row in seen], np.float64)


def is_alike(one: NDArray[np.float64], other: NDArray[np.float64]) -> bool:
    """Says whether two pictures show the same, but for single pixels at edges."""
    differs = np.abs(one - other).max(axis=-1) > 0.1
    return float(differs.mean()) < 0.005


def tell(page: Browser, *displaced: protocol.Displaced) -> None:
    """Tells the page where matter stands, as the engine does."""
    changed = protocol.Changed(0, None, [], [], list(displaced))
    packed = list(protocol.encode_to_page(changed))
    page.read(f"window.palpate.receive(new Uint8Array({packed}))")


def standing(moved: tuple[float, float, float], page: Browser) -> protocol.Displaced:
    """Returns nodes around the whole scan that stand beside their places [mm], fading at its ends.

    The fade is far from the outline that is looked at.
    """
    dimensions = page.read("window.palpate.scan.dimensions")
    size = (17, 17, 17)
    texels = np.zeros((*size, 4), np.float16)
    texels[1:-1, 1:-1, 1:-1, :3] = moved
    x, y, z = (float(count) / 15.0 for count in dimensions)
    origin = (-0.5 * x, -0.5 * y, -0.5 * z)
    return protocol.Displaced(origin, (x, y, z), size, texels.tobytes())


@pytest.mark.long
@pytest.mark.parametrize("shown_as", ["volume", "surface"])
def test_matter_a_third_of_a_voxel_beside_its_voxels_is_seen_there(
    page: Browser, shown_as: str
) -> None:
    choice = f"document.querySelector('[data-testid=shown-as-{shown_as}]')"
    page.read(f"{choice}.click()")
    page.all_done()
    # until the surface is there, the voxels are seen
    there = "window.palpate.triangles[1] > 0" if shown_as == "surface" else "true"
    page.wait(f"{choice}.checked && {there}")
    still = page.picture(OUTPUT / f"matter_{shown_as}_still.png")
    spacing = page.read("window.palpate.scan.spacing[0]")
    # just inside of the outline
    x, y = float(outline(still)[len(ROWS) // 2]) - 4.0, still.shape[0] // 2 + ROWS[len(ROWS) // 2]
    edge = page.read(f"window.palpate.pick({x}, {y}).point")
    pixels_per_mm = 1.0 / page.read(f"window.palpate.pixelSizeAt({edge})")
    for voxels in (0.3, -0.3, 1.7):
        # seen from before, the patient's left (+x) is at the right
        tell(page, standing((voxels * spacing, 0.0, 0.0), page))
        moved = page.picture(OUTPUT / f"matter_{shown_as}_moved.png")
        pixels = float((outline(moved) - outline(still)).mean())
        seen = pixels / (spacing * pixels_per_mm)
        # a voxel is five pixels, and the outline is not all at one depth
        assert abs(seen - voxels) < 0.1 + 0.05 * abs(voxels), (seen, voxels)
    tell(page)
    assert is_alike(page.picture(OUTPUT / "matter_again.png"), still)


def test_constants_and_regions_are_chosen_and_taken_back(page: Browser) -> None:
    page.do("choose", testid="material-1", value="liver")
    page.shows("matter-1", "text.includes('1.06 g/cm³, tears at 164 J/m², friction 20 %')")
    page.do("click", testid="constants-1")
    assert "Roulot" in page.text("source-1")
    page.do("fill", testid="density-1", text="1.2")
    page.shows("source-1", "text.includes('your own')")
    page.do("fill", testid="fracture_energy-1", text="")
    page.shows("matter-1", "text.includes('1.2 g/cm³, never tears')")
    # what cannot be is refused beside its field, and the engine is not asked
    page.do("fill", testid="poisson-1", text="0.5")
    assert "it cannot be 0.5. Enter -0.99 to 0.499." in page.text("refused-1")
    page.do("screenshot", path=str(OUTPUT / "matter_constants.png"))
    for _ in range(2):
        page.do("press", key="Control+z")
    page.shows("source-1", "text.includes('Roulot')")
    page.shows("matter-1", "text.includes('5.50 kPa, ν 0.45, 1.06 g/cm³, tears at 164 J/m²')")
    page.do("click", testid="constants-1")

    # all of it hard, told in a line, and taken back
    page.do("click", testid="show-regions-1")
    page.do("click", testid="whole-1-rigid")
    page.shows("regions-1", "text === 'hard'")
    page.do("press", key="Control+z")
    page.wait("document.querySelector('[data-testid=whole-1-deformable]').checked")
    page.do("click", testid="show-regions-1")
    page.do("click", testid="reset-matter")
    page.wait(f"{MATTER}.model === null")


def test_a_segment_whose_name_tells_of_no_tissue_is_softened_by_two_clicks(page: Browser) -> None:
    asked = "document.querySelector('[data-testid=which-tissue-1]')"
    page.do("click", testid="soften-1")
    page.wait(f"{asked} !== null")
    # the first choice has the focus; Escape asks no more
    assert page.read("document.activeElement.dataset.testid") == "tissue-1-liver"
    page.do("screenshot", path=str(OUTPUT / "matter_which_tissue.png"))
    page.do("press", key="Escape")
    page.wait(f"{asked} === null")
    assert page.read("window.palpate.segments[0].material") is None

    page.do("click", testid="soften-1")
    page.do("click", testid="tissue-1-muscle")
    page.wait(f"{MATTER}.model === 'lattice'")
    page.wait("window.palpate.segments[0].material?.preset === 'muscle'")
    page.wait(f"{asked} === null")
    assert page.read("document.querySelector('[data-testid=soften-1]')") is None
    page.do("press", key="Control+z")
    page.wait("window.palpate.segments[0].material === null")
    page.do("click", testid="reset-matter")
    page.wait(f"{MATTER}.model === null")


def test_options_of_a_model_are_chosen_and_taken_back(page: Browser) -> None:
    page.do("choose", testid="material-1", value="liver")
    page.wait(f"{MATTER}.model === 'lattice'")
    # what is felt can be chosen, and what was usual comes back
    page.do("click", testid="matter-options")
    page.do("click", testid="force-source-voxels")
    page.wait(f"{MATTER}.force_source === 'voxels'")
    page.do("press", key="Control+z")
    page.wait(f"{MATTER}.force_source === 'matter'")
    page.do("slide", testid="matter-box", value=15)
    page.wait(f"{MATTER}.options.edge === 15")
    page.shows("matter-box-value", "!text.includes('usual')")
    page.do("click", testid="usual-options")
    page.wait(f"{MATTER}.options.edge === null")
    page.shows("matter-box-value", "text.includes('usual')")

    # a force that fades: each slider is one step of undo
    page.do("slide", testid="matter-fades", value=0.5)
    page.wait(f"{MATTER}.options.prony?.share === 0.5")
    page.do("slide", testid="matter-fades-in", value=3)
    page.wait(f"{MATTER}.options.prony?.time === 3")
    page.do("press", key="Control+z")
    page.wait(f"{MATTER}.options.prony?.time === 1")

    page.do("slide", testid="matter-yields", value=0.05)
    page.wait(f"{MATTER}.options.yield_strain === 0.05")
    page.shows("matter-yields-value", "text === 'beyond 5 %'")
    page.do("press", key="Control+z")
    page.wait(f"{MATTER}.options.yield_strain === null")
    page.shows("matter-yields-value", "text === 'never, usual'")
    page.do("click", testid="matter-options")
    page.do("click", testid="reset-matter")
    page.wait(f"{MATTER}.model === null")


def test_options_of_particles_are_chosen_and_taken_back(page: Browser) -> None:
    page.do("choose", testid="material-1", value="liver")
    page.wait(f"{MATTER}.model === 'lattice'")
    page.do("click", testid="matter-options")
    # another model offers other options
    page.do("choose", testid="deformation", value="fcc-lj")
    page.wait(f"{MATTER}.model === 'fcc-lj'")
    page.shows("matter-binding-value", "text === '0 %, usual'")
    page.do("slide", testid="matter-binding", value=0.5)
    page.wait(f"{MATTER}.options.binding === 0.5")
    page.do("click", testid="matter-walls")
    page.wait(f"{MATTER}.options.walls")
    page.do("slide", testid="matter-layers", value=3)
    page.wait(f"{MATTER}.options.layers === 3")
    page.shows("matter-layers-value", "text === '3'")
    page.do("click", testid="matter-calibration-wave-speed")
    page.wait(f"{MATTER}.options.calibration === 'wave-speed'")
    page.do("click", testid="matter-motion-fire")
    page.wait(f"{MATTER}.options.motion === 'fire'")
    chosen = "document.querySelector('[data-testid=matter-motion] .chosen').textContent.trim()"
    # also where it is taken back before the page has drawn it
    page.do("press", key="Control+z")
    page.wait(f"{MATTER}.options.motion === null")
    page.wait(f"{chosen} === 'Friction'")
    page.wait("document.querySelector('[data-testid=matter-motion-scaled-time]').checked")
    page.do("screenshot", path=str(OUTPUT / "matter_options_panel.png"))
    page.picture(OUTPUT / "matter_options.png")
    page.do("click", testid="usual-options")
    page.wait(f"!{MATTER}.options.walls && {MATTER}.options.binding === null")
    page.wait(f"{MATTER}.options.layers === null && {MATTER}.options.calibration === null")
    page.shows("matter-layers-value", "text === '1, usual'")

    # one without an energy has no FIRE
    page.do("choose", testid="deformation", value="cuboid-lj")
    page.wait(f"{MATTER}.model === 'cuboid-lj'")
    page.shows("matter-layers-value", "text === '1, usual'")
    page.wait("document.querySelector('[data-testid=matter-motion]') === null")
    page.do("click", testid="matter-options")
    page.do("click", testid="reset-matter")
    page.wait(f"{MATTER}.model === null")


def test_a_pressed_liver_gives_way_on_the_page_and_comes_back(page: Browser) -> None:
    tell(page)
    still = page.picture(OUTPUT / "matter_before.png")
    start = page.read("window.palpate.pick(...window.palpate.middle)")["point"]
    page.do("choose", testid="material-1", value="liver")
    page.wait(f"{MATTER}.model === 'lattice'")
    page.shows("matter-1", "text.includes('5.50 kPa, ν 0.45, 1.06 g/cm³, tears at 164 J/m²')")
    before = [start[0], start[1] - 6.0, start[2]]
    page.read(f"window.palpate.place({before})")
    page.all_done()
    page.read(f"window.palpate.hand({[start[0], start[1] + 3.0, start[2]]})")
    page.wait(f"Math.hypot(...{MATTER}.force) > 0.005 && window.palpate.displaced.length > 0")
    page.shows("matter-force", "parseFloat(text) > 0")
    page.shows("matter-rate", "parseFloat(text) > 0")
    # a hand that stands still feels tissue at rest
    page.wait(f"!{MATTER}.settling")
    page.shows("matter-force", "!text.includes('settling')")
    # its nodes on request
    page.do("click", testid="show-parts")
    page.wait("window.palpate.parts > 1000")
    page.do("screenshot", path=str(OUTPUT / "matter_nodes.png"))
    page.do("click", testid="show-parts")
    page.wait("window.palpate.parts === 0")
    page.do("screenshot", path=str(OUTPUT / "matter_pressed.png"))

    # away from it, and hard again: no trace
    page.read(f"window.palpate.place({before})")
    page.do("click", testid="reset-matter")
    page.wait(f"{MATTER}.model === null && window.palpate.displaced.length === 0", seconds=240)
    # above the probe, which stands elsewhere now
    above = slice(0, still.shape[0] // 3)
    assert is_alike(page.picture(OUTPUT / "matter_after.png")[above], still[above])
    assert page.complaints == []


def test_a_busy_computer_has_a_small_box_and_the_page_says_so(page: Browser) -> None:
    tell(page)
    start = page.read("window.palpate.pick(...window.palpate.middle)")["point"]
    page.do("choose", testid="material-1", value="liver")
    page.wait(f"{MATTER}.model === 'lattice'")
    page.read(f"window.palpate.place({[start[0], start[1] - 6.0, start[2]]})")
    page.all_done()
    with ExitStack() as stack:
        # the model then gets about a seventh of a core, and the box it has takes more than that
        for _ in range(6 * (os.cpu_count() or 1)):
            busy = subprocess.Popen([sys.executable, "-c", "while True: pass"])
            stack.callback(busy.wait)
            stack.callback(busy.kill)
        # each way is some answers' work, and a few slow ones are enough
        for way in range(40):
            depth = 1.0 + 3.0 * (way % 2)
            page.read(f"window.palpate.hand({[start[0], start[1] + depth, start[2]]})")
            page.read("new Promise((done) => setTimeout(done, 300))")
            if page.read(f"{MATTER}.small_box"):
                break
        page.shows("matter-small-box", "text.includes('less tissue')")
    page.read(f"window.palpate.place({[start[0], start[1] - 6.0, start[2]]})")
    page.do("click", testid="reset-matter")
    page.wait(f"{MATTER}.model === null", seconds=240)
    assert page.complaints == []


@pytest.mark.long
def test_matter_that_yields_keeps_its_dent_until_it_is_undone(page: Browser) -> None:
    tell(page)
    start = page.read("window.palpate.pick(...window.palpate.middle)")["point"]
    page.do("choose", testid="material-1", value="liver")
    page.wait(f"{MATTER}.model === 'lattice'")
    page.do("click", testid="matter-options")
    page.do("slide", testid="matter-yields", value=0.02)
    page.wait(f"{MATTER}.options.yield_strain === 0.02")
    page.do("slide", testid="radius", value=4)
    page.wait("Math.abs(window.palpate.state.probe_radius - 4) < 0.5")
    before = [start[0], start[1] - 10.0, start[2]]
    page.read(f"window.palpate.place({before})")
    page.all_done()
    still = page.picture(OUTPUT / "matter_whole.png")

    page.read(f"window.palpate.hand({[start[0], start[1] + 4.0, start[2]]})")
    # a ball of 4 mm, pressed 4 mm into liver, is pushed back by 0.05 to 0.1 N
    page.wait(f"Math.hypot(...{MATTER}.force) > 0.03")
    pressed = page.read(f"{MATTER}.answers")
    # until it rests: some 20 answers
    page.wait(f"{MATTER}.answers > {pressed + 40}")
    page.read(f"window.palpate.place({before})")
    page.wait(f"Math.hypot(...{MATTER}.force) === 0")
    lifted = page.read(f"{MATTER}.answers")
    page.wait(f"{MATTER}.answers > {lifted + 20}")
    page.all_done()
    dented = page.picture(OUTPUT / "matter_dented.png")
    # the dent is as large as the ball, 800 pixels here; single pixels at edges may differ
    assert np.sum(np.abs(dented - still).max(axis=-1) > 0.05) > 300

    page.do("press", key="Control+z")
    page.all_done()
    undone = page.picture(OUTPUT / "matter_undented.png")
    assert np.sum(np.abs(undone - still).max(axis=-1) > 0.05) < 30
    assert page.complaints == []


@pytest.mark.long
def test_the_engine_draws_a_pressed_liver_as_the_browser_does(page: Browser) -> None:
    tell(page)
    page.all_done()
    start = page.read("window.palpate.pick(...window.palpate.middle)")["point"]
    page.do("choose", testid="material-1", value="liver")
    page.wait(f"{MATTER}.model === 'lattice'")
    before = [start[0], start[1] - 10.0, start[2]]
    page.read(f"window.palpate.place({before})")
    page.all_done()
    page.draw_by("engine")
    still = page.picture(OUTPUT / "matter_surface_still.png")
    page.read(f"window.palpate.hand({[start[0], start[1] + 4.0, start[2]]})")
    page.wait(f"Math.hypot(...{MATTER}.force) > 0.005 && window.palpate.displaced.length > 0")
    pressed = page.read(f"{MATTER}.answers")
    # until it rests: some 20 answers
    page.wait(f"{MATTER}.answers > {pressed + 40}")
    # its surface has the dent too, and is as it was far from it
    dented = page.picture(OUTPUT / "matter_surface_dented.png")
    assert page.read("window.palpate.drawer.engine")
    other = np.abs(dented - still).max(axis=-1) > 0.05
    assert 300 < other.sum() < 0.2 * other.size

    page.read("document.querySelector('[data-testid=shown-as-volume]').click()")
    page.all_done()
    drawn = {}
    for drawer in ("engine", "browser"):
        page.draw_by(drawer)
        told = {"choice": drawer, "engine": drawer == "engine", "obstacle": None}
        assert page.read("window.palpate.drawer") == told
        # by software, beside the model that is at work
        page.wait("window.palpate.finished", seconds=300)
        drawn[drawer] = page.picture(OUTPUT / f"matter_by_{drawer}.png")
    assert page.read("window.palpate.displaced.length") > 0
    liver = drawn["browser"].max(axis=-1) > 0.25
    assert liver.mean() > 0.1
    off = np.abs(drawn["engine"] - drawn["browser"])[liver]
    assert off.mean() <= 4 / 255
    page.read(f"window.palpate.place({before})")
    page.do("click", testid="reset-matter")
    page.wait(f"{MATTER}.model === null", seconds=240)
    assert page.complaints == []
