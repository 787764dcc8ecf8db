"""``palpate run``: a whole pipeline from a file."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from palpate.base.console import Display, quiet_libraries, warn

__all__ = ["EXAMPLES", "run_file"]

EXAMPLES = """\b
A recipe has a step for each command, with its options:

  import:
    path: ct/
  register:                    # optional: a second scan
    moving: mr/
    resampled: mr-on-ct.nii.gz
    output: mr-to-ct.tfm
  segment:
    - threshold: 250
      keep-largest: true
      name: bone
    - grow: ["-83,278,1170"]
      smooth: 2
      name: liver
  surface:
    - segment: bone
      out: bone.stl
  export:
    - out: segments.seg.nrrd
  transform:                   # the second scan's labels, on the grid of the first
    - path: mr-labels.nii.gz
      transform: mr-to-ct.tfm
      output: on-ct.nii.gz
  report: report.html

Instead of import, reconstruct makes the scan from projections:

  reconstruct:
    path: projections.nrrd
    beam: parallel
    arc: 180
    pixel: [0.8, 0.8]

Paths are relative to the recipe. The whole recipe is checked before anything is written.
"""


def run_file(
    recipe: Annotated[Path, typer.Argument(help="Recipe (YAML).", metavar="RECIPE")],
    *,
    check: Annotated[
        bool,
        typer.Option(
            "--check", help="Check the recipe and the files that it reads; write nothing."
        ),
    ] = False,
) -> None:
    """Run a recipe: import, registration, segments, surfaces, export, report."""
    from palpate.recipes.check import read_inputs
    from palpate.recipes.recipe import read_recipe
    from palpate.recipes.run import run_recipe

    wanted, source = read_recipe(recipe)
    with quiet_libraries(), Display() as display:
        inputs = read_inputs(wanted, source, progress=display)
        if not check:
            scene, written, told = run_recipe(wanted, inputs, progress=display)
    if check:
        typer.echo(f"{recipe}: nothing is wrong with it")
        return
    for sentence in told:
        warn(sentence)
    for shown in scene:
        typer.echo(f"{shown.name}: {shown.segment.volume_text}")
    for path in written:
        typer.echo(f"{path} written")
