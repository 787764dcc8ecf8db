"""Scenes that are saved on the page and opened again, in a real browser on a real scan."""

from __future__ import annotations

import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from zipfile import ZipFile

import numpy as np
import pytest
from browser import ROOT, TOOL, Browser, browser, palpate
from palpate.io.reading import read
from palpate.labels.labels import read_labels
from pydicom import dcmread

pytestmark = [pytest.mark.browser, pytest.mark.data]

OUTPUT = ROOT / "tests" / "output"
SIZE = {"width": 1000, "height": 560}


@contextmanager
def opened(path: Path, *options: str) -> Iterator[Browser]:
    """A file on a page of a browser that has never been here."""
    with palpate("open", path, *options) as command, browser() as page:
        assert page.do("open", url=command.url, **SIZE)["firstPicture"] is not None
        yield page
        assert page.complaints == []


def test_a_saved_scene_looks_the_same_when_it_is_opened(data_folder: Path, tmp_path: Path) -> None:
    scan = data_folder / "cthead_stanford" / "CThead.mha"
    linked, whole = tmp_path / "linked.palpate", tmp_path / "whole.palpate"
    with opened(scan, "--threshold", "1350") as page:
        page.read("window.palpate.setView('R')")
        page.do("wheel", y=-300)
        page.do("drag", x=60, y=20)
        page.do("press", key="l")
        page.read("window.palpate.cross([100, 90, 120])")
        # an edit, so that the segment is no threshold any more
        page.read("window.palpate.place([127, 1, 150])")
        page.all_done()
        page.do("press", key="b")
        page.do("clickAt", testid="canvas", x=0.5, y=0.5)
        camera, marks, crosshair, slices = (
            page.read(f"window.palpate.{name}")
            for name in ("camera", "marks", "crosshair", "slices")
        )
        assert len(marks) == 1
        assert len(slices) > 0
        before = page.picture(OUTPUT / "scene_saved.png")
        page.do("download", testid="save-scene", path=str(linked))
        page.wait("document.querySelector('.notices').textContent.includes('Saved as ')")
        page.do("click", testid="scene-with-scan")
        page.do("download", testid="save-scene", path=str(whole))
        check_export(page, tmp_path / "head.seg.nrrd", scan)
    assert linked.stat().st_size < 5_000_000 < whole.stat().st_size
    for saved in (linked, whole):
        with opened(saved) as page:
            assert page.read("window.palpate.camera") == camera
            assert page.read("window.palpate.marks") == marks
            aside = f"window.palpate.crosshair.map((c, i) => c - {crosshair}[i])"
            page.wait(f"Math.hypot(...{aside}) < 1")
            assert len(page.read("window.palpate.slices")) == len(slices)
            after = page.picture(OUTPUT / f"scene_{saved.stem}.png")
            # the probe stands elsewhere: nothing else has changed
            assert np.mean(np.abs(after - before).max(axis=-1) > 0.05) < 0.02


def check_export(page: Browser, path: Path, scan: Path) -> None:
    """Exports the segment for 3D Slicer, as a person does."""
    buttons = "[...document.querySelectorAll('button')]"
    page.read(f"{buttons}.find((each) => each.textContent.trim() === 'Export').click()")
    # nothing in DICOM can refer to it: that is said before, not after
    formats = "[...document.querySelectorAll('[data-testid=export-format] option')]"
    offered = page.read(f"{formats}.filter((each) => !each.disabled).map((each) => each.value)")
    assert offered == ["slicer", "labels", "scan", "scene"]
    page.shows(
        "no-dicom", "/^No DICOM can be made: the scan .CThead.* is no DICOM series/.test(text)"
    )
    page.do("screenshot", path=str(OUTPUT / "export.png"))
    page.do("download", testid="export", path=str(path))
    volume = read(scan)
    segment = read_labels(path, volume).labels[0].segment
    assert segment.voxel_count == volume.threshold(1350.0).voxel_count


def test_a_scene_that_was_just_saved_opens_without_an_offer(
    data_folder: Path, tmp_path: Path
) -> None:
    scan, state = data_folder / "cthead_stanford" / "CThead.mha", tmp_path / "state"
    path = tmp_path / "head.palpate"
    rows = "document.querySelectorAll('[data-testid^=visible-]').length"
    with palpate("open", scan, "--threshold", "1350", state=state) as command, browser() as page:
        page.do("open", url=command.url, **SIZE)
        page.do("click", testid="group-segments")
        page.read("document.querySelector('[aria-label=\"Add a segment by threshold\"]').click()")
        page.wait(f"{rows} === 2")
        page.do("download", testid="save-scene", path=str(path))
        assert command.stop() == 0
    # it has all that was done: there is nothing to bring back
    with palpate("open", path, state=state) as command, browser() as page:
        page.do("open", url=command.url, **SIZE)
        page.do("click", testid="group-segments")
        page.wait(f"{rows} === 2")
        page.all_done()
        assert page.read("document.querySelector('[data-testid=recovery]')") is None
        assert page.complaints == []


def test_a_damaged_scene_is_refused(tmp_path: Path) -> None:
    wrong = tmp_path / "wrong.palpate"
    wrong.write_bytes(b"PK no zip")
    ended = subprocess.run([*TOOL, "open", wrong], capture_output=True, text=True, check=False)
    assert ended.returncode == 2
    assert "is no scene file, or a damaged one" in ended.stderr
    assert ended.stderr.count("\n") == 1


@pytest.mark.long
def test_the_autosave_of_a_damaged_scene_is_opened_from_the_page(
    data_folder: Path, tmp_path: Path
) -> None:
    scan, state = data_folder / "cthead_stanford" / "CThead.mha", tmp_path / "state"
    path = tmp_path / "head.palpate"
    rows = "document.querySelectorAll('[data-testid^=visible-]').length"
    with palpate("open", scan, "--threshold", "1350", state=state) as command, browser() as page:
        page.do("open", url=command.url, **SIZE)
        page.do("click", testid="find-segments")
        page.do("click", testid="otsu-make")
        # bone by its threshold, and the classes above the lowest
        page.wait(f"{rows} === 3")
        page.do("download", testid="save-scene", path=str(path))
        assert command.stop() == 0
    path.write_bytes(path.read_bytes()[:4000])
    # the browser has named it as the engine did
    dropped = tmp_path / "CThead.palpate"
    path.rename(dropped)
    with palpate("open", state=state) as command, browser() as page:
        page.do("open", url=command.url, **SIZE)
        page.do("drop", paths=[str(dropped)])
        page.shows("open-failure", "text.includes('damaged')")
        page.shows("open-autosave", "text.startsWith('Open the last autosave (')")
        page.do("screenshot", path=str(OUTPUT / "scene_damaged.png"))
        assert page.do("axe")["value"] == []
        page.do("click", testid="open-autosave")
        page.wait(f"window.palpate?.ready === true && {rows} === 3", seconds=120.0)
        assert page.complaints == []


def test_names_are_chosen_before_a_scan_is_shared(data_folder: Path, tmp_path: Path) -> None:
    scan, path, scene = (tmp_path / name for name in ("scan", "shared.zip", "shared.palpate"))
    scan.mkdir()
    for file in (data_folder / "dcmqi_seg" / "ct-3slice").glob("*.dcm"):
        dataset = dcmread(file)
        dataset.BurnedInAnnotation = "YES"
        dataset.save_as(scan / file.name)
    with palpate("open", scan, "--threshold", "200") as command, browser() as page:
        page.do("open", url=command.url, **SIZE)
        buttons = "[...document.querySelectorAll('button')]"
        page.wait(f"{buttons}.some((each) => each.textContent.trim() === 'Export')")
        page.read(f"{buttons}.find((each) => each.textContent.trim() === 'Export').click()")
        page.read(
            "(() => { const format = document.querySelector('[data-testid=export-format]');"
            " format.value = 'share';"
            " format.dispatchEvent(new Event('change', {bubbles: true})); })()"
        )
        name = "document.querySelector('[aria-label^=\"Name to share\"]')"
        page.wait(f"{name}?.value === 'threshold'")
        page.read(
            f"{name}.value = 'bone'; {name}.dispatchEvent(new Event('change', {{bubbles: true}}))"
        )
        page.read(f"{name}.scrollIntoView()")
        page.do("screenshot", path=str(OUTPUT / "export_names.png"))
        # images that say that they have text in their pixels are to be looked at first
        page.do("click", testid="export")
        page.shows("export-looked", "true")
        page.do("click", testid="export-looked")
        page.do("screenshot", path=str(OUTPUT / "export_look.png"))
        page.do("download", testid="export", path=str(path))
        page.wait("document.querySelector('.notices').textContent.includes('Saved as ')")
        page.read(
            "(() => { const format = document.querySelector('[data-testid=export-format]');"
            " format.value = 'scene';"
            " format.dispatchEvent(new Event('change', {bubbles: true})); })()"
        )
        page.shows("export-names-looked", "true")
        page.do("screenshot", path=str(OUTPUT / "export_scene.png"))
        page.do("download", testid="export", path=str(scene))
        # the browser tells of the first answer, which has status 428
        assert all("428" in each for each in page.complaints), page.complaints
    with ZipFile(scene) as packed:
        held = b"".join(packed.read(member) for member in packed.namelist())
    assert len(held) > 500_000
    assert str(dataset.PatientID).encode() not in held
    assert str(tmp_path).encode() not in held
    with ZipFile(path) as packed:
        assert "deidentification.csv" in packed.namelist()
        (one,) = dcmread(packed.open("segments.dcm")).SegmentSequence
    assert one.SegmentLabel == "bone"
