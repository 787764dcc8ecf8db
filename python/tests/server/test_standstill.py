"""A process that was stopped is told from one that is busy."""

from __future__ import annotations

import pytest
from palpate.server.standstill import Standstill


@pytest.mark.parametrize(
    ("seconds", "on_processor", "stood_still"),
    [
        (0.1, 0.0, 0.0),
        (0.9, 0.0, 0.0),
        (1.5, 0.01, 1.5),
        (45.0, 0.02, 45.0),
        # busy, not stopped: what was asked meanwhile is only late
        (1.5, 1.4, 0.0),
        (10.0, 4.0, 0.0),
    ],
)
def test_it_stood_still_where_time_passed_without_a_processor(
    seconds: float, on_processor: float, stood_still: float
) -> None:
    now = [100.0, 3.0]
    standstill = Standstill(lambda: now[0], lambda: now[1])
    assert standstill.beat() == 0.0
    now[0] += seconds
    now[1] += on_processor
    assert standstill.beat() == pytest.approx(stood_still)
    assert standstill.beat() == 0.0
