"""``palpate run``: a whole pipeline from a file."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from palpate.base.console import Display, quiet_libraries, warn
from palpate.base.errors import OptionError
from palpate.base.files_read import files_noted, note_read
from palpate.base.replacing import agreed_by
from palpate.cli.case_options import Memory, Timeout, Workers, limits_of
from palpate.cli.written_files import Force, asked

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
  compare:                     # with a reference mask
    - reference: truth.seg.nrrd
      out: agreement.csv
  landmarks:
    - segment: bone
      out: landmarks.csv
  touch:                       # a press of 3 mm from above
    - segment: bone
      at: superior
      depth: 3
      out: press.csv
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


def run_file(  # noqa: PLR0913  # one per option of the command line
    recipe: Annotated[Path, typer.Argument(help="Recipe (YAML).", metavar="RECIPE")],
    *,
    check: Annotated[
        bool,
        typer.Option(
            "--check", help="Check the recipe and the files that it reads; write nothing."
        ),
    ] = False,
    over: Annotated[
        str | None,
        typer.Option(
            help="Run it over each scan that matches, in the place of import: path.",
            metavar="PATTERN",
        ),
    ] = None,
    table: Annotated[
        Path | None,
        typer.Option(
            help="Run it over each row of a CSV file; columns fill {column} in the recipe, the "
            "column case names the row."
        ),
    ] = None,
    bids: Annotated[
        Path | None, typer.Option(help="Run it over each scan of a BIDS data set.", metavar="DIR")
    ] = None,
    participant_label: Annotated[
        list[str] | None,
        typer.Option("--participant-label", help="With --bids: these participants; repeatable."),
    ] = None,
    suffix: Annotated[
        str | None, typer.Option(help="With --bids: this kind of image, such as T1w or ct.")
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option(
            "--output", "-o", help="Folder with one folder for each case.", metavar="FOLDER"
        ),
    ] = None,
    shard: Annotated[
        str | None, typer.Option(help="Run the i-th of n shares of all cases.", metavar="I/N")
    ] = None,
    only_failed: Annotated[
        bool, typer.Option("--only-failed", help="Run only cases that failed before.")
    ] = False,
    dry_run: Annotated[
        bool, typer.Option("--dry-run", help="Say which cases would run; write nothing.")
    ] = False,
    workers: Workers = None,
    scheduler: Annotated[
        str | None,
        typer.Option(help="Run them on the Dask cluster with this scheduler.", metavar="ADDRESS"),
    ] = None,
    timeout: Timeout = None,
    memory: Memory = None,
    retry: Annotated[
        int, typer.Option(help="How often a case that failed is tried again.", min=0)
    ] = 0,
    force: Force = False,
) -> None:
    """Run a recipe: import, registration, segments, surfaces, export, report."""
    if over is not None or table is not None or bids is not None:
        if force:
            raise OptionError(
                "--force given with many cases; allowed: without it, since a case's folder is "
                "replaced only where it is made again"
            )
        from palpate.cli.recipe_over import OverOptions, run_over

        options = OverOptions(
            over=over,
            table=table,
            bids=bids,
            participants=participant_label or (),
            suffix=suffix,
            output=output,
            shard=shard,
            only_failed=only_failed,
            dry_run=dry_run or check,
            workers=workers,
            scheduler=scheduler,
            limits=limits_of(timeout=timeout, memory=memory, retry=retry),
        )
        raise typer.Exit(run_over(recipe, options))
    many = (output, shard, only_failed, dry_run, workers, scheduler, participant_label, suffix)
    if any(many):
        raise OptionError(
            "no scans given for these options; allowed: with --over, --table or --bids"
        )
    from palpate.recipes.check import read_inputs
    from palpate.recipes.recipe import read_recipe
    from palpate.recipes.run import run_recipe
    from palpate.segmentation.measures.statistics_table import aligned_lines

    with (
        files_noted(),
        agreed_by(asked(force=force or check)),
        quiet_libraries(),
        Display() as display,
    ):
        note_read(recipe)
        wanted, source = read_recipe(recipe)
        inputs = read_inputs(wanted, source, progress=display)
        if not check:
            made = run_recipe(wanted, inputs, progress=display)
    if check:
        typer.echo(f"{recipe}: nothing is wrong with it")
        return
    for sentence in made.told:
        warn(sentence)
    for shown in made.scene:
        typer.echo(f"{shown.name}: {shown.segment.volume_text}")
    for measured in made.measures.tables:
        typer.echo("\n".join((f"{measured.title}:", *aligned_lines(measured.cells))))
    for path in made.written:
        typer.echo(f"{path} written")
