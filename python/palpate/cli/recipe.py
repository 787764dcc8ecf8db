"""``palpate run``: a whole pipeline from a file."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from palpate.base.console import Display, quiet_libraries, warn

__all__ = ["EXAMPLES", "run_file"]

EXAMPLES = """\b
A recipe, with the options of the commands under their names:

  import:
    path: ct/
  register:                    # where there is another scan
    moving: mr/
    resampled: mr-on-ct.nii.gz
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
  report: report.html

In the place of import, reconstruct makes the scan of projections:

  reconstruct:
    path: projections.nrrd
    beam: parallel
    arc: 180
    pixel: [0.8, 0.8]

Files stand beside the recipe. All is checked before anything is read.
"""


def run_file(
    recipe: Annotated[Path, typer.Argument(help="A recipe, YAML.", metavar="RECIPE")],
    *,
    check: Annotated[bool, typer.Option("--check", help="Check it, and do nothing.")] = False,
) -> None:
    """Run a recipe: scan, registration, segments, surfaces, files, report."""
    from palpate.recipes.recipe import read_recipe
    from palpate.recipes.run import run_recipe

    wanted = read_recipe(recipe)
    if check:
        typer.echo(f"{recipe}: nothing is wrong with it")
        return
    with quiet_libraries(), Display() as display:
        scene, written, told = run_recipe(wanted, progress=display)
    for sentence in told:
        warn(sentence)
    for shown in scene:
        typer.echo(f"{shown.name}: {shown.segment.volume_ml:.1f} ml")
    for path in written:
        typer.echo(f"{path} written")
