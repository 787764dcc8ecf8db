"""What a click says, measurements, the palette of actions and both themes, in a real browser.

The oracle of values and lengths is SimpleITK, which reads the file itself.
"""

from __future__ import annotations

import csv
import io
import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import SimpleITK
from browser import Browser, browser, palpate
from numpy.typing import NDArray

pytestmark = [pytest.mark.browser, pytest.mark.data]

BONE = 1350
Vector = NDArray[np.float64]


@pytest.fixture(scope="module")
def scan(data_folder: Path) -> Path:
    """A head without a unit."""
    return data_folder / "cthead_stanford" / "CThead.mha"


@pytest.fixture(scope="module")
def image(scan: Path) -> Any:
    """The same as another program reads it."""
    return SimpleITK.ReadImage(str(scan))


@pytest.fixture(scope="module")
def opened(scan: Path) -> Iterator[Browser]:
    """The head on the page."""
    with palpate("open", scan, "--threshold", str(BONE)) as command, browser() as page:
        opening = page.do("open", url=command.url, width=1366, height=768)
        assert opening["firstPicture"] is not None
        page.read("window.palpate.setJitter(false)")
        yield page


@pytest.fixture
def page(opened: Browser) -> Iterator[Browser]:
    """The page in four panes, dark, without marks, nothing open."""
    opened.do("press", key="Escape")
    opened.do("click", testid="layout-four")
    opened.wait("window.palpate.slices.length === 3")
    opened.read("window.palpate.setView('A')")
    if opened.read("window.palpate.marks.length") > 0:
        act(opened, "Delete all marks")
    opened.wait("window.palpate.marks.length === 0")
    yield opened
    assert opened.complaints == []


def act(page: Browser, name: str) -> None:
    """Does an action by its name, as the palette finds it."""
    page.do("press", key="Control+k")
    page.do("type", text=name)
    page.do("press", key="Enter")
    page.wait("document.querySelector('[data-testid=palette]') === null")


def plane_of(page: Browser, name: str) -> dict[str, Any]:
    """Returns where a slice lies, and its pane."""
    found = page.read(f"window.palpate.slices.find(({{name}}) => name === {name!r})")
    return {**found["plane"], **found["rect"]}


def point_on(plane: dict[str, Any], x: float, y: float) -> Vector:
    """Returns the point of a slice at shares of its pane."""
    right, up = np.array(plane["right"]), np.array(plane["up"])
    across, upward = (x - 0.5) * plane["width"], (0.5 - y) * plane["height"]
    return np.asarray(np.array(plane["centre"]) + plane["pixel"] * (across * right + upward * up))


def place_in(text: str) -> Vector:
    """Returns the point that a place such as ``L 12.0  P 3.0  S 4.0 mm`` names."""
    found = re.findall(r"([LRPASI]) (\d+\.\d)", text)
    return np.array([float(number) * (1 if letter in "LPS" else -1) for letter, number in found])


def clipboard(page: Browser) -> str:
    """Returns what was copied, once the page says that it was."""
    page.wait("document.querySelector('.notice')?.textContent.includes('copied') === true")
    text = str(page.read("navigator.clipboard.readText()"))
    page.read("document.querySelectorAll('.notice button').forEach((each) => each.click())")
    return text


def test_a_click_says_what_is_there_and_where_and_how_much(page: Browser, image: Any) -> None:
    # a voxel of a slice, in the middle of one so that rounding means nothing
    page.do("clickAt", testid="slice-axial", x=0.5, y=0.4)
    point = place_in(page.text("picked-place"))
    expected = point_on(plane_of(page, "axial"), 0.5, 0.4)
    np.testing.assert_allclose(point, expected, atol=plane_of(page, "axial")["pixel"] + 0.1)
    value = float(page.text("picked-value").split()[0])
    index = np.array(image.TransformPhysicalPointToContinuousIndex(expected.tolist()))
    corners = {tuple(np.floor(index + shift).astype(int)) for shift in np.ndindex(2, 2, 2)}
    assert value in {image[tuple(map(int, corner))] for corner in corners}
    assert page.text("picked-name") == ("threshold" if value >= BONE else "No segment")

    # bone in the 3-D view: its surface is where the values between voxels reach the threshold
    page.do("clickAt", testid="canvas", x=0.5, y=0.5)
    page.wait("document.querySelector('[data-testid=picked-name]')?.textContent === 'threshold'")
    value = float(page.text("picked-value").split()[0])
    assert BONE <= value < BONE + 400
    picked = place_in(page.text("picked-place"))
    # places are written in tenths of a millimetre
    around = [
        image.EvaluateAtPhysicalPoint((picked + shift).tolist(), SimpleITK.sitkLinear)
        for shift in np.array(list(np.ndindex(3, 3, 3))) * 0.06 - 0.06
    ]
    assert min(around) - 2 <= value <= max(around) + 2
    page.do("click", testid="picked-copy")
    copied = clipboard(page)
    assert copied.startswith(f"threshold, {value:g}")
    assert copied.isascii(), "plain numbers, for a spreadsheet"
    page.do("click", testid="picked-cross")
    np.testing.assert_allclose(page.read("window.palpate.crosshair"), picked, atol=0.1)

    # a drag turns the picture and says nothing; Escape closes
    page.do("press", key="Escape")
    page.wait("document.querySelector('[data-testid=pick-card]') === null")
    page.do("drag", x=60, y=0)
    page.frames()
    assert page.read("document.querySelector('[data-testid=pick-card]')") is None


def test_distances_and_angles_are_set_dragged_and_taken_back(page: Browser) -> None:
    plane = plane_of(page, "coronal")
    page.do("press", key="m")
    page.do("clickAt", testid="slice-coronal", x=0.3, y=0.5)
    page.do("clickAt", testid="slice-coronal", x=0.7, y=0.4)
    page.wait("window.palpate.marks.length === 1")
    ends = [point_on(plane, 0.3, 0.5), point_on(plane, 0.7, 0.4)]
    # clicks are at whole pixels
    limit = 2 * plane["pixel"]
    long = float(np.linalg.norm(ends[1] - ends[0]))
    assert float(page.text("mark-value-1").removesuffix(" mm")) == pytest.approx(long, abs=limit)
    label = "mark-label-coronal-1"
    assert page.text(label) == page.text("mark-label-view-1") == page.text("mark-value-1")

    # the second end is dragged to the left: one step, which Ctrl+Z takes back
    before = page.read("window.palpate.marks")
    page.do("dragElement", testid="mark-coronal-1-1", x=-60, y=0)
    ends[1] -= 60 * plane["pixel"] * np.array(plane["right"])
    moved = float(np.linalg.norm(ends[1] - ends[0]))
    page.shows(label, f"Math.abs(parseFloat(text) - {moved}) < {limit}")
    dragged = page.read("window.palpate.marks")
    page.do("press", key="Control+z")
    assert page.read("window.palpate.marks") == before
    page.do("press", key="Control+Shift+z")
    assert page.read("window.palpate.marks") == dragged


def test_an_angle_is_set_on_what_is_seen_and_marks_are_a_table(page: Browser) -> None:
    page.do("press", key="Shift+M")
    width, height = (2 * middle for middle in page.read("window.palpate.middle"))
    seen = []
    # the vertex is the second point
    for x, y in ((0.4, 0.5), (0.5, 0.35), (0.6, 0.5)):
        picked = page.read(f"window.palpate.pick({x} * {width}, {y} * {height})")
        seen.append(np.array(picked["point"]))
        page.do("clickAt", testid="canvas", x=x, y=y)
    page.wait("window.palpate.marks.length === 1")
    points = np.array(page.read("window.palpate.marks[0].points"))
    # clicks are at whole pixels
    np.testing.assert_allclose(points, seen, atol=4)
    sides = points[[0, 2]] - points[1]
    cosine = sides[0] @ sides[1] / np.prod(np.linalg.norm(sides, axis=1))
    angle = float(np.degrees(np.arccos(cosine)))
    assert float(page.text("mark-label-view-1").removesuffix("°")) == pytest.approx(angle, abs=0.06)

    # named, hidden, copied, deleted
    page.do("press", key="b")
    page.do("clickAt", testid="slice-axial", x=0.5, y=0.5)
    page.do("fill", testid="mark-name-1", text='jaw, "upper"')
    page.do("click", testid="mark-visible-1")
    page.wait("document.querySelector('[data-testid=mark-label-view-1]') === null")
    page.do("click", testid="marks-copy")
    head, *rows = csv.reader(io.StringIO(clipboard(page)))
    assert head[:4] == ["name", "kind", "value", "unit"]
    assert [row[:2] for row in rows] == [['jaw, "upper"', "angle"], ["Point 1", "point"]]
    assert float(rows[0][2]) == pytest.approx(angle, abs=0.01)
    np.testing.assert_allclose(np.array(rows[0][4:13], float), points.ravel(), atol=0.01)
    page.do("click", testid="mark-delete-1")
    page.wait("window.palpate.marks.length === 1")


def values_inside(image: Any, kind: str, points: Vector) -> Vector:
    """Returns the file's values in an axial area: of the slice's voxels with centres inside."""
    values = SimpleITK.GetArrayFromImage(image)
    z = image.TransformPhysicalPointToIndex(points[0].tolist())[2]
    matrix = np.array(image.GetDirection()).reshape(3, 3) * image.GetSpacing()
    y, x = np.indices(values.shape[1:])
    centres = np.stack([x, y, np.full_like(x, z)], axis=-1) @ matrix.T + image.GetOrigin()
    shares = [
        (centres - points[0]) @ half / (half @ half)
        for half in (points[1] - points[0], points[2] - points[0])
    ]
    reach = np.hypot(*shares) if kind == "ellipse" else np.maximum(*np.abs(shares))
    return np.asarray(values[z][reach <= 1], np.float64)


def told_inside(page: Browser, number: int) -> list[float]:
    """Returns mean, SD, least and largest value as the list tells them of an area."""
    page.shows(f"mark-inside-{number}", "text.includes('mean')")
    text = page.text(f"mark-inside-{number}")
    return [float(figure) for figure in re.findall(r"-?\d+(?:\.\d+)?", text)]


def agrees(page: Browser, image: Any) -> None:
    """Checks what is told of the first mark, an area, by the values of the file."""
    mark = page.read("window.palpate.marks[0]")
    inside = values_inside(image, mark["kind"], np.array(mark["points"]))
    assert len(inside) > 100
    expected = [inside.mean(), inside.std(), inside.min(), inside.max()]
    # told with a digit after the point, and of an area that is measured anew after a moment
    page.shows("mark-inside-1", f"Math.abs(parseFloat(text.slice(5)) - {inside.mean()}) < 0.51")
    np.testing.assert_allclose(told_inside(page, 1), expected, rtol=1e-3, atol=0.6)


def test_an_area_tells_the_values_of_the_file_inside_it(page: Browser, image: Any) -> None:
    plane = plane_of(page, "axial")
    page.do("press", key="u")
    # the other buttons keep their meaning meanwhile, also between its corners
    page.do("clickAt", testid="slice-axial", x=0.4, y=0.4)
    window = "document.querySelector('[data-testid=window-axial]').textContent"
    before = page.read(window)
    page.do("dragElement", testid="slice-axial", x=60, y=30, button="right")
    page.wait(f"{window} !== {before!r}")
    page.do("press", key="Control+z")
    page.wait(f"{window} === {before!r}")
    page.do("press", key="Escape")
    page.do("press", key="u")
    page.do("dragElement", testid="slice-axial", **{"from": [-70, -40]}, x=110, y=60)
    page.wait("window.palpate.marks.length === 1")
    (mark,) = page.read("window.palpate.marks")
    assert mark["kind"] == "ellipse"
    points = np.array(mark["points"])
    # drags are of whole pixels
    size = np.pi * 55 * 30 * plane["pixel"] ** 2
    area = float(page.text("mark-value-1").removesuffix(" mm²"))
    assert area == pytest.approx(size, rel=0.05)

    agrees(page, image)
    assert page.text("mark-values-axial-1-0").startswith("mean")
    # it goes along slices only: no arrow key moves it in the 3-D view
    page.read("document.querySelector('[data-testid=mark-view-1-0]').focus()")
    page.do("press", key="ArrowRight")
    page.frames()
    assert page.read("window.palpate.marks[0].points") == mark["points"]
    page.do("press", key="Escape")

    now = "JSON.stringify(window.palpate.marks[0].points)"
    # made wider by its handle: one step, which Ctrl+Z takes back
    page.do("dragElement", testid="mark-axial-1-1", x=25, y=0)
    page.wait(
        "(([m, u]) => Math.hypot(...m.map((c, i) => c - u[i])))(window.palpate.marks[0].points)"
        f" > {np.linalg.norm(points[1] - points[0]) + 15 * plane['pixel']}"
    )
    agrees(page, image)
    page.do("press", key="Control+z")
    page.wait(f"{now} === JSON.stringify({mark['points']})")
    # moved as a whole by its middle
    page.do("dragElement", testid="mark-axial-1-0", x=-30, y=20)
    page.wait(f"{now} !== JSON.stringify({mark['points']})")
    moved = np.array(page.read("window.palpate.marks[0].points"))
    np.testing.assert_allclose(moved[1] - moved[0], points[1] - points[0], atol=1e-6)
    agrees(page, image)


def test_a_rectangle_is_set_by_two_clicks_and_is_there_again(page: Browser, image: Any) -> None:
    page.do("press", key="Shift+U")
    page.do("clickAt", testid="slice-axial", x=0.35, y=0.35)
    page.do("clickAt", testid="slice-axial", x=0.6, y=0.55)
    page.wait("window.palpate.marks.length === 1")
    assert page.read("window.palpate.marks[0].kind") == "rectangle"
    agrees(page, image)
    kept = page.read("window.palpate.marks")
    page.do("open", url=page.read("window.location.href"), width=1366, height=768)
    page.wait("window.palpate.marks.length === 1")
    assert page.read("window.palpate.marks") == kept
    agrees(page, image)


def test_marks_leave_as_csv_and_for_3d_slicer(page: Browser, image: Any, tmp_path: Path) -> None:
    page.do("clickAt", testid="slice-axial", x=0.45, y=0.4)
    picked = float(page.text("picked-value").split()[0])
    page.do("click", testid="picked-mark")
    page.do("press", key="m")
    page.do("clickAt", testid="slice-coronal", x=0.3, y=0.5)
    page.do("clickAt", testid="slice-coronal", x=0.7, y=0.4)
    page.do("press", key="u")
    page.do("dragElement", testid="slice-axial", **{"from": [-50, -30]}, x=90, y=50)
    page.wait("window.palpate.marks.length === 3")
    marks = page.read("window.palpate.marks")
    mean, _, least, most = told_inside(page, 3)

    told = page.do("download", testid="marks-save", path=str(tmp_path / "marks.csv"))
    assert told["name"] == "marks.csv"
    with (tmp_path / "marks.csv").open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert [row["kind"] for row in rows] == ["point", "distance", "ellipse"]
    assert float(rows[2]["mean"]) == pytest.approx(mean, abs=0.06)
    assert (float(rows[2]["min"]), float(rows[2]["max"])) == (least, most)

    told = page.do("download", testid="marks-slicer", path=str(tmp_path / "marks.mrk.json"))
    assert told["name"] == "marks.mrk.json"
    markups = json.loads((tmp_path / "marks.mrk.json").read_text(encoding="utf-8"))["markups"]
    assert [each["type"] for each in markups] == ["Fiducial", "Line", "ClosedCurve"]
    assert {each["coordinateSystem"] for each in markups} == {"LPS"}
    places = [[point["position"] for point in each["controlPoints"]] for each in markups]
    # in the frame in which another program has the file: it finds the value that the page shows
    np.testing.assert_allclose(places[0], marks[0]["points"], atol=1e-6)
    np.testing.assert_allclose(places[1], marks[1]["points"], atol=1e-6)
    assert image[image.TransformPhysicalPointToIndex(places[0][0])] == picked
    # the curve goes around the same area
    around = np.array(places[2])
    middle = np.array(marks[2]["points"][0])
    steps = np.roll(around, -1, axis=0) - around
    enclosed = np.linalg.norm(np.cross(around - middle, steps).sum(axis=0)) / 2
    told_area = float(rows[2]["value"])
    assert enclosed == pytest.approx(told_area, rel=0.01)


def test_the_palette_does_what_is_typed_and_says_what_it_is(page: Browser) -> None:
    page.do("click", testid="open-palette")
    field = "document.querySelector('[data-testid=palette-field]')"
    active = f"document.getElementById({field}.getAttribute('aria-activedescendant'))"
    assert page.read(f"document.activeElement === {field}")
    everything = page.read("document.querySelectorAll('[role=option]').length")
    assert everything > 40
    page.do("type", text="3-d view")
    page.wait(f"{active}?.textContent.includes('3-D view alone, with')")
    # the wheel of a list: from the first one up to the last, and down again to the second
    page.do("press", key="ArrowUp")
    assert "three slices" in page.read(f"{active}.textContent")
    page.do("press", key="ArrowDown")
    page.do("press", key="ArrowDown")
    assert page.read(f"{active}.getAttribute('aria-selected')") == "true"
    page.do("press", key="Enter")
    page.wait("window.palpate.slices.length === 0")
    assert page.read(field) is None

    # a key that the help tells does what it tells
    page.do("press", key="?")
    page.wait("document.querySelector('#help-title') !== null")
    assert "Ctrl + K" in page.read(
        "document.querySelector('[role=dialog][aria-modal]').textContent"
    )
    page.do("press", key="Escape")
    page.do("press", key="l")
    page.wait("window.palpate.slices.length === 1")


def test_what_panels_do_is_done_by_name_from_the_palette(page: Browser) -> None:
    act(page, "Oblique slice")
    page.wait("window.palpate.slices[0]?.name === 'oblique'")
    act(page, "3-D view with three slices")
    act(page, "Quality: Fine")
    page.finish()
    assert page.read("window.palpate.shown.stepsPerVoxel") == 2
    act(page, "Quality: Fast")

    # half of the picture is cut away, and comes back
    page.finish()
    middle = "(([x, y]) => window.palpate.pick(x, y)?.point)(window.palpate.middle)"
    before = page.read(middle)
    act(page, "Add a clip plane")
    page.finish()
    toward = page.read("window.palpate.camera.back")
    assert np.dot(np.subtract(before, page.read(middle)), toward) > 30
    act(page, "Clip nothing")
    page.finish()
    np.testing.assert_allclose(page.read(middle), before, atol=0.5)

    blend = "document.querySelector('[data-testid=blend]').value"
    assert page.read(blend) == "shaded"
    act(page, "Lighting on")
    assert page.read(blend) == "composite"
    act(page, "Lighting on")
    assert page.read(blend) == "shaded"

    segments = "document.querySelectorAll('[data-testid^=visible-]').length"
    count = page.read(segments)
    act(page, "Add a segment by threshold")
    page.wait(f"{segments} === {count + 1}")
    # until the engine's state tells of it, the last step is one of the page's own
    page.wait("window.palpate.state.can_undo")
    act(page, "Undo")
    page.wait(f"{segments} === {count}")

    # files are handed to the browser under their names
    page.read(
        "void (window.__kept = [],"
        " HTMLAnchorElement.prototype.click = function () { window.__kept.push(this.download) })"
    )
    act(page, "Save a picture")
    page.wait("window.__kept.length === 1", seconds=240.0)
    act(page, "Export: Segments for 3D Slicer")
    page.wait("window.__kept.length === 2", seconds=240.0)
    kept = page.read("window.__kept")
    assert kept[0].endswith(".png")
    assert kept[1].endswith(".seg.nrrd")


def test_view_slices_and_marks_follow_keys_alone(page: Browser) -> None:
    camera = page.read("window.palpate.camera")
    page.do("press", key="Shift+ArrowRight")
    turned = page.read("window.palpate.camera")
    # what is nearer goes to the right
    assert np.dot(turned["back"], camera["right"]) < -0.02
    np.testing.assert_allclose(turned["target"], camera["target"])
    page.do("press", key="Shift+PageUp")
    nearer = page.read("window.palpate.camera")
    assert nearer["distance"] < 0.99 * turned["distance"]
    page.do("press", key="Control+ArrowRight")
    moved = page.read("window.palpate.camera")
    assert np.dot(np.subtract(moved["target"], nearer["target"]), nearer["right"]) < -0.5
    assert moved["distance"] == nearer["distance"]

    # in a slice that has the focus the same keys move the slice
    page.do("clickAt", testid="slice-axial", x=0.45, y=0.5)
    place = plane_of(page, "axial")
    page.do("press", key="Control+ArrowLeft")
    page.do("press", key="+")
    after = plane_of(page, "axial")
    assert np.linalg.norm(np.subtract(after["centre"], place["centre"])) > 1
    assert after["pixel"] < place["pixel"]
    assert page.read("window.palpate.camera") == moved

    # a distance from the probe to the crosshair, a point at the crosshair
    page.do("press", key="Escape")
    proxy = page.settled()["proxy"]
    crosshair = page.read("window.palpate.crosshair")
    for key in ("m", "j", "Shift+J", "Shift+J"):
        page.do("press", key=key)
    page.wait("window.palpate.marks.length === 2")
    distance, point = page.read("window.palpate.marks")
    assert (distance["kind"], point["kind"]) == ("distance", "point")
    np.testing.assert_allclose(distance["points"], [proxy, crosshair], atol=0.05)
    np.testing.assert_allclose(point["points"], [crosshair], atol=1e-6)

    page.do("press", key="?")
    page.wait("document.querySelector('#help-title') !== null")
    told = page.read("document.querySelector('[role=dialog][aria-modal]').textContent")
    for text in ("Shift + arrows", "Ctrl + arrows", "Set a point at the probe"):
        assert text in told
    page.do("press", key="Escape")


def test_no_serious_fault_of_accessibility_in_either_theme(page: Browser) -> None:
    page.do("press", key="m")
    page.do("clickAt", testid="slice-axial", x=0.4, y=0.4)
    page.do("clickAt", testid="slice-axial", x=0.6, y=0.4)
    page.do("clickAt", testid="slice-axial", x=0.5, y=0.5)
    page.do("click", testid="tool-drill")
    # all that is folded is opened
    page.read(
        "document.querySelectorAll('aside [aria-expanded=false]').forEach((each) => each.click())"
    )
    grounds = []
    for theme in ("Theme: Light", "Theme: Dark"):
        act(page, theme)
        ground = "getComputedStyle(document.querySelector('aside')).backgroundColor"
        grounds.append(page.read(ground))
        assert faults(page) == []
        for key in ("Control+k", "?"):
            page.do("press", key=key)
            page.wait("document.querySelector('[role=dialog][aria-modal]') !== null")
            assert faults(page) == []
            page.do("press", key="Escape")
    page.do("click", testid="tool-none")
    assert grounds == ["rgb(246, 248, 250)", "rgb(19, 24, 31)"]


def faults(page: Browser) -> list[Any]:
    """Returns what axe finds that is serious or critical."""
    found = page.do("axe")["value"]
    return [fault for fault in found if fault["impact"] in {"serious", "critical"}]
