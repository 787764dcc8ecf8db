"""Small pictures of a scan in each preset."""

from __future__ import annotations

from base64 import b64decode
from io import BytesIO
from typing import Any

import numpy as np
import pytest
from made_scans import make_ball
from numpy.typing import NDArray
from palpate.base.errors import OptionError
from palpate.pictures.live_view import LiveView
from palpate.pictures.still_pictures import StillPictures
from palpate.server.preset_pictures import SIZE, PresetsRequest, preset_pictures_job
from palpate.session.session import Session
from PIL import Image


def drawn(*presets: str) -> dict[str, NDArray[np.uint8]]:
    """Returns the pictures that a page gets, by the names that it asked for."""
    lines: list[Any] = []
    with Session(make_ball()) as session:
        wanted = PresetsRequest(list(presets))
        volume = session.scene.volume
        job = preset_pictures_job(wanted, volume, lambda: StillPictures(session, LiveView()))
        job._run(lines.append)
    assert lines[-2:] == [{"kind": "done"}, None]
    return {
        line["preset"]: np.asarray(Image.open(BytesIO(b64decode(line["png"]))).convert("RGBA"))
        for line in lines[:-1]
        if line["kind"] == "preset"
    }


def test_each_preset_has_a_picture_of_the_scan_under_the_name_that_was_asked_for() -> None:
    pictures = drawn("Bone in tissue", "CT-Soft-Tissue", "CT-Muscle")
    assert list(pictures) == ["Bone in tissue", "CT-Soft-Tissue", "CT-Muscle"]
    for picture in pictures.values():
        assert picture.shape == (SIZE[1], SIZE[0], 4)
        # something is seen in the middle, nothing in a corner
        assert picture[SIZE[1] // 2, SIZE[0] // 2, 3] > 0
        assert picture[0, 0, 3] == 0
    assert np.abs(pictures["CT-Soft-Tissue"].astype(int) - pictures["CT-Muscle"]).mean() > 2.0


def test_a_preset_that_there_is_not_is_refused_before_any_is_drawn() -> None:
    with pytest.raises(OptionError, match="preset 'CT-Bones' given"):
        drawn("CT-Bone", "CT-Bones")
