"""Volumes of one file, such as times, on the page: a slider in the list, steps from an open one."""

from __future__ import annotations

from pathlib import Path

import nibabel
import numpy as np
import pytest
from browser import ROOT, Browser, browser, palpate

pytestmark = pytest.mark.browser

OUTPUT = ROOT / "tests" / "output"
READY = "window.palpate?.ready === true"
COUNT = 40


def cine_at(folder: Path) -> Path:
    """Writes a ball that grows with time."""
    x, y, z = np.indices((32, 32, 24)) - np.array([16, 16, 12])[:, None, None, None]
    distance = np.sqrt(x**2 + y**2 + z**2)
    values = np.stack([(distance < 3 + time / 5) * 400 + time for time in range(COUNT)], axis=-1)
    image = nibabel.Nifti1Image(values.astype(np.int16), np.diag([2.0, 2.0, 2.0, 1.0]))
    image.header.set_xyzt_units("mm", "sec")
    nibabel.save(image, folder / "cine.nii.gz")
    mask = (values[..., 0] > 100).astype(np.uint8)
    nibabel.save(nibabel.Nifti1Image(mask, image.affine), folder / "mask.nii.gz")
    return folder / "cine.nii.gz"


def test_a_time_is_chosen_by_a_slider_and_changed_by_steps(tmp_path: Path) -> None:
    cine = cine_at(tmp_path)
    with (
        palpate("open", "--no-journal", state=tmp_path / "state") as command,
        browser() as page,
    ):
        page.do("open", url=command.url, width=1366, height=768)
        page.do("fill", testid="open-path", text=str(cine))
        page.do("click", testid="open-look")
        chosen_by_the_slider(page)
        stepped(page)
        told_of_changes(page, tmp_path / "mask.nii.gz")
        told_by_a_person(page)
        chosen_as_the_second_scan(page, cine)
        assert page.complaints == []


def chosen_by_the_slider(page: Browser) -> None:
    """Unfolds the volumes, moves to the 39th, whose picture comes then, and opens it."""
    page.shows("volumes-0", f"text.includes('{COUNT} volumes')")
    page.do("click", testid="volumes-0")
    page.shows("open-volume", "text === 'Open this volume'")
    page.wait("document.querySelectorAll('[data-testid=series-list] img').length >= 32")
    pictured = "document.querySelector('[data-testid=series-38] img') !== null"
    assert not page.read(pictured)
    page.do("slide", testid="volume-slider", value=39)
    page.shows("volume-slider-value", f"text === '39 of {COUNT}'")
    page.wait(pictured)
    for width, height in ((900, 620), (1366, 768)):
        page.do("resize", width=width, height=height)
        page.do("screenshot", path=str(OUTPUT / f"volumes-list-{width}.png"))
        assert page.do("axe")["value"] == []
    page.do("click", testid="open-volume")
    opened(page, 39)


def stepped(page: Browser) -> None:
    """Goes to the next volume, which is the last, and back."""
    page.do("click", testid="volume-next")
    opened(page, COUNT)
    assert page.read("document.querySelector('[data-testid=volume-next]').disabled")
    for width, height in ((900, 620), (1366, 768)):
        page.do("resize", width=width, height=height)
        page.do("screenshot", path=str(OUTPUT / f"volumes-open-{width}.png"))
    page.do("click", testid="volume-previous")
    opened(page, COUNT - 1)


def opened(page: Browser, number: int) -> None:
    """Waits until a volume is open, and looks whether its values are its own."""
    page.wait(f"{READY} && window.palpate.scan.volume[0] === {number}", seconds=120.0)
    page.shows("volume-step", f"text.includes('Volume {number} of {COUNT}')")
    assert page.read("window.palpate.scan.range[0]") == number - 1


def told_of_changes(page: Browser, mask: Path) -> None:
    """Adds a segment: a step leaves it only after it was told that it is kept nowhere."""
    page.do("click", testid="segments-from-file")
    page.do("fill", testid="open-path", text=str(mask))
    page.do("click", testid="open-look")
    page.wait("document.querySelector('dialog[open]') === null && window.palpate.state.can_undo")
    page.do("click", testid="volume-next")
    page.shows("reread-anyway", "text === 'Go on without them'")
    page.do("screenshot", path=str(OUTPUT / "volumes-changed.png"))
    page.do("click", testid="reread-anyway")
    opened(page, COUNT)


def told_by_a_person(page: Browser) -> None:
    """Says that values are HU, which the file does not."""
    assert "--" not in page.read("document.querySelector('aside').textContent")
    page.do("click", testid="unit-hu")
    page.wait(f"{READY} && window.palpate.scan.unit === 'HU'", seconds=120.0)
    opened(page, COUNT)
    assert page.read("document.querySelector('[data-testid=unit-hu]') === null")


def chosen_as_the_second_scan(page: Browser, cine: Path) -> None:
    """Shows another volume beside the open one, and steps in that."""
    page.do("click", testid="add-second")
    page.do("fill", testid="open-path", text=str(cine))
    page.do("click", testid="open-look")
    page.shows("volumes-0", "text !== ''")
    page.do("click", testid="volumes-0")
    page.do("click", testid="series-2")
    page.wait("document.querySelector('dialog[open]') === null")
    page.do("clickText", text="Second scan")
    page.shows("second-volume-step", f"text.includes('Volume 3 of {COUNT}')")
    page.do("click", testid="second-volume-next")
    page.shows("second-volume-step", f"text.includes('Volume 4 of {COUNT}')")
    page.do("screenshot", path=str(OUTPUT / "volumes-second.png"))
    assert page.read("window.palpate.scan.volume[0]") == COUNT
