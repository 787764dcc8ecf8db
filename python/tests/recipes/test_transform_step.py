"""A recipe carries files through the transform that it has found, and checks that before."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import palpate
import pytest
import SimpleITK
from palpate.base.errors import OptionError
from palpate.cli.commands import run
from palpate.recipes.recipe import read_recipe

SHIFT = (4, 2, 3)
"""Voxels x, y, z."""

RECIPE = """
import: {path: fixed.mha}
register: {moving: moving.mha, start: geometry, metric: correlation, output: T.tfm,
           write-inverse: I.tfm}
segment:
  - {threshold: 400, name: body}
surface:
  - {segment: body, out: body.stl}
transform:
  - {path: labels.nrrd, transform: T.tfm, output: on-fixed.nrrd}
  - {path: body.stl, transform: T.tfm, inverse: true, like: moving.mha, output: moved.stl}
  - {path: tip.csv, transform: I.tfm, inverse: true, like: moving.mha, output: there.csv}
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    z, y, x = np.indices((22, 24, 26))
    off = np.sqrt((x - 11) ** 2 + 1.5 * (y - 10) ** 2 + 0.7 * (z - 9) ** 2)
    body = np.rint(900.0 - 60.0 * off).clip(-500, 900).astype(np.int16)
    moved = np.roll(body, SHIFT[::-1], axis=(0, 1, 2))
    labels = np.where(moved > 400, np.where(x > 15, 7, 3), 0).astype(np.uint8)
    for values, name in ((body, "fixed.mha"), (moved, "moving.mha"), (labels, "labels.nrrd")):
        SimpleITK.WriteImage(SimpleITK.GetImageFromArray(values), str(tmp_path / name))
    (tmp_path / "tip.csv").write_text("tip,14,12,12\n")
    return tmp_path


def written(folder: Path, text: str) -> Path:
    path = folder / "recipe.yaml"
    path.write_text(text)
    return path


def test_labels_surfaces_and_points_are_carried_where_they_belong(folder: Path) -> None:
    assert run(["run", str(written(folder, RECIPE))]) == 0
    fixed = palpate.read(folder / "fixed.mha")
    labels = palpate.read(folder / "on-fixed.nrrd").values()
    assert set(np.unique(labels)) == {0, 3, 7}
    body = fixed.array > 400
    assert np.count_nonzero((labels > 0) != body) < 0.1 * np.count_nonzero(body)
    before, after = (
        palpate.read_mesh(folder / name).mesh.vertices.mean(axis=0)
        for name in ("body.stl", "moved.stl")
    )
    np.testing.assert_allclose(after - before, SHIFT, atol=0.5)
    # through the inverse of the inverse: from the moving scan to the fixed one
    tip = [float(cell) for cell in (folder / "there.csv").read_text().split(",")[1:]]
    np.testing.assert_allclose(tip, np.subtract((14, 12, 12), SHIFT), atol=0.5)


@pytest.mark.parametrize(
    ("wrong", "line", "said"),
    [
        (("path: labels.nrrd", "path: gone.nrrd"), 10, "gone.nrrd does not exist"),
        (("transform: T.tfm", "transform: U.tfm"), 10, "U.tfm does not exist"),
        (("output: on-fixed.nrrd", "output: on-fixed.stl"), 10, "'on-fixed.stl' given; allowed"),
        (("output: on-fixed.nrrd", "output: labels.nrrd"), 10, "is read by another step"),
        # on-fixed.csv has the names of the labels
        (("output: there.csv", "output: on-fixed.csv"), 12, "is written by another step"),
        (("inverse: true, like: moving.mha", "inverse: true"), 11, "inverse without like given"),
        (("output: there.csv", "outpt: there.csv"), 12, "'outpt' is no option here .*; allowed"),
        (("output: there.csv", "output: t.csv, interpolation: cubic"), 12, "cubic"),
    ],
)
def test_what_is_wrong_is_told_before_anything_is_done(
    folder: Path, wrong: tuple[str, str], line: int, said: str
) -> None:
    assert wrong[0] in RECIPE
    recipe = written(folder, RECIPE.replace(*wrong, 1))
    with pytest.raises(OptionError, match=f"recipe.yaml, line {line}: .*{said}"):
        read_recipe(recipe)
