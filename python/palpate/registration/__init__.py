"""Registration: where the points of one scan lie in another."""

from __future__ import annotations

from typing import TYPE_CHECKING

from palpate.base.lazy_exports import lazy_exports

if TYPE_CHECKING:
    from palpate.registration.options import Level, RegistrationError, SearchOptions
    from palpate.registration.registration import (
        Registration,
        metric_for,
        register,
        resampled,
        write_transform,
    )

__all__ = [
    "Level",
    "Registration",
    "RegistrationError",
    "SearchOptions",
    "metric_for",
    "register",
    "resampled",
    "write_transform",
]

__getattr__ = lazy_exports(
    __name__,
    {
        "Level": "options",
        "Registration": "registration",
        "RegistrationError": "options",
        "SearchOptions": "options",
        "metric_for": "registration",
        "register": "registration",
        "resampled": "registration",
        "write_transform": "registration",
    },
)
