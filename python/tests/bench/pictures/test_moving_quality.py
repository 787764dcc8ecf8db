"""Moving pictures are compared with sharp ones as the page shows both."""

from __future__ import annotations

import numpy as np
import palpate
import pytest
from palpate.bench.goals.seen import SEEN_ROWS, moving_case
from palpate.bench.pictures.moving_quality import MOVING, likeness, moving_quality
from palpate.bench.pictures.on_page import enlarged, on_page, screen_from_linear
from palpate.bench.pictures.ssim import structural_similarity
from palpate.saved.opening import opening_of
from palpate.server.messages import engine_pictures


def test_even_pictures_have_the_similarity_of_their_brightness() -> None:
    # without structure the formula is (2ab + c) / (a² + b² + c), c = 0.0001 (Wang et al. 2004)
    dark, bright = np.full((20, 30), 0.2), np.full((20, 30), 0.6)
    expected = (2 * 0.2 * 0.6 + 1e-4) / (0.2**2 + 0.6**2 + 1e-4)
    assert structural_similarity(dark, bright) == pytest.approx(expected, abs=1e-12)
    assert structural_similarity(bright, bright) == pytest.approx(1.0)


def test_similarity_is_that_of_scikit_image() -> None:
    y, x = np.mgrid[0:48, 0:64] / 8.0
    one = 0.5 + 0.3 * np.sin(x) * np.cos(y)
    other = np.clip(one + 0.1 * np.sin(5.0 * x + y), 0.0, 1.0)
    # scikit-image 0.26: gaussian_weights, sigma 1.5, use_sample_covariance False, data_range 1;
    # its mean leaves out 5 pixels at each side, too
    assert structural_similarity(one, other) == pytest.approx(SCIKIT_IMAGE, abs=1e-9)


SCIKIT_IMAGE = 0.5083290151574508


def test_a_ramp_is_enlarged_to_a_ramp() -> None:
    ramp = np.tile((np.arange(8) + 0.5) / 8.0, (6, 1))[..., None]
    large = enlarged(ramp, (24, 18))
    assert large.shape == (18, 24, 1)
    assert large[:, 2:-2, 0] == pytest.approx(
        np.tile((np.arange(24) + 0.5) / 24.0, (18, 1))[:, 2:-2]
    )


def test_the_page_shows_the_ground_where_nothing_is_and_bends_highlights() -> None:
    clear = on_page(np.zeros((4, 4, 4)), (8, 8))
    assert clear.shape == (8, 8, 3)
    assert np.ptp(clear, axis=(0, 1)) == pytest.approx(0.0, abs=1e-12)
    opaque = np.ones((4, 4, 4))
    bent = 0.7 + 0.3 * (1.0 - np.exp(-1.0))
    expected = float(screen_from_linear(np.array(bent)))
    # coarse pictures are put together first: of an even one that is the same
    for size in ((4, 4), (12, 12), (16, 16)):
        assert on_page(opaque, size) == pytest.approx(np.full((*size, 3), expected))


def test_likeness_is_of_the_same_picture_whole() -> None:
    picture = np.random.default_rng(1).random((16, 16, 3))
    assert likeness(picture, picture) == pytest.approx((1.0, 0.0))
    similarity, error = likeness(picture, np.clip(picture + 0.1, 0.0, 1.1))
    assert similarity < 1.0
    assert error == pytest.approx(0.1)


def test_moving_pictures_are_drawn_as_the_server_draws_them() -> None:
    stage = engine_pictures.Stage(3.0, haste=True)
    assert MOVING.haste is stage.haste
    assert MOVING.samples == stage.samples
    assert MOVING.steps_per_voxel == engine_pictures.HASTE_STEPS


def test_a_finer_moving_picture_is_no_less_like_the_sharp_one() -> None:
    z, y, x = np.mgrid[0:40, 0:40, 0:40] - 20.0
    values = np.where(x * x + y * y + z * z <= 15.0**2, 900, -1000).astype(np.int16)
    scene = opening_of(palpate.Volume(values, spacing=(1.0, 1.0, 1.0))).scene
    coarse, fine = (
        moving_quality(scene, divisor=by, views=1, size=(120, 100)) for by in (8.0, 2.0)
    )
    assert coarse["ssim"] < fine["ssim"] <= 1.0
    assert coarse["error"] > fine["error"] > 0.0
    case = moving_case("CThead")
    assert {row.key for row in SEEN_ROWS if row.case == case} == set(fine)
