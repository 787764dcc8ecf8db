"""Cohorts: one recipe over many scans, each case in a process and a folder of its own.

What programs use stands here; nothing of it needs Dask, all of it works as its tasks:
``client.map(palpate.cohort.run_case, cases, recipe=recipe, output=folder)``.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from palpate.base.lazy_exports import lazy_exports

if TYPE_CHECKING:
    from palpate.cohort.bids import cases_of_bids
    from palpate.cohort.case import Case
    from palpate.cohort.limits import Limits
    from palpate.cohort.matches import cases_over
    from palpate.cohort.one_case import CaseResult, run_case
    from palpate.cohort.table import cases_of_table

__all__ = [
    "Case",
    "CaseResult",
    "Limits",
    "cases_of_bids",
    "cases_of_table",
    "cases_over",
    "run_case",
]

__getattr__ = lazy_exports(
    __name__,
    {
        "Case": "case",
        "CaseResult": "one_case",
        "Limits": "limits",
        "cases_of_bids": "bids",
        "cases_of_table": "table",
        "cases_over": "matches",
        "run_case": "one_case",
    },
)
