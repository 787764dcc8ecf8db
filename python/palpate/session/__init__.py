"""Sessions of touch: a scene, a device and the engine; tools, settings and recordings."""

from __future__ import annotations

from typing import TYPE_CHECKING

from palpate.base.lazy_exports import lazy_exports

if TYPE_CHECKING:
    from palpate.session.session import Session, SessionOptions

__all__ = ["Session", "SessionOptions"]

__getattr__ = lazy_exports(
    __name__,
    {
        "Session": "session",
        "SessionOptions": "session",
    },
)
