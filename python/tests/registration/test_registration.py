"""Registration finds transforms that are known exactly, and leaves all as it was where it fails."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import SimpleITK
from numpy.typing import NDArray
from palpate import OptionError, RegistrationError, SearchOptions, Volume, read, register
from palpate.registration.image_pair import Compared, Measured
from palpate.registration.options import Kind, Metric, Pairs
from palpate.registration.other_places import turns
from palpate.registration.registration import metric_for
from palpate.registration.search import Search
from palpate.registration.search_history import SearchHistory
from palpate.volumes.volume import VolumeTraits

Points = NDArray[np.float64]

SHAPE = (26, 30, 34)
SPACING = (2.5, 2.5, 3.0)
ORIGIN = (-40.0, -35.0, 100.0)
QUICK = SearchOptions(
    samples=8000, bent_samples=1500, iterations=60, bent_iterations=80, knots=25.0
)
MIDDLE = np.array([2.0, 2.0, 138.0])

BLOBS = (
    # place from the middle [mm], width [mm], height
    ((0.0, 0.0, 0.0), 26.0, 900.0),
    ((18.0, 4.0, -12.0), 7.0, 1200.0),
    ((-14.0, 12.0, 10.0), 9.0, -700.0),
    ((-6.0, -20.0, 14.0), 6.0, 1000.0),
    ((10.0, -10.0, 20.0), 5.0, 1500.0),
    ((4.0, 18.0, -20.0), 6.0, 800.0),
)


def body(points: Points) -> Points:
    """Values of a body of blobs, alike nowhere, at points [mm]."""
    values = np.full(points.shape[:-1], -1000.0)
    for place, width, height in BLOBS:
        far = np.linalg.norm(points - MIDDLE - place, axis=-1)
        values += height * np.exp(-0.5 * (far / width) ** 2)
    return values


def scan(
    seen: Callable[[Points], Points], *, origin: tuple[float, float, float] = ORIGIN
) -> Volume:
    """A scan of values at points of the patient [mm]."""
    z, y, x = np.indices(SHAPE)
    points = np.stack([x, y, z], axis=-1) * SPACING + origin
    return Volume(np.rint(seen(points)).astype(np.int16), spacing=SPACING, origin=origin)


def turned(degrees: float, *, shift: tuple[float, float, float], scale: float = 1.0) -> Points:
    """A matrix about the middle, shape [4, 4]: from the fixed scan to the moving one."""
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    matrix = np.eye(4)
    matrix[:3, :3] = scale * np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    matrix[:3, 3] = MIDDLE + shift - matrix[:3, :3] @ MIDDLE
    return matrix


def moving_of(matrix: Points, *, origin: tuple[float, float, float] = ORIGIN) -> Volume:
    """The scan in which the body lies where the matrix takes it."""
    back = np.linalg.inv(matrix)
    return scan(lambda points: body(points @ back[:3, :3].T + back[:3, 3]), origin=origin)


def places() -> Points:
    """Points in the body [mm]."""
    points: Points = MIDDLE + np.array([place for place, *_ in BLOBS])
    return points


def taken(matrix: Points, points: Points) -> Points:
    there: Points = points @ matrix[:3, :3].T + matrix[:3, 3]
    return there


@pytest.fixture(scope="module")
def fixed() -> Volume:
    return scan(body)


@pytest.mark.parametrize("metric", ["mutual-information", "correlation", "mean-squares"])
def test_a_turn_and_a_shift_are_found(fixed: Volume, metric: Metric) -> None:
    matrix = turned(8.0, shift=(5.0, -4.0, 3.0))
    moving = moving_of(matrix)
    found = register(fixed, moving, metric=metric, options=QUICK)
    apart = found.points(places()) - taken(matrix, places())
    assert np.linalg.norm(apart, axis=1).max() < 0.5, metric
    assert found.matrix is not None
    np.testing.assert_allclose(found.matrix[:3, :3], matrix[:3, :3], atol=0.01)
    assert found.after < found.before
    assert found.overlap > 0.8
    there = found.resampled(moving, fixed)
    np.testing.assert_array_equal(there.patient_from_grid, fixed.patient_from_grid)
    inner = (slice(6, -6),) * 3
    apart = there.array[inner].astype(float) - fixed.array[inner]
    assert np.abs(apart).mean() < 25.0, "of 2000 between air and blobs"


def test_scans_with_other_values_are_brought_together_by_mutual_information(fixed: Volume) -> None:
    matrix = turned(-6.0, shift=(-4.0, 6.0, 0.0))
    other = moving_of(matrix)
    # what is bright in one is dark in the other, and the middle is brightest
    values = 900.0 - np.abs(other.array.astype(float) - 300.0)
    moving = other.with_values(values.astype(np.int16))
    found = register(fixed, moving, start="geometry", options=QUICK)
    apart = found.points(places()) - taken(matrix, places())
    assert np.linalg.norm(apart, axis=1).max() < 1.0


def test_an_affine_transform_finds_a_scale_that_a_rigid_one_cannot(fixed: Volume) -> None:
    matrix = turned(4.0, shift=(3.0, 0.0, -4.0), scale=1.08)
    moving = moving_of(matrix)
    errors = {}
    kinds: tuple[Kind, ...] = ("rigid", "affine")
    for kind in kinds:
        found = register(fixed, moving, kind=kind, metric="correlation", options=QUICK)
        apart = found.points(places()) - taken(matrix, places())
        errors[kind] = float(np.linalg.norm(apart, axis=1).mean())
    assert errors["affine"] < 0.3 < errors["rigid"]


def bump(points: Points) -> Points:
    """How far points of the fixed scan lie away in a bent moving one [mm]."""
    wave = np.sin((points - MIDDLE) @ np.array([0.0, 0.05, 0.06]))
    return np.stack([5.0 * wave, np.zeros_like(wave), 3.0 * wave], axis=-1)


def test_a_bent_transform_follows_what_an_affine_one_cannot() -> None:
    # the values of the fixed scan are those of the moving one at the bent places
    moving = scan(body)
    bent = scan(lambda points: body(points + bump(points)))
    errors = {}
    kinds: tuple[Kind, ...] = ("affine", "bspline")
    for kind in kinds:
        found = register(bent, moving, kind=kind, metric="mean-squares", options=QUICK)
        inside = places() * 0.7 + 0.3 * MIDDLE
        apart = found.points(inside) - (inside + bump(inside))
        errors[kind] = float(np.linalg.norm(apart, axis=1).mean())
        assert (found.matrix is None) == (kind == "bspline")
    assert errors["bspline"] < 0.5 * errors["affine"]


def test_a_matrix_is_a_start_and_what_it_scales_is_kept(fixed: Volume) -> None:
    matrix = turned(70.0, shift=(6.0, -3.0, 4.0), scale=1.08)
    moving = moving_of(matrix)
    near = turned(67.0, shift=(4.0, -2.0, 4.0), scale=1.08)
    found = register(fixed, moving, kind="affine", metric="correlation", start=near, options=QUICK)
    assert found.start == "matrix"
    assert [level.stage for level in found.curve] == ["affine", "affine"]
    apart = found.points(places()) - taken(matrix, places())
    assert np.linalg.norm(apart, axis=1).max() < 0.5
    # a rigid search takes the turn and the shift of it
    rigid = register(fixed, moving, metric="correlation", start=near, options=QUICK).matrix
    assert rigid is not None
    np.testing.assert_allclose(rigid[:3, :3] @ rigid[:3, :3].T, np.eye(3), atol=1e-6)


@pytest.mark.parametrize(
    ("start", "said"),
    [
        (np.eye(3), r"a start of shape \[3, 3\] given"),
        (np.diag([1.0, 1.0, -1.0, 1.0]), "neither flattens nor mirrors"),
        (np.full((4, 4), np.nan), "neither flattens nor mirrors"),
    ],
)
def test_a_matrix_that_is_no_place_is_refused(fixed: Volume, start: Points, said: str) -> None:
    with pytest.raises(OptionError, match=said):
        register(fixed, fixed, start=start)


def test_scans_by_ct_are_compared_by_correlation(fixed: Volume) -> None:
    ct, mr = (
        Volume(fixed.array, spacing=SPACING, traits=VolumeTraits(modality=name))
        for name in ("CT", "MR")
    )
    assert metric_for(ct, ct) == "correlation"
    assert metric_for(ct, mr) == metric_for(mr, mr) == "mutual-information"


def pairs_of(matrix: Points) -> Pairs:
    points = places()
    return points.tolist(), taken(matrix, points).tolist()


def test_landmarks_find_a_turn_that_is_too_large_for_the_middle(fixed: Volume) -> None:
    matrix = turned(100.0, shift=(60.0, 30.0, -20.0))
    moved = (ORIGIN[0] + 60.0, ORIGIN[1] + 30.0, ORIGIN[2] - 20.0)
    moving = moving_of(matrix, origin=moved)
    found = register(fixed, moving, landmarks=pairs_of(matrix), options=QUICK)
    assert found.start == "landmarks"
    apart = found.points(places()) - taken(matrix, places())
    assert np.linalg.norm(apart, axis=1).max() < 0.5


def tilted(degrees: float) -> Points:
    """A turn about a slanted axis through the middle of the body, and a small shift."""
    turn = SimpleITK.VersorRigid3DTransform()
    turn.SetRotation((0.6, 0.64, 0.48), float(np.radians(degrees)))
    matrix = np.eye(4)
    matrix[:3, :3] = np.reshape(turn.GetMatrix(), (3, 3))
    matrix[:3, 3] = MIDDLE + np.array([4.0, -3.0, 2.0]) - matrix[:3, :3] @ MIDDLE
    return matrix


@pytest.mark.parametrize("metric", ["mutual-information", "correlation", "mean-squares"])
def test_a_body_turned_far_is_found_or_what_was_found_is_doubted(
    fixed: Volume, metric: Metric
) -> None:
    matrix = tilted(100.0)
    moving = moving_of(matrix)
    found = register(fixed, moving, metric=metric, options=QUICK)
    apart = found.points(places()) - taken(matrix, places())
    assert np.linalg.norm(apart, axis=1).max() < 1.0
    assert (found.start, found.doubt) == ("turned", None)
    # a start that was asked for is kept, but its end is not passed off as the best
    asked = register(fixed, moving, metric=metric, start="centre", options=QUICK)
    away = np.linalg.norm(asked.points(places()) - taken(matrix, places()), axis=1).mean()
    assert away > 10.0
    assert asked.start == "centre"
    assert "more alike in another place" in (asked.doubt or "")


def test_a_body_that_looks_alike_from_two_sides_is_told() -> None:
    def pillar(points: Points) -> Points:
        off = np.abs(points - MIDDLE) / (12.0, 20.0, 25.0)
        return np.where(off.max(axis=-1) < 1.0, 500.0, -1000.0)

    still, moving = scan(pillar), scan(lambda points: pillar(points - (6.0, -4.0, 5.0)))
    found = register(still, moving, metric="correlation", options=QUICK)
    # planes of voxels on planes: within a voxel
    moved = found.points(MIDDLE)[0] - MIDDLE
    assert np.abs(moved - (6.0, -4.0, 5.0)).max() < 2.5
    assert "alike in another place" in (found.doubt or "")


def test_turns_are_spread_evenly() -> None:
    spread = turns(400)
    np.testing.assert_allclose(
        spread @ spread.swapaxes(1, 2), np.tile(np.eye(3), (400, 1, 1)), atol=1e-12
    )
    some = turns(4001)
    nearest = np.einsum("nij,mij->nm", some, spread).max(axis=1)
    assert np.degrees(np.arccos((nearest.min() - 1.0) / 2.0)) < 30.0


@pytest.mark.parametrize("degrees", [60.0, 90.0])
def test_a_turn_about_a_locking_axis_is_found_as_well(fixed: Volume, degrees: float) -> None:
    matrix = np.eye(4)
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    matrix[1:3, 1:3] = [[c, -s], [s, c]]
    matrix[:3, 3] = MIDDLE - matrix[:3, :3] @ MIDDLE
    found = register(fixed, moving_of(matrix), metric="correlation", options=QUICK)
    apart = found.points(places()) - taken(matrix, places())
    # less than a voxel
    assert np.linalg.norm(apart, axis=1).max() < 2.5


def test_moments_find_a_body_far_from_the_middle_of_its_scan(fixed: Volume) -> None:
    matrix = turned(0.0, shift=(22.0, -16.0, 0.0))
    found = register(fixed, moving_of(matrix), start="moments", options=QUICK)
    apart = found.points(places()) - taken(matrix, places())
    assert np.linalg.norm(apart, axis=1).max() < 0.5


def test_what_lies_outside_of_a_mask_does_not_count(fixed: Volume) -> None:
    matrix = turned(5.0, shift=(3.0, 3.0, 0.0))
    plain = moving_of(matrix)
    values = plain.array.copy()
    values[:, :, :4] = 3000  # a plate beside the body, which the fixed scan has elsewhere
    still = fixed.array.copy()
    still[:, :, -4:] = 3000
    masks = [np.ones(SHAPE, bool), np.ones(SHAPE, bool)]
    # farther than coarser levels blur it
    masks[0][:, :, -9:] = False
    masks[1][:, :, :9] = False
    first, second = fixed.with_values(still), plain.with_values(values)
    found = register(
        first,
        second,
        metric="mean-squares",
        fixed_mask=first.segment(masks[0], name="mask"),
        moving_mask=second.segment(masks[1], name="mask"),
        options=QUICK,
    )
    apart = found.points(places()) - taken(matrix, places())
    assert np.linalg.norm(apart, axis=1).mean() < 0.5


def test_the_same_scans_give_the_same_transform(fixed: Volume) -> None:
    moving = moving_of(turned(5.0, shift=(3.0, 3.0, 0.0)))
    few = SearchOptions(samples=2000, iterations=30)
    twice = [register(fixed, moving, kind="affine", options=few) for _ in range(2)]
    apart = twice[0].points(places()) - twice[1].points(places())
    assert np.abs(apart).max() < 1e-6


@pytest.mark.parametrize("metric", ["correlation", "mean-squares"])
def test_scans_that_lie_right_already_stay_so(fixed: Volume, metric: Metric) -> None:
    few = SearchOptions(samples=1000, iterations=5, bent_samples=500, bent_iterations=30)
    found = register(fixed, fixed, kind="bspline", metric=metric, options=few)
    assert found.after <= found.before
    np.testing.assert_allclose(found.points(places()), places(), atol=0.1)


def test_each_level_compares_as_many_voxels_as_asked(fixed: Volume) -> None:
    few = SearchOptions(samples=1000, iterations=5)
    found = register(fixed, moving_of(turned(5.0, shift=(3.0, 3.0, 0.0))), options=few)
    voxels = [np.prod([n // level.shrink for n in SHAPE]) for level in found.curve]
    sampled = [level.sampled * count for level, count in zip(found.curve, voxels, strict=True)]
    assert [level.shrink for level in found.curve] == [2, 1]
    np.testing.assert_allclose(sampled, 1000.0, rtol=0.05)


def test_a_transform_is_saved_whole_and_says_the_same_to_simpleitk(
    fixed: Volume, tmp_path: Path
) -> None:
    moving = moving_of(turned(5.0, shift=(3.0, 3.0, 0.0)))
    quick = SearchOptions(samples=2000, bent_samples=500, iterations=20, bent_iterations=2)
    kinds: tuple[Kind, ...] = ("rigid", "affine", "bspline")
    for kind in kinds:
        found = register(fixed, moving, kind=kind, options=quick)
        path = tmp_path / f"{kind}.tfm"
        found.save(path)
        again = SimpleITK.ReadTransform(str(path))
        for place, there in zip(places(), found.points(places()), strict=True):
            np.testing.assert_allclose(again.TransformPoint(place.tolist()), there, atol=1e-6)
    assert sorted(one.name for one in tmp_path.iterdir()) == [
        "affine.tfm",
        "bspline.tfm",
        "rigid.tfm",
    ]
    with pytest.raises(OptionError, match=r"allowed: a name with \.tfm"):
        found.save(tmp_path / "transform.txt")


class StoppedError(Exception):
    """A person has stopped the work."""


@pytest.mark.parametrize("stage", ["rigid", "affine", "bspline"])
def test_it_stops_when_a_person_stops_it(
    fixed: Volume, stage: str, capfd: pytest.CaptureFixture[str]
) -> None:
    calls: list[str] = []

    def progress(what: str, share: float | None) -> None:
        assert share is None or 0.0 <= share <= 1.0
        calls.append(what)
        if what.startswith(stage):
            raise StoppedError

    quick = SearchOptions(samples=1000, bent_samples=500, iterations=10, bent_iterations=5)
    before = fixed.array.copy()
    with pytest.raises(StoppedError):
        register(fixed, fixed, kind="bspline", options=quick, progress=progress)
    assert sum(1 for what in calls if what.startswith(stage)) == 1
    np.testing.assert_array_equal(fixed.array, before)
    assert capfd.readouterr().err == ""


@pytest.mark.parametrize("metric", ["mutual-information", "correlation", "mean-squares"])
def test_scans_that_do_not_overlap_are_refused(fixed: Volume, metric: Metric) -> None:
    far = Volume(fixed.array, spacing=SPACING, origin=(900.0, 0.0, 0.0))
    with pytest.raises(RegistrationError, match="do not overlap enough"):
        register(fixed, far, metric=metric, start="geometry", options=QUICK)


def test_an_end_worse_than_the_start_is_refused_with_the_curve(fixed: Volume) -> None:
    arrays = (fixed.array, moving_of(turned(5.0, shift=(3.0, 3.0, 0.0))).array)
    still, other = (SimpleITK.GetImageFromArray(array.astype(np.float32)) for array in arrays)
    search = Search(
        Compared((still, other), (None, None), metric="mean-squares", bins=32),
        options=SearchOptions(samples=1000, iterations=5),
        progress=lambda *_: None,
    )
    search.run(SimpleITK.Euler3DTransform(), "rigid")
    good = Measured(100.0, 0.9)
    few_of_all = 0.005 * float(np.var(arrays[0]))
    search.check(good, Measured(100.0 + few_of_all, 0.9))
    for bad, said in (
        (Measured(1e6, 0.9), "did not become more alike .mean-squares 100 before, 1e.06 after"),
        (Measured(np.nan, 0.9), "did not become more alike"),
        (Measured(5.0, 0.1), "were moved apart"),
    ):
        with pytest.raises(RegistrationError, match=said) as refused:
            search.check(good, bad)
        assert [level.shrink for level in refused.value.curve] == [2, 1]
        assert all(level.values for level in refused.value.curve)
        assert "on the way: rigid /2: " in str(refused.value)


METRICS: tuple[Metric, ...] = ("correlation", "mutual-information", "mean-squares")


@pytest.mark.data
@pytest.mark.parametrize("metric", METRICS)
def test_blocks_of_one_head_that_share_a_third_are_found(metric: Metric, data_folder: Path) -> None:
    head = read(data_folder / "cthead_stanford" / "CThead.mha").array[:, ::2, ::2]
    count = len(head)
    # each with its own origin, as SimpleITK-Notebooks#199 has it
    parts = head[: round(0.6 * count)].copy(), head[round(0.4 * count) :].copy()
    lower, upper = (Volume(part, spacing=(2.0, 2.0, 2.0)) for part in parts)
    found = register(lower, upper, metric=metric, options=SearchOptions(samples=10_000))
    assert found.overlap_before == 1.0
    assert found.overlap == pytest.approx(1.0 / 3.0, abs=0.02)
    middle = np.array([[128.0, 128.0, 100.0]])
    there = [[0.0, 0.0, -2.0 * round(0.4 * count)]]
    np.testing.assert_allclose(found.points(middle) - middle, there, atol=0.85)


START = Measured(-0.2, 1.0)


@pytest.mark.parametrize(
    ("end", "said"),
    [
        (Measured(-0.9, 0.33, contrast=0.9), None),
        # little is left, and that shows nothing: air on air
        (Measured(-0.9, 0.33, contrast=0.1), "were moved apart"),
        # or is hardly more alike than all was at the start
        (Measured(-0.21, 0.33, contrast=0.9), "were moved apart"),
        # too little is left, however good
        (Measured(-0.99, 0.1, contrast=0.9), "were moved apart"),
        (Measured(-0.21, 0.6, contrast=0.1), None),
        (Measured(-0.19, 1.0), "did not become more alike"),
        (Measured(np.nan, 1.0), "did not become more alike"),
    ],
)
def test_an_end_must_be_borne_out(end: Measured, said: str | None) -> None:
    image = SimpleITK.GetImageFromArray(np.zeros((4, 4, 4), np.float32))
    compared = Compared((image, image), (None, None), metric="correlation", bins=32)
    history = SearchHistory(lambda *_: None, lambda _: None)
    if said is None:
        compared.check(START, end, history)
        return
    with pytest.raises(RegistrationError, match=said):
        compared.check(START, end, history)


def test_scans_in_which_nothing_is_alike_are_refused() -> None:
    random = np.random.default_rng(0)
    noise = [random.normal(0.0, 300.0, SHAPE).astype(np.int16) for _ in range(2)]
    first, second = (Volume(values, spacing=SPACING) for values in noise)
    few = SearchOptions(samples=20_000, iterations=20)
    with pytest.raises(RegistrationError, match="nothing in the scans is alike"):
        register(first, second, metric="correlation", options=few)


@pytest.mark.parametrize("metric", METRICS)
@pytest.mark.parametrize("which", ["fixed", "moving"])
def test_a_scan_of_one_value_is_refused_for_that(fixed: Volume, metric: Metric, which: str) -> None:
    flat = fixed.with_values(np.full(SHAPE, -1000, np.int16))
    pair = (flat, fixed) if which == "fixed" else (fixed, flat)
    with pytest.raises(OptionError, match=f"the {which} scan has one value, -1000, everywhere"):
        register(*pair, metric=metric, options=QUICK)


def test_masks_without_voxels_or_over_one_value_are_refused_for_that(fixed: Volume) -> None:
    empty = fixed.segment(np.zeros(SHAPE), name="none")
    outside = Volume(fixed.array, spacing=SPACING, origin=(900.0, 0.0, 0.0))
    whole = outside.segment(np.ones(SHAPE), name="elsewhere")
    for mask in (empty, whole):
        with pytest.raises(OptionError, match="the mask of the fixed scan has no voxel in it"):
            register(fixed, fixed, fixed_mask=mask, options=QUICK)
        with pytest.raises(OptionError, match="the mask of the moving scan has no voxel in it"):
            register(fixed, fixed, moving_mask=mask, options=QUICK)
    air = fixed.with_values(np.where(fixed.array < -900, -1000, fixed.array).astype(np.int16))
    around = air.segment(air.array == -1000, name="air")
    with pytest.raises(OptionError, match="moving scan has one value, -1000, within its mask"):
        register(fixed, air, moving_mask=around, options=QUICK)


def test_a_start_is_kept_only_where_it_is_the_best(fixed: Volume) -> None:
    few = SearchOptions(samples=1000, iterations=5)
    found = register(fixed, fixed, metric="correlation", options=few)
    assert found.start_kept
    assert found.after == found.before
    # a scan that is alike along an axis does not tell where along it the other lies
    bar = fixed.with_values(np.broadcast_to(fixed.array[:, :1, :], SHAPE).copy())
    with pytest.raises(RegistrationError, match="better than the start, nor is the start the best"):
        register(bar, bar, metric="correlation", options=few)


LINE = [[0.0, 0.0, 0.0], [1.0, 1.0, 1.0], [2.0, 2.0, 2.0]]


@pytest.mark.parametrize(
    ("choice", "said"),
    [
        ({"kind": "elastic"}, "kind 'elastic' given; allowed: rigid, affine, bspline"),
        ({"metric": "ssd"}, "allowed: automatic, mutual-information, correlation, mean-squares"),
        ({"start": "middle"}, "allowed: geometry, centre, moments, landmarks"),
        ({"start": "landmarks"}, "start from landmarks, but none given"),
        ({"landmarks": (LINE, LINE)}, "3 landmarks given, or all on one line"),
        ({"landmarks": (LINE, LINE[:2])}, r"landmarks of shapes \[3, 3\] and \[2, 3\] given"),
        ({"options": SearchOptions(knots=0.0)}, "knots 0 given; allowed: 1 to 1000"),
    ],
)
def test_choices_that_are_not_known_are_refused(
    fixed: Volume, choice: dict[str, object], said: str
) -> None:
    with pytest.raises(OptionError, match=said):
        register(fixed, fixed, **choice)  # type: ignore[arg-type]
