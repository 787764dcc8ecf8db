"""Steps of recipes and commands are one: names, types, defaults and help of their options."""

from __future__ import annotations

from typing import Any, get_args, get_origin

import pytest
from palpate.base.file_suffixes import MESH_SUFFIXES
from palpate.base.hints import retold
from palpate.base.request import Option, Request, options_of
from palpate.cli.commands import app
from palpate.export.request import ExportRequest
from palpate.pictures.request import PictureRequest
from palpate.recipes.steps import ImportStep, Recipe, ReconstructStep, RegisterStep, TransformStep
from palpate.segmentation.measures.comparison_request import CompareRequest
from palpate.segmentation.measures.landmarks_request import LandmarksRequest
from palpate.segmentation.request import SegmentRequest
from palpate.session.touch_request import TouchRequest
from palpate.volumes.mesh_write import SUFFIXES
from palpate.volumes.surface_request import SurfaceRequest
from typer.main import get_command

STEPS: dict[str, tuple[type[Request], str]] = {
    "import": (ImportStep, "import"),
    "reconstruct": (ReconstructStep, "reconstruct"),
    "register": (RegisterStep, "register"),
    "segment": (SegmentRequest, "segment"),
    "surface": (SurfaceRequest, "surface export"),
    "export": (ExportRequest, "export"),
    "compare": (CompareRequest, "compare"),
    "landmarks": (LandmarksRequest, "landmarks"),
    "touch": (TouchRequest, "touch"),
    "transform": (TransformStep, "transform"),
    "picture": (PictureRequest, "render"),
}
"""Each step, and the command that it is."""

OTHER_NAMES = {
    ("import", "path"): "paths",
    ("reconstruct", "path"): "projections",
    ("reconstruct", "output"): "out",
    ("transform", "path"): "inputs",
}
"""Parameters of commands that have another name than the key: all of them are typed without one, or
under both."""

OF_THE_RECIPE = {("register", "go-on-with")}
"""A recipe goes on with a scan, a command ends."""

READING = {each.field for each in options_of(ImportStep)}
ELSEWHERE: dict[str, set[str]] = {
    # another step writes, makes segments, or lists nothing
    "import": {
        "dicomweb", "study", "volume", "output", "segments", "resample", "another_patient", "every",
        "as_json",
    },
    "reconstruct": set(),
    "register": {"fixed", "fixed_series", "fixed_frame", "as_json"},
    # one that is written needs no step of its own
    "transform": {"write_inverse"},
    "segment": {"path", "out"} | READING,
    "surface": {
        "path", "json_file", "segments", "threshold", "resample", "another_patient",
    } | READING,
    "export": {"path", "segments", "threshold", "resample", "another_patient"} | READING,
    "compare": {"path", "segments", "threshold", "as_csv", "as_json"} | READING,
    "landmarks": {
        "path", "segments", "threshold", "resample", "another_patient", "as_csv", "as_json",
    } | READING,
    "touch": {"path", "segments", "threshold", "resample", "another_patient"} | READING,
    "picture": {"path", "segments", "threshold", "resample", "another_patient"} | READING,
}  # fmt: skip
"""Parameters of a command that other steps of a recipe stand for."""


def parameters(command: str) -> dict[str, Any]:
    found: Any = get_command(app)
    for name in command.split():
        found = found.commands[name]
    return {each.name: each for each in found.params}


PAIRS = [(step, option) for step, (kind, _) in STEPS.items() for option in options_of(kind)]


def test_all_steps_are_looked_at() -> None:
    steps = {}
    for option in options_of(Recipe):
        (inner,) = get_args(option.kind) if get_origin(option.kind) is list else (option.kind,)
        if isinstance(inner, type) and issubclass(inner, Request):
            steps[option.name] = inner
    assert steps == {name: kind for name, (kind, _) in STEPS.items()}


@pytest.mark.parametrize(("step", "option"), PAIRS, ids=lambda each: getattr(each, "name", each))
def test_an_option_of_a_step_is_one_of_its_command(step: str, option: Option) -> None:
    if (step, option.name) in OF_THE_RECIPE:
        return
    field = OTHER_NAMES.get((step, option.name), option.field)
    parameter = parameters(STEPS[step][1])[field]
    if field == option.field:
        assert (
            step == "transform"
            or retold(option.told, lambda name, _: f"--{name}") == parameter.help
        )
        assert option.argument or f"--{option.name}" in parameter.opts
    else:
        assert parameter.param_type_name == "argument" or f"--{option.name}" in parameter.opts
    if option.required:
        # a command is told its place of several by name
        assert parameter.required or field in {"paths", "inputs", "output"}
        return
    given = parameter.default
    assert given is None or option.value(given) == option.default
    assert given is not None or not option.default


@pytest.mark.parametrize("step", STEPS)
def test_an_option_of_a_command_is_one_of_its_step_or_another_step(step: str) -> None:
    kind, command = STEPS[step]
    own = {OTHER_NAMES.get((step, each.name), each.field) for each in options_of(kind)}
    # a recipe replaces files where its command is told to
    assert set(parameters(command)) - own - ELSEWHERE[step] == {"force"}


VALUES = {
    bool: ("true", True),
    int: ("3", 3),
    float: ("2.5", 2.5),
    str: ("word", "word"),
}


@pytest.mark.parametrize(("step", "option"), PAIRS, ids=lambda each: getattr(each, "name", each))
def test_what_is_typed_means_the_same_in_a_command_and_in_a_recipe(
    step: str, option: Option
) -> None:
    del step
    kind = option.kind
    for choice in option.choices:
        assert option.value(choice) == choice
        # whoever reads the help finds it
        assert choice in option.told
    if get_origin(kind) is tuple:
        numbers = tuple(part(number + 1) for number, part in enumerate(get_args(kind)))
        typed = ",".join(map(str, numbers))
        assert option.value(typed) == option.value(list(numbers)) == numbers
    if kind in VALUES:
        assert option.value(VALUES[kind][1]) == VALUES[kind][1]
        # as a variable fills it
        assert option.value(VALUES[kind][0]) == VALUES[kind][1]
    wrong: Any = {"no": "such"}
    with pytest.raises(ValueError, match=f"^{option.name} .*given.*; allowed: ") as refused:
        option.value(wrong)
    said = str(refused.value)
    for internal in ("Expected", "null", "enum", "class", "Literal", "|"):
        assert internal not in said


def test_surfaces_are_written_under_the_names_that_are_checked() -> None:
    assert MESH_SUFFIXES == SUFFIXES
