"""The probe of a session: the hand that leads it, its place, the view and the settings of touch."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict

from palpate.base.errors import OptionError
from palpate.session.engine import Engine, Point, option_errors, triple
from palpate.session.segment_state import SettingsState
from palpate.session.touch_settings import TouchSettings

__all__ = ["ClipPlane", "SessionProbe"]

ClipPlane = tuple[Point, float]
"""Unit normal toward what is cut away [scene], and ``normal · point`` of its points [mm]."""


class SessionProbe:
    """Probe, device and hand of a session."""

    def __init__(self, engine: Engine) -> None:
        """Takes the engine."""
        self._engine = engine

    def hand(self, target: Point) -> None:
        """Moves the target to which the simulated hand pulls the device [scene, mm].

        Raises:
            OptionError: The point is not finite.
        """
        with option_errors():
            self._engine.hand(*triple("target", target))

    def press(self, origin: Point, direction: Point, *, pressure: float) -> None:
        """Presses on the surface that a ray meets first, as a finger on the picture does.

        The hand brings the probe there, pushes until it feels ``pressure``, follows the next press
        along the surface, and lifts and comes down again where that ends. Returns at once.

        Args:
            origin: Where the ray begins, before what is touched [scene, mm].
            direction: Where it goes, of any length [scene].
            pressure: Force on the surface [N], at most 5 N and the limit of the settings.

        Raises:
            OptionError: Ray or force are not allowed, or the device has a hand of its own.
        """
        with option_errors():
            self._engine.press(triple("origin", origin), triple("direction", direction), pressure)

    def lift(self) -> None:
        """Lifts the hand off what it presses; without a press it does nothing."""
        self._engine.lift()

    def place(self, point: Point) -> tuple[float, float, float]:
        """Moves probe, device and hand to a point, or to the nearest free voxel [scene, mm].

        Returns:
            Their new position.

        Raises:
            OptionError: There is no free voxel near the point.
        """
        with option_errors():
            return self._engine.place(*triple("point", point))

    def view(self, *, right: Point, up: Point) -> None:
        """Aligns the axes of the device with those of the view (thesis 4.7).

        Args:
            right: Direction to the right of the view [scene].
            up: Upward direction of the view [scene].

        Raises:
            OptionError: The axes are not perpendicular.
        """
        with option_errors():
            self._engine.view(triple("right", right), triple("up", up))

    def settings(self, changes: TouchSettings | None = None) -> SettingsState:
        """Changes settings of touch within the limits of the device.

        Args:
            changes: New settings; fields that are None keep their value.

        Returns:
            All settings in effect, by the names of the fields of ``TouchSettings``.

        Raises:
            OptionError: A setting is out of range.
        """
        with option_errors():
            return self._engine.settings(asdict(changes or TouchSettings()))

    def set_clip(self, planes: Sequence[ClipPlane]) -> None:
        """Cuts the scene for touch at planes, instead of those before; none cut nothing.

        A voxel whose centre lies before a plane is no obstacle, and no tool changes it. Moved
        segments are cut where they stand, soft tissue too. Voxels, statistics, exports and undo
        stay as they are; material that comes back leaves the probe free, as undo does.

        Args:
            planes: At most 16: unit normal toward what is cut away [scene], and
                ``normal · point`` of the plane's points [mm].

        Raises:
            OptionError: They are not such planes.

        Example:
            >>> session.set_clip([((0.0, 0.0, 1.0), 20.0)])  # nothing above z = 20 mm
        """
        try:
            given = [(triple("normal", normal), float(offset)) for normal, offset in planes]
        except (TypeError, ValueError):
            allowed = "pairs of a normal, x, y, z, and an offset [mm]"
            raise OptionError(f"planes {planes!r} given; allowed: {allowed}") from None
        with option_errors():
            self._engine.set_clip(given)

    def clip(self) -> list[tuple[tuple[float, float, float], float]]:
        """Returns the planes that cut the scene for touch, as ``set_clip`` takes them."""
        return self._engine.clip()

    def clutch(self, *, on: bool) -> None:
        """Decouples the device from the probe, or couples them again where both are then.

        A device with a small workspace can be moved back this way. It is sent no force while it is
        decoupled.

        Args:
            on: Whether device and probe are decoupled.
        """
        with option_errors():
            self._engine.clutch(on)
