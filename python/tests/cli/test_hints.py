"""What messages tell a person to do can be done: options that they name are options there are."""

from __future__ import annotations

import ast
import inspect
import re
import shlex
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import palpate
import pytest
from palpate.base.console import spoken, told_by, warn
from palpate.base.hints import HINT, in_recipe, prefixed
from palpate.base.request import Request, options_of
from palpate.cli.commands import app, run
from palpate.cli.flags import as_flags
from typer.main import get_command

PACKAGE = Path(palpate.__file__).parent
FLAG = re.compile(r"(?<![\w-])--[a-z][a-z_-]*")
OWN = {"--help", "--version"}

OF_SEVERAL = {
    "of", "like", "inverse", "landmarks", "keep_identity", "only", "another_patient", "resample",
    "bone", "smoothing", "fast", "out", "turntable", "segment", "against",
    "pixels_checked",
}  # fmt: skip
"""Options that only the commands have that use them."""

OF_OTHER_PROGRAMS = {
    ("segmentation/automatic.py", "--fast"),
    ("saved/autosave.py", "--recover"),
    ("cohort/overview/page.py", "--segments"),
}
"""Options that a program is started with, or a whole command that is printed."""

READING = {"series", "frame", "orientation", "unit", "fill", "raw", "voxel_size", "max_voxels"}
FITTING = {"resample", "another_patient"}
WRITING = {"only", "keep_identity"}
HINTS: dict[str, set[str]] = {
    "info": READING,
    "open": READING | FITTING,
    "record": READING | FITTING,
    "import": READING | FITTING,
    "export": READING | FITTING | WRITING,
    # of a file there, its holes are filled: a value for voxels without one is no option
    "segment": READING | FITTING | {"threshold", "otsu", "grow", "seeds", "auto"},
    "surface export": READING | FITTING,
    "surface voxels": {"close", "as_shell", "frame", "unit"},
    "statistics": READING | FITTING,
    "compare": READING | FITTING | {"segment", "against"},
    "landmarks": READING | FITTING,
    "touch": READING | FITTING,
    "register": {"landmarks", "moving_series", "moving_frame"} | FITTING,
    "transform": {"of", "like", "inverse", "series", "frame", "unit"} | FITTING,
}
"""Options that messages name while a command runs."""


def texts(file: Path) -> Iterator[tuple[int, str]]:
    """Yields texts of a module that are no documentation, each with its line."""
    tree = ast.parse(file.read_text("utf-8"))
    documentation = {
        id(first.value)
        for node in ast.walk(tree)
        if isinstance(node, (ast.Module, ast.ClassDef, ast.FunctionDef))
        for first in node.body
        if isinstance(first, ast.Expr)
    }
    inside = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.JoinedStr):
            inside |= {id(part) for part in node.values}
            parts = [part.value if isinstance(part, ast.Constant) else "…" for part in node.values]
            yield node.lineno, "".join(map(str, parts))
    for node in ast.walk(tree):
        if (
            isinstance(node, ast.Constant)
            and isinstance(node.value, str)
            and id(node) not in documentation | inside
        ):
            yield node.lineno, node.value


def commands(command: Any = None, path: str = "") -> Iterator[tuple[str, Any]]:
    command = get_command(app) if command is None else command
    yield path, command
    for name, each in getattr(command, "commands", {}).items():
        yield from commands(each, f"{path} {name}".strip())


COMMANDS = dict(commands())


def flags(command: Any) -> set[str]:
    return {name for each in command.params for name in (*each.opts, *each.secondary_opts)} | OWN


def test_messages_of_the_library_name_no_flags_of_the_command_line() -> None:
    named = []
    for file in PACKAGE.rglob("*.py"):
        place = file.relative_to(PACKAGE).as_posix()
        if place.startswith(("cli/", "bench/")):
            continue
        for line, text in texts(file):
            # colours of a style are written alike
            own = re.sub(r"`palpate [^`]*`|var\(--[^)]*\)", "", text)
            named += [
                (place, line, flag)
                for flag in FLAG.findall(own)
                if (place, flag) not in OF_OTHER_PROGRAMS
            ]
    assert named == []


def test_no_message_shows_a_scan_as_python_does() -> None:
    for file in PACKAGE.rglob("*.py"):
        for found in re.findall(
            r"\{(?:volume|scan|fixed|moving|scene)!r\}", file.read_text("utf-8")
        ):
            pytest.fail(f"{file}: {found}")


def test_each_option_that_a_message_names_is_one_of_python_and_of_a_command() -> None:
    taken = {name for each in palpate.__all__ for name in _arguments(getattr(palpate, each))}
    requests = {option.field for kind in _requests(Request) for option in options_of(kind)}
    known = {parameter.name for each in COMMANDS.values() for parameter in each.params}
    hints = {
        (file.name, line, name)
        for file in PACKAGE.rglob("*.py")
        for line, text in texts(file)
        for name, _ in HINT.findall(text)
    }
    assert len(hints) > 30
    assert [each for each in sorted(hints) if each[2] not in known] == []
    of_meshes = {"close", "as_shell", "bone"}
    assert [each for each in sorted(hints) if each[2] not in taken | requests | of_meshes] == []


def _arguments(public: Any) -> set[str]:
    try:
        return set(inspect.signature(public).parameters)
    except (TypeError, ValueError):
        return set()


def _requests(kind: type[Request]) -> Iterator[type[Request]]:
    for each in kind.__subclasses__():
        yield each
        yield from _requests(each)


@pytest.mark.parametrize("command", HINTS)
def test_each_option_that_a_command_is_told_of_is_in_its_help(command: str) -> None:
    found = COMMANDS[command]
    arguments = [*command.split(), "scan.nii.gz"]
    for name in sorted(HINTS[command]):
        said = as_flags(f"allowed: with `{name}=True`", app, arguments)
        (flag,) = FLAG.findall(said)
        assert flag in flags(found), said


def test_each_flag_that_a_command_says_is_one_of_a_command() -> None:
    everywhere = set().union(*(flags(each) for each in COMMANDS.values()))
    lacking = []
    for file in (PACKAGE / "cli").glob("*.py"):
        for line, text in texts(file):
            for quoted in re.findall(r"`palpate ([a-z -]+?)(?: [A-Z][^`]*)?`", text):
                words = quoted.split(" --")[0].strip()
                if words in COMMANDS:
                    lacking += [
                        (file.name, line, flag)
                        for flag in FLAG.findall(quoted)
                        if flag not in flags(COMMANDS[words])
                    ]
            lacking += [
                (file.name, line, flag) for flag in FLAG.findall(text) if flag not in everywhere
            ]
    assert lacking == []


def test_an_option_is_told_in_the_words_of_whoever_reads_it() -> None:
    said = "choose one with `series=NUMBER`, or `resample=True`"
    own = in_recipe(said, known={"series", "resample"})
    assert own == "choose one with `series: NUMBER`, or `resample: true`"
    with told_by(lambda message: as_flags(message, app, ["export", "ct"])):
        assert spoken(said) == "choose one with --series NUMBER, or --resample"
    moving = prefixed("choose one with `series=NUMBER`", "moving")
    assert as_flags(moving, app, ["register"]) == "choose one with --moving-series NUMBER"
    # where a command lacks it, one that has it is told whole
    unit = as_flags("give `unit=HU`", app, ["register"])
    assert unit == "give `palpate import FILE --unit HU -o NEW.nrrd`"
    moving = as_flags("give `moving_unit=HU`", app, ["register"])
    assert moving == unit
    said = in_recipe("b.mha: give `unit=HU`", known={"series"}, files=[Path("a"), Path("b.mha")])
    assert said == "b.mha: give `palpate import b.mha --unit HU -o NEW.nrrd`"
    # what a person typed stays
    assert as_flags("/a/unit=3.nii is no scan", app, ["info"]) == "/a/unit=3.nii is no scan"


def named() -> set[str]:
    """Returns all options that messages name."""
    return {
        name
        for file in PACKAGE.rglob("*.py")
        for _, text in texts(file)
        for name, _ in HINT.findall(text)
    }


def test_where_a_command_lacks_an_option_the_one_that_has_it_is_told_whole() -> None:
    names = sorted(named())
    for command, found in COMMANDS.items():
        if command.startswith("bench") or not command:
            continue
        own = {parameter.name for parameter in found.params}
        lacking = [name for name in names if name not in own]
        message = "\n".join(f"with `{name}=VALUE`" for name in lacking)
        said = as_flags(message, app, [*command.split(), "README.md"]).splitlines()
        for name, told in zip(lacking, said, strict=True):
            quoted = re.search(r"`palpate ([^`]*)`", told)
            # only the commands that use those have them
            assert (quoted is None) == (name in OF_SEVERAL), told
            if quoted is not None:
                check_whole(shlex.split(quoted[1]))


def check_whole(typed: list[str]) -> None:
    """Sees that a command has the flags that are typed, and all that it needs."""
    words = max((path for path in COMMANDS if " ".join(typed).startswith(path)), key=len)
    found, rest = COMMANDS[words], typed[len(words.split()) :]
    asked = [word for word in rest if word.startswith("--")]
    assert len(asked) == 1, typed
    assert set(asked) <= flags(found), typed
    # an option's value is no argument; each of these commands takes one option with "-o"
    arguments = [each for each in found.params if each.param_type_name == "argument"]
    needed = sum(each.required for each in found.params)
    assert needed <= len(arguments) + ("-o" in rest), typed


def test_the_command_that_is_told_can_be_typed_as_it_stands(
    tmp_path: Path,
    write_image: Any,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    z, y, x = np.indices((22, 24, 26))
    off = np.sqrt((x - 11) ** 2 + 1.5 * (y - 10) ** 2 + 0.7 * (z - 9) ** 2)
    values = (900.0 - 60.0 * off).clip(-500, 900).astype(np.int16)
    write_image(values, "a b.mha", spacing=(1.0, 1.0, 1.0))
    write_image(np.roll(values, (3, 2, 4), (0, 1, 2)), "c.mha", spacing=(1.0, 1.0, 1.0))
    monkeypatch.chdir(tmp_path)
    asked = ["register", "a b.mha", "c.mha", "--metric", "correlation", "--start", "geometry"]
    assert run([*asked, "-o", "T.tfm"]) == 0
    said = capsys.readouterr().err
    told = re.findall(r"warning: ([^:]*): .*give `palpate ([^`]*)`", said)
    assert [name for name, _ in told] == ["a b.mha", "c.mha"]
    for number, (_, line) in enumerate(told):
        assert run(shlex.split(line.replace("NEW", f"NEW{number}"))) == 0
        assert Path(f"NEW{number}.nrrd").exists()
    # a mask may lie on another grid, as the hint says
    write_image(np.ones((9, 9, 9), np.uint8), "mask.mha", spacing=(2.7, 2.7, 2.7))
    asked += ["-o", "masked.tfm", "--fixed-mask", "mask.mha"]
    assert run(asked) == 2
    assert "or others with --resample" in capsys.readouterr().err
    assert run([*asked, "--resample"]) == 0


def test_warnings_name_flags(capsys: pytest.CaptureFixture[str]) -> None:
    with told_by(lambda message: as_flags(message, app, ["info"])):
        warn("give `unit=HU` if it is HU")
    assert "give --unit HU if it is HU" in capsys.readouterr().err


def test_segments_of_another_grid_are_resampled_as_the_hint_says(
    tmp_path: Path, write_image: Any, capsys: pytest.CaptureFixture[str]
) -> None:
    values = np.full((12, 13, 14), -1000, np.int16)
    values[3:9, 3:9, 3:9] = 500
    scan = write_image(values, "scan.nii.gz", spacing=(1.0, 1.0, 1.0))
    other = write_image(np.ones((3, 20, 20), np.uint8), "other.nii.gz", spacing=(0.9, 0.9, 1.7))
    out = tmp_path / "out.nii.gz"
    asked = ["segment", str(scan), "--threshold", "0", "--subtract", str(other), "-o", str(out)]
    assert run(asked) == 2
    said = capsys.readouterr().err
    assert "another grid than the scan; allowed: the scan's 14 x 13 x 12 voxels" in said
    (flag,) = FLAG.findall(said)
    assert run([*asked, flag]) == 0
    assert out.exists()


def test_no_command_writes_over_what_it_reads(
    tmp_path: Path, write_image: Any, capsys: pytest.CaptureFixture[str]
) -> None:
    values = np.full((12, 13, 14), -1000, np.int16)
    values[3:9, 3:9, 3:9] = 500
    scan = str(write_image(values, "scan.nii.gz", spacing=(1.0, 1.0, 1.0)))
    before = Path(scan).read_bytes()
    out = str(tmp_path / "new.mha")
    for given in (
        ["segment", scan, "--threshold", "0", "-o", scan],
        ["segment", scan, "--seeds", scan, "-o", scan],
        ["export", scan, "--threshold", "0", "-o", scan],
        ["register", scan, out, "--resampled", scan],
        ["register", scan, scan, "--resampled", out, "--fixed-mask", scan, "-o", scan],
    ):
        assert run(given) == 2
        said = capsys.readouterr().err
        assert "allowed: " in said
        assert Path(scan).read_bytes() == before
