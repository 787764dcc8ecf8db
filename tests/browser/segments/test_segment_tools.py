"""Segments found and changed at the page: grown from a click, shaped, taken back."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
import SimpleITK
from browser import ROOT, Browser, browser, palpate
from palpate import read
from palpate.segmentation import changed_shape
from reference_head import small_head

pytestmark = pytest.mark.browser

OUTPUT = ROOT / "tests" / "output"
SIZE = {"width": 1366, "height": 768}
PLACE_OF_BALL = """(() => {
  const slice = window.palpate.slices.find(({ name }) => name === 'axial');
  const { plane, rect } = slice;
  const off = [34, 24, 24].map((c, axis) => c - plane.centre[axis]);
  const along = (axis) => off.reduce((sum, c, place) => sum + c * axis[place], 0) / plane.pixel;
  return [0.5 + along(plane.right) / rect.width, 0.5 - along(plane.up) / rect.height];
})()"""
"""Where (34, 24, 24), between core and border, is on the axial slice, in shares of its pane."""


PIXEL_OF_BALL = f"""(() => {{
  const [x, y] = {PLACE_OF_BALL};
  const box = document.querySelector('[data-testid=slice-axial]').getBoundingClientRect();
  return [box.left + x * box.width, box.top + y * box.height];
}})()"""
GROWN_VOLUME = "document.querySelector('[data-testid=grown-volume]')?.textContent"
REGION_IS_LISTED = (
    "[...document.querySelectorAll('[data-testid^=segment-]')]"
    ".some(({ textContent }) => /Region 2/.test(textContent))"
)
LEAST_LEVEL = "Number(document.querySelector('[data-testid=grown-level]').min)"


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    """A ball of 500 around a core of 900, and a small one, on the page."""
    path = tmp_path_factory.mktemp("found") / "balls.mha"
    z, y, x = np.indices((48, 48, 64))
    places = np.stack([x, y, z], axis=-1)
    values = np.zeros((48, 48, 64), np.int16)
    values[np.linalg.norm(places - (24, 24, 24), axis=-1) <= 16] = 500
    values[np.linalg.norm(places - (24, 24, 24), axis=-1) <= 6] = 900
    values[np.linalg.norm(places - (54, 24, 24), axis=-1) <= 4] = 500
    SimpleITK.WriteImage(SimpleITK.GetImageFromArray(values), str(path))
    with palpate("open", path, "--threshold", "250,600") as command, browser() as opened:
        assert opened.do("open", url=command.url, **SIZE)["firstPicture"] is not None
        yield opened


PAINTED_VOLUME = (
    "(([number, unit]) => Number(number) / (unit === 'ml' ? 1 : 1000))("
    "[...document.querySelectorAll('[data-testid^=segment-] .name')]"
    ".find(({ textContent }) => textContent.includes('Painted 1'))"
    ".querySelector('.volume').textContent.split(/\\s/))"
)
"""Of the segment that is painted [ml]."""

SHOWN_SIZE = "document.querySelector('[data-testid=segment-1] .size').textContent"


def test_a_surface_is_saved_and_says_what_it_keeps(page: Browser, tmp_path: Path) -> None:
    page.do("click", testid="shown-as-surface")
    page.wait("window.palpate.triangles[1] > 0")
    file = tmp_path / "surface.stl"
    page.do("download", testid="surface-save", path=str(file))
    page.wait("document.querySelector('[data-testid=surface-written]') !== null")
    told = page.do("text", testid="surface-written")["value"]
    # a ball around a cavity, and a small one
    assert re.fullmatch(
        r"[\w-]+\.stl: segment '\w+', \d+ triangles, [\d.]+ cm², 15\.\d ml in 2 bodies "
        r"\(voxels: 16\.\d ml in 2 bodies\), LPS",
        told,
    )
    assert f" {int.from_bytes(file.read_bytes()[80:84], 'little')} triangles" in told
    page.do("screenshot", path=str(OUTPUT / "surface_saved.png"))
    page.do("click", testid="shown-as-volume")
    page.finish()


def test_which_islands_stay_is_chosen_and_seen_before_the_others_go(page: Browser) -> None:
    page.do("clickText", text="Change shape")
    whole = page.read(SHOWN_SIZE)
    page.do("choose", testid="shape-kind", value="keep-largest")
    page.do("click", testid="shape-show")
    page.shows("islands", "/2 islands:/.test(text) && / ml, 2/.test(text)")
    page.shows("islands-bar", "text.includes('1 of 2 islands')")
    page.wait("document.querySelectorAll('[data-testid^=\"visible-\"]').length === 2")
    page.finish()
    page.do("screenshot", path=str(OUTPUT / "segment_islands.png"))
    assert page.read(SHOWN_SIZE) == whole
    # the least volume in place of the number; both are larger
    page.do("choose", testid="shape-kind", value="drop-small")
    page.do("fill", testid="shape-amount", text="0.1")
    page.shows("islands-bar", "text.includes('All 2 islands')")
    page.do("fill", testid="shape-amount", text="1")
    page.shows("islands-bar", "text.includes('1 of 2 islands')")
    page.do("press", key="Escape")
    page.wait("document.querySelectorAll('[data-testid^=\"visible-\"]').length === 1")
    assert page.read(SHOWN_SIZE) == whole

    page.do("click", testid="shape-show")
    page.do("click", testid="islands-remove")
    page.wait(f"{SHOWN_SIZE} !== {whole!r}")
    page.wait("document.querySelectorAll('[data-testid^=\"visible-\"]').length === 1")
    page.do("press", key="Control+z")
    page.wait(f"{SHOWN_SIZE} === {whole!r}")
    page.wait("document.querySelectorAll('[data-testid^=\"visible-\"]').length === 1")
    page.do("clickText", text="Change shape")


def test_shapes_change_by_one_step_of_undo(page: Browser) -> None:
    page.do("clickText", text="Change shape")
    sizes = [page.read(SHOWN_SIZE)]
    for kind in ("fill-holes", "grow"):
        page.do("choose", testid="shape-kind", value=kind)
        page.do("click", testid="shape-apply")
        page.wait(f"{SHOWN_SIZE} !== {sizes[-1]!r}")
        sizes.append(page.read(SHOWN_SIZE))
    page.finish()
    page.do("screenshot", path=str(OUTPUT / "segment_shape.png"))
    for size in reversed(sizes[:-1]):
        page.do("press", key="Control+z")
        page.wait(f"{SHOWN_SIZE} === {size!r}")


def show_again(page: Browser, found: str) -> None:
    """Loads the page anew, which has a region that waits for a decision too, and drops that."""
    page.read("void (window.__before = true, window.location.reload())")
    page.wait(f"window.__before === undefined && {GROWN_VOLUME} !== undefined")
    page.wait(f"{GROWN_VOLUME} !== {found!r}")
    page.finish()
    page.do("screenshot", path=str(OUTPUT / "segment_grown_again.png"))
    page.do("click", testid="grown-drop")
    page.wait(f"!{REGION_IS_LISTED}")
    if page.read("document.querySelector('[data-testid=grow-click]') === null"):
        page.do("click", testid="find-segments")


def test_a_pressed_region_is_shown_narrowed_and_kept_as_one_step(page: Browser) -> None:
    page.do("click", testid="find-segments")
    page.do("click", testid="layout-four")
    page.read("window.palpate.cross([24, 24, 24])")
    page.finish()
    page.do("click", testid="grow-click")
    # Escape means none
    page.do("press", key="Escape")
    page.wait("document.querySelector('[data-testid=grow-click]').ariaPressed === 'false'")
    page.do("click", testid="grow-click")
    place = page.read(PLACE_OF_BALL)
    page.do("clickAt", testid="slice-axial", x=place[0], y=place[1])
    page.wait(REGION_IS_LISTED)
    page.finish()
    page.do("screenshot", path=str(OUTPUT / "segment_grown.png"))

    # Escape drops it; pressed again, the slider and dragging make it less, and letting go keeps it
    page.do("press", key="Escape")
    page.wait(f"!{REGION_IS_LISTED}")
    page.do("click", testid="grow-click")
    page.do("clickAt", testid="slice-axial", x=place[0], y=place[1])
    page.shows("grown-volume", "/ml|mm/.test(text)")
    found = page.read(GROWN_VOLUME)
    page.do("slide", testid="grown-level", value=page.read(LEAST_LEVEL))
    page.wait(f"{GROWN_VOLUME} !== {found!r}")
    show_again(page, found)

    page.do("click", testid="grow-click")
    left, top = page.read(PIXEL_OF_BALL)
    page.do("point", x=left, y=top)
    page.do("mouse", down=True)
    page.shows("grown-volume", "/ml|mm/.test(text)")
    page.do("point", x=left - 120, y=top + 120)
    page.wait(f"{GROWN_VOLUME} !== {found!r}")
    page.do("mouse", down=False)
    page.wait("document.querySelector('[data-testid=grown-bar]') === null")
    # it is open and in sight; once it is taken back, the one before is open again
    page.wait(
        "(row => row !== undefined && row.classList.contains('open') &&"
        " row.getBoundingClientRect().top > 0 && row.getBoundingClientRect().top < innerHeight)"
        "([...document.querySelectorAll('[data-testid^=segment-]')]"
        ".find(({ textContent }) => /Region 2/.test(textContent)))"
    )
    page.finish()
    page.do("press", key="Control+z")
    page.wait(f"!{REGION_IS_LISTED}")
    page.wait("document.querySelector('[data-testid=segment-1]').classList.contains('open')")


def test_once_new_segments_are_gone_the_row_before_each_is_open_again(page: Browser) -> None:
    opened = "document.querySelector('[data-testid^=segment-].open')?.textContent ?? ''"
    place = page.read(PLACE_OF_BALL)
    for number in (2, 3):
        page.do("click", testid="grow-click")
        page.do("clickAt", testid="slice-axial", x=place[0], y=place[1])
        page.do("click", testid="grown-keep")
        page.wait(f"/Region {number}/.test({opened})")
    page.do("press", key="Control+z")
    page.wait(f"/Region 2/.test({opened})")
    page.do("press", key="Control+z")
    page.wait("document.querySelector('[data-testid=segment-1]').classList.contains('open')")


def test_a_region_is_kept_or_discarded_where_slices_alone_are_seen(page: Browser) -> None:
    page.do("choose", testid="layout-names", value="slices")
    page.read("window.palpate.cross([24, 24, 24])")
    page.finish()
    place = page.read(PLACE_OF_BALL)
    bar = "document.querySelector('[data-testid=grown-bar]')"
    statistics = "document.querySelector('[data-testid=show-statistics]').ariaPressed"
    if page.read("document.querySelector('[data-testid=grow-click]') === null"):
        page.do("click", testid="find-segments")
    # whether its button is what a person would hit
    reached = (
        "(button => { const { x, y, width, height } = button.getBoundingClientRect();"
        " return button.contains(document.elementFromPoint(x + width / 2, y + height / 2)); })"
    )
    for button in ("grown-drop", "grown-keep"):
        page.do("click", testid="grow-click")
        page.do("clickAt", testid="slice-axial", x=place[0], y=place[1])
        page.wait(f"{bar} !== null")
        page.frames()
        page.do("screenshot", path=str(OUTPUT / "segment_grown_slices.png"))
        assert page.read(f"{reached}(document.querySelector('[data-testid={button}]'))")
        # Enter on a button of the panel is that button's
        page.read("document.querySelector('[data-testid=show-statistics]').focus()")
        for pressed in ("true", "false"):
            page.do("press", key="Enter")
            page.wait(f"{statistics} === '{pressed}'")
        page.all_done()
        assert page.read(f"{bar} !== null")
        page.do("click", testid=button)
        page.wait(f"{bar} === null")
    page.wait(REGION_IS_LISTED)
    page.do("press", key="Control+z")
    page.wait(f"!{REGION_IS_LISTED}")
    page.do("click", testid="layout-four")


def test_classes_of_values_become_segments(page: Browser) -> None:
    page.do("choose", testid="otsu-classes", value="3")
    page.do("click", testid="otsu-make")
    page.wait(
        "[...document.querySelectorAll('[data-testid^=segment-]')]"
        ".some(({ textContent }) => /Otsu 3 of 3/.test(textContent))"
    )


def test_a_disc_is_painted_in_a_slice_taken_back_and_limited_to_values(page: Browser) -> None:
    page.do("click", testid="layout-four")
    page.read("window.palpate.cross([24, 24, 24])")
    page.finish()
    page.do("click", testid="paint-segments")
    page.do("click", testid="brush-new")
    page.wait(
        "[...document.querySelectorAll('[data-testid=brush-segment] option')]"
        ".some(({ selected, text }) => selected && text === 'Painted 1')"
    )
    page.do("slide", testid="brush-radius", value=6)
    radius = float(page.text("brush-radius-value").removesuffix(" mm"))
    pixel = page.read("window.palpate.slices.find(({ name }) => name === 'axial').plane.pixel")
    way, volume = round(12 / pixel), PAINTED_VOLUME

    def paint(x: float = 0, y: float = 0, *, hold: bool = False) -> None:
        """Drags by 12 mm around a point so far from the middle of the slice [mm]."""
        begin = [x / pixel - way / 2, y / pixel]
        options = {"x": way, "y": 0, "from": begin, "hold": hold}
        page.do("dragElement", testid="slice-axial", **options)

    def near(square: float) -> str:
        """Returns that so much is painted, within what voxels of 1 mm allow [mm²]."""
        return f"Math.abs({volume} * 1000 - {square}) < {0.06 * square + 4}"

    long = np.pi * radius**2 + 2 * radius * way * pixel
    paint()
    page.wait(near(long))
    page.finish()
    page.do("screenshot", path=str(OUTPUT / "segment_painted.png"))
    # one that is not let go is taken back by Escape, and leaves the first one
    paint(y=12, hold=True)
    page.wait(f"{volume} * 1000 > {1.3 * long}")
    page.do("press", key="Escape")
    page.do("release")
    page.wait(near(long))
    assert page.read("document.querySelector('[data-testid=brush-radius]') !== null")
    page.do("press", key="Control+z")
    page.wait(f"{volume} === 0")

    # the core of 900 has a radius of 6 mm, and nothing else its value
    page.do("click", testid="brush-within")
    page.do("fill", testid="brush-low", text="800")
    page.do("fill", testid="brush-high", text="1000")
    paint(x=-8)
    page.wait(near(np.pi * 36))
    page.do("click", testid="brush-erase")
    paint(x=-8)
    page.wait(f"{volume} === 0")
    page.do("press", key="Control+z")
    page.wait(near(np.pi * 36))


NUMBERS = (
    "[...document.querySelectorAll('[data-testid=statistics-table] tbody td:nth-child(2)')]"
    ".map(({ textContent }) => textContent)"
)


def test_statistics_stand_in_the_panel_and_follow_edits(page: Browser) -> None:
    page.do("click", testid="show-statistics")
    page.wait(f"{NUMBERS}.length > 5")
    before = page.read(NUMBERS)
    page.do("screenshot", path=str(OUTPUT / "segment_statistics.png"))
    # a newer segment is open
    page.read("document.querySelector('[data-testid=segment-1]:not(.open) .name')?.click()")
    page.frames()
    if page.read("document.querySelector('[data-testid=shape-kind]') === null"):
        page.do("clickText", text="Change shape")
    page.do("choose", testid="shape-kind", value="grow")
    page.do("click", testid="shape-apply")
    page.wait(f"{NUMBERS}[0] !== {before[0]!r} && {NUMBERS}[6] !== {before[6]!r}")
    page.do("press", key="Control+z")
    page.wait(f"JSON.stringify({NUMBERS}) === JSON.stringify({before})")
    page.do("click", testid="show-statistics")
    page.wait("document.querySelector('[data-testid=statistics]') === null")


def new_painted_segment(page: Browser) -> str:
    """Takes the brush and a new segment for it; returns what tells its volume [ml]."""
    page.do("click", testid="layout-four")
    page.read("window.palpate.cross([24, 24, 24])")
    page.finish()
    if page.read("document.querySelector('[data-testid=brush-new]') === null"):
        page.do("click", testid="paint-segments")
    before = page.read("document.querySelectorAll('[data-testid=brush-segment] option').length")
    page.do("click", testid="brush-new")
    page.wait(
        f"document.querySelectorAll('[data-testid=brush-segment] option').length === {before + 1}"
    )
    if page.read("document.querySelector('[data-testid=brush-low]') !== null"):
        page.do("click", testid="brush-within")
    page.do("click", testid="brush-paint")
    name = page.read(
        "document.querySelector('[data-testid=brush-segment]').selectedOptions[0].text"
    )
    return PAINTED_VOLUME.replace("Painted 1", name)


def click_in_slice(page: Browser, x: float, y: float) -> None:
    """Clicks in the axial slice, so far from its middle [mm]."""
    at = page.read(PLACE_OF_BALL.replace("34, 24, 24", f"{24 + x}, {24 + y}, 24"))
    page.do("clickAt", testid="slice-axial", x=at[0], y=at[1])


def test_outlines_follow_edges_by_wire_and_by_level_and_what_they_enclose_is_painted(
    page: Browser,
) -> None:
    volume = new_painted_segment(page)
    # the ball of 16 mm
    disc = np.pi * 16**2
    whole = f"Math.abs({volume} * 1000 - {disc}) < {0.08 * disc}"
    pieces = (
        "(document.querySelector('[data-testid=wire-set-axial]').getAttribute('d')"
        ".match(/M/g) ?? []).length"
    )

    # the wire, by four clicks
    page.do("click", testid="brush-way-wire")
    corners = [(16.0, 0.0), (0.0, 16.0), (-16.0, 0.0), (0.0, -16.0)]
    for count, corner in enumerate(corners):
        click_in_slice(page, *corner)
        page.wait(f"{pieces} === {count}")
    page.finish()
    page.do("screenshot", path=str(OUTPUT / "segment_wire.png"))
    page.do("press", key="Backspace")
    page.wait(f"{pieces} === 2")
    click_in_slice(page, *corners[3])
    page.wait(f"{pieces} === 3")
    page.do("press", key="Enter")
    page.wait(whole)
    page.do("press", key="Control+z")
    page.wait(f"{volume} === 0")

    # the level, by one
    page.do("click", testid="brush-way-level")
    click_in_slice(page, 16.0, 0.0)
    page.wait(whole)
    page.do("press", key="Control+z")
    page.wait(f"{volume} === 0")
    page.do("click", testid="brush-way-brush")


STEPS = (
    "[...document.querySelectorAll('[data-testid=steps-1] .what')]"
    ".map(({ textContent }) => textContent.trim()).join(', ')"
)


def apply_shape(page: Browser, kind: str, amount: float) -> None:
    """Applies a change of shape to the segment that is open."""
    page.do("choose", testid="shape-kind", value=kind)
    page.do("fill", testid="shape-amount", text=str(amount))
    page.do("click", testid="shape-apply")


def keep_largest(page: Browser) -> None:
    """Removes all islands of the segment that is open but the largest one."""
    page.do("choose", testid="shape-kind", value="keep-largest")
    page.do("click", testid="shape-show")
    page.do("click", testid="islands-remove")


@pytest.mark.long
def test_steps_follow_the_threshold_of_a_head(data_folder: Path, tmp_path: Path) -> None:
    head = tmp_path / "head.mha"
    image = small_head(data_folder / "cthead_stanford" / "CThead.mha")
    SimpleITK.WriteImage(image, str(head))
    with palpate("open", head, "--threshold", "330") as command, browser() as page:
        assert page.do("open", url=command.url, **SIZE)["firstPicture"] is not None
        volume = read(head)

        def voxels(low: float, *steps: tuple[str, float]) -> str:
            """Returns that the page tells the size of what operations make from scratch."""
            made = volume.threshold(low)
            for kind, amount in steps:
                made = changed_shape(made, kind, amount=amount)  # type: ignore[arg-type]
            digits = str(made.voxel_count)
            return f"{SHOWN_SIZE}.split('·')[1].replace(/\\D/g, '') === '{digits}'"

        page.do("clickText", text="Change shape")
        keep_largest(page)
        page.wait(f"{STEPS} === 'Keep largest islands'")
        apply_shape(page, "smooth", 3)
        page.wait(f"{STEPS} === 'Keep largest islands, Smooth'")
        page.wait(voxels(330, ("keep-largest", 1), ("smooth", 3)))
        page.finish()
        page.do("screenshot", path=str(OUTPUT / "segment_steps.png"))

        # the threshold, whose steps follow
        page.do("fill", testid="threshold", text="500")
        page.wait(voxels(500, ("keep-largest", 1), ("smooth", 3)))
        page.finish()
        page.do("screenshot", path=str(OUTPUT / "segment_steps_followed.png"))
        # the value of a step, in its place; its order; off; and all of it taken back
        page.do("fill", testid="step-amount-1", text="2.5")
        page.wait(voxels(500, ("keep-largest", 1), ("smooth", 2.5)))
        page.do("click", testid="step-up-1")
        page.wait(f"{STEPS} === 'Smooth, Keep largest islands'")
        page.wait(voxels(500, ("smooth", 2.5), ("keep-largest", 1)))
        page.do("click", testid="step-on-0")
        page.wait(voxels(500, ("keep-largest", 1)))
        page.do("click", testid="step-remove-1")
        page.wait(voxels(500))
        page.wait(f"{STEPS} === 'Smooth'")
        for _ in range(3):
            page.do("press", key="Control+z")
        page.wait(f"{STEPS} === 'Keep largest islands, Smooth'")
        page.wait(voxels(500, ("keep-largest", 1), ("smooth", 2.5)))
        page.do("press", key="Control+z")
        page.do("press", key="Control+z")
        page.wait(voxels(330, ("keep-largest", 1), ("smooth", 3)))
        page.wait("document.querySelector('[data-testid=threshold]').value === '330'")
