"""Names and numbers of segments are the same after writing and reading, or it is told."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import palpate
import pytest
import SimpleITK
from palpate.base.errors import OptionError
from palpate.cli.commands import run
from palpate.export.export import export_scene
from palpate.export.numbering import numbers_of, unique_names
from palpate.labels.labels import read_labels
from palpate.saved.edited_scene import edited_scene
from palpate.saved.scene_file import open_scene, save_scene
from palpate.session.session import Session, SessionOptions
from palpate.volumes.scene import Scene, choose_segment

NUMBERS = (1, 6, 40, 41)


def volume() -> palpate.Volume:
    return palpate.Volume(np.zeros((4, 5, 12), np.int16), spacing=(1.0, 1.0, 1.0))


def scene_of(*named: tuple[str, int | None]) -> Scene:
    scan = volume()
    scene = Scene(scan)
    for place, (name, number) in enumerate(named):
        mask = np.zeros(scan.shape, np.uint8)
        mask[1:3, 1:3, place] = 1
        segment = scan.segment(mask, name=name)
        segment.number = number
        scene.add(segment)
    return scene


def atlas(*numbers: int) -> Scene:
    return scene_of(*((f"part {number}", number) for number in numbers))


@pytest.mark.parametrize("name", ["a.nii.gz", "a.nrrd", "a.mha", "a.seg.nrrd"])
@pytest.mark.parametrize("numbers", [NUMBERS, (3, 614454277), (300, 2)])
def test_numbers_stay(tmp_path: Path, name: str, numbers: tuple[int, ...]) -> None:
    assert export_scene(atlas(*numbers), tmp_path / name) == []
    found = read_labels(tmp_path / name, volume()).labels
    assert {one.segment.number: one.segment.name for one in found} == {
        number: f"part {number}" for number in numbers
    }
    if ".seg." not in name:
        voxels = SimpleITK.GetArrayFromImage(SimpleITK.ReadImage(str(tmp_path / name)))
        assert set(np.unique(voxels)) == {0, *numbers}


def test_numbers_stay_in_a_saved_scene(tmp_path: Path) -> None:
    scene = atlas(*NUMBERS)
    with Session(scene, options=SessionOptions(real_time=False)) as session:
        save_scene(tmp_path / "a.palpate", session, copy=True)
    again, _ = edited_scene(open_scene(tmp_path / "a.palpate"))
    assert [one.segment.number for one in again] == list(NUMBERS)


def test_a_number_too_large_is_told_and_comes_back_from_the_table(tmp_path: Path) -> None:
    told = export_scene(atlas(2, 2**40, -7), tmp_path / "a.nii.gz")
    assert told == [f"label numbers change: part {2**40} {2**40} -> 1, part -7 -7 -> 3"]
    found = read_labels(tmp_path / "a.nii.gz", volume()).labels
    assert {one.segment.number for one in found} == {2, 2**40, -7}


def test_segments_of_one_number_get_numbers_of_their_own() -> None:
    numbers, told = numbers_of(list(scene_of(("a", 1), ("b", None), ("c", 1), ("d", 2))))
    assert numbers == [1, 3, 4, 2]
    assert told == ["label numbers change: c 1 -> 4"]


def test_each_file_has_a_table_of_its_own(tmp_path: Path) -> None:
    files = {"pat.1.nii.gz": "bone", "pat.2.nii.gz": "soft tissue", "pat.1.nrrd": "skin"}
    for name, part in files.items():
        export_scene(scene_of((part, None)), tmp_path / name)
    for name, part in files.items():
        assert [one.segment.name for one in read_labels(tmp_path / name, volume()).labels] == [part]


@pytest.mark.parametrize(
    ("before", "name"),
    [
        # a table of marks, of whatever program
        ({"a.csv": "name,x,y,z\ntip,1,2,3\n"}, "a.nrrd"),
        # names that belong to no image that is there yet
        ({"a.csv": "id,structure\n1,mine\n"}, "a.nrrd"),
        # names of all label maps of a folder
        ({}, "structures.nrrd"),
        # the same name in other letters, and an image called as the other's table
        ({"a.NRRD": ""}, "a.nii.gz"),
        ({"a.nii.gz": ""}, "a.nii.gz.nrrd"),
    ],
)
def test_a_table_replaces_no_other_file(tmp_path: Path, before: dict[str, str], name: str) -> None:
    for other, text in before.items():
        (tmp_path / other).write_text(text)
    for part in ("bone", "again"):
        export_scene(scene_of((part, None)), tmp_path / name)
        (found,) = read_labels(tmp_path / name, volume()).labels
        assert found.segment.name == part
        assert (tmp_path / f"{name}.csv").is_file()
        assert all((tmp_path / other).read_text() == text for other, text in before.items())


def test_a_table_of_version_0_1_is_read_where_one_file_may_mean_it(tmp_path: Path) -> None:
    path = tmp_path / "pat.1.nii.gz"
    export_scene(scene_of(("bone", None)), path)
    (tmp_path / "pat.1.csv").rename(tmp_path / "pat.csv")
    assert read_labels(path, volume()).labels[0].segment.name == "bone"
    (tmp_path / "pat.2.nii.gz").write_bytes(path.read_bytes())
    assert read_labels(path, volume()).labels[0].segment.name == "label 1"


def test_it_is_told_what_lies_outside_of_the_scan(tmp_path: Path) -> None:
    export_scene(atlas(*NUMBERS), tmp_path / "a.nii.gz")
    scan = palpate.Volume(np.zeros((4, 5, 2), np.int16), spacing=(1.0, 1.0, 1.0))
    found = read_labels(tmp_path / "a.nii.gz", scan)
    assert [one.segment.number for one in found.labels] == [1, 6]
    lost = "8 voxels of segments lie outside the scan (50 %): part 40 (100 %), part 41 (100 %)"
    assert lost in found.warnings


def test_the_command_tells_what_it_wrote_and_of_how_many(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    export_scene(atlas(*NUMBERS), tmp_path / "a.seg.nrrd")
    export_scene(Scene(volume()), tmp_path / "scan.nrrd")
    given = [str(tmp_path / "scan.nrrd"), "--segments", str(tmp_path / "a.seg.nrrd")]
    chosen = ["--only", "part 6", "--only", "part 41"]
    assert run(["export", *given, *chosen, "-o", str(tmp_path / "two.nii.gz")]) == 0
    assert "2 of 4 segments (part 6, part 41) in scan" in capsys.readouterr().out


def test_a_name_of_two_segments_chooses_none() -> None:
    scene = scene_of(("a", None), ("a", None))
    with pytest.raises(OptionError, match="2 segments are called 'a'; allowed: a number, 1 or 2"):
        choose_segment(scene, "a")
    with pytest.raises(OptionError, match="allowed: a name or a number of 1 a, 2 a"):
        choose_segment(scene, None)


def test_names_are_made_different_within_64_characters() -> None:
    long = "x" * 80
    names, told = unique_names(list(scene_of((long + "1", None), (long + "2", None), ("a", None))))
    assert names == ["x" * 64, "x" * 60 + " (2)", "a"]
    assert len(told) == 1
    names, told = unique_names(list(scene_of(("a", None), ("a", None), ("a (2)", None))))
    assert names == ["a", "a (3)", "a (2)"]
    assert told == ["names are made different within 64 characters: 'a' as 'a (3)'"]
