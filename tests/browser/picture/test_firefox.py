"""Firefox where Mesa's llvmpipe draws: it rounds to bytes what lies between texels of bytes.

The oracle is NumPy: it samples the file itself along the rays of the page's own camera.
"""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import SimpleITK
from browser import ROOT, palpate
from firefox import firefox
from opened_scan import Seen

pytestmark = pytest.mark.browser

OUTPUT = ROOT / "tests" / "output"
WINDOW, LEVEL = 800.0, 1000.0


def ball(path: Path) -> Path:
    """Writes values that fall from a middle outward, through carries from low byte to high."""
    z, y, x = np.mgrid[:32, :32, :32] - 15.5
    values = 1500 - 60 * np.sqrt(x**2 + y**2 + z**2)
    SimpleITK.WriteImage(SimpleITK.GetImageFromArray(values.astype(np.int16)), str(path))
    return path


def test_a_mip_in_firefox_is_the_largest_value_on_each_ray_of_the_file(tmp_path: Path) -> None:
    path = ball(tmp_path / "ball.nii.gz")
    window = {"window": WINDOW, "level": LEVEL}
    mip = {"blend": "mip", "windows": {"mip": window, "minip": window, "average": window}}
    with palpate("open", path, "--unit", "HU") as command, firefox() as page:
        page.open(command.url, width=640, height=400)
        page.read(f"window.palpate.keep('optics', {json.dumps(mip)})")
        page.read("window.palpate.allDone()")
        # a page that is opened takes up what is kept
        page.open(command.url, width=640, height=400)
        assert "llvmpipe" in page.read("window.palpate.support.renderer")
        drawn = page.picture(OUTPUT / "firefox-mip.png")[..., 1]
        filtering = page.read("window.palpate.filter")
        height, across = drawn.shape
        rows, columns = np.mgrid[10 : height - 10 : 8, 10 : across - 10 : 8]
        pixels = np.stack([columns.ravel(), rows.ravel()], 1).astype(float)
        seen = Seen(page, SimpleITK.ReadImage(str(path)))
        values = seen.values_along(pixels, np.arange(-32, 32, 0.1))

    # bytes are what would be wrong, and something else was found
    assert filtering["errors"]["rg8"] > 100
    assert filtering["format"] == "r32f"
    most = np.nanmax(np.where(np.isnan(values), -5000, values), axis=1)
    grey = np.clip((most - LEVEL) / WINDOW + 0.5, 0, 1)
    off = np.abs(drawn[rows.ravel(), columns.ravel()] - grey)[(grey > 0.3) & (grey < 0.95)]
    assert len(off) > 300
    assert np.mean(off < 8 / 255) > 0.99


def test_a_turntable_in_firefox_is_a_film_of_the_turning_view(tmp_path: Path) -> None:
    path = ball(tmp_path / "ball.nii.gz")
    with palpate("open", path, "--unit", "HU") as command, firefox() as page:
        page.remember(image={"seconds": 1, "turns": 1}, drawer={"choice": "browser"})
        page.open(command.url, width=640, height=400)
        # what is kept by the browser
        page.read(
            "void (URL.createObjectURL = (blob) => (window.__film = blob, 'data:,'),"
            " document.querySelector('[data-testid=save-image]').click(),"
            " document.querySelector('[data-testid=film-save]').click())"
        )
        page.wait("window.__film !== undefined || document.querySelector('.notice.error') !== null")
        assert page.read("document.querySelector('.notice.error')?.textContent ?? null") is None
        # an EBML file, which a browser can play
        head = page.read(
            "window.__film.slice(0, 4).arrayBuffer().then(b => [...new Uint8Array(b)])"
        )
        assert head == [0x1A, 0x45, 0xDF, 0xA3]
        # the length of a second: more than one picture
        assert page.read("window.__film.size") > 1000
