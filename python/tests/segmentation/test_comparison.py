"""Segments beside a reference: Dice and distances, checked against ITK and distance maps."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import palpate
import pytest
import SimpleITK
from numpy.typing import NDArray
from palpate.base.errors import OptionError
from palpate.labels.labels import read_any_labels
from palpate.segmentation.measures.surface_distances import border_voxels, surface_distances
from scipy import ndimage

SPACING = (0.7, 1.3, 2.1)
SHAPE = (24, 31, 37)


def blobs(seed: int) -> NDArray[np.bool_]:
    """Random smooth blobs, some of which reach the border of the grid."""
    noise = np.random.default_rng(seed).standard_normal(SHAPE)
    return np.asarray(ndimage.gaussian_filter(noise, 3.0) > 0.02, bool)


def volume_of(shape: tuple[int, ...] = SHAPE) -> palpate.Volume:
    return palpate.Volume(np.zeros(shape, np.int16), spacing=SPACING)


def labels_of(volume: palpate.Volume, **masks: NDArray[Any]) -> palpate.Labels:
    made = (palpate.Label(volume.segment(mask, name=name)) for name, mask in masks.items())
    return palpate.Labels(tuple(made))


def compared(first: NDArray[Any], second: NDArray[Any]) -> palpate.SegmentComparison:
    volume = volume_of()
    scene = palpate.Scene(volume, [volume.segment(first, name="mine")])
    (one,) = palpate.compare(scene, labels_of(volume, truth=second)).segments
    return one


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_distances_are_those_of_distance_maps(seed: int) -> None:
    first, second = blobs(seed), blobs(seed + 10)
    rims = [mask & ~ndimage.binary_erosion(mask) for mask in (first, second)]
    maps = [ndimage.distance_transform_edt(~rim, sampling=SPACING[::-1]) for rim in rims]
    ways = maps[1][rims[0]], maps[0][rims[1]]
    found = surface_distances(first, second, SPACING)
    for mine, other in zip(found, ways, strict=True):
        np.testing.assert_allclose(np.sort(mine), np.sort(other), atol=1e-9)
    one = compared(first, second)
    assert one.hausdorff_95 == pytest.approx(max(np.percentile(way, 95) for way in ways))
    assert one.mean_surface_distance == pytest.approx(np.concatenate(ways).mean())


def test_overlap_and_largest_distance_are_those_of_itk() -> None:
    first, second = blobs(4), blobs(5)
    images = [SimpleITK.GetImageFromArray(mask.astype(np.uint8)) for mask in (first, second)]
    for image in images:
        image.SetSpacing(SPACING)
    overlap = SimpleITK.LabelOverlapMeasuresImageFilter()
    overlap.Execute(*images)
    one = compared(first, second)
    assert one.dice == pytest.approx(overlap.GetDiceCoefficient())
    # ITK measures from all voxels that it is given
    distances = SimpleITK.HausdorffDistanceImageFilter()
    rims = [
        SimpleITK.GetImageFromArray((mask & ~ndimage.binary_erosion(mask)).astype(np.uint8))
        for mask in (first, second)
    ]
    for rim in rims:
        rim.SetSpacing(SPACING)
    distances.Execute(*rims)
    largest = max(way.max() for way in surface_distances(first, second, SPACING))
    assert largest == pytest.approx(distances.GetHausdorffDistance(), rel=1e-5)


def test_a_shift_of_a_block_is_measured_in_millimetres() -> None:
    first = np.zeros(SHAPE, bool)
    first[6:14, 8:20, 10:25] = True
    one = compared(first, np.roll(first, 2, axis=2))
    assert one.dice == pytest.approx(2 * 13 / (2 * 15))
    assert one.hausdorff_95 == pytest.approx(2 * 0.7)
    same = compared(first, first)
    assert (same.dice, same.hausdorff_95, same.mean_surface_distance) == (1.0, 0.0, 0.0)


def test_the_border_of_the_grid_is_a_border() -> None:
    full = np.ones((3, 4, 5), bool)
    assert len(border_voxels(full)) == 3 * 4 * 5 - 1 * 2 * 3


def test_empty_masks_have_no_distance_and_are_told() -> None:
    nothing, block = np.zeros(SHAPE, bool), np.zeros(SHAPE, bool)
    block[5:9, 5:9, 5:9] = True
    missed = compared(nothing, block)
    assert (missed.dice, missed.hausdorff_95) == (0.0, None)
    assert missed.note == "the segment is empty: no distances"
    volume = volume_of()
    scene = palpate.Scene(volume, [volume.segment(block, name="mine")])
    found = palpate.compare(scene, labels_of(volume, truth=nothing))
    assert found.segments[0].dice == 0.0
    assert found.warnings == ("mine: the reference is empty: no distances",)
    both = compared(nothing, nothing)
    assert (both.dice, both.note) == (None, "both are empty")


def test_segments_are_compared_by_their_names_and_what_is_left_is_told() -> None:
    volume, block = volume_of(), np.zeros(SHAPE, bool)
    block[5:9, 5:9, 5:9] = True
    scene = palpate.Scene(
        volume, [volume.segment(block, name="liver"), volume.segment(block, name="bone")]
    )
    truth = labels_of(volume, bone=np.roll(block, 1, axis=0), spleen=block)
    found = palpate.compare(scene, truth)
    liver, bone = found.segments
    assert liver.dice is None
    assert bone.dice == pytest.approx(0.75)
    assert found.warnings == (
        "only in the reference, not compared: spleen",
        "liver: not in the reference, or empty there",
    )
    (chosen,) = palpate.compare(scene, truth, segment="liver", against="spleen").segments
    assert (chosen.reference, chosen.dice) == ("spleen", 1.0)
    with pytest.raises(OptionError, match=r"^reference: segment 'liver' given; allowed: .*spleen"):
        palpate.compare(scene, truth, segment="liver")
    other = labels_of(volume, kidney=block, spleen=block)
    with pytest.raises(OptionError, match=r"allowed: names that both have"):
        palpate.compare(scene, other)


def test_a_reference_on_another_grid_is_refused() -> None:
    volume, block = volume_of(), np.ones(SHAPE, bool)
    scene = palpate.Scene(volume, [volume.segment(block, name="mine")])
    moved = palpate.Volume(np.zeros(SHAPE, np.int16), spacing=SPACING, origin=(0.3, 0.0, 0.0))
    with pytest.raises(OptionError, match="mm off the voxels of the scan"):
        palpate.compare(scene, labels_of(moved, truth=block))
    own = palpate.Label(volume.segment(block, name="plate").as_object())
    with pytest.raises(OptionError, match="has a grid of its own"):
        palpate.compare(scene, palpate.Labels((own,)))


def test_files_are_laid_by_their_place_in_the_patient(tmp_path: Path) -> None:
    volume, block = volume_of(), np.zeros(SHAPE, bool)
    block[5:9, 6:12, 7:15] = True
    scene = palpate.Scene(volume, [volume.segment(block, name="mine")])

    def written(values: NDArray[Any], origin: tuple[float, ...]) -> Path:
        image = SimpleITK.GetImageFromArray(values.astype(np.uint8))
        image.SetSpacing(SPACING)
        image.SetOrigin(origin)
        path = tmp_path / "truth.nii.gz"
        SimpleITK.WriteImage(image, str(path))
        return path

    # a part of the grid, cut out
    cut = written(block[3:15, 4:20, 5:30], (5 * 0.7, 4 * 1.3, 3 * 2.1))
    found = palpate.compare(scene, read_any_labels(cut, volume))
    assert found.segments[0].dice == 1.0
    assert "the map has 25 x 16 x 12 voxels, the scan 37 x 31 x 24" in found.warnings
    # half a voxel off is refused, or resampled and told
    off = written(block, (0.35, 0.0, 0.0))
    with pytest.raises(OptionError, match="lies on another grid than the scan"):
        read_any_labels(off, volume)
    told = palpate.compare(scene, read_any_labels(off, volume, resample=True)).warnings
    assert any("another grid" in sentence for sentence in told)
    empty = written(np.zeros(SHAPE), (0.0, 0.0, 0.0))
    found = palpate.compare(scene, read_any_labels(empty, volume))
    assert (found.segments[0].dice, found.segments[0].hausdorff_95) == (0.0, None)
    assert "mine: the reference is empty: no distances" in found.warnings
