"""Writes the overview of a cohort's folder: ``index.html`` and ``cohort.csv``."""

from __future__ import annotations

from pathlib import Path

from palpate.base.whole_file import whole_file
from palpate.cohort.locked_cases import page_lock
from palpate.cohort.output_folder import CohortFolder
from palpate.cohort.overview.csv_table import cohort_csv
from palpate.cohort.overview.page import cohort_page
from palpate.cohort.overview.told_cases import told_cases

__all__ = ["write_overview"]

PAGE, TABLE = "index.html", "cohort.csv"


def write_overview(folder: CohortFolder) -> tuple[Path, int]:
    """Writes page and table of all cases that a folder holds; returns the page and their number.

    Raises:
        OSError: The disk refuses it.
    """
    page, table = folder.of(PAGE), folder.of(TABLE)
    # another run must not write an older one over it
    with page_lock(folder):
        cases = told_cases(folder)
        for path, text in ((table, cohort_csv(cases)), (page, cohort_page(cases))):
            with whole_file(path) as unfinished:
                unfinished.write_text(text, "utf-8")
    return page, len(cases)
