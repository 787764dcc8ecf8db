"""What pages ask of a session, one thing after another."""

from __future__ import annotations

from collections.abc import Callable

import msgspec
import numpy as np

from palpate import protocol
from palpate.base.errors import OptionError
from palpate.server.messages.outbox import Outbox
from palpate.server.messages.painting import Painter
from palpate.server.messages.segment_list import ShownSegments
from palpate.server.messages.segments import GapWatch
from palpate.server.messages.session import Recovering
from palpate.server.messages.soft_tissue import asked_material, asked_options, asked_regions
from palpate.server.recording import Recorder
from palpate.session.needle import TISSUES
from palpate.session.painted_cut import PaintedCut
from palpate.session.session import Session
from palpate.session.touch_settings import TouchSettings

__all__ = ["Requests"]


class Requests:
    """Does what pages ask, in the thread that calls."""

    def __init__(
        self,
        session: Session,
        segments: ShownSegments,
        *,
        painter: Painter,
        recorder: Recorder,
        gaps: GapWatch,
        recovery: Recovering,
        settings: protocol.Settings,
        tell: Callable[[protocol.ToPage], None],
    ) -> None:
        """Takes whom it hands on to; ``tell`` tells all pages, from any thread."""
        self.settings = settings
        """Those that hold."""
        self._session = session
        self._segments = segments
        self._painter = painter
        self._recorder = recorder
        self._gaps = gaps
        self._recovery = recovery
        self._tell = tell

    def do(self, message: protocol.FromPage, outbox: Outbox) -> None:
        """Does what a page asks; ``outbox`` is that page's.

        Raises:
            PalpateError: It cannot be done.
            RuntimeError: The session has ended.
        """
        match message:
            case protocol.Paint():
                self._painter.paint(message, outbox)
            case protocol.EndPaint(keep):
                self._painter.end(keep=keep)
            case protocol.FillOutline():
                self._painter.fill(message)
            case protocol.NewSegment(name):
                self._segments.add_empty(name)
            case _:
                self._do_to_hand(message)

    def _do_to_hand(self, message: protocol.FromPage) -> None:
        match message:
            case protocol.Place(point):
                self._session.place(point)
            case protocol.View(right, up):
                self._session.view(right=right, up=up)
            case protocol.Clutch(on):
                self._session.clutch(on=on)
            case protocol.Tool():
                self._take_tool(message)
            case protocol.WithdrawNeedle():
                self._session.withdraw_needle()
            case protocol.Undo():
                self._painter.end()
                self._session.undo()
            case protocol.Redo():
                self._painter.end()
                self._session.redo()
            case _:
                self._do_to_session(message)

    def _take_tool(self, wanted: protocol.Tool) -> None:
        self._session.set_tool(
            None if wanted.kind == "none" else wanted.kind,
            radius=wanted.radius,
            segment_ids=wanted.segments,
            tissues=[TISSUES[name].met_by(2.0 * wanted.radius) for name in wanted.tissues],
            depth=wanted.depth,
            overlaps=wanted.overlaps,
        )

    def _do_to_session(self, message: protocol.FromPage) -> None:
        match message:
            case protocol.RecordSession(on):
                self._record(on=on)
            case protocol.ChangeSettings(settings):
                self._change_settings(settings)
            case protocol.Recover(bring_back):
                self._recovery.decide(bring_back=bring_back)
            case protocol.WatchGap(pair):
                self._gaps.choose(pair)
            case _:
                self._do_to_matter(message)

    def _do_to_matter(self, message: protocol.FromPage) -> None:
        match message:
            case protocol.SetDeformation(model, options, undoable):
                self._session.set_deformation(model, asked_options(options), undoable=undoable)
            case protocol.SetForceSource(source):
                self._session.set_force_source(source)
            case protocol.SetMaterial(segment_id):
                self._session.set_material(
                    segment_id, asked_material(message), undoable=message.undoable
                )
            case protocol.SetRegions(segment_id):
                self._session.set_regions(segment_id, asked_regions(message))
            case _:
                self._do_to_segment(message)

    def _do_to_segment(self, message: protocol.FromPage) -> None:
        match message:
            case protocol.SegmentProperties():
                self._segments.change(message)
            case protocol.MoveSegment(segment_id, pose, goes_on):
                self._session.move_segment(segment_id, np.reshape(pose, (4, 4)), goes_on=goes_on)
            case protocol.Grab(segment_id, collides):
                self._session.grab(segment_id, collides=collides)
            case protocol.TurnGrabbed(rotation):
                self._session.turn_grabbed(rotation)
            case protocol.CutSegment(cut_id, point, normal):
                self._segments.cut(cut_id, lambda: self._session.cut(cut_id, point, normal))
            case protocol.CutAlong():
                self._cut_along(message)
            case protocol.SegmentFeel(segment_id, feel):
                self._session.set_feel(segment_id, **msgspec.structs.asdict(feel))
            case protocol.RemoveSegment(segment_id):
                self._session.remove_segment(segment_id)

    def _cut_along(self, wanted: protocol.CutAlong) -> None:
        cut = PaintedCut(line=wanted.line, eye=wanted.eye, view=wanted.view, closed=wanted.closed)
        if not wanted.preview:
            self._segments.cut(wanted.id, lambda: self._session.cut_along(wanted.id, cut))
            return
        parts: tuple[float, float] | tuple[None, None]
        try:
            parts = self._session.preview_cut(wanted.id, cut)
        except OptionError:
            # the page says so where the line is
            parts = None, None
        self._tell(protocol.CutPreview(wanted.id, *parts))

    def _change_settings(self, wanted: protocol.Settings) -> None:
        try:
            held = self._session.settings(TouchSettings(**msgspec.structs.asdict(wanted)))
            self.settings = protocol.Settings(**held)
        finally:
            # a page shows what it asked for at once: refused, it must learn what holds
            self._tell(protocol.SettingsChanged(self.settings))

    def _record(self, *, on: bool) -> None:
        if on:
            self._recorder.start()
        else:
            said = self._recorder.stop()
            self._tell(protocol.Notice(level="info", text=f"Recorded {said}."))
