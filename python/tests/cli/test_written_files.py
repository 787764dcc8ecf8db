"""No command replaces a file that it read, and others only where a person agrees."""

from __future__ import annotations

import os
import pty
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import SimpleITK
import trimesh
from palpate.cli.commands import app, run
from pydicom.uid import generate_uid
from typer.main import get_command

CUBE = np.full((16, 16, 16), -1000, np.int16)
CUBE[5:11, 5:11, 5:11] = 400
SEGMENT = ["segment", "scan.nii.gz", "--threshold", "0"]

READ_BY = {
    # what is written over the file that is named last, which the command reads
    "segment": ([*SEGMENT, "-o"], "scan.nii.gz"),
    "segment, a mask": ([*SEGMENT, "--subtract", "labels.nii.gz", "-o"], "labels.nii.gz"),
    "export": (["export", "scan.nii.gz", "--segments", "labels.nii.gz", "-o"], "labels.nii.gz"),
    "export a scan": (["export", "scan.nii.gz", "--as", "scan", "-o"], "scan.nii.gz"),
    "import": (["import", "scan.nii.gz", "-o"], "scan.nii.gz"),
    "register": (["register", "scan.nii.gz", "moved.nii.gz", "--resampled"], "moved.nii.gz"),
    "render": (["render", "scan.nii.gz", "--segments", "mask.png", "-o"], "mask.png"),
    "statistics": (["statistics", "scan.nii.gz", "--segments", "marks.csv", "-o"], "marks.csv"),
    "compare": (
        ["compare", "scan.nii.gz", "--threshold", "0", "--reference", "marks.csv", "-o"],
        "marks.csv",
    ),
    "landmarks": (["landmarks", "scan.nii.gz", "--segments", "marks.csv", "-o"], "marks.csv"),
    "touch": (["touch", "scan.nii.gz", "--segments", "marks.csv", "-o"], "marks.csv"),
    "surface voxels": (["surface", "voxels", "ball.stl", "--like", "scan.nii.gz"], "scan.nii.gz"),
    "surface export": (["surface", "export", "scan.nii.gz", "--segments", "ball.stl"], "ball.stl"),
    "transform": (["transform", "marks.csv", "--transform", "T.tfm", "-o"], "marks.csv"),
    "transform back": (["transform", "--transform", "T.tfm", "--write-inverse"], "T.tfm"),
    "record": (["record", "scan.nii.gz", "--script", "path.csv", "--out"], "path.csv"),
    "replay": (["replay", "run.palpate-session", "--csv"], "run.palpate-session"),
    "scenario": (["scenario", "drilling", "scan.nii.gz", "--json"], "scan.nii.gz"),
    "reconstruct": (
        ["reconstruct", "scan.nii.gz", "--beam", "parallel", "--pixel", "1,1", "-o"],
        "scan.nii.gz",
    ),
    "bench edit": (["bench", "edit", "scan.nii.gz", "--json"], "scan.nii.gz"),
}


def other_spelling(path: Path) -> str:
    return str(Path("sub") / ".." / path)


def symbolic_link(path: Path) -> str:
    link = Path("sub") / path.name
    link.symlink_to(path.absolute())
    return str(link)


def hard_link(path: Path) -> str:
    link = Path("sub") / path.name
    link.hardlink_to(path)
    return str(link)


WAYS = [str, other_spelling, symbolic_link, hard_link]


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """All files that the commands name."""
    place = tmp_path_factory.mktemp("made")
    for name, values in (
        ("scan.nii.gz", CUBE),
        ("moved.nii.gz", np.roll(CUBE, 1, axis=2)),
        ("labels.nii.gz", (CUBE > 0).astype(np.uint8)),
    ):
        SimpleITK.WriteImage(SimpleITK.GetImageFromArray(values), str(place / name))
    (place / "labels.csv").write_text("id,structure,red,green,blue\n1,cube,1,0,0\n")
    shift = SimpleITK.TranslationTransform(3, (1.0, 0.0, 0.0))
    SimpleITK.WriteTransform(shift, str(place / "T.tfm"))
    (place / "marks.csv").write_text("tip,8,8,8\n")
    (place / "path.csv").write_text("t,x,y,z\n0,8,8,14\n0.1,8,8,12\n")
    trimesh.creation.icosphere(radius=4.0).apply_translation((8, 8, 8)).export(place / "ball.stl")
    (place / "mask.png").write_bytes(b"a picture")
    (place / "run.palpate-session").write_bytes(b"a recording")
    (place / "sub").mkdir()
    return place


@pytest.fixture
def here(made: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A copy of them, in which a command works."""
    place = tmp_path / "here"
    shutil.copytree(made, place)
    monkeypatch.chdir(place)
    before = {path: path.read_bytes() for path in place.iterdir() if path.is_file()}
    yield place
    changed = [path.name for path, was in before.items() if path.read_bytes() != was]
    assert changed == [], "what was read is as it was"


def said(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, str]:
    code = run(list(arguments))
    return code, capsys.readouterr().err


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("name", READ_BY)
def test_no_command_replaces_what_it_reads(
    name: str, way: Any, here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    arguments, file = READ_BY[name]
    # read-only files are replaced by whoever may write their folder
    (here / file).chmod(0o444)
    code, told = said(capsys, *arguments, way(Path(file)), "--force")
    assert code == 2
    assert "is what is read; allowed: a new file" in told


def test_what_a_reader_opens_beside_the_named_file_is_what_is_read(
    here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    # one file of the header, one of the voxels, and the command names the first
    SimpleITK.WriteImage(SimpleITK.GetImageFromArray(CUBE), "pair.nhdr")
    voxels = next(path for path in here.iterdir() if path.name.startswith("pair.raw"))
    header = Path("pair.nhdr").read_text("ascii").replace(voxels.name, "voxels.nrrd")
    Path("pair.nhdr").write_text(header, "ascii")
    voxels.rename("voxels.nrrd")
    before = Path("voxels.nrrd").read_bytes()
    arguments = ["segment", "pair.nhdr", "--threshold", "0", "-o", "voxels.nrrd"]
    assert "is what is read" in said(capsys, *arguments, "--force")[1]
    assert Path("voxels.nrrd").read_bytes() == before


def test_a_slice_of_a_series_is_what_is_read(
    write_series: Any, capsys: pytest.CaptureFixture[str]
) -> None:
    uids = {name: generate_uid() for name in ("StudyInstanceUID", "FrameOfReferenceUID")}
    folder = write_series("ct", scale=(1.0, 0.0), **uids)
    first = min(folder.iterdir())
    before = first.read_bytes()
    arguments = ["export", str(folder), "--threshold", "0", "--as", "dicom-seg", "--keep-identity"]
    out = first.rename(first.with_suffix(".dcm"))
    code, told = said(capsys, *arguments, "-o", str(out), "--force")
    assert (code, "is what is read" in told) == (2, True), told
    assert out.read_bytes() == before


def written_options() -> list[tuple[str, ...]]:
    """Lists commands with each option or argument that they write."""
    found: list[tuple[str, ...]] = []

    def walk(command: Any, way: tuple[str, ...]) -> None:
        for name, each in getattr(command, "commands", {}).items():
            walk(each, (*way, name))
        names = {parameter.name for parameter in command.params}
        if "force" in names:
            found.append(way)

    walk(get_command(app), ())
    return found


def test_every_command_that_writes_files_takes_force() -> None:
    assert {" ".join(way) for way in written_options()} >= {
        "record", "replay", "export", "import", "reconstruct", "register", "transform", "render",
        "segment", "statistics", "compare", "landmarks", "touch", "run",
        "surface export",
        "surface voxels", "scenario drilling",
        "scenario palpation", "scenario needle-skull", "scenario needle-liver", "bench stress",
        "bench haptics", "bench deform",
    }  # fmt: skip


OTHERS = {
    "segment": [*SEGMENT, "-o", "there.seg.nrrd"],
    "export": ["export", "scan.nii.gz", "--segments", "labels.nii.gz", "-o", "there.seg.nrrd"],
    "import": ["import", "scan.nii.gz", "-o", "there.nrrd"],
    "import segments": ["import", "scan.nii.gz", "--segments", "labels.nii.gz", "-o", "new.nrrd"],
    "statistics": ["statistics", "scan.nii.gz", "--threshold", "0", "-o", "there.csv"],
    "compare": ["compare", "scan.nii.gz", "--threshold", "0", "--reference", "labels.nii.gz", "-o",
                "there.csv"],
    "landmarks": ["landmarks", "scan.nii.gz", "--threshold", "0", "-o", "there.csv"],
    "touch": ["touch", "scan.nii.gz", "--threshold", "0", "-o", "there.csv"],
    "surface voxels": ["surface", "voxels", "ball.stl", "there.nrrd", "--spacing", "1",
                       "--frame", "LPS", "--unit", "mm"],
    "surface export": ["surface", "export", "scan.nii.gz", "there.stl", "--threshold", "0"],
    "surface report": ["surface", "export", "scan.nii.gz", "new.stl", "--threshold", "0",
                       "--json", "there.json"],
    "transform": ["transform", "marks.csv", "--transform", "T.tfm", "-o", "there.csv"],
    "transform back": ["transform", "--transform", "T.tfm", "--write-inverse", "there.tfm"],
    "record": ["record", "scan.nii.gz", "--threshold", "0", "--script", "path.csv", "--out",
               "there.palpate-session"],
    "render": ["render", "scan.nii.gz", "-o", "there.png", "--size", "64x64"],
    "labels": [*SEGMENT, "-o", "there.nii.gz"],
}  # fmt: skip
"""Commands, and a file that each would replace."""
REPLACED = {"import segments": "new.seg.nrrd"}
"""Where that is not the last word that begins with "there"."""


@pytest.mark.parametrize("name", OTHERS)
@pytest.mark.usefixtures("here")
def test_other_files_are_replaced_with_force_only(
    name: str, capsys: pytest.CaptureFixture[str]
) -> None:
    arguments = OTHERS[name]
    there = [each for each in arguments if each.startswith("there")]
    file = Path(REPLACED[name] if name in REPLACED else there[-1])
    content = "id,structure\n1,mine\n" if file.suffix == ".csv" else "mine"
    file.write_text(content)
    code, told = said(capsys, *arguments)
    assert (code, f"{file} exists already" in told) == (2, True), told
    assert "or to replace it with --force" in told
    assert file.read_text() == content
    code, told = said(capsys, *arguments, "--force")
    assert code == 0, told
    assert file.read_bytes() != content.encode()


@pytest.mark.usefixtures("here")
def test_a_read_only_file_and_what_is_no_file_stay(capsys: pytest.CaptureFixture[str]) -> None:
    kept = Path("kept.seg.nrrd")
    kept.write_text("mine")
    kept.chmod(0o444)
    code, told = said(capsys, *SEGMENT, "-o", str(kept), "--force")
    assert (code, "exists already and is read-only" in told) == (2, True)
    assert kept.read_text() == "mine"
    os.mkfifo("pipe.seg.nrrd")
    assert "is a device, a pipe or a socket" in said(capsys, *SEGMENT, "-o", "pipe.seg.nrrd")[1]
    assert Path("pipe.seg.nrrd").is_fifo()


@pytest.mark.usefixtures("here")
def test_a_link_is_written_through() -> None:
    target = Path("sub") / "real.seg.nrrd"
    link = Path("link.seg.nrrd")
    link.symlink_to(target)
    assert run([*SEGMENT, "-o", str(link)]) == 0
    assert link.is_symlink()
    assert target.read_bytes()[:4] == b"NRRD"
    target.write_text("before")
    target.chmod(0o600)
    assert run([*SEGMENT, "-o", str(link), "--force"]) == 0
    assert link.is_symlink()
    assert target.read_bytes()[:4] == b"NRRD"
    # who could not read it cannot read the new one
    assert target.stat().st_mode & 0o777 == 0o600


@pytest.mark.usefixtures("here")
def test_a_recipe_replaces_nothing_unless_told(capsys: pytest.CaptureFixture[str]) -> None:
    recipe = Path("recipe.yaml")
    recipe.write_text(
        "import:\n  path: scan.nii.gz\nsegment:\n  - threshold: 0\n    name: cube\n"
        "export:\n  - out: out.nii.gz\nreport: report.html\n"
    )
    assert run(["run", "recipe.yaml"]) == 0
    table = Path("out.csv").read_bytes()
    Path("out.nii.gz").unlink()
    code, told = said(capsys, "run", "recipe.yaml")
    assert (code, "exists already" in told) == (2, True)
    # a check replaces nothing, so that nobody has to agree
    assert run(["run", "recipe.yaml", "--check"]) == 0
    assert run(["run", "recipe.yaml", "--force"]) == 0
    assert Path("out.csv").read_bytes() == table
    hard = Path("report.html")
    hard.unlink()
    hard.hardlink_to(recipe)
    before = recipe.read_bytes()
    assert "is what is read" in said(capsys, "run", "recipe.yaml", "--force")[1]
    assert recipe.read_bytes() == before


CARRY = ["transform", "labels.nii.gz", "--transform", "T.tfm", "--like", "scan.nii.gz"]
ASKED = {
    "segment": (SEGMENT, "there.seg.nrrd", None),
    "segment, and names": (SEGMENT, "there.nii.gz", "there.csv"),
    "export, and names": (
        ["export", "scan.nii.gz", "--segments", "labels.nii.gz"], "there.nii.gz", "there.csv",
    ),
    "transform, and names": (CARRY, "there.nii.gz", "there.csv"),
}  # fmt: skip
"""A command, what it writes, and the table beside that, which it asks about too."""


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no such terminals")
@pytest.mark.parametrize("answered", ["y", "n"])
@pytest.mark.parametrize("name", ASKED)
def test_on_a_terminal_the_person_is_asked(name: str, answered: str, here: Path) -> None:
    arguments, out, table = ASKED[name]
    files = [Path(each) for each in (out, table) if each is not None]
    for each in files:
        each.write_text("id,structure\n7,mine\n")
    before = [each.read_bytes() for each in files]
    # the last one is what the answer is about
    answers = [*["y"] * (len(files) - 1), answered]
    agrees = answered == "y"
    ours, theirs = pty.openpty()
    process = subprocess.Popen(
        [sys.executable, "-m", "palpate", *arguments, "-o", out],
        stdin=theirs, stderr=theirs, stdout=subprocess.DEVNULL, cwd=here,
    )  # fmt: skip
    os.close(theirs)
    try:
        for answer in answers:
            told = b""
            while b"Replace it?" not in told:
                told += os.read(ours, 1000)
            os.write(ours, f"{answer}\n".encode())
        assert process.wait(60) == (0 if agrees else 2)
    finally:
        process.kill()
        process.wait()
        os.close(ours)
    same = [each.read_bytes() == was for each, was in zip(files, before, strict=True)]
    assert same == [not agrees] * len(files)
