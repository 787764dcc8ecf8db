"""The list of segments as pages see it: what the engine has of each, and how it is shown.

Names and colours are kept when a segment is removed, since undo may bring it back.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from itertools import product
from threading import Lock
from typing import NamedTuple

import numpy as np
from msgspec.structs import replace
from numpy.typing import NDArray

from palpate import protocol
from palpate.base.errors import OptionError
from palpate.base.progress import Progress, silent
from palpate.server.messages.labels_version import LabelsVersion
from palpate.server.messages.part_name import part_name
from palpate.server.messages.segment_steps import steps_message
from palpate.server.messages.soft_tissue import material_of, regions_of
from palpate.server.voxel_data import labels_of
from palpate.session.appearance import (
    UNMOVED,
    ShownAppearance,
    appearance_of_number,
    appearances_of,
    colour_of_number,
    keep_appearances,
    restore_appearances,
    scene_with_appearances,
    with_colour_chosen,
)
from palpate.session.segment_state import Bounds, SegmentState
from palpate.session.session import Session
from palpate.session.steps import ShapeChange
from palpate.volumes.anatomical_colour import colour_of_name, first_colour
from palpate.volumes.appearance import Colour, SegmentAppearance, SurfaceSource
from palpate.volumes.scene import Scene, new_appearance
from palpate.volumes.segment import Segment

__all__ = ["SegmentList"]


class SegmentList:
    """Segments of a session; every method may be called from any thread."""

    def __init__(self, session: Session, keep: Callable[[bytes], None] | None = None) -> None:
        """Takes appearances from the session's scene; ``keep`` is given them when they change."""
        self._session = session
        self._keep = keep
        self._appearances = appearances_of(session)
        self._lock = Lock()
        self._seen: tuple[int, ...] | None = None
        self._notices: list[str] = []
        self._appearances_version = 0
        self._coming = 0
        self._labels = LabelsVersion()
        self._made: dict[int, MadeSurface | None] = {}
        self.message = self._make_message(voxels_version=0, edit=0)

    def refresh(
        self, segments_version: int, *, voxels_version: int, pending: int, edit: int
    ) -> bool:
        """Makes the list again if something changed; says whether it did.

        Args:
            segments_version: Rises with each change of voxels or of the list.
            voxels_version: Rises where voxels change that ``picture_changes`` does not have.
            pending: How many changes touch does not follow yet.
            edit: Number of the newest edit of voxels.
        """
        with self._lock:
            seen = (segments_version, self._appearances_version, pending)
            if seen == self._seen:
                return False
            self._seen = seen
        self.message = self._make_message(voxels_version=voxels_version, edit=edit)
        return True

    @property
    def is_unsure_of_labels(self) -> bool:
        """Whether pages may need other labels than they have; making ``labels`` tells."""
        return self._labels.is_unsure

    def change(self, wanted: protocol.SegmentProperties) -> None:
        """Changes how a segment looks and whether it can be touched, and its voxels changed."""
        self._session.set_touchable(
            wanted.id,
            touchable=wanted.touchable,
            visible=wanted.visible,
            touched_while_hidden=wanted.touched_while_hidden,
        )
        self._session.set_locked(wanted.id, locked=wanted.locked)
        colour, chosen = self._colour_after(wanted.id, name=wanted.name, colour=wanted.colour)
        look = replace(with_colour_chosen(wanted, chosen=chosen), colour=colour)
        self._set_appearance(wanted.id, look)
        self._show(wanted.id, look)
        self.keep()

    def show(self, changes: Sequence[protocol.ShownSegments]) -> None:
        """Shows and hides segments, or shows them in another way, and keeps that once for all.

        Raises:
            OptionError: There is no such segment; then none is changed.
        """
        looks: dict[int, ShownAppearance] = {}
        for change in changes:
            wanted = {"visible": change.visible, "shown_as": change.shown_as}
            given = {name: value for name, value in wanted.items() if value is not None}
            for segment_id in change.ids:
                look = looks.get(segment_id, self._appearance_of(segment_id))
                looks[segment_id] = replace(look, **given)
        self._session.show_segments({each: look.visible for each, look in looks.items()})
        for segment_id, look in looks.items():
            self._show(segment_id, look)
        with self._lock:
            # no list tells of some of them only: pages would fetch labels for it
            self._appearances.update(looks)
            self._appearances_version += 1
        self.keep()

    def threshold(self, wanted: protocol.Threshold, *, progress: Progress = silent) -> ShapeChange:
        """Makes a segment of a range of values, or changes one: the steps that it has follow.

        Raises:
            PalpateError: The range selects nothing, or nothing is left after the steps.
        """
        if wanted.id is None:
            self.add(self._session.threshold(wanted.low, wanted.high, name=wanted.name))
            return ShapeChange(changed=True)
        change = self._session.set_threshold(
            wanted.id, wanted.low, wanted.high, name=wanted.name, progress=progress
        )
        look = self._appearance_of(wanted.id)
        colour, chosen = self._colour_after(wanted.id, name=wanted.name, colour=look.colour)
        self._set_appearance(
            wanted.id, replace(look, name=wanted.name, colour=colour, colour_chosen=chosen)
        )
        self.keep()
        return change

    def steps_changed(self) -> None:
        """Has pages told of lists of steps anew, and has them written to the journal."""
        with self._lock:
            self._appearances_version += 1
        self.keep()

    def add(self, segment: Segment, *, colour: Colour | None = None) -> None:
        """Adds a segment under its name, in a colour of its own where none is given."""
        with self._told_once_named():
            segment_id = self._session.add_segment(segment)
            own = self._own_colour(segment_id, segment.name)
            chosen = colour is not None and colour != own
            new = new_appearance(segment.name, colour or own)
            self._set_appearance(segment_id, with_colour_chosen(new, chosen=chosen))
        self.keep()

    def add_preview(self, segment: Segment, *, colour: Colour) -> int:
        """Adds a segment that is not touched, for a person to look at; returns its number."""
        with self._told_once_named():
            segment_id = self._session.add_segment(segment, touchable=False)
            look = with_colour_chosen(new_appearance(segment.name, colour), chosen=True)
            self._set_appearance(segment_id, look)
        self.keep()
        return segment_id

    def add_empty(self, name: str) -> None:
        """Adds a segment without voxels, to be painted."""
        volume = self._session.scene.volume
        self.add(volume.segment(np.zeros(volume.shape, np.uint8), name=name))

    def is_shown(self, segment_id: int) -> bool:
        """Returns whether pages show a segment."""
        return self._appearance_of(segment_id).visible

    def has_steps(self, segment_id: int | None) -> bool:
        """Returns whether pages were told of steps of a segment."""
        return any(
            each.id == segment_id and each.steps is not None and bool(each.steps.steps)
            for each in self.message.segments
        )

    def name_of(self, segment_id: int) -> str:
        """Returns what pages call a segment."""
        return self._appearance_of(segment_id).name

    def look_of(self, segment_id: int) -> SegmentAppearance:
        """Returns how pages show a segment."""
        return self._appearance_of(segment_id)

    def place_of(self, segment_id: int) -> int:
        """Returns where a segment stands among all, from 0 on.

        Raises:
            OptionError: There is none of this number.
        """
        ids = [state["id"] for state in self._session.segments()]
        if segment_id not in ids:
            allowed = ", ".join(map(str, ids)) or "none: there are no segments"
            raise OptionError(f"segment {segment_id} given; allowed: {allowed}")
        return ids.index(segment_id)

    def scene(
        self, values: NDArray[np.int16], *, names: Mapping[int, str] | None = None
    ) -> tuple[Scene, list[str]]:
        """Returns the scan with such stored values and its segments as they are now, for files.

        Also returns sentences on what files cannot hold.

        Args:
            values: Stored values of the scan.
            names: Other names for segments, by their numbers; blank ones are left out.

        Raises:
            OptionError: Segments came or went meanwhile.
        """

        def shared(segment_id: int) -> ShownAppearance:
            look = self._appearance_of(segment_id)
            name = (names or {}).get(segment_id, "").strip()
            return replace(look, name=name) if name else look

        return scene_with_appearances(self._session, values, shared)

    def keep(self) -> None:
        """Has appearances written to the journal, with what can be touched and changed."""
        if self._keep is not None:
            self._keep(self.kept())

    def kept(self) -> bytes:
        """Returns appearances and what can be touched and changed, as ``restore`` takes them."""
        return keep_appearances(self._session, self._appearance_of)

    def restore(self, kept: bytes) -> None:
        """Takes appearances that were kept.

        Raises:
            OptionError: The bytes are not what ``kept`` returns.
        """
        appearances = restore_appearances(self._session, kept)
        there = {state["id"] for state in self._session.segments()}
        for segment_id, look in appearances.items():
            if segment_id in there:
                self._set_appearance(segment_id, look)
            else:
                self._remember(segment_id, look)

    def cut(self, segment_id: int, cut: Callable[[], int]) -> None:
        """Cuts a segment in two; the part that ``cut`` returns gets a name and a colour of its own.

        Raises:
            PalpateError: All of it is left on one side.
        """
        with self._told_once_named():
            part = cut()
            look = self._appearance_of(segment_id)
            name = self._name_of_part(segment_id, part)
            look = replace(look, name=name, colour=colour_of_number(part), colour_chosen=False)
            self._set_appearance(part, look)
        self.keep()

    @contextmanager
    def _told_once_named(self) -> Iterator[None]:
        """Has pages told of a segment that is added meanwhile only once it has its name."""
        with self._lock:
            self._coming += 1
        try:
            yield
        finally:
            with self._lock:
                self._coming -= 1
                self._appearances_version += 1

    def _name_of_part(self, segment_id: int, part: int) -> str:
        """Returns a name by the side on which a part lies of the rest, and that no other has."""
        states = {state["id"]: state for state in self._session.segments()}
        taken = [self._appearance_of(other).name for other in states if other != part]
        whole = self._appearance_of(segment_id).name
        boxes = [self._box_in_patient(states[each]) for each in (segment_id, part)]
        rest, piece = boxes
        if rest is None or piece is None or not self._session.scene.volume.traits.orientation_known:
            return part_name(whole, None, 0.0, taken=taken)
        size = float(np.ptp(rest, axis=0).max())
        return part_name(whole, piece.mean(axis=0) - rest.mean(axis=0), size, taken=taken)

    def _box_in_patient(self, state: SegmentState) -> NDArray[np.float64] | None:
        """Returns the corners of a segment's box where the scan has it, LPS, [8, 3] [mm]."""
        if state["bounds"] is None:
            return None
        grid = state["grid"]
        patient_from_grid = (
            self._session.scene.volume.patient_from_grid
            if grid is None
            else np.reshape(grid, (4, 4))
        )
        corners = np.array(list(product(*zip(*state["bounds"], strict=True))), np.float64)
        return corners @ patient_from_grid[:3, :3].T + patient_from_grid[:3, 3]

    def take_notices(self) -> list[str]:
        """Returns sentences for pages since the last call."""
        with self._lock:
            notices, self._notices = self._notices, []
        return notices

    def _show_moved_as_surface(self, state: SegmentState) -> None:
        """Shows a moved segment as a surface, since voxels are drawn where the scan has them."""
        segment_id, pose, has_own_grid = state["id"], state["pose"], state["grid"] is not None
        if (pose is None or pose == UNMOVED) and not has_own_grid:
            return
        # at once: another thread may be giving it a name
        with self._lock:
            look = self._appearance_of(segment_id)
            if look.shown_as == "surface":
                return
            self._appearances[segment_id] = replace(look, shown_as="surface")
            why = "has a grid of its own" if has_own_grid else "was moved"
            self._notices.append(
                f"{look.name} {why}: it is shown as a surface from now on, since voxels "
                "are drawn where the scan has them."
            )

    def _show(self, segment_id: int, look: ShownAppearance) -> None:
        """Has the engine make the surface that is shown, where it is not made yet."""
        wanted = _surface_of(look)
        with self._lock:
            if wanted == self._made.get(segment_id):
                return
        if wanted is None:
            self._session.hide_surface(segment_id)
        else:
            self._session.show_surface(segment_id, smoothing=wanted.smoothing, source=wanted.source)
        with self._lock:
            self._made[segment_id] = wanted

    def labels(self) -> NDArray[np.uint8]:
        """Returns the number of each voxel's segment, for segments without a range.

        Visible ones are before hidden ones, where they overlap.
        """
        with self._lock:
            order, edit = self._labels.order, self._labels.edit
        segments = {each: self._session.segment(each) for each in order}
        labels, overlapping = labels_of(segments, self._session.scene.volume.shape)
        with self._lock:
            number = self._labels.number
            self._labels.learn(overlapping, order=order, edit=edit)
            if self._labels.number != number:
                self._appearances_version += 1
        return labels

    def _set_appearance(self, segment_id: int, look: ShownAppearance) -> None:
        """Shows a segment that is there in this way, with a surface where it has one."""
        self._show(segment_id, look)
        self._remember(segment_id, look)

    def _remember(self, segment_id: int, look: ShownAppearance) -> None:
        with self._lock:
            self._appearances[segment_id] = look
            self._appearances_version += 1

    def _appearance_of(self, segment_id: int) -> ShownAppearance:
        # a program beside the page may have added it
        return self._appearances.get(segment_id, appearance_of_number(segment_id))

    def _colour_after(self, segment_id: int, *, name: str, colour: Colour) -> tuple[Colour, bool]:
        """Returns the colour of a segment that gets this name and colour, and if it is chosen.

        One that nobody has chosen follows the name from and to those of the body.
        """
        before = self._appearance_of(segment_id)
        if colour != before.colour:
            # undo of a name gives its own colour back
            return colour, colour != self._own_colour(segment_id, name)
        anatomical = colour_of_name(name) is not None or colour_of_name(before.name) is not None
        if name != before.name and not before.colour_chosen and anatomical:
            return self._own_colour(segment_id, name), False
        return colour, before.colour_chosen

    def _own_colour(self, segment_id: int, name: str) -> Colour:
        others = [look.name for other, look in self._appearances.items() if other != segment_id]
        return first_colour(name, others, otherwise=colour_of_number(segment_id))

    def _make_message(self, *, voxels_version: int, edit: int) -> protocol.Segments:
        states = self._told_states()
        for state in states:
            self._show_moved_as_surface(state)
            self._show(state["id"], self._appearance_of(state["id"]))
        segments = [self._segment(state) for state in states]
        labelled = sorted(filter(_is_labelled, segments), key=lambda segment: segment.visible)
        order = [segment.id for segment in labelled]
        with self._lock:
            changed = self._labels.follow(order, voxels_version=voxels_version, edit=edit)
            number = self._labels.number
        if changed:
            # changes have the labels of these from now on, before pages ask for them
            self._session.set_labelled(order)
        return protocol.Segments(segments=segments, labels=number)

    def _told_states(self) -> list[SegmentState]:
        """Returns the segments of the engine, less new ones while one waits for its name."""
        states = self._session.segments()
        # asked after: one that is new among them may still have the name that its number had before
        with self._lock:
            if self._coming == 0:
                return states
        told = {each.id for each in self.message.segments}
        return [state for state in states if state["id"] in told]

    def _segment(self, state: SegmentState) -> protocol.Segment:
        segment_id = state["id"]
        look = self._appearance_of(segment_id)
        return protocol.Segment(
            **{name: getattr(look, name) for name in SegmentAppearance.__struct_fields__},
            id=segment_id,
            touchable=state["touchable"],
            felt=state["felt"],
            locked=state["locked"],
            range=state["range"],
            made_by=state["made_by"],
            voxels=state["voxels"],
            volume_ml=state["volume"] / 1000.0,
            pending=state["pending"],
            feel=protocol.Feel(**state["feel"]),
            material=material_of(state),
            regions=regions_of(self._session.regions(segment_id)),
            pose=state["pose"],
            bounds=_box_of(state["bounds"]),
            grid=state["grid"],
            steps=steps_message(self._session.listed(state)),
        )


def _box_of(
    bounds: Bounds | None,
) -> tuple[protocol.GridPlace, protocol.GridPlace] | None:
    """Returns the bounding box of a segment in the form of a message."""
    if bounds is None:
        return None
    (x, y, z), (to_x, to_y, to_z) = bounds
    return (x, y, z), (to_x, to_y, to_z)


def _is_labelled(segment: protocol.Segment) -> bool:
    """Says whether the picture can show a segment by the labels of the scan's voxels."""
    return segment.range is None and segment.grid is None


class MadeSurface(NamedTuple):
    """How the engine makes a surface."""

    smoothing: int
    source: SurfaceSource


def _surface_of(look: SegmentAppearance) -> MadeSurface | None:
    """Returns how the surface of a segment is made; None where none is shown."""
    if not look.visible or look.shown_as == "volume":
        return None
    return MadeSurface(look.smoothing, look.surface_from)
