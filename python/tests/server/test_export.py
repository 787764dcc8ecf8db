"""Files that a page asks for to share: names of segments, and what a person confirms first."""

from __future__ import annotations

import json
from io import BytesIO
from pathlib import Path
from zipfile import ZipFile

import numpy as np
from made_scans import series_writer
from palpate.io.reading import read
from palpate.volumes.scene import Scene
from pydicom import dcmread
from running_server import running, write_page


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
