"""Objects as a person with the page puts them together.

A plate from the command line stands beside a scan of thick slices, is picked and touched.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
import SimpleITK
from browser import Browser, browser, palpate
from numpy.typing import ArrayLike
from palpate.mesh_write import write_mesh
from palpate.surface import Mesh

pytestmark = pytest.mark.browser

MIDDLES = ((20.0, 32.0, 32.0), (46.0, 32.0, 32.0))
RADIUS = 9.0
SPACING = (1.0, 1.0, 2.0)
PLATE = np.array([10.0, 1.5, 14.0])
PLATE_AT = np.array([46.0, 12.0, 32.0])
"""The middle of the plate [mm], before the second ball."""
SIZE = {"width": 1100, "height": 760}


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    """Two balls of a label map in thick slices and a plate from a file, seen from before."""
    folder = tmp_path_factory.mktemp("assembly")
    z, y, x = np.indices((32, 64, 68))
    points = np.stack([x, y, z], -1) * SPACING
    labels = np.zeros(z.shape, np.uint8)
    for label, middle in enumerate(MIDDLES, start=1):
        labels[np.linalg.norm(points - middle, axis=-1) <= RADIUS] = label
    paths = folder / "scan.mha", folder / "labels.mha"
    for array, path in zip(((labels > 0) * np.int16(1000), labels), paths, strict=True):
        image = SimpleITK.GetImageFromArray(array)
        image.SetSpacing(SPACING)
        SimpleITK.WriteImage(image, str(path))
    write_plate(folder / "plate.stl")
    mesh = ("--mesh", folder / "plate.stl", "--spacing", "0.25")
    with (
        palpate("open", paths[0], "--segments", paths[1], *mesh) as command,
        browser() as opened,
    ):
        assert opened.do("open", url=command.url, **SIZE)["firstPicture"] is not None
        opened.read("window.palpate.setView('A')")
        opened.wait("window.palpate.triangles[3] > 0")
        yield opened


def write_plate(path: Path) -> None:
    corners = np.array([[i & 1, i >> 1 & 1, i >> 2 & 1] for i in range(8)], np.float64) - 0.5
    sides = [(0, 4, 6, 2), (1, 3, 7, 5), (0, 1, 5, 4), (2, 6, 7, 3), (0, 2, 3, 1), (4, 5, 7, 6)]
    triangles = [triple for a, b, c, d in sides for triple in ((a, b, c), (a, c, d))]
    normals = corners / np.linalg.norm(corners, axis=1, keepdims=True)
    vertices = PLATE_AT + corners * PLATE
    write_mesh(Mesh(vertices, normals.astype(np.float32), np.array(triangles, np.uint32)), path)


def seen(page: Browser, point: ArrayLike) -> tuple[float, float]:
    """Returns where a point of the scene stands in the picture [CSS pixels]."""
    camera = page.read("window.palpate.camera")
    width, height = page.read(
        "(({ clientWidth, clientHeight }) => [clientWidth, clientHeight])"
        "(document.querySelector('[data-testid=canvas]'))"
    )
    right, up, back, target = (np.array(camera[key]) for key in ("right", "up", "back", "target"))
    from_eye = np.asarray(point) - (target + back * camera["distance"])
    scale = height / 2.0 / np.tan(camera["field"] / 2.0) / -(from_eye @ back)
    return width / 2.0 + scale * (from_eye @ right), height / 2.0 - scale * (from_eye @ up)


def pick(page: Browser, point: ArrayLike) -> int | None:
    x, y = seen(page, point)
    picked = page.read(f"window.palpate.pick({x}, {y})")
    return None if picked is None else picked["segment"]


def test_a_mesh_of_the_command_line_is_as_thick_as_it_is_in_thick_slices(page: Browser) -> None:
    assert "plate" in page.text("segment-3")
    assert pick(page, PLATE_AT) == 3
    front = float(PLATE_AT[1] - PLATE[1] / 2.0)
    for start, end in ((front - 4.0, front), (front + 4.5, front + 1.5)):
        page.read(f"window.palpate.place({[46.0, start, 32.0]})")
        page.wait(f"Math.abs(window.palpate.state.proxy[1] - {start}) < 0.01")
        page.read(f"window.palpate.hand({[46.0, 12.0, 32.0]})")
        # the probe stops at the face, whichever it comes to: the plate is a multiple of its voxels
        page.wait(
            f"window.palpate.state.touched === 3"
            f" && Math.abs(window.palpate.state.proxy[1] - {end}) < 0.02"
        )
        page.read(f"window.palpate.place({[46.0, start, 32.0]})")
        page.wait("!window.palpate.state.contact")
    assert page.complaints == []
