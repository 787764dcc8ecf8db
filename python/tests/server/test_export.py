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
