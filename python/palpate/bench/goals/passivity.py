"""Rows of the benchmark of passivity, and their goals."""

from __future__ import annotations

from palpate.bench.goals.goal import Goal

__all__ = [
    "BONE",
    "DEFAULT_STIFFNESS",
    "FLAT_WALL",
    "PASSIVITY_ROWS",
    "RATES_KHZ",
    "WALLS",
]

FLAT_WALL = "flat wall"
BONE = "bone"
WALLS = (FLAT_WALL, BONE)
RATES_KHZ = (1, 2, 4)
"""Rates of device and servo [kHz]."""

DEFAULT_STIFFNESS = {
    "simulated": 1.0,
    "Touch": 0.4,
    "Omni": 0.7,
    "Desktop": 1.0,
    "Premium 1.5": 0.8,
    "Premium 3.0": 1.0,
    "omega": 1.0,
    "sigma.7": 1.0,
    "lambda.7": 1.0,
    "delta.3": 1.0,
    "Falcon": 1.0,
}
"""Initial stiffness of each device [N/mm]: the default of touch, or the largest that the device
allows."""


def _passivity(device: str, rate_khz: int, wall: str) -> tuple[Goal, ...]:
    """Returns the rows of a device on a wall."""
    case = f"{device}, {rate_khz} kHz, {wall}"
    least = DEFAULT_STIFFNESS[device]
    return (
        Goal(case, "net energy to the hand", "to_hand", 1.0, "N·mm", 0.0, "lower"),
        Goal(case, "largest gain of a contact", "of_one_contact", 1.0, "N·mm", None, "lower"),
        Goal(case, "solid ticks", "violations", 1.0, "1", 0.0, "lower"),
        Goal(case, "in contact", "contact_share", 100.0, "%", None, "higher"),
        Goal(case, "taken back", "damped", 1.0, "ticks", None, "lower"),
        Goal(case, "stiffness", "stiffness", 1.0, "N/mm", None, "higher"),
        Goal(case, "largest passive", "largest_stiffness", 1.0, "N/mm", least, "higher"),
        Goal(case, "bound", "bound", 1.0, "N/mm", least, "higher"),
    )


PASSIVITY_ROWS = tuple(
    goal
    for device in DEFAULT_STIFFNESS
    for wall in WALLS
    for rate in RATES_KHZ
    for goal in _passivity(device, rate, wall)
)
