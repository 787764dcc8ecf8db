"""Messages on touch: the hand, the view, the tool, its needle, settings and what is cut away."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from datetime import datetime

import msgspec

from palpate import protocol
from palpate.server.messages.outbox import Outbox
from palpate.server.messages.table import MessageTable, Runs
from palpate.session.needle import TISSUES
from palpate.session.session import Session
from palpate.session.touch_settings import TouchSettings

__all__ = ["PublishedNeedle", "TouchMessages"]

MOST_EVENTS = 100
"""Newest events of the needle that are published."""


class TouchMessages:
    """Does what pages ask of the device and its tool."""

    def __init__(
        self,
        session: Session,
        settings: protocol.Settings,
        publish: Callable[[protocol.ToPage], None],
    ) -> None:
        """Takes the settings that hold, and what publishes to all pages from any thread."""
        self.settings = settings
        """Those that hold."""
        self.clip = protocol.TouchClipChanged(planes=[])
        """What is cut away from touch."""
        self._session = session
        self._publish = publish
        self._pressed_by: Outbox | None = None
        self._led_by: Outbox | None = None
        self._moved_by: Outbox | None = None
        self._opened: dict[Outbox, str] = {}
        """When each page was opened (ISO 8601)."""

    def add_to(self, table: MessageTable) -> None:
        """Adds the rows of touch."""
        # the most frequent message, and wait-free
        table.add(protocol.Hand, self._hand, runs=Runs.ON_LOOP)
        table.add(protocol.Press, self._press, runs=Runs.ON_LOOP)
        table.add(protocol.Lift, self._lift, runs=Runs.ON_LOOP)
        table.add(protocol.Place, self._place, runs=Runs.IN_ORDER)
        table.add(protocol.View, self._view, runs=Runs.IN_ORDER)
        table.add(protocol.Clutch, self._clutch, runs=Runs.IN_ORDER)
        table.add(protocol.Tool, self._set_tool, runs=Runs.IN_ORDER)
        table.add(protocol.NeedleDirection, self._set_needle_direction, runs=Runs.IN_ORDER)
        table.add(protocol.WithdrawNeedle, self._withdraw_needle, runs=Runs.IN_ORDER)
        table.add(protocol.Stroke, self._stroke, runs=Runs.IN_ORDER)
        table.add(protocol.ChangeSettings, self._change_settings, runs=Runs.IN_ORDER)
        table.add(protocol.ChangeTouchClip, self._change_clip, runs=Runs.IN_ORDER)

    def join(self, page: Outbox) -> None:
        """Takes a page that was opened; to be called on the event loop, as ``part``."""
        self._opened[page] = datetime.now().astimezone().isoformat(timespec="seconds")
        if self._moved_by is not None:
            page.put(protocol.HandLed(self._opened[self._moved_by]))

    def part(self, page: Outbox) -> None:
        """Forgets a page that has gone."""
        self._opened.pop(page, None)
        if self._moved_by is page:
            self._move(None)

    def leave(self, page: Outbox) -> None:
        """Releases the tool and lifts the hand where a page that has gone pressed them."""
        with suppress(RuntimeError):
            self._lift(protocol.Lift(), page)
        if self._pressed_by is page:
            self._pressed_by = None
            with suppress(RuntimeError):
                self._session.stroke(on=False)

    def _move(self, page: Outbox | None) -> None:
        """Tells all pages whose hand it is where another page has it now."""
        if page is not self._moved_by:
            self._moved_by = page
            since = None if page is None else self._opened[page]
            for each in self._opened:
                each.put(protocol.HandLed(None if each is page else since))

    def _hand(self, message: protocol.Hand, page: Outbox) -> None:
        self._session.hand(message.target)
        self._move(page)

    def _press(self, message: protocol.Press, page: Outbox) -> None:
        self._session.press(message.origin, message.direction, pressure=message.pressure)
        self._move(page)
        self._led_by = page

    def _lift(self, _message: protocol.Lift, page: Outbox) -> None:
        # another page's press is not this one's to end
        if self._led_by is page:
            self._led_by = None
            self._session.lift()

    def _place(self, message: protocol.Place, _: Outbox) -> None:
        self._session.place(message.point)

    def _view(self, message: protocol.View, _: Outbox) -> None:
        self._session.view(right=message.right, up=message.up)

    def _clutch(self, message: protocol.Clutch, _: Outbox) -> None:
        self._session.clutch(on=message.on)

    def _set_tool(self, wanted: protocol.Tool, _: Outbox) -> None:
        self._session.set_tool(
            None if wanted.kind == "none" else wanted.kind,
            radius=wanted.radius,
            segment_ids=wanted.segments,
            tissues=[TISSUES[name].met_by(2.0 * wanted.radius) for name in wanted.tissues],
            depth=wanted.depth,
            overlaps=wanted.overlaps,
        )

    def _set_needle_direction(self, wanted: protocol.NeedleDirection, _: Outbox) -> None:
        self._session.set_needle_direction(wanted.direction)

    def _withdraw_needle(self, _message: protocol.WithdrawNeedle, _: Outbox) -> None:
        self._session.withdraw_needle()

    def _stroke(self, message: protocol.Stroke, page: Outbox) -> None:
        self._session.stroke(on=message.on)
        self._pressed_by = page if message.on else None

    def _change_settings(self, message: protocol.ChangeSettings, _: Outbox) -> None:
        try:
            wanted = TouchSettings(**msgspec.structs.asdict(message.settings))
            self.settings = protocol.Settings(**self._session.settings(wanted))
        finally:
            # a page shows what it asked for at once: refused, it must learn what holds
            self._publish(protocol.SettingsChanged(self.settings))

    def _change_clip(self, message: protocol.ChangeTouchClip, _: Outbox) -> None:
        try:
            self._session.set_clip(message.planes)
        finally:
            # a page sends the next ones once it is answered
            self.clip = protocol.TouchClipChanged(planes=self._session.clip())
            self._publish(self.clip)


class PublishedNeedle:
    """The events of a session's needle, and how many of them pages know."""

    def __init__(self, session: Session) -> None:
        """Begins with no event published."""
        self._session = session
        self._known = 0

    def message(self, count: int) -> protocol.NeedleEvents | None:
        """Returns the newest events where the session has had ``count``; None without news."""
        if count == self._known:
            return None
        self._known = count
        events = self._session.needle_events()[-MOST_EVENTS:]
        return protocol.NeedleEvents(
            msgspec.convert(events, list[protocol.NeedleEvent], from_attributes=True)
        )
