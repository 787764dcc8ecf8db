"""What the engine returns has the keys and types that ``_core.pyi`` declares."""

from __future__ import annotations

import types
import typing
from collections.abc import Sequence
from typing import Any, Literal, TypedDict, Union, is_typeddict

import numpy as np
import palpate
import pytest
from palpate import _core  # noqa: TID251  # the stub is held against it
from palpate.bench.results import (
    EmbeddedResult,
    LatticeFrames,
    PairsResult,
    PressedBlock,
    SessionResult,
    SoftTissueStressResult,
    StressResult,
)
from palpate.scenarios.drive import Drive
from palpate.scenarios.engine_run import DrillRun, NeedleRun, PressRun, RearrangingRun
from palpate.session.deformation_state import DeformationState, ModelOffer, ModelParts
from palpate.session.frame_state import FrameState, LatenessState
from palpate.session.model_options import ModelOptions, Prony
from palpate.session.picture_change import PictureChange
from palpate.session.recording_columns import (
    TAPE,
    TICKS,
    ReplayResult,
    TapeColumns,
    TickColumns,
)
from palpate.session.segment_state import SegmentState, SettingsState

SIZE = 24


def differences(value: object, kind: Any, where: str = "it") -> list[str]:
    """Lists where a value is not of a type; unlike for ``isinstance``, an int is no float."""
    if is_typeddict(kind):
        return _of_dictionary(value, typing.get_type_hints(kind), where)
    compare = COMPARED.get(typing.get_origin(kind), _of_class)
    return compare(value, kind, where)


def _of_class(value: object, kind: Any, where: str) -> list[str]:
    return [] if type(value) is kind else [f"{where} is {value!r}, not {kind}"]


def _of_dictionary(value: object, hints: dict[str, Any], where: str) -> list[str]:
    if not isinstance(value, dict):
        return [f"{where} is {type(value).__name__}, not a dictionary"]
    if value.keys() != hints.keys():
        return [f"{where} has other keys: {sorted(value.keys() ^ hints.keys())}"]
    found = (differences(value[name], hints[name], f"{where}.{name}") for name in hints)
    return [one for each in found for one in each]


def _of_union(value: object, kind: Any, where: str) -> list[str]:
    tried = [differences(value, each, where) for each in typing.get_args(kind)]
    return [] if [] in tried else min(tried, key=len)


def _of_literal(value: object, kind: Any, where: str) -> list[str]:
    return [] if value in typing.get_args(kind) else [f"{where} is {value!r}, not {kind}"]


def _of_array(value: object, kind: Any, where: str) -> list[str]:
    (number,) = typing.get_args(typing.get_args(kind)[1])
    fits = isinstance(value, np.ndarray) and value.dtype == number
    return [] if fits else [f"{where} is {value!r}, not an array of {number}"]


def _of_list(value: object, kind: Any, where: str) -> list[str]:
    if not isinstance(value, list):
        return [f"{where} is {value!r}, not {kind}"]
    (each,) = typing.get_args(kind)
    return [one for part in value for one in differences(part, each, f"{where}[]")]


def _of_tuple(value: object, kind: Any, where: str) -> list[str]:
    kinds = typing.get_args(kind)
    if not isinstance(value, tuple) or len(value) != len(kinds):
        return [f"{where} is {value!r}, not {kind}"]
    pairs = zip(value, kinds, strict=True)
    return [one for part, each in pairs for one in differences(part, each, f"{where}()")]


def _of_sequence(value: object, kind: Any, where: str) -> list[str]:
    return _of_list(list(value) if isinstance(value, tuple) else value, kind, where)


def _of_figures(value: object, kind: Any, where: str) -> list[str]:
    """Compares a dictionary of numbers by name; counts may be among them."""
    assert typing.get_args(kind) == (str, float)
    fits = isinstance(value, dict) and {type(each) for each in value.values()} <= {int, float}
    return [] if fits else [f"{where} is {value!r}, not {kind}"]


COMPARED = {
    Union: _of_union,
    types.UnionType: _of_union,
    Literal: _of_literal,
    np.ndarray: _of_array,
    list: _of_list,
    tuple: _of_tuple,
    Sequence: _of_sequence,
    dict: _of_figures,
}


class _Example(TypedDict):
    name: Literal["a", "b"]
    places: list[tuple[float, float]]
    rest: bytes | None


@pytest.mark.parametrize(
    ("value", "found"),
    [
        ({"name": "a", "places": [(1.0, 2.0)], "rest": None}, 0),
        ({"name": "c", "places": [(1.0, 2.0)], "rest": b""}, 1),
        ({"name": "a", "places": [(1, 2.0)], "rest": "x"}, 2),
        ({"name": "a", "places": [[1.0, 2.0]], "rest": None}, 1),
        ({"name": "a", "places": []}, 1),
    ],
)
def test_a_difference_is_found(value: object, found: int) -> None:
    assert len(differences(value, _Example)) == found


@pytest.fixture(scope="module")
def scan() -> palpate.Volume:
    values = np.zeros((SIZE, SIZE, SIZE), np.int16)
    values[:, SIZE // 2 :, :] = 1000
    return palpate.Volume(values, spacing=(1.0, 1.0, 1.0))


def pressed(scan: palpate.Volume) -> palpate.Session:
    """Returns a session in which a probe presses a deformable block, with a surface and a tool."""
    scene = palpate.Scene(scan, [scan.threshold(500)])
    scene.add(palpate.Segment.as_object(scan.threshold(500, name="object")), touchable=False)
    path = palpate.ScriptedPath((12.0, 8.0, 12.0)).move((12.0, 13.5, 12.0), seconds=0.3)
    options = palpate.SessionOptions(real_time=False)
    session = palpate.Session(scene, device=path, options=options)
    session.picture_changes()
    session.set_material(1, "liver")
    session.set_deformation("lattice", ModelOptions(edge=9, prony=Prony(0.5, 1.0)))
    session.show_model_parts(on=True)
    session.show_surface(1)
    session.set_feel(1, stiffness=0.5)
    session.move_segment(2, np.eye(4))
    session.set_tool("eraser", radius=2.0, segment_ids=[1])
    return session


def test_a_session_returns_what_is_declared(scan: palpate.Volume) -> None:
    with pressed(scan) as session:
        session.start_recording()
        session.let_pass(0.5)
        session.fill_box(1, low=(0, 20, 0), high=(4, 24, 4), solid=False)
        session.let_pass(0.5)
        changes = session.picture_changes()
        engine = session._engine
        assert any(change["voxels"] for change in changes)
        assert any(surface["patches"] for change in changes for surface in change["surfaces"])
        assert any(change["displaced"] for change in changes)
        assert differences(changes, list[PictureChange]) == []
        assert differences(session.whole_surfaces(), PictureChange) == []
        frame = session.frame()
        assert frame["poses"]
        assert frame["samples"]
        assert differences(frame, FrameState) == []
        assert differences(session.segments(), list[SegmentState]) == []
        assert differences(session.settings(), SettingsState) == []
        assert differences(session.lateness(), LatenessState) == []
        assert differences(engine.deformation(), DeformationState) == []
        assert session.deformation()["options"] == ModelOptions(edge=9, prony=Prony(0.5, 1.0))
        parts = session.model_parts()
        assert parts is not None
        assert differences(parts, ModelParts) == []
        ticks, tape = engine.stop_recording()
        assert tape is not None
        assert differences(ticks, TickColumns) == []
        assert differences(tape, TapeColumns) == []
        assert differences(_core.replay_recording(ticks, tape), ReplayResult) == []


@pytest.mark.parametrize(("kinds", "declared"), [(TICKS, TickColumns), (TAPE, TapeColumns)])
def test_columns_in_files_are_those_of_the_engine(
    kinds: dict[str, tuple[str, int]], declared: Any
) -> None:
    hints = typing.get_type_hints(declared)
    assert kinds.keys() == hints.keys()
    for name, (kind, _) in kinds.items():
        assert np.dtype(kind) == typing.get_args(typing.get_args(hints[name])[1])[0], name


def test_models_offer_what_is_declared() -> None:
    assert differences(_core.deformation_models(), list[ModelOffer]) == []


def test_scenarios_return_what_is_declared(scan: palpate.Volume) -> None:
    block = scan.threshold(500)
    inner, segment = scan._internal, block._internal
    drive = Drive(
        start=np.array((12.0, 9.0, 12.0)),
        target=np.array((12.0, 15.0, 12.0)),
        speed=40.0,
        force_limit=5.0,
        rest_secs=0.02,
        stiffness=1.0,
    ).given()
    tissue = _core.needle_tissues()[0][1]
    assert differences(_core.drive_needle(inner, [(segment, tissue)], drive), NeedleRun) == []
    assert differences(_core.drive_drill(inner, segment, drive, 2.0, None, 1.0), DrillRun) == []
    pushed = _core.drive_rearranging_ball(inner, segment, drive, 2.0, 5000.0, is_hu=True)
    assert differences(pushed, RearrangingRun) == []
    layers: list[tuple[_core.Segment, str | None]] = [(segment, "liver")]
    pressed_in = _core.press(inner, layers, drive, 3.0, 2.0, "lattice")
    assert differences(pressed_in, PressRun) == []


@pytest.mark.long
def test_benchmarks_return_what_is_declared(scan: palpate.Volume) -> None:
    block = scan.threshold(500)
    inner, segment = scan._internal, block._internal
    small = _core.Ground(inner, [segment])
    large = small.embedded((32, 32, 32))
    embedded = _core.bench_embedded(small, large, "proxy", 200, 20, 1)
    assert differences(embedded, EmbeddedResult) == []
    stress = _core.bench_stress(1, 0, 1, "exact", 1, inner, segment)
    assert differences(stress, StressResult) == []
    worked = _core.bench_matter_stress("lattice", 1, 0, 1, 100, 1)
    assert differences(worked, SoftTissueStressResult) == []
    session = _core.bench_session(inner, segment, "lattice", 1, 1, 100)
    assert differences(session, SessionResult) == []
    assert differences(_core.bench_lattice_frames(7, 0.25, 0, 1.0, 5), LatticeFrames) == []
    assert differences(_core.bench_lj_pairs(4, 1.0, 1, 2, 1), PairsResult) == []
    still, moved = (0.0, 0.0, 0.0), (0.0, 0.0, 0.1)
    block_at_rest = _core.press_block((5, 5, 5), 1.0, 1e4, 0.25, moved, still, 1e-2, 50)
    assert differences(block_at_rest, PressedBlock) == []
