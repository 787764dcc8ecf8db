"""Reading of medical volumes into patient space."""

from __future__ import annotations

from typing import TYPE_CHECKING

from palpate.base.lazy_exports import lazy_exports

if TYPE_CHECKING:
    from palpate.io.reading import list_series, read

__all__ = ["list_series", "read"]

__getattr__ = lazy_exports(
    __name__,
    {
        "list_series": "reading",
        "read": "reading",
    },
)
