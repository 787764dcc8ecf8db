"""Clipping, projections and saved pictures of a real scan in a real browser.

The oracle is NumPy: it samples the file itself along the rays of the page's own camera.
"""

from __future__ import annotations

import subprocess
from collections.abc import Callable, Iterator
from pathlib import Path

import imageio_ffmpeg
import numpy as np
import pytest
import SimpleITK
from browser import ROOT, browser, palpate
from numpy.typing import NDArray
from opened_scan import Array, Opened

pytestmark = [pytest.mark.browser, pytest.mark.data]

OUTPUT = ROOT / "tests" / "output"
SIZE = {"width": 1000, "height": 640}


@pytest.fixture(scope="module")
def opened(data_folder: Path) -> Iterator[Opened]:
    """A contrast CT of the trunk, with the controls of clipping in sight."""
    path = data_folder / "amos_0336" / "amos_0336.mhd"
    with palpate("open", path, "--unit", "HU") as command, browser() as page:
        opening = page.do("open", url=command.url, **SIZE)
        assert opening["firstPicture"] is not None
        yield Opened(page, SimpleITK.ReadImage(str(path)))


@pytest.fixture
def scan(opened: Opened) -> Opened:
    """The same as each test finds it: nothing cut away, in perspective, from the front."""
    page = opened.page
    page.do("resize", **SIZE)
    page.do("choose", testid="blend", value="mip")
    if page.read("!document.querySelector('[data-testid=clip-reset]').disabled"):
        page.do("click", testid="clip-reset")
    if page.read("window.palpate.camera.parallel !== null"):
        page.do("click", testid="orthographic")
    page.read("window.palpate.setView('A')")
    return opened


def front_of(image: SimpleITK.Image) -> float:
    """Returns where the scan's anterior face lies [mm], for a scan along the body's axes."""
    assert np.allclose(np.abs(image.GetDirection()), np.eye(3).ravel())
    ends = [-0.5, image.GetSize()[1] - 0.5]
    corners = [image.TransformContinuousIndexToPhysicalPoint((0.0, end, 0.0)) for end in ends]
    return float(min(corner[1] for corner in corners))


def number(scan: Opened, testid: str) -> float:
    """Returns the number in a text with a unit."""
    return float(scan.page.text(testid).split()[0])


def mip_agrees(scan: Opened, name: str, kept: Callable[[Array], NDArray[np.bool_]]) -> None:
    """Checks that the picture is the largest of the file's kept values along each ray."""
    page = scan.page
    drawn = page.picture(OUTPUT / f"{name}.png")[..., 1]
    width, level = (
        float(page.read(f"document.querySelector('[data-testid={testid}]').value"))
        for testid in ("picture-window", "picture-level")
    )
    height, across = drawn.shape
    rows, columns = np.mgrid[60 : height - 60 : 12, 60 : across - 60 : 12]
    pixels = np.stack([columns.ravel(), rows.ravel()], 1).astype(float)
    lengths = np.arange(-420, 420, 0.4)
    values = scan.values_along(pixels, lengths)
    counted = ~np.isnan(values) & kept(scan.points_along(pixels, lengths))
    most = np.where(counted, values, -5000).max(axis=1)
    grey = np.clip((most - level) / width + 0.5, 0, 1)
    # black is the page's own ground, of which dark grey has a share
    lit = grey > 0.3
    assert lit.mean() > 0.03
    off = np.abs(drawn[rows.ravel(), columns.ravel()] - grey)[lit]
    assert np.median(off) < 4 / 255, np.median(off) * 255
    assert np.mean(off < 12 / 255) > 0.9


def test_what_a_clip_box_cuts_away_is_not_seen_nor_picked_and_handles_move_it(scan: Opened) -> None:
    page = scan.page
    whole = page.picture(OUTPUT / "unclipped.png")
    page.do("click", testid="clip-box")
    page.do("slide", testid="clip-A", value=150)
    face = front_of(scan.image) + number(scan, "clip-A-value")
    mip_agrees(scan, "clip_mip", lambda points: points[..., 1] >= face)

    # what is seen first lies on the cut or behind it
    page.do("choose", testid="blend", value="shaded")
    page.frames()
    x, y = page.read("window.palpate.middle")
    picked = page.read(f"window.palpate.pick({x}, {y})")
    assert picked is not None
    assert face - 0.1 < picked["point"][1] < face + 80

    # the left face is dragged inward, and is where it is by the scale of the picture
    page.do("dragElement", testid="clip-handle-L", x=-60)
    pixel = page.read("window.palpate.pixelSizeAt(window.palpate.camera.target)")
    assert 60 * pixel * 0.7 < number(scan, "clip-L-value") < 60 * pixel * 1.3
    cut = page.text("clip-L-value")
    OUTPUT.mkdir(exist_ok=True)
    page.finish()
    page.do("screenshot", path=str(OUTPUT / "clip_page.png"))

    # it is remembered, and taken back by one button
    page.do("open", url=page.read("location.href"), **SIZE)
    page.shows("clip-L-value", f"text === '{cut}'")
    page.do("click", testid="clip-reset")
    page.do("choose", testid="blend", value="mip")
    page.read("window.palpate.setView('A')")
    assert np.abs(page.picture(OUTPUT / "unclipped_again.png") - whole).max() < 2 / 255
    assert not page.complaints


def test_a_plane_across_the_view_cuts_one_side_away_and_flipped_the_other(scan: Opened) -> None:
    page = scan.page
    middle = page.read("window.palpate.camera.target")[1]
    page.do("click", testid="clip-add")
    mip_agrees(scan, "clip_plane", lambda points: points[..., 1] >= middle)
    page.do("clickText", text="Flip plane 1")
    mip_agrees(scan, "clip_flipped", lambda points: points[..., 1] <= middle)
    page.do("clickText", text="Remove plane 1")
    assert page.read("document.querySelector('[data-testid=clip-reset]').disabled")
    assert not page.complaints


def test_without_perspective_rays_are_parallel_in_picture_and_pick(scan: Opened) -> None:
    page = scan.page
    page.do("press", key="o")
    page.wait("window.palpate.camera.parallel !== null")
    mip_agrees(scan, "orthographic", lambda points: np.ones(points.shape[:-1], bool))
    camera = page.read("window.palpate.camera")
    x, y = page.read("window.palpate.middle")
    picked = page.read(f"window.palpate.pick({x + 40}, {y})")
    pixel = page.read("window.palpate.pixelSizeAt([0, 0, 0])")
    right = np.dot(np.subtract(picked["point"], camera["target"]), camera["right"])
    assert abs(right - 40 * pixel) < 1e-6
    page.do("press", key="3")
    page.wait("window.palpate.camera.back[0] > 0.99 && window.palpate.camera.parallel !== null")
    assert not page.complaints


def frames_of(film: Path, width: int, height: int) -> NDArray[np.uint8]:
    """Returns the frames of a film, [frame, row, column, colour]."""
    ffmpeg = imageio_ffmpeg.get_ffmpeg_exe()
    passed = ("-fps_mode", "passthrough", "-f", "rawvideo", "-pix_fmt", "rgb24", "-")
    ran = subprocess.run(
        [ffmpeg, "-v", "error", "-i", film, *passed], check=True, capture_output=True
    )
    return np.frombuffer(ran.stdout, np.uint8).reshape(-1, height, width, 3)


def test_the_view_is_saved_as_a_larger_picture_and_as_a_film(scan: Opened) -> None:
    page = scan.page
    shown = page.picture(OUTPUT / "shown.png")
    page.do("click", testid="save-image")
    page.do("choose", testid="image-size", value="2")
    told = "".join(
        c if c.isdigit() else " " for c in page.text("image-pixels").replace("\u2009", "")
    )
    assert [int(edge) for edge in told.split()] == [2 * shown.shape[1], 2 * shown.shape[0]]
    saved = OUTPUT / "saved.png"
    answer = page.do("download", testid="image-save", path=str(saved))
    assert answer["name"] == "amos_0336.png"
    image = SimpleITK.GetArrayFromImage(SimpleITK.ReadImage(str(saved)))[..., :3] / 255.0
    height, width = shown.shape[:2]
    assert image.shape[:2] == (2 * height, 2 * width)
    halved = image.reshape(height, 2, width, 2, 3).mean(axis=(1, 3))
    assert np.abs(halved - shown).mean() < 2 / 255

    # a film of it turning, of a smaller view: begun, then taken back; then a whole one
    page.do("resize", width=520, height=400)
    page.frames()
    page.do("click", testid="save-image")
    page.do("slide", testid="film-seconds", value=2)
    least = page.read("document.querySelector('[data-testid=film-seconds]').min")
    page.do("click", testid="film-save")
    page.do("click", testid="image-cancel")
    page.wait("document.querySelector('[data-testid=image-cancel]') === null")
    page.do("click", testid="save-image")
    film = OUTPUT / "turntable.webm"
    answer = page.do("download", testid="film-save", path=str(film))
    assert answer["name"] == "amos_0336.webm"
    content = film.read_bytes()
    # EBML, and the size of its frames as Matroska writes them: PixelWidth and PixelHeight
    assert content[:4] == b"\x1a\x45\xdf\xa3"
    view = page.read(
        "(({ width, height }) => [width, height])"
        "(document.querySelector('[data-testid=canvas]').getBoundingClientRect())"
    )
    even = [int(edge) // 2 * 2 for edge in view]
    assert b"\xb0\x82" + even[0].to_bytes(2, "big") in content
    assert b"\xba\x82" + even[1].to_bytes(2, "big") in content
    # it ends beside where it began, and shows as much there: codecs begin with blocks
    frames = frames_of(film, *even)
    assert len(frames) >= 18
    first, last = (np.abs(np.diff(frame.astype(float), axis=1)).mean() for frame in frames[[0, -1]])
    assert first > 0.9 * last
    assert least == "2"
    assert not page.complaints
