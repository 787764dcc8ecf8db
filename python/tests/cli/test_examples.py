"""The examples that ``--help`` shows, each run as printed in a folder with the files they name."""

from __future__ import annotations

import json
import re
import shlex
import shutil
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import SimpleITK
import trimesh
from made_scans import series_writer
from numpy.typing import NDArray
from palpate.cli.commands import app, run
from palpate.cli.recipe import EXAMPLES as RECIPE
from palpate.export.export import export_scene
from palpate.io.reading import read
from palpate.saved.scene_file import save_scene
from palpate.session.session import Session, SessionOptions
from palpate.volumes.scene import Scene
from pydicom.dataset import FileDataset
from pydicom.uid import generate_uid
from typer.main import get_command

ROOT = Path(__file__).parents[3]
SPACING = 2.5
SHAPE = (28, 30, 32)
ORIGIN = (-123.0, 240.5, 1135.0)
"""Around the point of the liver in the examples [mm]."""
UNSERVED = ("--dicomweb", "--auto", "palpate reconstruct", "palpate recover --re")
"""What needs a server, TotalSegmentator, RTK or changes: only its options are looked at."""
TOLD_OF = {
    "palpate bids data/ out/ group": (
        "palpate bids data/ out/ participant --recipe recipe.yaml --participant-label 01 02"
    ),
}
"""What an example tells of, and another one makes."""


def commands(command: Any = None) -> Iterator[Any]:
    """Gives each command of the command line."""
    command = get_command(app) if command is None else command
    yield command
    for each in getattr(command, "commands", {}).values():
        yield from commands(each)


def examples(text: str) -> list[str]:
    """Returns the commands that a help shows, with what goes on in the next line."""
    found = re.findall(r"^  (palpate .+(?:\n    .+)*)", text, re.MULTILINE)
    return [re.sub(r" {2,}\(.*\)|\n", " ", each).strip() for each in found]


EXAMPLES = [
    each for one in commands() for text in (one.help, one.epilog) for each in examples(text or "")
]
SHOWN = sorted(
    {
        line.partition("  #")[0].partition(" #")[0].strip()
        for page in (*ROOT.glob("*.md"), *ROOT.glob("python/*.md"), *ROOT.glob("docs/**/*.md"))
        for block in re.findall(r"```\n(.*?)```", page.read_text("utf-8"), re.DOTALL)
        for line in block.splitlines()
        if line.strip().startswith("palpate ") and "…" not in line
    }
)
"""Commands of the documents."""


def body(shift: int = 0, *, liver: float = 4.0) -> NDArray[np.int16]:
    """A trunk in air with liver [voxels], bone and a gradient, in HU."""
    z, y, x = np.indices(SHAPE)
    off = np.sqrt((x - 16) ** 2 + 1.3 * (y - 15) ** 2 + 0.8 * (z - 14) ** 2)
    values = np.where(off < 11.0, 40.0 + 0.5 * x - 0.4 * z, -1000.0)
    values[np.sqrt((x - 16) ** 2 + (y - 15) ** 2 + (z - 14) ** 2) < liver] = 110.0
    values[6:22, 21:24, 14:19] = 900.0
    return np.roll(np.rint(values).astype(np.int16), shift, axis=2)


def write(path: Path, values: NDArray[Any]) -> None:
    image = SimpleITK.GetImageFromArray(values)
    image.SetSpacing((SPACING,) * 3)
    image.SetOrigin(ORIGIN)
    SimpleITK.WriteImage(image, str(path))


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """All files that examples name."""
    place = tmp_path_factory.mktemp("examples")
    still, moved = body(), body(shift=1)
    for name in ("scan.nii.gz", "ct.nii.gz", "before.mha", "a.mha"):
        write(place / name, still)
    # a liver that is large enough to be grown from a click
    large, large_moved = body(liver=6.0), body(shift=1, liver=6.0)
    write(place / "ct.mha", large)
    for name in ("mr.nii.gz", "after.mha", "b.mha"):
        write(place / name, moved)
    parts = np.where(still > 500, 2, np.where(still > 100, 1, 0)).astype(np.uint8)
    parts[:, :2, :] = 3
    for name in ("organs.seg.nrrd", "painted.seg.nrrd", "labels.nii.gz"):
        write(place / name, parts)
    write(place / "bone.nii.gz", (still > 500).astype(np.uint8))
    write(place / "teeth.seg.nrrd", (still > 500).astype(np.uint8) * (np.indices(SHAPE)[0] > 18))
    write(place / "body.nii.gz", (still > -500).astype(np.uint8))
    write_dicom(place, large, large_moved)
    given = ["--threshold", "250", "--keep-identity", "-o", str(place / "seg.dcm")]
    assert run(["export", str(place / "ct"), *given]) == 0
    (place / "raw").mkdir()
    for number in range(2):
        slab = np.full((256, 256), number, ">i2")
        (place / "raw" / f"{number}").write_bytes(slab.tobytes())
    places = np.array([[-83.0, 278, 1170], [-70, 285, 1155], [-90, 290, 1180], [-85, 265, 1165]])
    pairs = np.hstack([places, np.add(places, (SPACING, 0, 0))])
    (place / "pairs.csv").write_text("".join(f"{','.join(map(str, pair))}\n" for pair in pairs))
    volume = read(place / "ct.mha", unit="HU")
    scene = Scene(volume, [volume.threshold(250.0, name="bone")])
    with Session(scene, options=SessionOptions(real_time=False)) as session:
        for name in ("work.palpate", "mr.palpate"):
            save_scene(place / name, session, copy=True)
        session.run(0.01).save(place / "session.palpate-session")
    for name in ("mine.seg.nrrd", "truth.seg.nrrd"):
        export_scene(scene, place / name)
    write_carried(place, parts)
    write_bids(place / "data", still)
    return place


def write_bids(place: Path, values: NDArray[np.int16]) -> None:
    """Writes a data set of two participants, and what there is of its derivative."""
    told = {"Name": "Two", "BIDSVersion": "1.10.0", "DatasetType": "raw"}
    for each in ("01", "02"):
        folder = place / f"sub-{each}" / "anat"
        folder.mkdir(parents=True)
        write(folder / f"sub-{each}_T1w.nii.gz", values)
    (place / "dataset_description.json").write_text(json.dumps(told))
    (place.parent / "recipe.yaml").write_text("segment:\n  - threshold: 250\n")


def write_carried(place: Path, parts: NDArray[np.uint8]) -> None:
    """Writes a transform, and what is carried through it."""
    shift = SimpleITK.TranslationTransform(3, (SPACING, 0.0, 0.0))
    SimpleITK.WriteTransform(shift, str(place / "T.tfm"))
    for name in ("mr.seg.nrrd", "mr-labels.nii.gz"):
        write(place / name, parts)
    (place / "marks.csv").write_text("tip,-83,278,1170\n")
    ball = trimesh.creation.icosphere(radius=9.0).apply_translation((-83.0, 278.0, 1170.0))
    text = ball.export(file_type="obj")
    (place / "a.obj").write_text(f"# SPACE=LPS UNIT=mm\n{text}")


@pytest.fixture
def folder(made: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A copy of them, in which a command works."""
    here = tmp_path / "here"
    shutil.copytree(made, here)
    monkeypatch.chdir(here)
    return here


def write_dicom(place: Path, still: NDArray[np.int16], moved: NDArray[np.int16]) -> None:
    """Writes the scans as DICOM: each in a folder of its own, and both in an archive."""
    write_series = series_writer(place)
    study = {"StudyInstanceUID": generate_uid(), "PatientID": "7", "PatientName": "Doe^Jane"}
    for name, prefix, values in (
        ("ct", "", still), ("mr", "", moved), ("study", "a", still), ("study", "b", moved),
    ):  # fmt: skip

        def give(number: int, dataset: FileDataset, values: NDArray[np.int16] = values) -> None:
            dataset.Rows, dataset.Columns = values.shape[1:]
            dataset.PixelSpacing = [SPACING, SPACING]
            dataset.PixelRepresentation = 1
            dataset.PixelData = values[number].astype("<i2").tobytes()

        write_series(
            name,
            positions=[(*ORIGIN[:2], ORIGIN[2] + SPACING * k) for k in range(SHAPE[0])],
            prefix=prefix,
            scale=(1.0, 0.0),
            each=give,
            FrameOfReferenceUID=generate_uid(),
            **study,
        )
    shutil.make_archive(str(place / "study"), "zip", place / "study")
    shutil.copytree(place / "ct", place / "slices")
    for file in (place / "slices").iterdir():
        file.rename(file.with_suffix(".dcm"))


def words(line: str) -> list[str]:
    """Returns what a shell makes of a line, without the program."""
    found: list[str] = []
    for word in shlex.split(line)[1:]:
        # a pattern in quotes is for the program
        is_pattern = "*" in word and f"'{word}'" not in line
        found += sorted(map(str, Path().glob(word))) if is_pattern else [word]
    return found


def understand(given: list[str]) -> None:
    """Refuses options that are not there, and those that lack."""
    command: Any = get_command(app)
    while given and given[0] in getattr(command, "commands", {}):
        command, given = command.commands[given[0]], given[1:]
    with command.make_context("palpate", list(given)):
        pass


def test_nothing_of_a_help_is_taken_for_a_style() -> None:
    # what stands in brackets would not be printed
    helps = [(option.name, option.help) for each in commands() for option in each.params]
    helps += [(each.name, text) for each in commands() for text in (each.help, each.epilog)]
    lost = [(name, text) for name, text in helps if re.search(r"\[[a-z/#@]", text or "")]
    assert lost == []


def test_there_are_examples() -> None:
    assert len(EXAMPLES) > 25
    assert len(SHOWN) > 25


@pytest.mark.parametrize(
    "line",
    [
        # a whole turn of pictures takes minutes
        pytest.param(line, marks=[pytest.mark.long] if "--turntable" in line else [])
        for line in EXAMPLES
    ],
)
@pytest.mark.usefixtures("folder")
def test_examples_of_the_help_run_as_printed(line: str, capsys: pytest.CaptureFixture[str]) -> None:
    given = words(line)
    if any(each in line for each in UNSERVED):
        understand(given)
        return
    if line in TOLD_OF:
        assert run(words(TOLD_OF[line])) == 0, capsys.readouterr().err
    # other examples read what this one writes
    options = {"-o", "--out", "--resampled", "--picture"}
    written = [after for one, after in pairwise(given) if one in options]
    for name in written:
        Path(name).unlink(missing_ok=True)
    # as printed, but the search ends sooner
    quick = ["--iterations", "3", "--samples", "1000"] if given[0] == "register" else []
    assert run([*given, *quick]) == 0, capsys.readouterr().err
    assert [name for name in written if not Path(name).exists()] == []


def test_the_recipe_of_the_help_runs_as_printed(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    # the second recipe, with reconstruct, needs RTK
    whole = RECIPE.partition("Instead of import")[0]
    lines = re.findall(r"^  (.*)$", whole, re.MULTILINE)
    (folder / "recipe.yaml").write_text("\n".join(lines) + "\n")
    assert run(["run", "recipe.yaml", "--check"]) == 0, capsys.readouterr().err
    assert run(["run", "recipe.yaml"]) == 0, capsys.readouterr().err
    for name in ("mr-on-ct.nii.gz", "bone.stl", "segments.seg.nrrd", "report.html"):
        assert (folder / name).stat().st_size > 0


@pytest.mark.parametrize("line", SHOWN)
def test_commands_of_the_documents_are_understood(line: str) -> None:
    understand(words(line))
