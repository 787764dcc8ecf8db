"""Volumes for people: small ones never become "0.0 ml"; the page writes the same."""

from __future__ import annotations

import pytest
from palpate.base.volume_text import volume_text


@pytest.mark.parametrize(
    ("volume", "text"),
    [
        (0.0, "0 mm³"),
        (0.0125, "0.0125 mm³"),
        (1.0, "1 mm³"),
        (36.24, "36.2 mm³"),
        (999.4, "999 mm³"),
        (999.7, "1.00 ml"),
        (1000.0, "1.00 ml"),
        (12_345.0, "12.3 ml"),
        (99_960.0, "100 ml"),
        (2_054_400.0, "2054 ml"),
    ],
)
def test_small_volumes_are_in_cubic_millimetres(volume: float, text: str) -> None:
    assert volume_text(volume) == text
