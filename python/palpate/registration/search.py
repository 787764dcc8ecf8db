"""The search for a transform: stages of more and more freedom, each from coarse to fine grids."""

from __future__ import annotations

from typing import Any

from palpate.base.progress import Progress
from palpate.registration.bspline import search_bspline
from palpate.registration.image_pair import Compared, Measured
from palpate.registration.linear import search_linear
from palpate.registration.options import Kind, Level, SearchOptions, Watch, unwatched
from palpate.registration.search_history import SearchHistory

__all__ = ["Search"]

STAGES: dict[Kind, tuple[Kind, ...]] = {
    "rigid": ("rigid",),
    "affine": ("rigid", "affine"),
    "bspline": ("rigid", "affine", "bspline"),
}


class Search:
    """Stages of one registration, and how far they are."""

    def __init__(
        self,
        compared: Compared,
        *,
        options: SearchOptions,
        progress: Progress,
        watch: Watch = unwatched,
    ) -> None:
        """Takes what is compared, how, and what each step is reported to.

        Raises:
            OptionError: An option is out of range.
        """
        options.check()
        self._compared = compared
        self._options = options
        self._history = SearchHistory(progress, watch)

    @property
    def curve(self) -> tuple[Level, ...]:
        """The metric after each step so far."""
        return tuple(self._history.curve)

    def measure(self, transform: Any) -> Measured:  # noqa: ANN401  # SimpleITK has no types
        """Returns how alike the scans are under a transform.

        Raises:
            RegistrationError: They do not overlap.
        """
        return self._compared.measure(transform, self._history)

    def check(self, before: Measured, after: Measured) -> None:
        """Refuses an end that is worse than its start.

        Raises:
            RegistrationError: It is; the error has the curve.
        """
        self._compared.check(before, after, self._history)

    def require_best(self, first: Any, before: Measured, after: Measured) -> None:  # noqa: ANN401
        """Refuses a start that nothing better was found than, unless all beside it is worse.

        Raises:
            RegistrationError: What is beside it is as good, so that nothing tells where scans lie;
                the error has the curve.
        """
        if not self._compared.is_best_near(first, before, self._history):
            why = "no place was found that is better than the start, nor is the start the best"
            raise self._compared.refusal(why, (before, after), self._history)

    def run(self, first: Any, kind: Kind, *, near: bool = False) -> Any:  # noqa: ANN401
        """Returns the best transform of a kind near a first one, which may be affine already.

        Args:
            first: Where the search begins.
            kind: Of the transform.
            near: Whether the first one is next to its place, and must not be left by a long step.

        Raises:
            RegistrationError: The scans do not overlap.
        """
        stages = STAGES[kind]
        if first.GetName() == "AffineTransform":
            # what it scales and shears would be lost
            stages = stages[1:]
        found = first
        for number, stage in enumerate(stages):

            def share(done: float, number: int = number) -> float:
                return (number + done) / len(stages)

            shared: dict[str, Any] = {
                "options": self._options,
                "history": self._history,
                "share": share,
            }
            if stage == "bspline":
                found = search_bspline(self._compared, found, **shared)
            else:
                near = near and stage == "rigid"
                found = search_linear(self._compared, found, stage, near=near, **shared)
        return found
