"""The history of a search: the metric after each step, reported as it goes on."""

from __future__ import annotations

from palpate.base.progress import Progress
from palpate.registration.options import STARTS, Kind, Level, RegistrationError, Watch

__all__ = ["SearchHistory"]


class SearchHistory:
    """Levels that were searched, and the metric on them."""

    def __init__(self, progress: Progress, watch: Watch) -> None:
        """Takes what each step is reported to."""
        self._progress = progress
        self._watch = watch
        self.curve: list[Level] = []

    def begin(self, stage: Kind, shrink: int, sampled: float) -> Level:
        """Begins a level; each step compares a share ``sampled`` of its voxels, 0..1."""
        level = Level(stage, shrink, min(1.0, sampled))
        self.curve.append(level)
        return level

    def step(self, level: Level, value: float, share: float) -> None:
        """Takes the metric after a step, and the share of the search that is done, 0..1.

        An exception of the progress stops the search: it is raised from here.
        """
        level.values.append(value)
        coarser = f", {level.shrink} times coarser" if level.shrink > 1 else ""
        self._watch(self.curve)
        self._progress(f"{level.stage}{coarser}", min(1.0, share))

    def summary(self) -> str:
        """Returns the first, middle and last value of each level."""
        return "; ".join(
            f"{level.stage} /{level.shrink}: "
            + ", ".join(f"{value:.4g}" for value in _ends(level.values))
            for level in self.curve
        )

    def no_overlap(self, reason: str) -> RegistrationError:
        """Returns the error of scans that do not overlap."""
        history = f"; on the way: {self.summary()}" if self.curve else ""
        return RegistrationError(
            f"the scans do not overlap enough ({reason}{history}); nothing was changed; "
            f"allowed: scans of the same part, or another start ({', '.join(STARTS)})",
            self.curve,
        )


def _ends(values: list[float]) -> list[float]:
    places = sorted({0, len(values) // 2, len(values) - 1}) if values else []
    return [values[place] for place in places]
