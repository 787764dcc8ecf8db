"""Packed pictures look as those that are not packed, and are much smaller."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from palpate import read
from palpate.pictures.render import DrawnScene
from palpate.pictures.session_pictures import DrawnArrays
from palpate.server.messages.encoded_picture import encoded_picture
from palpate.server.messages.picture_coding import Packing
from picture_texels import colours_of, depths_of

SIZE = (400, 340)


@pytest.fixture(scope="module")
def picture(data_folder: Path) -> DrawnArrays:
    scene = DrawnScene(read(data_folder / "cthead_stanford" / "CThead.mha"))
    camera = scene.camera("first", SIZE)
    drawn = scene._renderer.draw(camera, SIZE, samples=1, haste=True)
    assert drawn is not None
    return DrawnArrays(drawn.colours(), drawn.depths())


def packed(picture: DrawnArrays, packing: Packing) -> dict[str, object]:
    message = encoded_picture(
        picture, number=1, divisor=1.0, samples=1, finished=True, seconds=0.1, packing=packing
    )
    return {name: getattr(message, name) for name in message.__struct_fields__}


def on_screen(colours: NDArray[np.float32]) -> NDArray[np.float64]:
    """Returns sRGB over the page's ground, highlights bent, 0 to 255 (composite.frag)."""
    light = colours[..., :3].astype(np.float64)
    bent = np.minimum(light, 0.7) + 0.3 * (1.0 - np.exp(-np.maximum(light - 0.7, 0.0) / 0.3))
    shown = np.clip(bent + (1.0 - colours[..., 3:]) * 0.01, 0.0, 1.0)
    return 255.0 * np.where(shown <= 0.0031308, 12.92 * shown, 1.055 * shown ** (1 / 2.4) - 0.055)


@pytest.mark.data
@pytest.mark.parametrize(("quality", "most"), [(50, 2.0), (75, 1.5), (95, 0.7)])
def test_a_packed_picture_looks_the_same(picture: DrawnArrays, quality: int, most: float) -> None:
    message = packed(picture, Packing(quality))
    off = np.abs(on_screen(colours_of(message)) - on_screen(picture.colours))
    assert off.mean() <= most
    assert np.quantile(off, 0.999) <= 40 * most


@pytest.mark.data
def test_it_is_much_smaller(picture: DrawnArrays) -> None:
    raw = packed(picture, Packing())
    small = packed(picture, Packing(75, depth_step=1.0, depth_every=2))
    sizes = [len(each["colours"]) + len(each["depths"]) for each in (raw, small)]  # type: ignore[arg-type]
    assert sizes[0] == 10 * SIZE[0] * SIZE[1]
    assert sizes[1] < sizes[0] / 40


@pytest.mark.data
def test_depths_are_kept_to_their_step(picture: DrawnArrays) -> None:
    message = packed(picture, Packing(75, depth_step=1.0, depth_every=2))
    before, after = picture.depths[::2, ::2], depths_of(message)
    seen = np.isfinite(before)
    assert (np.isfinite(after) == seen).all()
    assert np.abs(after[seen] - before[seen]).max() <= 0.501


@pytest.mark.data
@pytest.mark.parametrize("packing", [Packing(), Packing(75, depth_step=1.0, depth_every=2)])
def test_depths_of_what_is_seen_through_are_told_apart(data_folder: Path, packing: Packing) -> None:
    scene = DrawnScene(read(data_folder / "cthead_stanford" / "CThead.mha"), mode="absorption")
    camera = scene.camera("first", SIZE)
    drawn = scene._renderer.draw(camera, SIZE, samples=1, haste=True)
    assert drawn is not None
    picture = DrawnArrays(drawn.colours(), drawn.depths())
    before = picture.depths[:: packing.depth_every, :: packing.depth_every]
    after = depths_of(packed(picture, packing))
    seen = np.isfinite(before)
    assert (before[seen] < 0).all()
    assert seen.mean() > 0.1
    assert (np.isfinite(after) == seen).all()
    # half a step
    assert np.abs(after[seen] - before[seen]).max() <= 0.501
    # the middle of a head, not its face
    assert abs(np.median(-before[seen]) - camera.distance) < 25.0
