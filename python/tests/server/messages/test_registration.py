"""The second scan registered on behalf of pages: where it then stands, before and after, files."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import pytest
import SimpleITK
from numpy.typing import NDArray
from palpate import SearchOptions
from palpate.server.messages import registration as server_registration
from palpate.volumes.scene import Scene
from palpate.volumes.second_scan import SecondScan
from palpate.volumes.second_scan import placed as laid
from palpate.volumes.volume import Volume
from running_server import PATIENCE, RunningServer, running, write_page

SHAPE = (24, 26, 30)
SPACING = (2.5, 2.5, 3.0)
SHIFT = np.array([5.0, -5.0, 3.0])
"""From points of the first scan to the second's [mm]."""
REGISTER: dict[str, Any] = {
    "type": "register",
    "kind": "rigid",
    "metric": "mean-squares",
    "start": "as-it-stands",
    "pairs": [],
}


def values_at(shift: NDArray[Any]) -> NDArray[np.int16]:
    """A body of blobs, moved."""
    z, y, x = np.indices(SHAPE)
    points = np.stack([x, y, z], axis=-1) * SPACING - shift
    values = np.full(SHAPE, -900.0)
    for place, width, height in (
        ((36.0, 30.0, 36.0), 16.0, 900.0),
        ((46.0, 24.0, 44.0), 6.0, 1100.0),
        ((26.0, 40.0, 26.0), 7.0, -500.0),
        ((34.0, 18.0, 30.0), 5.0, 900.0),
    ):
        off = np.linalg.norm(points - place, axis=-1)
        values += height * np.exp(-0.5 * (off / width) ** 2)
    found: NDArray[np.int16] = np.rint(values).astype(np.int16)
    return found


@pytest.fixture
def blobs(tmp_path: Path) -> Iterator[RunningServer]:
    """A server with two scans of which the second lies elsewhere."""
    scene = Scene(Volume(values_at(np.zeros(3)), spacing=SPACING))
    scene.second = SecondScan(Volume(values_at(SHIFT), spacing=SPACING))
    with running(scene, write_page(tmp_path / "page")) as started:
        yield started


def ended(page: Any, *, steps: int) -> Any:
    """Waits until no registration runs and so many can be taken back."""
    return page.receive("registration", until=lambda m: m["doing"] is None and m["steps"] == steps)


def placed(page: Any) -> NDArray[np.float64]:
    """The next place of the second scan that is told, shape [4, 4]."""
    return np.reshape(page.receive("second_scan")["second_from_first"], (4, 4))


def asked(server: RunningServer, **wanted: str) -> httpx.Response:
    headers = {"Cookie": f"{server.access.cookie}={server.access.token}", "Origin": server.base}
    address = f"{server.base}/api/registration"
    return httpx.post(address, json=wanted, headers=headers, trust_env=False, timeout=PATIENCE)


def test_a_registration_moves_the_second_scan_and_can_be_taken_back(
    blobs: RunningServer, tmp_path: Path
) -> None:
    with blobs.page() as page:
        before = page.receive("second_scan")
        assert page.receive("registration")["found"] is None
        page.send(REGISTER)
        found = placed(page)
        np.testing.assert_allclose(found[:3, 3], SHIFT, atol=0.5)
        np.testing.assert_allclose(found[:3, :3], np.eye(3), atol=0.02)
        told = ended(page, steps=1)
        assert told["failure"] is None
        assert told["found"]["after"] < told["found"]["before"]
        assert told["found"]["moved_mean"] == pytest.approx(np.linalg.norm(SHIFT), abs=0.5)
        assert [level["name"] for level in told["curve"]] == ["rigid, 2 times coarser", "rigid"]
        assert all(level["values"] for level in told["curve"])

        # what is saved is what is seen
        (tmp_path / "T.tfm").write_bytes(asked(blobs, what="transform").content)
        transform = SimpleITK.ReadTransform(str(tmp_path / "T.tfm"))
        there = np.subtract(transform.TransformPoint((36.0, 30.0, 36.0)), (36.0, 30.0, 36.0))
        np.testing.assert_allclose(there, SHIFT, atol=0.5)
        answer = asked(blobs, what="scan", ending=".nrrd")
        assert answer.headers["content-disposition"].endswith('scan-to-scan.nrrd"')
        (tmp_path / "R.nrrd").write_bytes(answer.content)
        brought = SimpleITK.GetArrayFromImage(SimpleITK.ReadImage(str(tmp_path / "R.nrrd")))
        inner = (slice(5, -5),) * 3
        apart = np.abs(brought.astype(float) - values_at(np.zeros(3)))[inner].mean()
        assert apart < 0.2 * np.abs(values_at(SHIFT) * 1.0 - values_at(np.zeros(3)))[inner].mean()

        page.send({"type": "show_registration", "which": "before"})
        np.testing.assert_array_equal(placed(page), np.eye(4))
        told = page.receive("registration", until=lambda m: m["shown"] == "before")
        assert told["found"] is not None
        page.send({"type": "show_registration", "which": "after"})
        np.testing.assert_array_equal(placed(page), found)
        page.send({"type": "undo_registration"})
        np.testing.assert_array_equal(placed(page), np.eye(4))
        told = ended(page, steps=0)
        assert (told["found"], told["undone"]) == (None, 1)
        page.send({"type": "redo_registration"})
        again = page.receive("second_scan")
        np.testing.assert_array_equal(np.reshape(again["second_from_first"], (4, 4)), found)
        # its values never changed: no page loads them anew
        assert again["version"] == before["version"]
        assert ended(page, steps=1)["undone"] == 0


def test_a_bent_one_is_shown_as_a_resampled_scan(
    blobs: RunningServer, monkeypatch: pytest.MonkeyPatch
) -> None:
    quick = SearchOptions(bent_samples=500, bent_iterations=20, knots=30.0)
    monkeypatch.setattr(server_registration, "OPTIONS", quick)
    with blobs.page() as page:
        before = page.receive("second_scan")
        page.send(REGISTER | {"kind": "bspline"})
        after = page.receive("second_scan")
        assert after["version"] == before["version"] + 1
        assert after["second_from_first"] == np.eye(4).ravel().tolist()
        assert ended(page, steps=1)["found"]["kind"] == "bspline"
        shown = blobs.session.scene.second
        assert shown is not None
        wrong = np.abs(shown.volume.array * 1.0 - blobs.session.scene.volume.array)
        assert wrong[5:-5, 5:-5, 5:-5].mean() < 30.0
        transform = asked(blobs, what="transform").text
        assert "BSplineTransform" in transform


def saved(server: RunningServer, what: str, folder: Path) -> Any:
    """A transform that a page saves."""
    (folder / f"{what}.tfm").write_bytes(asked(server, what=what).content)
    return SimpleITK.ReadTransform(str(folder / f"{what}.tfm"))


def test_the_share_that_is_covered_is_told_and_the_inverse_saved(
    blobs: RunningServer, tmp_path: Path
) -> None:
    with blobs.page() as page:
        page.receive("second_scan")
        page.send(REGISTER)
        found = ended(page, steps=1)["found"]
        assert found["overlap_before"] == 1.0
        assert not found["start_kept"]
        there, back = saved(blobs, "transform", tmp_path), saved(blobs, "inverse", tmp_path)
        again = back.TransformPoint(there.TransformPoint((36.0, 30.0, 36.0)))
        np.testing.assert_allclose(again, (36.0, 30.0, 36.0), atol=1e-6)


def test_a_bent_transform_of_a_file_is_what_is_saved(blobs: RunningServer, tmp_path: Path) -> None:
    first, second = blobs.session.scene.volume, blobs.session.scene.second
    assert second is not None
    assert blobs.live is not None
    bent = SimpleITK.BSplineTransform(3, 3)
    bent.SetTransformDomainPhysicalDimensions([90.0, 90.0, 90.0])
    bent.SetTransformDomainMeshSize([3, 3, 3])
    numbers = np.random.default_rng(0).normal(0.0, 1.5, len(bent.GetParameters()))
    bent.SetParameters(numbers.tolist())
    blobs.live.show_second(laid(first, second.as_read, bent))
    there, back = saved(blobs, "transform", tmp_path), saved(blobs, "inverse", tmp_path)
    for point in np.random.default_rng(1).uniform(30.0, 50.0, (20, 3)).tolist():
        place = there.TransformPoint(point)
        np.testing.assert_allclose(place, bent.TransformPoint(point), atol=1e-6)
        np.testing.assert_allclose(back.TransformPoint(place), point, atol=0.1)
    notes = asked(blobs, what="inverse").headers["x-palpate-notes"]
    assert "a%20field%20of%20displacements" in notes


def test_pairs_of_points_begin_it(blobs: RunningServer) -> None:
    first = np.array([[36.0, 30.0, 36.0], [46.0, 24.0, 44.0], [26.0, 40.0, 26.0]])
    pairs = [[point.tolist(), (point + SHIFT).tolist()] for point in first]
    with blobs.page() as page:
        page.receive("second_scan")
        page.send(REGISTER | {"start": "landmarks", "pairs": pairs})
        np.testing.assert_allclose(placed(page)[:3, 3], SHIFT, atol=0.5)
        page.send(REGISTER | {"start": "landmarks", "pairs": pairs[:2]})
        told = page.receive("registration", until=lambda m: m["failure"] is not None)
        assert "2 landmarks given" in told["failure"]


def test_what_diverges_changes_nothing_and_says_so(blobs: RunningServer) -> None:
    live = blobs.live
    assert live is not None
    away = np.eye(4)
    away[:3, 3] = 500.0
    second = blobs.session.scene.second
    assert second is not None
    with blobs.page() as page:
        page.receive("second_scan")
        # moved by another hand: what was found before is forgotten
        live.show_second(SecondScan(second.volume, away))
        np.testing.assert_array_equal(placed(page), away)
        page.send(REGISTER)
        told = page.receive("registration", until=lambda m: m["failure"] is not None)
        assert "the scans do not overlap enough" in told["failure"]
        assert (told["steps"], told["found"]) == (0, None)
    standing = blobs.session.scene.second
    assert standing is not None
    np.testing.assert_array_equal(standing.second_from_first, away)


def test_it_stops_when_a_person_stops_it(blobs: RunningServer) -> None:
    with blobs.page() as page:
        page.receive("second_scan")
        page.send(REGISTER | {"kind": "bspline"})
        page.receive("registration", until=lambda m: m["doing"] is not None)
        page.send(REGISTER)
        assert "runs already" in page.receive("notice")["text"]
        page.send({"type": "stop_registration"})
        assert page.receive("notice")["text"] == "Stopped: the second scan lies as before."
        assert ended(page, steps=0)["failure"] is None
        page.send(REGISTER)
        assert ended(page, steps=1)["found"] is not None


def test_without_a_second_scan_there_is_nothing_to_register(server: RunningServer) -> None:
    with server.page() as page:
        page.send(REGISTER)
        assert "there is no second scan" in page.receive("notice")["text"]
    assert asked(server, what="transform").status_code == 400
