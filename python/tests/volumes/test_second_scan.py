"""A second scan: where a transform's file puts it, what pages are told, and what is refused."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import SimpleITK
from palpate.base.errors import OptionError, VolumeFormatError
from palpate.volumes.second_scan import SecondScan, doubts_of, placed, read_transform
from palpate.volumes.volume import Volume, VolumeTraits
from running_server import voxels


def slopes(*, spacing: float = 2.0, origin: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> Volume:
    """A scan whose value is x + 10 y + 100 z of a voxel's number."""
    z, y, x = np.mgrid[0:9, 0:9, 0:9]
    return Volume((x + 10 * y + 100 * z).astype(np.int16), spacing=[spacing] * 3, origin=origin)


def written(transform: Any, folder: Path) -> Any:
    """A transform as it comes back from its file."""
    path = folder / "t.tfm"
    SimpleITK.WriteTransform(transform, str(path))
    return read_transform(path)


def test_a_rigid_transform_is_a_matrix_and_the_values_stay(tmp_path: Path) -> None:
    rigid = SimpleITK.Euler3DTransform((4.0, 5.0, 6.0), 0.1, -0.2, 0.3, (1.0, 2.0, 3.0))
    both = SimpleITK.CompositeTransform([rigid, SimpleITK.TranslationTransform(3, (7.0, 0.0, 0.0))])
    second = slopes()
    for transform in (rigid, both):
        shown = placed(slopes(spacing=1.0), second, written(transform, tmp_path))
        assert shown.volume is second
        point = np.array([3.0, -8.0, 11.0])
        expected = transform.TransformPoint(tuple(point))
        np.testing.assert_allclose((shown.second_from_first @ [*point, 1.0])[:3], expected)


def test_without_a_transform_both_lie_in_one_patient() -> None:
    np.testing.assert_array_equal(placed(slopes(), slopes()).second_from_first, np.eye(4))


def test_what_bends_is_laid_on_the_first_scans_grid(tmp_path: Path) -> None:
    first = slopes(spacing=1.0, origin=(2.0, 2.0, 2.0))
    bent = SimpleITK.BSplineTransformInitializer(
        SimpleITK.Image([9, 9, 9], SimpleITK.sitkInt16), [3, 3, 3], 3
    )
    # all nodes alike: a shift by 2 mm along x, which no one can tell from the file
    nodes = len(bent.GetParameters()) // 3
    bent.SetParameters([2.0] * nodes + [0.0] * (2 * nodes))
    shown = placed(first, slopes(), written(bent, tmp_path))
    assert shown.volume.dimensions == first.dimensions
    assert shown.volume.origin == first.origin
    np.testing.assert_array_equal(shown.second_from_first, np.eye(4))
    # voxel (2, 0, 0) of the first stands at 4, 2, 2 mm: in the second at 6, 2, 2, its voxel 3, 1, 1
    assert shown.volume.array[0, 0, 2] == 3 + 10 + 100


def test_what_is_no_transform_of_space_is_refused(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError):
        read_transform(tmp_path / "none.tfm")
    damaged = tmp_path / "damaged.tfm"
    damaged.write_text("#Insight Transform File V1.0\nTransform: Affine")
    with pytest.raises(VolumeFormatError, match=r"allowed: \.tfm"):
        read_transform(damaged)
    flat = SimpleITK.AffineTransform(3)
    flat.SetMatrix([1, 0, 0, 0, 1, 0, 0, 0, 0])
    with pytest.raises(OptionError, match="flattens"):
        placed(slopes(), slopes(), flat)
    with pytest.raises(OptionError, match="of 2 dimensions given"):
        placed(slopes(), slopes(), SimpleITK.TranslationTransform(2, (1.0, 1.0)))


def test_another_patient_and_frame_of_reference_are_told() -> None:
    first, same, other = slopes(), slopes(), slopes()
    first.traits = same.traits = VolumeTraits(patient_id="Doe^Jane 17", frame="1.2.3")
    other.traits = VolumeTraits(patient_id="Doe^John 18", frame="1.2.4")
    assert doubts_of(first, placed(first, same)) == ()
    patient, frame = doubts_of(first, placed(first, other))
    assert "patient is not that of the first scan" in patient
    assert "frame of reference is not that" in frame
    # a transform says where it lies, not whose it is
    shift = SimpleITK.TranslationTransform(3, (1.0, 0.0, 0.0))
    assert doubts_of(first, placed(first, other, shift)) == (patient,)
    # files that do not tell are no other patient's; a dose has to lie right
    assert doubts_of(slopes(), placed(slopes(), other)) == ()
    dose = slopes()
    dose.traits = VolumeTraits(modality="RTDOSE", frame="1.2.3")
    assert doubts_of(first, placed(first, dose)) == ()
    (said,) = doubts_of(slopes(), placed(slopes(), dose))
    assert "no frame of reference" in said


def test_pages_are_told_of_a_second_scan_and_where_it_goes(server: Any) -> None:
    assert server.get("/api/second").status_code == 404
    second = slopes()
    second.traits = VolumeTraits(modality="RTDOSE", unit="Gy")
    with server.page() as page:
        live = server.live
        live.show_second(SecondScan(second))
        told = page.receive("second_scan")
        assert told["scan"]["dimensions"] == [9, 9, 9]
        assert told["scan"]["unit"] == "Gy"
        assert "no frame of reference" in told["scan"]["warnings"][0]
        moved = np.eye(4)
        moved[0, 3] = 5.0
        live.show_second(SecondScan(second, moved))
        again = page.receive("second_scan")
        assert again["second_from_first"] == moved.ravel().tolist()
        # the same values: nothing is fetched again
        assert again["version"] == told["version"]
        np.testing.assert_array_equal(voxels(server, "/api/second", "<i2"), second.array)
        with server.page() as other:
            assert other.receive("second_scan")["second_from_first"] == moved.ravel().tolist()
        live.show_second(None)
        gone = page.receive("second_scan")
        assert gone["scan"] is None
        assert gone["version"] > told["version"]


def transform_file(transform: Any, folder: Path) -> bytes:
    path = folder / "t.tfm"
    SimpleITK.WriteTransform(transform, str(path))
    return path.read_bytes()


def test_a_page_lays_the_second_scan_elsewhere_and_takes_it_away(
    server: Any, tmp_path: Path
) -> None:
    rigid = SimpleITK.Euler3DTransform((0.0, 0.0, 0.0), 0.1, 0.0, 0.0, (7.0, 0.0, 0.0))
    bent = SimpleITK.BSplineTransformInitializer(
        SimpleITK.Image([9, 9, 9], SimpleITK.sitkInt16), [3, 3, 3], 3
    )
    moved = "/api/second/transform?name=turn.tfm"
    with server.page() as page:
        refused = server.ask("PUT", moved, transform_file(rigid, tmp_path))
        assert (refused.status_code, refused.text[:24]) == (400, "there is no second scan.")
        second = slopes()
        server.live.show_second(SecondScan(second))
        told = page.receive("second_scan")
        assert not told["is_moved"]

        assert server.ask("PUT", moved, transform_file(rigid, tmp_path)).status_code == 204
        told = page.receive("second_scan")
        assert told["is_moved"]
        point = np.array(told["second_from_first"]).reshape(4, 4) @ [1.0, 2.0, 3.0, 1.0]
        np.testing.assert_allclose(point[:3], rigid.TransformPoint((1.0, 2.0, 3.0)))

        # what bends is laid on the first scan's grid, and can be laid as it was again
        assert server.ask("PUT", moved, transform_file(bent, tmp_path)).status_code == 204
        told = page.receive("second_scan")
        assert told["is_moved"]
        assert tuple(told["scan"]["dimensions"]) == server.session.scene.volume.dimensions
        assert server.ask("DELETE", "/api/second/transform").status_code == 204
        told = page.receive("second_scan")
        assert (told["is_moved"], told["scan"]["dimensions"]) == (False, [9, 9, 9])

        for name, content, reason in (
            ("turn.tfm", b"nothing", "turn.tfm cannot be read as a transform"),
            ("turn.png", b"", "'turn.png' cannot be used. Use .tfm"),
        ):
            refused = server.ask("PUT", f"/api/second/transform?name={name}", content)
            assert refused.status_code == 400
            assert refused.text.startswith(reason)
        assert server.ask("DELETE", "/api/second").status_code == 204
        assert page.receive("second_scan")["scan"] is None
        assert server.get("/api/second").status_code == 404


def label_file(grid: Volume, folder: Path, mask: Any) -> bytes:
    image = SimpleITK.GetImageFromArray(mask.astype(np.uint8))
    image.SetSpacing(grid.spacing)
    image.SetOrigin(grid.origin)
    SimpleITK.WriteImage(image, str(folder / "given.nrrd"))
    return (folder / "given.nrrd").read_bytes()


@pytest.mark.parametrize("bends", [False, True])
def test_segments_of_the_second_scan_come_to_where_it_lies(
    server: Any, tmp_path: Path, *, bends: bool
) -> None:
    first = server.session.scene.volume
    moving = Volume(np.zeros((30, 30, 30), np.int16), spacing=(2.0, 2.0, 2.0))
    segments = "/api/second/segments?name=liver.nrrd"
    mask = np.zeros(moving.shape, bool)
    mask[9:15, 8:18, 12:20] = True
    content = label_file(moving, tmp_path, mask)
    refused = server.ask("PUT", segments, content)
    assert (refused.status_code, refused.text[:24]) == (400, "there is no second scan.")

    middle = first.patient_from_grid @ [*(0.5 * np.array(first.dimensions)), 1.0]
    shift = np.array([30.0, 25.0, 23.0]) - middle[:3]
    transform = SimpleITK.TranslationTransform(3, shift.tolist())
    if bends:
        bent = SimpleITK.BSplineTransformInitializer(
            SimpleITK.Image([90, 90, 90], SimpleITK.sitkInt16), [3, 3, 3], 3
        )
        bent.SetParameters([0.7] * len(bent.GetParameters()))
        bent.SetTransformDomainOrigin((middle[:3] - 45.0).tolist())
        transform = SimpleITK.CompositeTransform([transform, bent])
        shift = shift + 0.7
    server.live.show_second(placed(first, moving, transform))
    before = len(server.session.segments())
    assert server.ask("PUT", segments, content).status_code == 204
    assert len(server.session.segments()) == before + 1
    added = list(server.session.scene_now())[-1].segment
    z, y, x = np.nonzero(added.mask())
    there = first.patient_from_grid @ [x.mean() + 0.5, y.mean() + 0.5, z.mean() + 0.5, 1.0]
    truth = np.array([15.5, 12.5, 11.5]) * 2.0 - shift
    np.testing.assert_allclose(there[:3], truth, atol=0.5 * max(first.spacing))

    other = label_file(Volume(mask, spacing=(3.0, 2.0, 2.0)), tmp_path, mask)
    refused = server.ask("PUT", segments, other)
    assert refused.status_code == 400
    assert "lies on another grid than the scan" in refused.text
