"""The overview of a cohort: a page and a table of all of its cases."""

from __future__ import annotations

from palpate.cohort.overview.overview import write_overview

__all__ = ["write_overview"]
