"""Areas that a page has drawn are measured in true values, as edits have left them."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest


def test_a_page_gets_the_values_in_its_areas(shared_server: Any) -> None:
    volume = shared_server.session.scene.volume
    matrix = volume.patient_from_grid
    middle = matrix[:3, :3] @ (np.array(volume.dimensions) // 2 + 0.5) + matrix[:3, 3]
    edge = volume.spacing[0]
    points = middle + edge * np.array([[0, 0, 0], [2.2, 0, 0], [0, 1.2, 0]])
    body = {"areas": [{"kind": "rectangle", "points": points.tolist()}]}
    answer = shared_server.ask("POST", "/api/areas", json.dumps(body).encode())
    (found,) = json.loads(answer.text)
    x, y, z = (count // 2 for count in volume.dimensions)
    voxels = volume.values((z, slice(y - 1, y + 2), slice(x - 2, x + 3)))
    assert found["count"] == 15
    assert found["mean"] == pytest.approx(float(voxels.mean()))
    assert found["area"] == pytest.approx(4 * 2.2 * 1.2 * edge**2)


def test_a_page_is_told_what_is_no_area(shared_server: Any) -> None:
    for body in ('{"areas": [{"kind": "circle", "points": []}]}', "x", '{"areas": 3}'):
        assert shared_server.ask("POST", "/api/areas", body.encode()).status_code == 400
