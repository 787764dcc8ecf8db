"""Messages on pictures of the 3-D view that the engine draws, for pages that are slower at it.

Structures of a look and a camera have the fields that ``_core.Renderer`` reads, as those of
``palpate.pictures`` do. Colours are linear here.
"""

from __future__ import annotations

from typing import Annotated, Literal

import msgspec

from palpate.pictures.appearance import Mode, Shown, Tint, Turns
from palpate.protocol.types import (
    ClipPlanes,
    LinearColour,
    Message,
    SegmentId,
    Share,
    Value,
    Vector,
)

__all__ = [
    "DrawPicture",
    "DrawnPicture",
    "LookLight",
    "LookSecond",
    "LookSegment",
    "LookSurface",
    "PictureFailed",
    "PictureLook",
    "PictureOver",
    "PicturePart",
    "PictureTaken",
    "SeenFrom",
]

Length = Annotated[float, msgspec.Meta(gt=0.0, le=1e6)]
Factor = Annotated[float, msgspec.Meta(ge=0.0, le=1e6)]
Points = Annotated[
    list[tuple[Value, LinearColour, Factor]], msgspec.Meta(min_length=2, max_length=4096)
]
Gradient = Annotated[float, msgspec.Meta(gt=0.0, le=1e9)]
CellEdge = Annotated[float, msgspec.Meta(ge=0.1, le=1e4)]
PixelCount = Annotated[int, msgspec.Meta(ge=1, le=8192)]


class SeenFrom(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A camera; see ``palpate.pictures.camera`` and ``camera.ts``."""

    target: Vector
    distance: Length
    right: Vector
    up: Vector
    back: Vector
    field: Annotated[float, msgspec.Meta(gt=0.0, lt=3.14)]
    parallel: Length | None
    aside: Annotated[float, msgspec.Meta(ge=-1.0, le=1.0)]


class LookLight(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Factors on the light of the picture; see ``palpate.pictures.appearance``."""

    ambient: Factor
    diffuse: Factor
    specular: Factor
    shininess: Factor
    edges: Share
    occlusion: Share
    shadow: Share


class LookSegment(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A segment that does not look as the scan does.

    ``range`` has the limits of the threshold that made it, both included; null where its voxels
    alone tell.
    """

    id: SegmentId
    range: tuple[Value, Value] | None
    edited: bool
    shown: Shown
    colour: LinearColour
    ambient: Factor
    specular: Factor


class LookSurface(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A segment whose surface of triangles is drawn, where it stands by then."""

    id: SegmentId
    colour: LinearColour
    opacity: Annotated[float, msgspec.Meta(gt=0.0, le=1.0)]
    wireframe: bool
    ambient: Factor
    specular: Factor


class LookSecond(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """How the second scan is drawn through the first, as ``PictureLook`` has it of that.

    ``tint`` are its colours in modes of grey, ``opacity`` theirs and that of its iso-surface. By
    ``turns`` both are seen, or one of them in cells of an edge of ``cells`` [mm], or the second.
    """

    density: Factor
    transfer: Points
    edge_gradient: Gradient
    window: tuple[Value, Value]
    iso_value: Value
    iso_colour: LinearColour
    tissue_from: Value
    tint: Tint
    opacity: Share
    turns: Turns
    cells: CellEdge


class PictureLook(Message, frozen=True, tag="picture_look"):
    """Sets how the engine's pictures for this page look from now on: all but the camera.

    ``transfer`` has value, colour and extinction [1/mm] of each point; ``window`` width and middle;
    ``slab`` is in mm; ``clip`` has planes, a unit normal toward what is cut away, and
    ``normal · point`` of their points [mm]. ``second`` is null where the second scan is not shown.
    """

    mode: Mode
    density: Factor
    transfer: Points
    edge_gradient: Gradient
    window: tuple[Value, Value]
    iso_value: Value
    iso_colour: LinearColour
    tissue_from: Value
    slab: Length | None
    lighting: LookLight
    segments: Annotated[list[LookSegment], msgspec.Meta(max_length=255)]
    surfaces: Annotated[list[LookSurface], msgspec.Meta(max_length=255)]
    clip: ClipPlanes
    second: LookSecond | None


class PictureOver(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The picture that a page shows in the same view, size and look; see ``DrawnPicture``."""

    state: Annotated[int, msgspec.Meta(ge=0)]
    divisor: Annotated[float, msgspec.Meta(ge=1.0, le=64.0)]


class DrawPicture(Message, frozen=True, tag="draw_picture"):
    """Requests pictures of the 3-D view in the last ``PictureLook``; see ``DrawnPicture``.

    One at once, with what each of the ``cameras`` sees: two eyes that look straight ahead, or one.
    Where the view does not move (``moving``) finer ones follow, until another is
    requested. ``size`` has columns and rows [pixels]. The last picture is the mean of ``samples``,
    of ``steps_per_voxel`` steps for each smallest voxel edge. With ``jitter`` rays start at
    different fractions of a step. Where the page shows this view already (``over``) and a part of
    it was edited since, that part comes first.
    """

    number: Annotated[int, msgspec.Meta(ge=0)]
    cameras: Annotated[list[SeenFrom], msgspec.Meta(min_length=1, max_length=2)]
    size: tuple[PixelCount, PixelCount]
    moving: bool
    over: PictureOver | None
    steps_per_voxel: Annotated[float, msgspec.Meta(ge=0.1, le=16.0)]
    samples: Annotated[int, msgspec.Meta(ge=1, le=64)]
    jitter: bool


class PictureTaken(Message, frozen=True, tag="picture_taken"):
    """Tells that the next ``PicturePart`` has arrived, by which the engine measures the way."""


class DrawnPicture(Message, frozen=True, tag="drawn_picture"):
    """A picture for the ``DrawPicture`` with this number; ``finished``: it is the last one.

    ``size`` has columns and rows: those requested, divided by ``divisor``, rounded up. Where it is
    a ``part`` of such a picture, it has its first column and row there, and is to be put over one
    of the same view that shows state ``over`` or a later one. ``state`` is the number of what it
    shows, which rises with every change of that. Rows from the upper edge, little-endian.
    ``milliseconds`` is how long it was drawn. With several ``eyes`` rows of colours and depths are
    those of all of them, one eye after the other; ``size`` is that of each.

    ``coding`` "raw": ``colours`` are linear RGB multiplied by opacity, and opacity, as float16,
    shape [rows, columns, 4]; ``depths`` distances from the eye along the direction of view as
    uint16 from ``nearest`` (0) to ``farthest`` (32766) [mm], 32768 more where all of a ray is seen
    through: there what is seen lies about so deep; 65535 where nothing is; shape [rows, columns].

    ``coding`` "webp": ``colours`` is a WebP picture of twice as many rows, above the same RGB
    divided by ``brightest``, as sRGB, below opacity as grey. ``depths`` are those of every
    ``depth_every``-th pixel of every ``depth_every``-th row, less that to their left (modulo
    65536); first all low bytes, then all high ones, deflated (RFC 1950).
    """

    number: int
    size: tuple[int, int]
    eyes: int
    part: tuple[int, int] | None
    over: int | None
    state: int
    divisor: float
    samples: int
    finished: bool
    milliseconds: float
    coding: Literal["raw", "webp"]
    colours: bytes
    brightest: float
    depths: bytes
    depth_every: int
    nearest: float
    farthest: float


class PicturePart(Message, frozen=True, tag="picture_part"):
    """Bytes of a packed ``DrawnPicture``, so that states need not wait for all of it.

    Parts of one ``serial`` come in order; ``last`` ends them. Once a part of another comes, the
    rest of those before never does.
    """

    serial: int
    last: bool
    packed: bytes


class PictureFailed(Message, frozen=True, tag="picture_failed"):
    """Tells that the pictures of the ``DrawPicture`` with this number do not come, and why."""

    number: int
    text: str
