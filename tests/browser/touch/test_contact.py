"""A real scan in a real browser: what is drawn, what is felt, and what is said when it fails.

The oracle is NumPy on the file itself: no code of Palpate takes part in what is expected.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from browser import ROOT, Browser, Command, browser, palpate
from numpy.typing import NDArray

pytestmark = pytest.mark.browser

OUTPUT = ROOT / "tests" / "output"
BONE = {"cthead_stanford/CThead.mha": 1350.0, "amos_0336/amos_0336.mhd": 250.0}

Points = NDArray[np.float64]


@dataclass(frozen=True)
class Oracle:
    """A scan as its file has it; axes along LPS."""

    values: NDArray[np.int16]
    """Shape [z, y, x]."""
    origin: Points
    spacing: Points
    bone: NDArray[np.bool_]

    def voxels_at(self, points: Points) -> NDArray[np.int64]:
        """Returns the voxel (x, y, z) of each point [mm]."""
        return np.floor((points - self.origin) / self.spacing + 0.5).astype(np.int64)

    def is_bone(self, point: Any) -> bool:
        """Says whether a point [mm] lies in a voxel of bone."""
        x, y, z = self.voxels_at(np.asarray(point, np.float64))
        inside = all(0 <= v < n for v, n in zip((z, y, x), self.bone.shape, strict=True))
        return inside and bool(self.bone[z, y, x])

    def surface(self) -> tuple[Points, Points]:
        """Returns the bone voxels with a free neighbour: middles [mm], unit normals; [n, 3]."""
        padded = np.pad(self.bone, 1)
        hidden = self.bone.copy()
        for axis in range(3):
            for shift in (-1, 1):
                hidden &= np.roll(padded, shift, axis)[1:-1, 1:-1, 1:-1]
        z, y, x = np.nonzero(self.bone & ~hidden)
        rising = np.gradient(self.values.astype(np.float32), *self.spacing[::-1])
        normals = -np.stack([along[z, y, x] for along in rising[::-1]], 1).astype(np.float64)
        lengths = np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-9)
        return np.stack([x, y, z], 1) * self.spacing + self.origin, normals / lengths


def oracle_of(path: Path, bone_from: float) -> Oracle:
    import SimpleITK

    image = SimpleITK.ReadImage(str(path))
    assert image.GetDirection() == (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)
    values = SimpleITK.GetArrayFromImage(image)
    return Oracle(
        values, np.array(image.GetOrigin()), np.array(image.GetSpacing()), values >= bone_from
    )


@dataclass(frozen=True)
class Opened:
    """A scan on the page."""

    page: Browser
    command: Command
    oracle: Oracle
    name: str


@pytest.fixture(scope="module", params=BONE, ids=["cthead", "amos"])
def opened(request: pytest.FixtureRequest, data_folder: Path) -> Iterator[Opened]:
    """A real CT, opened by the command line in a browser."""
    path, bone_from = data_folder / request.param, BONE[request.param]
    with palpate("open", path, "--threshold", str(bone_from)) as command, browser() as page:
        assert page.do("open", url=command.url)["firstPicture"] is not None
        yield Opened(page, command, oracle_of(path, bone_from), path.stem)


# --- what is drawn --------------------------------------------------------------------


CELL = 4
"""Pixels along a cell in which pictures are compared: single pixels and noise do not count."""


def expected_light(page: Browser, oracle: Oracle, shape: tuple[int, ...]) -> Points:
    """Returns how bright bone is expected in each cell, by the page's camera and a headlight."""
    camera = page.read("window.palpate.camera")
    right, up, back = (np.array(camera[axis]) for axis in ("right", "up", "back"))
    points, normals = oracle.surface()
    offset = points - np.array(camera["target"])
    size = 2 * (camera["distance"] - offset @ back) * np.tan(camera["field"] / 2) / shape[0]
    column = ((shape[1] / 2 + offset @ right / size) // CELL).astype(int)
    row = ((shape[0] / 2 - offset @ up / size) // CELL).astype(int)
    light = np.zeros((shape[0] // CELL, shape[1] // CELL))
    inside = (row >= 0) & (row < light.shape[0]) & (column >= 0) & (column < light.shape[1])

    # from far to near, so that what is in front stays
    order = np.argsort(offset @ back)
    order = order[inside[order]]
    light[row[order], column[order]] = 0.2 + 0.8 * np.abs(normals[order] @ back)
    return light


def coarse(pixels: Points) -> Points:
    """Averages the cells of a picture."""
    height, width = (length // CELL for length in pixels.shape)
    cells = pixels[: height * CELL, : width * CELL].reshape(height, CELL, width, CELL)
    return np.asarray(cells.mean(axis=(1, 3)), np.float64)


def likeness(one: Points, other: Points) -> float:
    """Returns the correlation of two pictures."""
    return float(np.corrcoef(one.ravel(), other.ravel())[0, 1])


@pytest.mark.data
@pytest.mark.parametrize("letter", ["A", "L"])
def test_the_bones_of_the_file_are_what_is_bright_in_the_picture(
    opened: Opened, letter: str
) -> None:
    opened.page.read(f"window.palpate.setView({letter!r})")
    pixels = opened.page.picture(OUTPUT / f"{opened.name}_{letter}.png")

    # bone is ivory: as blue as soft tissue never is
    bright = coarse(pixels[..., 2])
    expected = expected_light(opened.page, opened.oracle, pixels.shape)

    # soft tissue and the light's direction are not expected exactly; a picture that is
    # mirrored, upside down or of something else is far less like it
    found = likeness(bright, expected)
    assert found > 0.6, found
    assert found > likeness(bright, expected[::-1]) + 0.03
    # a trunk seen from before is nearly its own mirror image: 0.03 more was measured
    assert found > likeness(bright, expected[:, ::-1]) + 0.02


# --- what is felt ---------------------------------------------------------------------


def target_on_bone(oracle: Oracle) -> Points:
    """Returns where [mm] the bone seen from before is flattest and thick: a place to press on."""
    window, thick = (3, 7), 3
    front = np.where(oracle.bone.any(axis=1), oracle.bone.argmax(axis=1), 0)
    behind = [np.take_along_axis(oracle.bone, front[:, None] + k, axis=1) for k in range(thick)]
    solid = np.concatenate(behind, axis=1).all(axis=1) & (front > 0)

    def windows(array: NDArray[Any]) -> NDArray[Any]:
        return np.lib.stride_tricks.sliding_window_view(array, window)

    unevenness = windows(front.astype(float)).std(axis=(2, 3))
    unevenness[~windows(solid).all(axis=(2, 3))] = np.inf
    # near the border of the scan the probe slips past the end of the bone
    border = unevenness.shape[0] // 6
    unevenness[:border] = unevenness[-border:] = np.inf
    row, column = np.unravel_index(int(unevenness.argmin()), unevenness.shape)
    z, x = int(row) + window[0] // 2, int(column) + window[1] // 2
    return np.array([x, front[z, x], z]) * oracle.spacing + oracle.origin


def check_contact(opened: Opened, state: dict[str, Any]) -> None:
    """Compares a state in contact with the file: a free voxel, force = stiffness × depth."""
    proxy, device = np.array(state["proxy"]), np.array(state["device"])
    assert state["contact"]
    assert not opened.oracle.is_bone(proxy)
    # the force comes from the smooth surface beside the probe
    spring = np.array(state["contact_point"]) - device
    stiffness = 1.0  # N/mm, the default
    force = np.array(state["force"])
    assert force == pytest.approx(stiffness * spring, rel=0.05, abs=0.01)
    assert force @ (proxy - device) > 0.0


@pytest.mark.data
def test_the_mouse_presses_on_bone_slides_and_retreats(opened: Opened) -> None:
    page, oracle = opened.page, opened.oracle
    page.read("window.palpate.setView('A')")
    page.finish()

    # a double click brings the probe to what is seen there
    point = target_on_bone(oracle)
    camera = page.read("window.palpate.camera")
    width, height = page.read(
        "(() => { const box = document.querySelector('[data-testid=canvas]')"
        ".getBoundingClientRect(); return [box.width, box.height]; })()"
    )
    offset = point - np.array(camera["target"])
    depth = camera["distance"] - offset @ np.array(camera["back"])
    size = 2 * depth * np.tan(camera["field"] / 2) / height
    before = page.read("String(window.palpate.state.proxy)")
    page.do(
        "doubleClick",
        x=width / 2 + float(offset @ np.array(camera["right"])) / size,
        y=height / 2 - float(offset @ np.array(camera["up"])) / size,
    )
    page.wait(f"String(window.palpate.state.proxy) !== {before!r}")
    placed = page.settled()
    sideways = (np.array(placed["proxy"]) - point)[[0, 2]]
    assert np.abs(sideways).max() < 5.0, "the probe stands before what was clicked"
    assert not oracle.is_bone(placed["proxy"])

    # Shift and the wheel rolled forward push it into the bone; it stops there while the
    # device goes deeper
    pressed = placed
    for _ in range(100):
        if pressed["depth"] > 1.0:
            break
        page.do("touch", depth=-80, steps=2)
        pressed = page.settled()
    check_contact(opened, pressed)
    page.shows("contact", "text === 'contact'")
    page.shows("force", "Number(text) > 1")
    page.do("screenshot", path=str(OUTPUT / f"{opened.name}_pressed.png"))

    # sideways it slides over the bone, and never enters it
    page.do("touch", x=25, y=0)
    slid = page.settled()
    assert not oracle.is_bone(slid["proxy"])
    moved = np.array(slid["device"]) - np.array(pressed["device"])
    assert moved[0] > 1.0, "right on the screen is the patient's left in a view from before"
    assert slid["safety"]["violations"] == 0

    # away from it nothing is felt
    away = (np.array(slid["proxy"]) - [0.0, 30.0, 0.0]).tolist()
    page.read(f"window.palpate.hand({away})")
    page.wait("window.palpate.state.contact === false")
    free = page.settled()
    assert free["force"] == [0.0, 0.0, 0.0]
    page.shows("contact", "text === 'free'")
    page.shows("force", "Number(text) === 0")


@pytest.mark.data
def test_nothing_complains_on_the_way(opened: Opened) -> None:
    assert opened.page.complaints == []


# --- what is said when it fails -------------------------------------------------------


@pytest.fixture(scope="module")
def demo() -> Iterator[Command]:
    """The phantom, served."""
    with palpate("demo", "--port", "0") as command:
        yield command


def test_without_webgl_the_page_says_so(demo: Command) -> None:
    with browser(flags="--disable-3d-apis") as page:
        page.do("open", url=demo.url)
        page.wait("document.querySelector('[data-testid=message]') !== null")
        page.do("screenshot", path=str(OUTPUT / "no_webgl.png"))
        assert "WebGL" in page.text("message")


def test_a_wrong_token_gets_a_readable_page(demo: Command) -> None:
    with browser() as page:
        page.do("open", url=demo.url.partition("?")[0] + "?token=wrong", seconds=3)
        page.do("screenshot", path=str(OUTPUT / "wrong_token.png"))
        assert "token" in page.read("document.body.innerText").lower()


def test_the_end_of_the_session_is_said_and_the_page_stays() -> None:
    with palpate("demo", "--port", "0") as command, browser() as page:
        page.do("open", url=command.url)
        page.shows("contact", "text === 'free'")
        assert command.stop() == 0
        page.wait("document.querySelector('[data-testid=message]') !== null")
        page.do("screenshot", path=str(OUTPUT / "session_ended.png"))
        # a page that is slow may not hear of the end, and finds nobody there
        assert re.search("session has ended|connection", page.text("message"), re.IGNORECASE)
