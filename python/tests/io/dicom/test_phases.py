"""Several volumes in one series: offered one by one."""

from __future__ import annotations

from copy import deepcopy
from pathlib import Path
from typing import Any

import numpy as np
import palpate
import pytest
from dicom_cases import case
from palpate.base.errors import SeriesChoiceError, VolumeFormatError
from palpate.cli.commands import run
from palpate.io.browse import browsed
from palpate.io.reading import list_series
from pydicom import dcmread
from pydicom.dataset import Dataset, FileDataset
from pydicom.sequence import Sequence

PLACES = [(0.0, 0.0, 2.5 * k) for k in range(4)]


def series_of(write_series: Any, *values: dict[str, Any], **changes: Any) -> Path:
    """Writes a stack of slices for each of these values, all in one series."""
    for number, one in enumerate(values):
        folder: Path = write_series(
            uid="1.2.3",
            prefix=f"{number}-",
            positions=PLACES,
            description="liver",
            scale=(1.0, 1000.0 * number),
            **changes,
            **one,
        )
    return folder


@pytest.mark.parametrize(
    ("values", "told"),
    [
        ([{"TemporalPositionIdentifier": n} for n in (10, 9)], ["time 9", "time 10"]),
        ([{"EchoTime": t} for t in (2.4, 4.8)], ["echo of 2.4 ms", "echo of 4.8 ms"]),
        ([{"DiffusionBValue": b} for b in (0.0, 800.0)], ["b = 0 s/mm²", "b = 800 s/mm²"]),
        ([{"AcquisitionNumber": n} for n in (1, 2)], ["acquisition 1", "acquisition 2"]),
        (
            [{"ImageType": ["ORIGINAL", "PRIMARY", kind]} for kind in ("FAT", "WATER")],
            ["ORIGINAL PRIMARY FAT", "ORIGINAL PRIMARY WATER"],
        ),
        (
            [{"EchoTime": t, "TemporalPositionIdentifier": n} for t in (1, 2) for n in (1, 2)],
            [f"time {n}, echo of {t} ms" for n in (1, 2) for t in ("1", "2")],
        ),
    ],
)
def test_phases_are_listed_and_read_one_by_one(
    write_series: Any, values: list[dict[str, Any]], told: list[str]
) -> None:
    folder = series_of(write_series, *values)
    listed = list_series(folder)
    assert [one.description for one in listed] == [f"liver, {words}" for words in told]
    assert {one.slices for one in listed} == {4}
    with pytest.raises(SeriesChoiceError, match=f"holds {len(told)} series; choose one"):
        palpate.read(folder)
    seen = set()
    for number, words in enumerate(told, 1):
        volume = palpate.read(folder, series=str(number))
        assert volume.name == f"liver, {words}"
        assert volume.dimensions == (4, 3, 4)
        by_name = palpate.read(folder, series=volume.name)
        np.testing.assert_array_equal(by_name.array, volume.array)
        seen.add(int(volume.array[0, 0, 0]))
    assert seen == {1000 * number for number in range(len(told))}
    # the page lists them too, each with what reads it
    with browsed(folder) as choices:
        assert [(one.name, one.series, one.refused) for one in choices] == [
            (f"liver, {words}", str(number), None) for number, words in enumerate(told, 1)
        ]


def test_many_volumes_of_one_series_are_one_entry(
    write_series: Any, capsys: pytest.CaptureFixture[str]
) -> None:
    directions = [(float(n), 0.0, 1.0) for n in range(6)]
    folder = series_of(
        write_series, *({"DiffusionGradientOrientation": list(one)} for one in directions)
    )
    write_series(uid="1.2.4", prefix="z", description="scout", positions=PLACES[:2])
    assert [one.part for one in list_series(folder)] == [
        *(f"direction {n} 0 1" for n in range(6)),
        "",
    ]
    said = r"\[1 to 6\] 1\.2\.3 'liver' CT, 6 volumes: direction 0 0 1 to direction 5 0 1; \[7\]"
    with pytest.raises(SeriesChoiceError, match=said):
        palpate.read(folder)
    for command in ("import", "series"):
        assert run([command, str(folder)]) == 0
        # the table is as wide as the terminal
        table = " ".join(capsys.readouterr().out.split())
        assert "1 to 6" in table
        assert "direction 3 0 1" not in table
        assert run([command, str(folder), "--all"]) == 0
        assert "direction 3 0 1" in " ".join(capsys.readouterr().out.split())
    # what the list counts as 4 is the fourth
    assert palpate.read(folder, series="4").name == "liver, direction 3 0 1"
    with browsed(folder) as choices:
        assert [one.part for one in choices[:2]] == ["direction 0 0 1", "direction 1 0 1"]


def test_slices_that_nothing_tells_apart_are_refused_as_before(write_series: Any) -> None:
    folder = series_of(write_series, {}, {})
    with pytest.raises(VolumeFormatError, match="4 slices at the place of another"):
        palpate.read(folder)


def test_one_volume_whose_slices_differ_is_not_parted(write_series: Any) -> None:
    def differ(number: int, dataset: FileDataset) -> None:
        dataset.AcquisitionNumber = number
        dataset.AcquisitionTime = f"12000{number}"

    folder = write_series(each=differ)
    assert len(list_series(folder)) == 1


FRAMES = Path("pydicom_transfer_syntaxes", "eCT_Supplemental.dcm")


def item(**values: Any) -> Dataset:
    """Returns the only item of a functional group."""
    made = Dataset()
    for name, value in values.items():
        setattr(made, name, value)
    return made


def directed(*direction: float) -> Dataset:
    """Returns a diffusion with a gradient in such a direction; in none where none is given."""
    if not direction:
        return item(DiffusionBValue=0.0)
    along = Sequence([item(DiffusionGradientOrientation=list(direction))])
    return item(DiffusionBValue=800.0, DiffusionGradientDirectionSequence=along)


def enhanced(source: Path, target: Path, group: str, *items: Dataset) -> None:
    """Writes the frames of a file again for each of these items of a functional group."""
    dataset = dcmread(source)
    frames = [*dataset.PerFrameFunctionalGroupsSequence]
    pixels = dataset.pixel_array
    groups = []
    # the frames of all of them take turns
    for frame in frames:
        for each in items:
            copy = deepcopy(frame)
            setattr(copy, group, Sequence([each]))
            groups.append(copy)
    dataset.PerFrameFunctionalGroupsSequence = Sequence(groups)
    dataset.NumberOfFrames = len(groups)
    # each is turned up and down against the one before
    turned = [pixels[:, :: 1 - 2 * (number % 2)] for number in range(len(items))]
    dataset.PixelData = np.stack(turned, axis=1).reshape(-1, *pixels.shape[1:]).tobytes()
    dataset.save_as(target)


@pytest.mark.data
@pytest.mark.parametrize(
    ("group", "items", "told"),
    [
        (
            "FrameContentSequence",
            [item(TemporalPositionIndex=number) for number in (1, 2)],
            ["time 1", "time 2"],
        ),
        (
            "MREchoSequence",
            [item(EffectiveEchoTime=time) for time in (2.4, 10.8)],
            ["echo of 2.4 ms", "echo of 10.8 ms"],
        ),
        (
            "MRDiffusionSequence",
            [item(DiffusionBValue=value) for value in (0.0, 800.0)],
            ["b = 0 s/mm²", "b = 800 s/mm²"],
        ),
        ("MRDiffusionSequence", [directed(), directed(0, 1, 0)], ["b = 0 s/mm²", "b = 800 s/mm²"]),
        (
            "MRDiffusionSequence",
            [directed(0, 0, 1), directed(0, 0.6, 0.8)],
            ["direction 0 0 1", "direction 0 0.6 0.8"],
        ),
        (
            "MRModifierSequence",
            [item(InversionTimes=[time]) for time in (150.0, 900.0)],
            ["inversion time 150 ms", "inversion time 900 ms"],
        ),
        (
            "CardiacSynchronizationSequence",
            [item(NominalCardiacTriggerDelayTime=time) for time in (0.0, 42.0)],
            ["0 ms after the trigger", "42 ms after the trigger"],
        ),
    ],
)
def test_volumes_in_one_file_of_many_frames_are_told_apart(
    data_folder: Path, tmp_path: Path, group: str, items: list[Dataset], told: list[str]
) -> None:
    path = tmp_path / "frames.dcm"
    enhanced(data_folder / FRAMES, path, group, *items)
    expected = palpate.read(data_folder / FRAMES)
    with pytest.raises(SeriesChoiceError, match=r"frames\.dcm holds 2 series; choose one"):
        palpate.read(path)
    first, second = (palpate.read(path, series=number) for number in ("1", "2"))
    np.testing.assert_array_equal(first.array, expected.array)
    np.testing.assert_array_equal(second.array, expected.array[:, ::-1])
    np.testing.assert_array_equal(first.patient_from_grid, expected.patient_from_grid)
    for one, words in zip((first, second), told, strict=True):
        assert one.name.endswith(words)
    with browsed(path) as choices:
        assert [one.series for one in choices] == ["1", "2"]
        small = [choice.picture() for choice in choices]
        assert not np.array_equal(small[0], small[1])


# --- times that differ from place to place ---------------------------------------------------


@pytest.mark.data
def test_phases_of_other_heartbeats_are_told_by_their_order(data_folder: Path) -> None:
    folder = case(data_folder, 24)
    assert [series.slices for series in list_series(folder)] == [12] * 4
    last = palpate.read(folder, series="4")
    assert (last.range, last.dimensions[2]) == ((0.0, 1000.0), 12)
    assert last.name.endswith("phase 4 of 4 after the trigger")


@pytest.mark.parametrize("name", ["TriggerTime", "AcquisitionTime"])
def test_times_are_ranked_at_each_place(write_series: Any, name: str) -> None:
    def change(number: int, dataset: FileDataset) -> None:
        place, phase = number % 4, number // 4
        # later places begin later than the last phase of the first, and run the other way in files
        setattr(dataset, name, str(101000 + 10 * place + 2 * (2 - phase)))

    folder = write_series(positions=PLACES * 3, each=change)
    for rank in range(3):
        volume = palpate.read(folder, series=str(rank + 1))
        numbers = (volume.array[:, 0, 0] + 1024) // 100
        assert numbers.tolist() == [4 * (2 - rank) + place for place in range(4)]


@pytest.mark.parametrize("differ", ["ImageType", "places", "equal"])
def test_times_do_not_rank_what_differs_otherwise(write_series: Any, differ: str) -> None:
    def change(number: int, dataset: FileDataset) -> None:
        place, phase = number % 4, number // 4
        dataset.TriggerTime = 5 if differ == "equal" else 100 + 3 * place + 20 * phase
        if differ == "ImageType":
            dataset.ImageType = ["ORIGINAL", "PRIMARY", "MP"[(place + phase) % 3 == 0]]

    # one place has no second phase
    places = PLACES * 2 if differ != "places" else PLACES + PLACES[:3]
    folder = write_series(positions=places, each=change)
    with pytest.raises(VolumeFormatError, match="at the place of another"):
        palpate.read(folder)
