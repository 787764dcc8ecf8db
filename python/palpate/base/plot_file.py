"""Files of plots, which need matplotlib (``pip install palpate[plot]``)."""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path

from palpate.base.errors import OptionError

__all__ = ["ENDINGS", "check_plot"]

ENDINGS = (".png", ".svg", ".pdf")


def check_plot(path: Path | None) -> None:
    """Refuses what would fail after the measurement.

    Raises:
        OptionError: The extension is not one of a picture, or matplotlib is missing.
    """
    if path is None:
        return
    if path.suffix.lower() not in ENDINGS:
        raise OptionError(f"plot {path} given; allowed: a file that ends in {', '.join(ENDINGS)}")
    if find_spec("matplotlib") is None:
        raise OptionError(
            "a plot needs matplotlib, which is not here; allowed: after pip install palpate[plot]"
        )
