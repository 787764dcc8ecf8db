"""Scan, segment, surface and points of one thing come to lie at one place, in both directions."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import SimpleITK
from numpy.typing import NDArray
from palpate import MeshFile, OptionError, Surface, Volume
from palpate.registration.carry import Carrier, Toward
from palpate.registration.inverse import inverse_of
from palpate.registration.point_map import points_before, points_through

Points = NDArray[np.float64]

FIXED = Volume(
    np.zeros((44, 40, 36), np.int16), spacing=(1.5, 1.25, 2.0), origin=(-20.0, 5.0, 40.0)
)
MOVING_DIRECTION = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
"""A grid that lies otherwise than the fixed one."""
MIDDLE = np.array([7.0, 30.0, 84.0])


def linear() -> Any:
    """A turn about a slanted axis and a shift: neither is its own inverse."""
    turn = SimpleITK.Euler3DTransform()
    turn.SetCenter(MIDDLE.tolist())
    turn.SetRotation(0.15, -0.1, 0.35)
    turn.SetTranslation([9.0, -6.0, 4.0])
    return turn


def affine() -> Any:
    made = SimpleITK.AffineTransform(3)
    made.SetCenter(MIDDLE.tolist())
    made.SetMatrix([1.15, 0.1, 0.0, -0.05, 0.9, 0.1, 0.0, 0.1, 1.05])
    made.SetTranslation([-5.0, 8.0, 3.0])
    return made


def bent() -> Any:
    """A B-spline over the fixed scan before the turn, as registration writes it."""
    spline = SimpleITK.BSplineTransform(3, 3)
    spline.SetTransformDomainOrigin([-40.0, -15.0, 20.0])
    spline.SetTransformDomainPhysicalDimensions([100.0, 100.0, 140.0])
    spline.SetTransformDomainMeshSize([5, 5, 6])
    random = np.random.default_rng(3)
    spline.SetParameters(random.normal(0.0, 3.0, len(spline.GetParameters())).tolist())
    return SimpleITK.CompositeTransform([linear(), spline])


def mirrored() -> Any:
    made = SimpleITK.AffineTransform(3)
    made.SetCenter(MIDDLE.tolist())
    made.SetMatrix([-0.95, 0.2, 0.1, 0.1, 1.0, -0.1, 0.0, 0.15, 1.0])
    made.SetTranslation([6.0, -5.0, 4.0])
    return made


TRANSFORMS = {"linear": linear(), "affine": affine(), "bent": bent(), "mirrored": mirrored()}


def around(points: Points) -> Volume:
    """An empty scan around points, on axes of its own."""
    spacing = np.array([1.2, 1.6, 1.8])
    along = points @ MOVING_DIRECTION
    low, high = along.min(axis=0) - 6.0, along.max(axis=0) + 6.0
    size = np.ceil((high - low) / spacing).astype(int)
    return Volume(
        np.zeros(size[::-1], np.int16),
        spacing=spacing.tolist(),
        origin=(MOVING_DIRECTION @ low).tolist(),
        direction=MOVING_DIRECTION,
    )


def wedge(volume: Volume, at: Points) -> NDArray[np.bool_]:
    """A body that is alike from no two sides, about a place of the patient [mm]."""
    z, y, x = np.indices(volume.shape)
    grid = np.stack([x, y, z], axis=-1) + 0.5
    matrix = volume.patient_from_grid
    off = grid @ matrix[:3, :3].T + matrix[:3, 3] - at
    inside = np.all((off > (-9.0, -6.0, -12.0)) & (off < (9.0, 7.0, 12.0)), axis=-1)
    body: NDArray[np.bool_] = inside & (off @ (1.0, 0.7, 0.4) < 3.0)
    return body


def middle_of(volume: Volume, mask: NDArray[Any]) -> Points:
    z, y, x = np.nonzero(mask)
    index = np.array([x.mean(), y.mean(), z.mean()]) + 0.5
    place: Points = volume.patient_from_grid[:3, :3] @ index + volume.patient_from_grid[:3, 3]
    return place


@pytest.mark.parametrize("name", TRANSFORMS)
@pytest.mark.parametrize("toward", ["fixed", "moving"])
def test_all_of_one_thing_lands_at_one_place(name: str, toward: Toward) -> None:
    transform = TRANSFORMS[name]
    random = np.random.default_rng(0).uniform(-14.0, 14.0, (400, 3))
    moving = around(points_through(transform, MIDDLE + random))
    source, target = (moving, FIXED) if toward == "fixed" else (FIXED, moving)
    place = points_through(transform, MIDDLE[None])[0] if toward == "fixed" else MIDDLE
    body = wedge(source, place)
    scan = source.with_values(np.where(body, 900, -700).astype(np.int16))
    segment = scan.segment(body, name="wedge")
    mesh = Surface(segment, source="bits", smoothing=0).mesh()
    carrier = Carrier(transform, toward=toward, grid=target)

    drawn = carrier.scan(scan)
    (carried,), told = carrier.segments([segment])
    moved = carrier.mesh(MeshFile(mesh, "wedge.stl", 0)).mesh
    point = carrier.points(middle_of(scan, body)[None])[0]

    assert told == []
    assert carried is not None
    half = 0.5 * min(target.spacing)
    in_segment = middle_of(target, carried.mask())
    np.testing.assert_allclose(middle_of(target, drawn.array > 100), in_segment, atol=half)
    np.testing.assert_allclose(point, in_segment, atol=half)
    # the body's own middle, of the tetrahedra between the mesh and a point
    a, b, c = moved.vertices[moved.triangles].transpose(1, 0, 2) - in_segment
    sizes = np.einsum("ij,ij->i", a, np.cross(b, c)) / 6.0
    centre = (sizes[:, None] * (a + b + c) / 4.0).sum(axis=0) / sizes.sum()
    np.testing.assert_allclose(centre, 0.0, atol=half)
    # the outside of the mesh is outside still, and it holds as much as the voxels
    assert sizes.sum() / 1000.0 == pytest.approx(carried.volume_ml, rel=0.06)
    # and there it is where the truth says, not where the other direction would have it
    truth = (
        points_through(transform, middle_of(scan, body)[None])[0]
        if toward == "moving"
        else points_before(transform, middle_of(scan, body)[None])[0][0]
    )
    np.testing.assert_allclose(in_segment, truth, atol=half)


@pytest.mark.parametrize("name", TRANSFORMS)
def test_an_inverse_leads_back_and_its_error_is_the_measured_one(name: str) -> None:
    transform = TRANSFORMS[name]
    points = MIDDLE + np.random.default_rng(1).uniform(-14.0, 14.0, (500, 3))
    there = points_through(transform, points)
    inverse = inverse_of(transform, around(there))
    off = np.linalg.norm(points_through(inverse.transform, there) - points, axis=1)
    assert inverse.exact == (name != "bent")
    if inverse.exact:
        assert off.max() < 1e-9
        assert inverse.sentence == "the inverse is exact"
    else:
        assert np.percentile(off, 99) <= 2.0 * inverse.error_most
        assert 0.0 < inverse.error_mean < inverse.error_most < 0.1
        assert f"{inverse.error_mean:.2g} mm on average" in inverse.sentence


def test_points_go_through_a_transform_as_simpleitk_takes_them() -> None:
    points = np.random.default_rng(2).uniform(-300.0, 300.0, (50, 3))
    for transform in TRANSFORMS.values():
        single = [transform.TransformPoint(point.tolist()) for point in points]
        np.testing.assert_allclose(points_through(transform, points), single, atol=1e-9)
    assert points_through(linear(), np.empty((0, 3))).shape == (0, 3)


def test_what_falls_outside_of_the_grid_is_told() -> None:
    shift = SimpleITK.TranslationTransform(3, (30.0, 0.0, 0.0))
    mask = np.zeros(FIXED.shape, bool)
    mask[10:20, 10:20, 12:28] = True  # x from 18 to 42 mm: 12 of its 24 mm go past the left end
    segments = [FIXED.segment(mask, name="long"), FIXED.segment(~mask, name="rest")]
    carrier = Carrier(shift, grid=FIXED)
    segments[0].number = 40
    (long, rest), told = carrier.segments(segments)
    assert long is not None
    assert rest is not None
    assert long.voxel_count == 8 * 100
    assert long.number == 40
    assert told[0] == "50.0% of long lies outside of the grid and is lost"
    gone = np.zeros(FIXED.shape, bool)
    gone[:, :, :10] = True
    (none, _), told = carrier.segments([FIXED.segment(gone, name="gone"), segments[0]])
    assert none is None
    assert told[0] == "gone does not reach the grid and is left out"


def test_a_segment_that_is_thin_for_the_grid_is_told_with_its_volumes() -> None:
    fine = Volume(np.zeros((60, 60, 60), np.int16), spacing=(0.5, 0.5, 0.5))
    coarse = Volume(np.zeros((10, 10, 10), np.int16), spacing=(3.0, 3.0, 3.0), origin=(1, 1, 1))
    sheet, block = np.zeros(fine.shape, bool), np.zeros(fine.shape, bool)
    sheet[:, 20:22] = True
    block[6:48, 6:48, 6:48] = True
    carrier = Carrier(SimpleITK.Transform(3, SimpleITK.sitkIdentity), grid=coarse)
    _, told = carrier.segments([fine.segment(sheet, name="sheet"), fine.segment(block, name="b")])
    assert told == [
        "sheet has 2700 mm³ on the grid and should have 900 mm³: it is thin for voxels of that size"
    ]


def test_what_does_not_meet_is_refused_with_the_direction() -> None:
    far = Carrier(SimpleITK.TranslationTransform(3, (900.0, 0.0, 0.0)), grid=FIXED)
    with pytest.raises(OptionError, match="reaches scan when carried from the moving scan to the"):
        far.scan(FIXED)
    whole = FIXED.segment(np.ones(FIXED.shape), name="whole")
    with pytest.raises(OptionError, match="none of 1 segments reaches scan when carried from"):
        far.segments([whole])
    with pytest.raises(OptionError, match="no grid given; allowed: the scan to which"):
        Carrier(linear()).scan(FIXED)


def test_what_cannot_be_turned_back_is_refused() -> None:
    flat = SimpleITK.AffineTransform(3)
    flat.SetMatrix([1.0, 0, 0, 0, 1.0, 0, 0, 0, 0])
    with pytest.raises(OptionError, match="flattens"):
        Carrier(flat).points(MIDDLE[None])
    with pytest.raises(OptionError, match="flattens"):
        inverse_of(flat, FIXED)
    folded = SimpleITK.BSplineTransform(3, 3)
    folded.SetTransformDomainOrigin([-40.0, -15.0, 20.0])
    folded.SetTransformDomainPhysicalDimensions([100.0, 100.0, 140.0])
    folded.SetTransformDomainMeshSize([12, 12, 12])
    random = np.random.default_rng(4)
    folded.SetParameters(random.normal(0.0, 40.0, len(folded.GetParameters())).tolist())
    points = MIDDLE + random.uniform(-14.0, 14.0, (50, 3))
    with pytest.raises(OptionError, match="of 50 points have no place in the fixed scan"):
        Carrier(folded).points(points)
    with pytest.raises(OptionError, match="needs the grid of the moving scan; allowed"):
        _ = Carrier(folded, grid=FIXED).inverse
