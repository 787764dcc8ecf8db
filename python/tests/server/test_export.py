"""Files that a page asks for to share: names of segments, and what a person confirms first."""

from __future__ import annotations

import json
from concurrent.futures import ThreadPoolExecutor
from io import BytesIO
from pathlib import Path
from threading import Event
from typing import Any
from zipfile import ZipFile

import numpy as np
import pytest
from made_scans import series_writer
from palpate.export.export import export_scene
from palpate.io.reading import read
from palpate.saved.scene_file import open_scene
from palpate.volumes.phantom import phantom
from palpate.volumes.scene import Scene
from pydicom import dcmread
from running_server import PATIENCE, RunningServer, running, write_page


def test_segments_of_one_name_are_shared_by_names_of_their_own_once_pixels_are_looked_at(
    tmp_path: Path,
) -> None:
    volume = read(series_writer(tmp_path)(BurnedInAnnotation="YES"))
    masks = np.zeros((2, *volume.shape), bool)
    masks[0, :2], masks[1, 2:] = True, True
    scene = Scene(volume, [volume.segment(mask, name="part") for mask in masks])
    wanted = {"kind": "dicom", "names": {"1": "upper", "2": " "}}
    with running(scene, write_page(tmp_path / "page")) as server:
        refused = server.ask("POST", "/api/export", json.dumps(wanted).encode())
        assert refused.status_code == 428
        assert "have text in their pixels" in refused.text
        confirmed = json.dumps(wanted | {"pixels_checked": True}).encode()
        made = server.ask("POST", "/api/export", confirmed)
        assert made.status_code == 200
    with ZipFile(BytesIO(made.content)) as packed:
        segments = dcmread(packed.open("segments.dcm")).SegmentSequence
    # a blank name is none
    assert [one.SegmentLabel for one in segments] == ["upper", "part"]


@pytest.mark.parametrize("kind", ["labels", "seg-nrrd"])
def test_an_edit_is_answered_while_an_export_runs_and_is_not_in_its_file(
    kind: str, server: RunningServer, monkeypatch: pytest.MonkeyPatch
) -> None:
    begun, goes_on = Event(), Event()

    def long(*given: Any, **options: Any) -> list[str]:
        begun.set()
        assert goes_on.wait(PATIENCE)
        return export_scene(*given, **options)

    monkeypatch.setattr("palpate.server.export.export_scene", long)
    threshold = {"type": "threshold", "id": None, "name": "late", "low": 50.0, "high": 200.0}
    with server.page() as page, ThreadPoolExecutor(1) as others:
        page.receive("hello")
        export = others.submit(
            server.ask, "POST", "/api/export", json.dumps({"kind": kind}).encode()
        )
        try:
            assert begun.wait(PATIENCE)
            page.send(threshold)
            page.receive("segments", until=lambda m: len(m["segments"]) == 2)
            page.send({"type": "remove_segment", "id": 1})
            page.receive("segments", until=lambda m: len(m["segments"]) == 1)
            assert not export.done()
        finally:
            goes_on.set()
        made = export.result(PATIENCE)
    assert made.status_code == 200
    # what there was when it began
    if kind == "labels":
        with ZipFile(BytesIO(made.content)) as packed:
            told = packed.read("labels.csv").decode()
    else:
        told = made.content.partition(b"\n\n")[0].decode()
    assert "ball" in told
    assert "late" not in told


def test_a_scene_is_shared_without_names_and_paths_once_pixels_are_looked_at(
    tmp_path: Path,
) -> None:
    series = series_writer(tmp_path)(PatientName="Alvarez^Ana", BurnedInAnnotation="YES")
    volume = read(series)
    scene = Scene(volume, [volume.segment(volume.array > 0, name="Alvarez tip")])
    wanted = {"view": {"camera": None, "remembered": {"panels": 1}}}
    with running(scene, write_page(tmp_path / "page")) as server:
        refused = server.ask("POST", "/api/scene/shared", json.dumps(wanted).encode())
        assert refused.status_code == 428
        confirmed = json.dumps(wanted | {"pixels_checked": True}).encode()
        made = server.ask("POST", "/api/scene/shared", confirmed)
        assert made.status_code == 200
        assert "x-palpate-notes" not in made.headers
    told = made.content + b"".join(members(made.content))
    assert b"Alvarez" not in told
    assert tmp_path.name.encode() not in told
    path = tmp_path / "other" / "shared.palpate"
    path.parent.mkdir()
    path.write_bytes(made.content)
    saved = open_scene(path)
    np.testing.assert_array_equal(saved.volume.array, volume.array)


@pytest.mark.parametrize(("checked", "name"), [(False, b"segment 1"), (True, b"Quixotessa")])
def test_names_of_a_scan_without_headers_become_numbers_unless_they_were_looked_at(
    *, checked: bool, name: bytes, tmp_path: Path
) -> None:
    volume = phantom().volume
    scene = Scene(volume, [volume.threshold(200, name="Quixotessa")])
    wanted = {"view": {}, "names_checked": checked}
    with running(scene, write_page(tmp_path / "page")) as server:
        made = server.ask("POST", "/api/scene/shared", json.dumps(wanted).encode())
    assert made.status_code == 200
    assert ("x-palpate-notes" in made.headers) is not checked
    held = b"".join(members(made.content))
    assert name in held
    assert (b"Quixotessa" in held) is checked


def members(packed: bytes) -> list[bytes]:
    """Returns what a packed file holds."""
    with ZipFile(BytesIO(packed)) as archive:
        return [archive.read(one) for one in archive.namelist()]
