"""``palpate bids``: a recipe over a BIDS data set, called as BIDS Apps are."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import typer

from palpate.cli.case_options import Memory, Timeout, Workers, limits_of

__all__ = ["EXAMPLES", "bids_app"]

EXAMPLES = """\b
Examples:
  palpate bids data/ out/ participant --recipe recipe.yaml --participant-label 01 02
  palpate bids data/ out/ group

Source: Gorgolewski et al., "BIDS apps", PLOS Computational Biology 13 (2017). The data set is not
validated: a validator of BIDS does that.
"""


def bids_app(
    bids_dir: Annotated[Path, typer.Argument(help="BIDS data set.", metavar="BIDS_DIR")],
    output_dir: Annotated[
        Path, typer.Argument(help="Folder of the derivative.", metavar="OUTPUT_DIR")
    ],
    *,
    analysis_level: Annotated[
        Literal["participant", "group"],
        typer.Argument(
            help="participant runs the recipe, group writes page and table of all.",
            metavar="LEVEL",
        ),
    ],
    more_labels: Annotated[
        list[str] | None,
        typer.Argument(help="Further labels after --participant-label.", metavar="[LABEL]..."),
    ] = None,
    recipe: Annotated[
        Path | None, typer.Option(help="Recipe (YAML); scans are its import.")
    ] = None,
    participant_label: Annotated[
        list[str] | None,
        typer.Option(
            "--participant-label",
            "--participant_label",
            help="Participants, with or without sub-; by default all.",
        ),
    ] = None,
    suffix: Annotated[
        str | None, typer.Option(help="Kind of image, such as T1w or ct; by default all scans.")
    ] = None,
    workers: Workers = None,
    timeout: Timeout = None,
    memory: Memory = None,
) -> None:
    """Run a recipe over a BIDS data set, as a BIDS App."""
    from palpate.base.errors import OptionError
    from palpate.cli.recipe_over import OverOptions, run_over
    from palpate.cli.report import write_report_of
    from palpate.cohort.bids import cases_of_bids, describe_derivative
    from palpate.cohort.output_folder import CohortFolder

    labels = (*(participant_label or ()), *(more_labels or ()))
    if more_labels and not participant_label:
        raise OptionError(f"{more_labels[0]!r} given; allowed: labels after --participant-label")
    if analysis_level == "group":
        if recipe is not None or labels:
            raise OptionError(
                "a recipe or participants given with group; allowed: with participant only"
            )
        # it must be one, whatever level it is
        cases_of_bids(bids_dir, suffix=suffix)
        write_report_of(output_dir)
        describe_derivative(CohortFolder(output_dir), bids_dir)
        return
    if recipe is None:
        raise OptionError("no recipe given; allowed: --recipe FILE")
    options = OverOptions(
        bids=bids_dir,
        participants=labels,
        suffix=suffix,
        output=output_dir,
        workers=workers,
        limits=limits_of(timeout=timeout, memory=memory),
    )
    code = run_over(recipe, options)
    describe_derivative(CohortFolder(output_dir), bids_dir)
    raise typer.Exit(code)
