"""Opening scans on the page in a real browser: from a list, dropped, over the open one."""

from __future__ import annotations

import json
import shutil
import zipfile
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest
import SimpleITK
from browser import ROOT, Browser, browser, palpate
from held_back import held_back
from numpy.typing import NDArray
from orthanc import orthanc
from pydicom import dcmread
from pydicom.uid import generate_uid
from rtk_words import write_geometry

pytestmark = [pytest.mark.browser, pytest.mark.data]

OUTPUT = ROOT / "tests" / "output"
SIZE = {"width": 1366, "height": 768}
READY = "window.palpate?.ready === true"


def exchanged(page: Browser, name: str) -> None:
    """Waits until the page shows another scan; it loads itself anew meanwhile."""
    named = f"document.querySelector('header .scan')?.textContent.endsWith({name!r})"
    page.wait(f"{READY} && {named}", seconds=120.0)


def test_a_page_without_a_scan_lists_takes_and_exchanges_scans(
    data_folder: Path, tmp_path: Path
) -> None:
    head = data_folder / "cthead_stanford" / "CThead.mha"
    study = tmp_path / "study"
    shutil.copytree(data_folder / "dcmqi_seg" / "ct-3slice", study / "thin")
    shutil.copytree(data_folder / "dcmqi_seg" / "23x38x3", study / "small")
    with palpate("open", state=tmp_path / "state") as command, browser() as page:
        page.do("open", url=command.url, **SIZE)
        chosen_from_a_list(page, study)
        # a file that is dropped onto the open scan takes its place
        page.do("drop", paths=[str(head)])
        exchanged(page, "CThead")
        # names of files that are dropped may be those of patients
        assert page.read("document.title") == "scan · Palpate"
        assert page.read("window.palpate.scan.dimensions") == [256, 256, 113]
        page.wait(
            "document.querySelector('aside').textContent.includes('emporary copy; save the scene')"
        )
        chosen_over_the_scan(page, study / "thin")
        archive_dropped(page, study / "thin", tmp_path / "study.zip")
        segments_from_a_file(page, data_folder / "dcmqi_seg" / "liver.dcm")
        segments_dropped_as_a_scan(page, data_folder / "dcmqi_seg" / "liver.dcm")
        many_volumes_unfolded(page, directions(study / "small" / "image", tmp_path / "directions"))
        raw_slices_dropped(page, data_folder / "cthead_stanford" / "raw")
        projections_dropped(page, tmp_path / "ball_proj.nrrd")
        assert [text for text in page.complaints if "400" not in text] == []
        assert command.stop() == 0


def chosen_from_a_list(page: Browser, study: Path) -> None:
    """Looks at a path that leads nowhere, then at one with several series, and opens one."""
    assert "Drop a scan here" in page.text("open-page")
    page.do("screenshot", path=str(OUTPUT / "open-start.png"))
    assert page.do("axe")["value"] == []
    page.do("fill", testid="open-path", text=str(study / "nowhere"))
    page.do("click", testid="open-look")
    page.shows("open-failure", "text.includes('does not exist')")
    page.do("fill", testid="open-path", text=str(study))
    page.do("click", testid="open-look")
    page.wait("document.querySelectorAll('[data-testid=series-list] img').length >= 2")
    listed = page.text("series-list")
    assert "512 × 512 × 3" in listed
    assert "JANCT000" in listed
    page.do("screenshot", path=str(OUTPUT / "open-list.png"))
    assert page.do("axe")["value"] == []
    page.do("click", testid="series-0")
    page.wait(READY, seconds=120.0)
    # list and header name the patient; the title, which the browser's history keeps, does not
    assert "JANCT000" in page.text("whose-scan")
    assert "JANCT000" not in page.read("document.title")
    assert page.read("window.palpate.scan.dimensions") == [512, 512, 3]


def segments_from_a_file(page: Browser, path: Path) -> None:
    """Adds the segment of a DICOM SEG to the open scan, and takes it back."""
    count = "document.querySelectorAll('[data-testid^=visible-]').length"
    before = page.read(count)
    page.do("click", testid="segments-from-file")
    page.do("screenshot", path=str(OUTPUT / "open-segments.png"))
    assert page.do("axe")["value"] == []
    page.do("fill", testid="open-path", text=str(path.parent / "ct-3slice"))
    page.do("click", testid="open-look")
    page.shows("open-failure", "text.includes('holds no masks')")
    page.do("fill", testid="open-path", text=str(path))
    page.do("click", testid="open-look")
    page.wait(f"{count} === {before + 1} && document.querySelector('dialog[open]') === null")
    page.do("press", key="Control+z")
    page.wait(f"{count} === {before}")


def segments_dropped_as_a_scan(page: Browser, path: Path) -> None:
    """Drops segments onto the open scan: they are said to be none, and added to it."""
    count = "document.querySelectorAll('[data-testid^=visible-]').length"
    before = page.read(count)
    page.do("drop", paths=[str(path)])
    page.shows("labels-card", "text.includes('liver.dcm is a DICOM segmentation')")
    page.do("screenshot", path=str(OUTPUT / "open-labels.png"))
    assert page.do("axe")["value"] == []
    page.do("click", testid="labels-add")
    page.wait(f"{count} === {before + 1} && document.querySelector('dialog[open]') === null")
    page.do("press", key="Control+z")
    page.wait(f"{count} === {before}")


def directions(folder: Path, target: Path) -> Path:
    """Writes the slices of a folder with six directions of diffusion, and a mask of them."""
    target.mkdir()
    series = generate_uid()
    slices = sorted(path for path in folder.iterdir() if path.is_file())
    for number, path in enumerate(slices * 6):
        image = dcmread(path)
        image.SOPInstanceUID = image.file_meta.MediaStorageSOPInstanceUID = generate_uid()
        image.SeriesInstanceUID, image.SeriesDescription = series, "diffusion"
        image.DiffusionGradientOrientation = [1.0, 0.0, float(number // 3)]
        image.save_as(target / f"{number}.dcm")
    mask = np.zeros((3, 38, 23), np.uint8)
    mask[:, 10:30, 5:15] = 1
    SimpleITK.WriteImage(SimpleITK.GetImageFromArray(mask), str(target / "mask.nii.gz"))
    return target


def many_volumes_unfolded(page: Browser, folder: Path) -> None:
    """Lists six volumes of one series as one entry, unfolds it, and leaves it."""
    page.do("press", key="Control+o")
    page.do("fill", testid="open-path", text=str(folder))
    page.do("click", testid="open-look")
    page.shows("volumes-0", "text.includes('6 volumes')")
    assert "direction 1 0 4" not in page.text("series-list")
    page.do("click", testid="volumes-0")
    page.shows("series-4", "text.includes('direction 1 0 4')")
    page.wait(f"{PICTURES}.length === 9")
    page.do("screenshot", path=str(OUTPUT / "open-unfolded.png"))
    assert page.do("axe")["value"] == []
    # segments beside them are said to be some
    page.shows("series-6", "text.includes('Segments: a label map')")
    page.do("click", testid="series-6")
    page.shows("labels-card", "text.includes('mask.nii.gz is a label map')")
    page.do("click", testid="leave-list")
    page.do("press", key="Escape")


def raw_slices_dropped(page: Browser, folder: Path) -> None:
    """Drops raw slices, tells what they do not, and opens them; the next time it is known."""
    page.do("drop", paths=[str(folder)])
    page.shows("bare-told", "text.includes('256 × 256 × 113 voxels, 14 MiB of memory')")
    chosen = "(id => document.querySelector(`[data-testid=${id}]`))"
    assert page.read(f"{chosen}('bare-order').value") == "big"
    assert page.read(f"{chosen}('bare-open').disabled")
    page.do("fill", testid="bare-rows", text="300")
    page.do("press", key="Tab")
    page.shows("bare-told", "text.includes('131072 bytes; 256 × 300 int16 asks 153600')")
    page.do("screenshot", path=str(OUTPUT / "open-raw-refused.png"))
    for field, text in (("rows", "256"), ("voxel-x", "1"), ("voxel-y", "1"), ("voxel-z", "2")):
        page.do("fill", testid=f"bare-{field}", text=text)
        page.do("press", key="Tab")
    page.wait(f"!{chosen}('bare-open').disabled && {chosen}('bare-slice') !== null")
    page.do("screenshot", path=str(OUTPUT / "open-raw.png"))
    assert page.do("axe")["value"] == []
    page.do("click", testid="bare-open")
    exchanged(page, "raw")
    assert page.read("window.palpate.scan.dimensions") == [256, 256, 113]
    page.do("drop", paths=[str(folder)])
    page.wait(f"{chosen}('bare-open')?.disabled === false")
    assert page.read(f"{chosen}('bare-voxel-z').value") == "2"
    page.do("click", testid="leave-list")
    page.do("press", key="Escape")


def chosen_over_the_scan(page: Browser, folder: Path) -> None:
    """Opens a folder by the chooser, over the open scan."""
    page.do("click", testid="open-scan")
    page.do("screenshot", path=str(OUTPUT / "open-over.png"))
    page.do("give", testid="open-folder", path=str(folder))
    page.wait(f"{READY} && window.palpate.scan.dimensions[2] === 3", seconds=120.0)
    page.do("press", key="Control+o")
    page.wait("document.querySelector('[data-testid=recent] button') !== null")
    page.do("press", key="Escape")
    page.wait("document.querySelector('[data-testid=open-page]') === null")


def archive_dropped(page: Browser, folder: Path, archive: Path) -> None:
    """Drops an archive of one series."""
    with zipfile.ZipFile(archive, "w") as packed:
        for file in folder.iterdir():
            packed.write(file, file.name)
    page.read("window.before = true")
    page.do("drop", paths=[str(archive)])
    page.wait(f"{READY} && window.before === undefined", seconds=120.0)
    assert page.read("window.palpate.scan.dimensions") == [512, 512, 3]


def projections_dropped(page: Browser, path: Path) -> None:
    """Drops projections of a ball, answers what they do not tell, opens them as a scan."""
    v, u = np.indices((24, 40)) * 2.0 - np.array([23.0, 39.0])[:, None, None]
    through = 2.0 * np.sqrt(np.maximum(0.0, 18.0**2 - u * u - v * v))
    images = np.repeat((0.0206 * through)[None], 36, axis=0).astype(np.float32)
    stack = SimpleITK.GetImageFromArray(images)
    stack.SetSpacing((2.0, 2.0, 1.0))
    SimpleITK.WriteImage(stack, str(path))
    page.do("drop", paths=[str(path)])
    page.wait("document.querySelector('[data-testid=reconstruct-card]') !== null")
    page.shows("reconstruct-grid", "text.includes('40 × 40 × 24 voxels of 1.302')")
    # what the work does is tested without a page: loading RTK alone takes a minute
    missing = "document.querySelector('[data-testid=reconstruct-missing]') !== null"
    assert page.read(missing) == (find_spec("itk") is None)
    refused = "document.querySelector('[data-testid=reconstruct]').disabled"
    assert page.read(refused) == page.read(missing)
    page.do("choose", testid="project-beam", value="parallel")
    page.shows("reconstruct-grid", "text.includes('40 × 40 × 24 voxels of 2 × 2 × 2 mm')")
    page.do("screenshot", path=str(OUTPUT / "open-projections.png"))
    assert page.do("axe")["value"] == []
    # parallel beams need no library
    assert not page.read(missing)
    assert not page.read(refused)
    geometry_chosen(page, path.with_name("geometry.xml"))
    page.do("click", testid="not-projected")
    exchanged(page, "ball_proj")
    assert page.read("window.palpate.scan.dimensions") == [40, 24, 36]


def geometry_chosen(page: Browser, path: Path) -> None:
    """Chooses a file that states where source and detector are, and takes it away again."""
    distances = {"SourceToIsocenterDistance": 1000.0, "SourceToDetectorDistance": 0.0}
    write_geometry(path, [{"GantryAngle": 10.0 * number, **distances} for number in range(36)])
    page.read(f"""(() => {{
        const chosen = new DataTransfer();
        chosen.items.add(new File([{json.dumps(path.read_text())}], "geometry.xml"));
        const input = document.querySelector("[data-testid=geometry-file]");
        input.files = chosen.files;
        input.dispatchEvent(new Event("change", {{ bubbles: true }}));
    }})()""")
    page.shows("geometry-name", "text === 'geometry.xml'")
    # what the file states is asked for no more
    arc = "document.querySelector('[data-testid=project-arc]')"
    assert page.read(f"{arc} === null")
    page.shows("reconstruct-grid", "text.includes('40 × 40 × 24 voxels of 2 × 2 × 2 mm')")
    page.do("screenshot", path=str(OUTPUT / "open-geometry.png"))
    assert page.do("axe")["value"] == []
    page.do("click", testid="geometry-leave")
    page.wait(f"{arc} !== null")


def test_a_servers_scans_are_listed_seen_and_opened(data_folder: Path, tmp_path: Path) -> None:
    head = data_folder / "dcmqi_seg" / "ct-3slice"
    times = two_times(head, tmp_path / "times")
    with (
        orthanc() as server,
        palpate("open", state=tmp_path / "state") as command,
        browser() as page,
    ):
        server.store([*head.iterdir(), *times.iterdir()])
        page.do("open", url=command.url, **SIZE)
        page.do("fill", testid="open-path", text="http://127.0.0.1:1/dicom-web")
        page.do("click", testid="open-look")
        page.shows("open-failure", "text.startsWith('No server answers')")
        page.do("fill", testid="open-path", text=server.dicomweb)
        page.do("click", testid="open-look")
        page.wait(f"{PICTURES}.length === 2")
        assert "512 × 512 × 3" in page.text("series-list")
        page.do("screenshot", path=str(OUTPUT / "open-server.png"))
        page.do("click", testid=place_of(page, "two times"))
        # one series, two volumes: these are offered once they are here
        page.wait(
            f"document.querySelector('[data-testid=series-list]')?.textContent.includes('time 2')"
            f" && {PICTURES}.length === 2"
        )
        page.do("screenshot", path=str(OUTPUT / "open-volumes.png"))
        assert page.do("axe")["value"] == []
        page.do("click", testid=place_of(page, "two times, time 2"))
        exchanged(page, "two times, time 2")
        assert page.read("window.palpate.scan.dimensions") == [512, 512, 3]
        assert page.picture(OUTPUT / "open-server-scan.png").std() > 0.02
        assert [text for text in page.complaints if "400" not in text] == []
        assert command.stop() == 0


PICTURES = "document.querySelectorAll('[data-testid=series-list] img')"


def place_of(page: Browser, name: str) -> str:
    """Returns the test id of a scan in the list by its name."""
    names = page.read(
        "[...document.querySelectorAll('[data-testid=series-list] .name')].map(e => e.textContent)"
    )
    return f"series-{names.index(name)}"


def two_times(folder: Path, target: Path) -> Path:
    """Writes the slices of a folder as two times of one series."""
    target.mkdir()
    series = generate_uid()
    for number, path in enumerate([*folder.iterdir()] * 2):
        image = dcmread(path)
        image.SOPInstanceUID = image.file_meta.MediaStorageSOPInstanceUID = generate_uid()
        image.SeriesInstanceUID, image.SeriesDescription = series, "two times"
        image.TemporalPositionIdentifier = 1 + number // 3
        image.save_as(target / f"{number}.dcm")
    return target


def test_a_large_scan_is_seen_coarsely_until_all_of_it_is_there(tmp_path: Path) -> None:
    values = np.zeros((136, 512, 512), np.int16)
    values[40:100, 150:350, 151:350] = 400
    path = tmp_path / "large.nrrd"
    SimpleITK.WriteImage(SimpleITK.GetImageFromArray(values), str(path), useCompression=True)
    opened = palpate("open", path, "--threshold", "400", state=tmp_path)
    with opened as command, browser(drawer="browser") as page:
        first = page.do("open", url=command.url, width=640, height=480)["firstPicture"]
        assert 0.0 < first < page.read("window.palpate.bench.wholePicture")
        # what is clicked then is that of all of the scan, to the voxel
        picked = page.read("window.palpate.pick(...window.palpate.middle)?.point")
        assert picked[1] == pytest.approx(150.0, abs=1.0)
        assert page.complaints == []


@pytest.mark.long
def test_what_has_arrived_of_a_large_scan_is_seen_while_the_rest_is_on_its_way(
    data_folder: Path, tmp_path: Path
) -> None:
    path = data_folder / "lidc0001_totalseg" / "cxr.nii.gz"
    planes, plane_bytes, coarse_planes = 133, 512 * 512 * 2, 45
    with (
        palpate("open", path, state=tmp_path) as command,
        held_back(command.url, asked="/api/volume?step=1 ", most=70 * plane_bytes) as way,
        browser(drawer="browser") as page,
    ):
        page.do("open", url=way.url, **SIZE, seconds=0.001)
        page.wait("window.palpate?.firstPicture > 0", seconds=120.0)
        page.do("click", testid="layout-four")
        page.wait(f"window.palpate.drawnPlanes > {coarse_planes}")
        # a view that a person has turned stays as it is
        page.do("drag", x=60, y=15)
        arrived = page.read("window.palpate.drawnPlanes")
        # planes are handed on by fours
        assert 60 <= arrived <= 70
        assert not page.read(READY)
        assert 0.4 < page.read("document.querySelector('progress').value") < 0.5
        camera = page.read("window.palpate.camera")
        part = seen_of(page, "part")

        way.released.set()
        page.wait(READY, seconds=120.0)
        assert page.read("window.palpate.drawnPlanes") == planes
        assert page.read("window.palpate.camera") == camera
        whole = seen_of(page, "whole")
        off = {name: np.abs(part[name] - whole[name]).mean(axis=2) for name in part}
        # the scan begins at the feet, and its middle is in the middle: two fifths of the height
        # have arrived, two fifths surely not, and no pixel of a slice is between both
        fifth = off["slice"].shape[0] // 5
        assert off["slice"][3 * fifth :].max() < 1.0 / 255.0
        assert off["slice"][: 2 * fifth].mean() > 2.0 / 255.0
        # rays go up and down a little, and shade is that of the coarse scan until all is there
        third = off["view"].shape[0] // 3
        assert off["view"][2 * third :].mean() < 0.2 * off["view"][:third].mean()
        assert page.complaints == []
        assert command.stop() == 0


def seen_of(page: Browser, name: str) -> dict[str, NDArray[np.float64]]:
    """Returns the 3-D view and a slice as they are drawn, RGB 0..1, shape [h, w, 3]."""
    view = page.picture(OUTPUT / f"open-{name}-view.png")
    path = OUTPUT / f"open-{name}-slice.png"
    page.do("screenshot", path=str(path), testid="slice-coronal")
    pixels = SimpleITK.GetArrayFromImage(SimpleITK.ReadImage(str(path)))
    return {"view": view, "slice": np.asarray(pixels[..., :3], np.float64) / 255.0}
