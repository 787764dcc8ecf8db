"""A dose over its scan in a real browser: isodose lines where the dose has their values.

The oracle takes the dose's tags alone: SciPy interpolates its stored numbers at each pixel.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pydicom
import pytest
import SimpleITK
from browser import ROOT, Browser, browser, palpate
from made_dose import write_dose
from made_scans import series_writer
from numpy.typing import NDArray
from scipy.ndimage import map_coordinates

pytestmark = pytest.mark.browser

OUTPUT = ROOT / "tests" / "output"
FRAME = "1.2.826.0.1.3680043.8.498.1"
COLOURS = {95: (255, 94, 41), 80: (255, 255, 41), 50: (41, 255, 148), 30: (41, 148, 255)}
"""Of the page's lines: hues of 15, 60, 150 and 210 degrees."""

Picture = NDArray[np.float64]


@pytest.fixture(scope="module")
def dose(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A dose on sagittal planes of 5 mm, tilted by 37 degrees: a field and a boost."""
    rows, columns = (0.0, 0.8, 0.6), (0.0, 0.6, -0.8)
    i, j, k = np.mgrid[0:17, 0:30, 0:30] - np.array([8, 14.5, 14.5])[:, None, None, None]
    gray = 20.0 * np.exp(-(i**2 + j**2 + k**2) / 60.0) + 3.0 / (1.0 + np.exp(j - 0.5 * k))
    path: Path = tmp_path_factory.mktemp("dose") / "dose.dcm"
    return write_dose(
        path,
        gray,
        # the middle of the grid at 0, 0, 0
        position=tuple(-np.array([-40.0, *(29 * np.array([0.8 + 0.9, 0.6 - 1.2]))])),
        orientation=(*rows, *columns),
        offsets=[5.0 * n for n in range(17)],
        FrameOfReferenceUID=FRAME,
    )


@pytest.fixture(scope="module")
def page(dose: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    """The dose over a scan of another grid, in four panes."""
    positions = [(-45.0, -45.0, -40.0 + 4.0 * n) for n in range(21)]
    write = series_writer(tmp_path_factory.mktemp("scan"))

    def whole(_: int, dataset: pydicom.Dataset) -> None:
        dataset.Rows = dataset.Columns = 61
        dataset.PixelSpacing = [1.5, 1.5]
        dataset.PixelData = np.full((61, 61), 1024, "<u2").tobytes()

    scan = write(positions=positions, each=whole, FrameOfReferenceUID=FRAME)
    with palpate("open", scan, "--with", dose) as command, browser() as page:
        page.do("open", url=command.url, width=1000, height=800)
        page.do("click", testid="layout-four")
        page.wait("window.palpate.slices.length === 3")
        page.do("clickText", text="Second scan")
        page.do("slide", testid="second-opacity", value=0)
        # the boost
        page.read("window.palpate.cross([0.5, 1.5, 0.5])")
        yield page


def dose_at(path: Path, points: Picture) -> Picture:
    """Doses at points of the patient; NaN outside."""
    dataset = pydicom.dcmread(path)
    row, column = np.array(dataset.ImageOrientationPatient, float).reshape(2, 3)
    steps = [np.cross(row, column) * 5.0, column * 3.0, row * 2.0]
    away = points - np.array(dataset.ImagePositionPatient, float)
    index = np.linalg.solve(np.stack(steps, 1), away.reshape(-1, 3).T)
    gray = dataset.pixel_array * float(dataset.DoseGridScaling)
    found = map_coordinates(gray, index, order=1, cval=np.nan)
    return np.asarray(found.reshape(points.shape[:-1]), float)


def slice_of(page: Browser, name: str) -> tuple[Picture, Picture]:
    """A slice as it is drawn, RGB 0..255 [h, w, 3], and the places of its pixels."""
    page.finish()
    path = OUTPUT / f"dose_{name}.png"
    path.parent.mkdir(parents=True, exist_ok=True)
    page.do("screenshot", path=str(path), testid=f"slice-{name}")
    drawn = SimpleITK.GetArrayFromImage(SimpleITK.ReadImage(str(path)))[..., :3].astype(float)
    plane = page.read(f"window.palpate.slices.find(({{name}}) => name === '{name}').plane")
    right, up, centre = (np.array(plane[key]) for key in ("right", "up", "centre"))
    tall, wide = drawn.shape[:2]
    x, y = np.meshgrid(np.arange(wide) + 0.5 - wide / 2, tall / 2 - np.arange(tall) - 0.5)
    return drawn, centre + plane["pixel"] * (x[..., None] * right + y[..., None] * up)


def test_lines_run_where_the_dose_has_their_value(page: Browser, dose: Path) -> None:
    dataset = pydicom.dcmread(dose)
    highest = float(dataset.pixel_array.max() * dataset.DoseGridScaling)
    legend = page.text("isoline-legend")
    assert legend.startswith(f"95 %  {0.95 * highest:.2f} Gy")
    for name in ("axial", "coronal", "sagittal"):
        drawn, points = slice_of(page, name)
        gray = dose_at(dose, points)
        rise = np.hypot(*np.gradient(gray))
        coloured = np.ptp(drawn, axis=2) > 60
        away = np.full(gray.shape, np.inf)
        for percent, colour in COLOURS.items():
            off = np.abs(gray - percent / 100.0 * highest) / rise
            # in the middle of a line is its colour; at its corners the slope of pixels is another
            on = off < 0.3
            assert on.sum() > 20, (name, percent)
            alike = np.abs(drawn[on] - colour).max(axis=1) < 25
            assert alike.mean() > 0.85, (name, percent)
            away = np.fmin(away, off)
        # two pixels away from all of them there is none
        assert coloured[(away > 2.5) & np.isfinite(gray)].mean() < 0.02, name


def test_the_dose_is_read_where_slices_cross(page: Browser, dose: Path) -> None:
    points = np.array([[3.1, -2.6, 7.3], [-11.0, 4.2, -9.4]])
    for point, expected in zip(points, dose_at(dose, points), strict=True):
        page.read(f"window.palpate.cross({point.tolist()})")
        page.frames()
        number, unit = page.text("read-second").split()
        assert unit == "Gy"
        assert float(number) == pytest.approx(expected, abs=0.006)


def test_levels_are_typed_in_gray_or_percent(page: Browser, dose: Path) -> None:
    page.do("fill", testid="lines-reference", text="20")
    page.do("press", key="Enter")
    page.wait(
        "document.querySelector('[data-testid=isoline-legend]').textContent.includes('19.00')"
    )
    while page.read("document.querySelectorAll('[data-testid=line-remove]').length") > 1:
        page.read("document.querySelector('[data-testid=line-remove]').click()")
        page.frames()
    page.do("fill", testid="line-value", text="15")
    page.do("press", key="Enter")
    page.wait("document.querySelector('[data-testid=isoline-legend]').children.length === 1")
    assert page.text("isoline-legend") == "75 %  15.00 Gy"
    drawn, points = slice_of(page, "axial")
    gray = dose_at(dose, points)
    on = np.abs(gray - 15.0) / np.hypot(*np.gradient(gray)) < 0.3
    assert (np.ptp(drawn, axis=2)[on] > 150).mean() > 0.85
    assert page.complaints == []
