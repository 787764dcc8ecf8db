"""Projections that pages find, ask about and have reconstructed."""

from __future__ import annotations

import sys
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import SimpleITK
from palpate.reconstruction.reconstruction import reconstruct
from palpate.reconstruction.scanner import Scanner
from projected_phantom import SIZE, VOXEL, flat, projected, scanner_of, truth
from rtk_words import ball_images, write_geometry
from running_server import LibraryClient

needs_rtk = pytest.mark.skipif(
    find_spec("itk") is None, reason="RTK is not installed: pip install 'palpate[reconstruct]'"
)


@pytest.fixture(scope="module")
def rtk() -> None:
    """RTK's modules, loaded: that takes as long as the disk needs, and requests have limits."""
    scanner = Scanner(beam="parallel", angles=range(0, 360, 45), pixel=(1.0, 1.0))
    reconstruct(np.zeros((8, 2, 4)), scanner)


@pytest.fixture
def projections(tmp_path: Path) -> Path:
    """Cone-beam projections of ellipsoids, with the detector's pixels in the file."""
    scanner = scanner_of("cone")
    image = SimpleITK.GetImageFromArray(projected(scanner).astype(np.float32))
    image.SetSpacing((*scanner.pixel, 1.0))
    path = tmp_path / "phantom_proj.nrrd"
    SimpleITK.WriteImage(image, str(path))
    return path


def asked(found: dict[str, Any], **changes: Any) -> dict[str, Any]:
    return {"find": found["find"], "request": {**found["suggested"], **changes}}


@needs_rtk
@pytest.mark.usefixtures("rtk")
def test_projections_are_recognised_asked_about_and_opened_as_a_scan(
    client: LibraryClient, projections: Path
) -> None:
    found, done = client.job("find", {"path": str(projections)})
    assert done == {"kind": "done"}
    assert (found["kind"], found["name"], found["missing"]) == ("projections", "phantom_proj", None)
    assert (found["shape"], found["suggested"]["pixel"]) == ([120, 40, 80], [2.0, 2.5])
    distances = {"source_to_axis": 600.0, "source_to_detector": 900.0}
    answer = client.ask("POST", "library/reconstruct/grid", asked(found, **distances))
    assert answer.json()["size"] == [80, 80, 40]
    answer = client.ask("POST", "library/reconstruct/grid", asked(found, arc=200.0))
    assert (answer.status_code, answer.text[:27]) == (400, "an arc of 200 degrees given")

    wanted = asked(found, **distances, size=SIZE, voxel=VOXEL)
    assert client.job("reconstruct", wanted) == [{"kind": "done"}]
    opened = client.workbench.opened
    assert opened is not None
    volume = opened.session.scene.volume
    assert (volume.name, volume.modality, volume.unit) == ("phantom_proj", "CT", "HU")
    assert any("in no file" in warning for warning in volume.warnings)
    right = truth()
    inner = flat(right) & (right > -900.0)
    values = volume.slope * volume.array + volume.intercept
    assert float(np.sqrt(((values - right)[inner] ** 2).mean())) < 25.0
    # nothing that could be opened again by its path
    assert client.about()["recent"] == []

    # beside the open scan, and by a name that says nothing
    plain = projections.with_name("head.nrrd")
    projections.rename(plain)
    found, _ = client.job("find", {"path": str(plain), "taken_as": "projections"})
    client.job("reconstruct", {**asked(found, **distances, voxel=[4, 4, 4]), "beside": True})
    assert client.workbench.opened is opened
    second = opened.session.scene.second
    assert second is not None
    assert second.volume.dimensions == (27, 27, 17)


@needs_rtk
@pytest.mark.usefixtures("rtk")
def test_what_was_dropped_goes_when_its_scan_is_made(
    client: LibraryClient, projections: Path
) -> None:
    upload = client.upload({projections.name: projections.read_bytes()})
    found, _ = client.job("find", {"upload": upload})
    distances = {"source_to_axis": 600.0, "source_to_detector": 900.0}
    (failed,) = client.job("reconstruct", asked(found, arc=100.0))
    assert "an arc of 100 degrees given" in failed["reason"]
    assert client.job("reconstruct", asked(found, **distances, voxel=[4, 4, 4])) == [
        {"kind": "done"}
    ]
    assert "is gone" in client.ask("POST", "library/find", {"upload": upload}).text
    opened = client.workbench.opened
    assert opened is not None
    # its name may be that of a patient
    assert opened.session.scene.volume.title == "CT"


def test_what_looks_like_projections_can_be_a_scan(
    client: LibraryClient, projections: Path
) -> None:
    found, *_ = client.job("find", {"path": str(projections), "taken_as": "scan"})
    assert (found["kind"], len(found["scans"])) == ("found", 1)
    assert client.job("open", {"find": found["find"]}) == [{"kind": "done"}]
    # a list of scans is no projections
    refused = client.ask("POST", "library/reconstruct", {"find": found["find"], "request": REQUEST})
    assert "those projections are gone" in refused.text


REQUEST = {"beam": "parallel", "pixel": [1, 1]}


def test_a_page_brings_the_file_that_states_the_geometry(
    client: LibraryClient, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "itk", None)
    # a file of parallel beams, as RTK writes it
    distances = {"SourceToIsocenterDistance": 400.0, "SourceToDetectorDistance": 0.0}
    stated = [{"GantryAngle": 12.0 * number, **distances} for number in range(30)]
    ball = (20.0, 30.0, 10.0)
    images = ball_images(stated, ball, 8.0, pixel=(4.0, 4.0), shape=(12, 32))
    path = tmp_path / "ball_proj.mha"
    SimpleITK.WriteImage(SimpleITK.GetImageFromArray(images.astype(np.float32)), str(path))
    found, _ = client.job("find", {"path": str(path)})
    xml = write_geometry(tmp_path / "geometry.xml", stated).read_bytes()
    geometry = client.upload({"geometry.xml": xml})
    wanted = {
        "find": found["find"],
        "geometry": geometry,
        "request": {"beam": "parallel", "pixel": [4, 4], "size": [32, 32, 12]},
    }
    assert client.ask("POST", "library/reconstruct/grid", wanted).json()["size"] == [32, 32, 12]
    # what the form says beside the file, and a file of other projections
    doubled = {**wanted, "request": {**wanted["request"], "zero": "back"}}
    told = client.ask("POST", "library/reconstruct/grid", doubled).text
    assert told.startswith("zero given with a geometry file. Use one of them")
    short = write_geometry(tmp_path / "short.xml", stated[:20]).read_bytes()
    other = {**wanted, "geometry": client.upload({"short.xml": short})}
    told = client.ask("POST", "library/reconstruct/grid", other).text
    said = "short.xml describes 20 projections, and ball_proj.mha holds 30. Use as many"
    assert told == said
    assert client.job("reconstruct", other) == [{"kind": "failed", "reason": said}]

    assert client.job("reconstruct", wanted) == [{"kind": "done"}]
    opened = client.workbench.opened
    assert opened is not None
    volume = opened.session.scene.volume
    z, y, x = np.nonzero(volume.slope * volume.array + volume.intercept > -500.0)
    middle = volume.patient_from_grid @ [x.mean() + 0.5, y.mean() + 0.5, z.mean() + 0.5, 1.0]
    # a quarter of a voxel
    np.testing.assert_allclose(middle[:3], ball, atol=1.0)
    assert f"upload {geometry} is gone" in client.ask("POST", "library/reconstruct", wanted).text


def test_without_rtk_a_page_is_told_what_to_install(
    client: LibraryClient, projections: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "itk", None)
    found, _ = client.job("find", {"path": str(projections)})
    assert "pip install 'palpate[reconstruct]'" in found["missing"]
    (failed,) = client.job("reconstruct", asked(found))
    assert "RTK is not installed" in failed["reason"]
    assert client.about()["scan"] is None
