"""What Python calls are given by mistake is refused by the argument's name, in its own words."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import palpate
import pytest
from palpate import OptionError, Scene, Session, SessionOptions, Volume


@pytest.fixture
def volume() -> Volume:
    values = np.zeros((16, 16, 16), np.int16)
    values[:8] = 1000
    return Volume(values, spacing=(1.0, 1.0, 1.0))


@pytest.fixture
def session(volume: Volume) -> Iterator[Session]:
    scene = Scene(volume, [volume.threshold(500)])
    with Session(scene, options=SessionOptions(real_time=False)) as started:
        yield started


@pytest.mark.parametrize("material", [5, (1.0, 2.0), {"young": 1.0}])
def test_what_is_no_material_is_refused_and_the_one_before_stays(
    session: Session, material: Any
) -> None:
    session.set_material(1, "liver")
    before = session.segments()[0]["material"]
    with pytest.raises(OptionError, match=r"material .* given; allowed: a Material, a Linear"):
        session.set_material(1, material)
    assert session.segments()[0]["material"] == before is not None


@pytest.mark.parametrize(
    ("name", "call"),
    [
        ("target", lambda session, given: session.hand(given)),
        ("point", lambda session, given: session.place(given)),
        ("up", lambda session, given: session.view(right=(1.0, 0.0, 0.0), up=given)),
        ("rotation", lambda session, given: session.turn_grabbed(given)),
        ("normal", lambda session, given: session.cut(1, (8.0, 8.0, 4.0), given)),
    ],
)
@pytest.mark.parametrize("given", [(1, 2), (1, 2, 3, 4), 5, ("a", "b", "c"), None])
def test_what_is_no_point_is_refused_by_name(
    session: Session, name: str, call: Callable[[Session, Any], Any], given: Any
) -> None:
    with pytest.raises(OptionError) as caught:
        call(session, given)
    assert str(caught.value) == f"{name} {given!r} given; allowed: three numbers, x, y, z"


def test_a_volume_in_the_place_of_a_scene_is_refused(volume: Volume, tmp_path: Path) -> None:
    said = r"scene of type Volume given; allowed: a Scene, as palpate.Scene\(volume"
    with pytest.raises(OptionError, match=said):
        Session(volume)  # type: ignore[arg-type]
    with pytest.raises(OptionError, match=said):
        palpate.export_scene(volume, tmp_path / "a.nrrd")  # type: ignore[arg-type]


def test_arrays_in_the_place_of_scans_and_segments_are_refused(volume: Volume) -> None:
    with pytest.raises(OptionError, match="volume of type ndarray given; allowed: a Volume"):
        Scene(volume.array)  # type: ignore[arg-type]
    with pytest.raises(OptionError, match="segment of type ndarray given; allowed: a Segment"):
        Scene(volume, [volume.array > 0])  # type: ignore[list-item]
