"""Label maps keep their labels on another grid, scans are linear between voxels."""

from __future__ import annotations

import numpy as np
import pytest
import SimpleITK
from numpy.typing import NDArray
from palpate import OptionError, Volume
from palpate.base.interpolation import InterpolationChoice
from palpate.volumes.label_like import are_labels
from palpate.volumes.resampled import interpolation_for, resampled
from palpate.volumes.volume import VolumeTraits

TURN = SimpleITK.Euler3DTransform()
TURN.SetCenter([12.0, 12.0, 12.0])
TURN.SetRotation(0.1, 0.2, 0.4)
TURN.SetTranslation([0.4, -0.3, 0.6])
FINER = Volume(np.zeros((34, 33, 32), np.int16), spacing=(0.7, 0.7, 0.7))


def labels(numbers: tuple[int, int] = (2, 5)) -> NDArray[np.int32]:
    """Two bodies that touch one another."""
    z, y, x = np.indices((24, 24, 24))
    off = np.sqrt((x - 12.0) ** 2 + (y - 11.0) ** 2 + 1.4 * (z - 12.0) ** 2)
    return np.where(off < 8.0, np.where(x > 12, *numbers), 0).astype(np.int32)


def volume(values: NDArray[np.generic], *, name: str = "scan", modality: str = "") -> Volume:
    traits = VolumeTraits(name=name, modality=modality)
    return Volume(values, spacing=(1.0, 1.0, 1.0), traits=traits)


@pytest.mark.parametrize("choice", ["automatic", "nearest", "labels"])
@pytest.mark.parametrize("numbers", [(2, 5), (40, 41)])
def test_a_label_map_has_no_labels_but_its_own(
    choice: InterpolationChoice, numbers: tuple[int, int]
) -> None:
    there = resampled(volume(labels(numbers)), FINER, TURN, interpolation=choice)
    assert set(np.unique(there.values())) == {0, *numbers}


def test_labels_of_any_size_stay_what_they_are() -> None:
    # identifiers of an atlas: no float of 32 bits holds them
    atlas = volume(labels((312_782_546, 312_782_547)), name="atlas_labels.nii.gz")
    assert are_labels(atlas)
    there = resampled(atlas, FINER, TURN)
    assert set(np.unique(there.values())) == {0, 312_782_546, 312_782_547}


def test_by_labels_borders_are_nearer_to_the_body_than_by_the_nearest_voxel() -> None:
    def ball(step: float, count: int) -> Volume:
        z, y, x = np.indices((count,) * 3) * step
        off = np.sqrt((x - 15.0) ** 2 + (y - 14.6) ** 2 + (z - 15.3) ** 2)
        return Volume((off < 10.0).astype(np.uint8), spacing=(step,) * 3)

    coarse, fine = ball(2.0, 16), ball(0.5, 61)
    identity = SimpleITK.Transform(3, SimpleITK.sitkIdentity)
    choices: tuple[InterpolationChoice, ...] = ("nearest", "labels")
    wrong = []
    for choice in choices:
        there = resampled(coarse, fine, identity, interpolation=choice).values()
        assert set(np.unique(there)) == {0, 1}
        wrong.append(int(np.count_nonzero(there != fine.values())))
    assert wrong[1] < 0.8 * wrong[0]


def test_scans_are_linear_unless_asked_otherwise() -> None:
    noise = np.random.default_rng(0).normal(0.0, 30.0, (24, 24, 24))
    scan = volume((labels() * 200 + noise).astype(np.int16), modality="CT")
    assert not are_labels(scan)
    # a CT of two values is a scan still
    assert not are_labels(volume(labels(), modality="CT"))
    assert interpolation_for(scan) == "linear"
    linear = resampled(scan, FINER, TURN).values()
    nearest = resampled(scan, FINER, TURN, interpolation="nearest").values()
    own = np.unique(scan.values())
    assert np.isin(nearest, own).all()
    assert not np.isin(linear, own).all()
    image = SimpleITK.GetImageFromArray(scan.array)
    grid = SimpleITK.GetImageFromArray(FINER.array)
    grid.SetSpacing(FINER.spacing)
    by_itk = SimpleITK.Resample(
        image, grid, TURN, SimpleITK.sitkNearestNeighbor, float(own.min()), SimpleITK.sitkInt16
    )
    np.testing.assert_array_equal(nearest, SimpleITK.GetArrayFromImage(by_itk))


def test_what_cannot_be_is_refused() -> None:
    noise = np.random.default_rng(0).normal(0.0, 300.0, (24, 24, 24)).astype(np.int16)
    with pytest.raises(OptionError, match=r"by labels of \d+ values given; allowed: a label map"):
        resampled(volume(noise), FINER, TURN, interpolation="labels")
    with pytest.raises(OptionError, match="'cubic' given; allowed: automatic, linear, nearest, la"):
        resampled(volume(noise), FINER, TURN, interpolation="cubic")  # type: ignore[arg-type]
