"""Small pictures of the scan in each preset, for the page to choose by."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Callable
from typing import Annotated

import msgspec

from palpate.base.progress import Progress
from palpate.pictures.extent import extent_of
from palpate.pictures.look_of_scan import appearance_of
from palpate.pictures.looks import preset_called
from palpate.pictures.picture_file import png_bytes
from palpate.pictures.session_pictures import Fineness
from palpate.pictures.shown_segments import ShownBodies
from palpate.pictures.still_pictures import StillPictures
from palpate.pictures.views import camera_of
from palpate.server.job import Emit, Job
from palpate.volumes.volume import Volume

__all__ = ["PresetsRequest", "preset_pictures_job"]

SIZE = (168, 132)
"""Columns and rows: twice what the page shows, for screens of small pixels."""
MARGIN = 0.88
"""Part of the page's field of view: a small picture needs less space around the scan."""
FINENESS = Fineness(steps_per_voxel=0.5, samples=4)
"""Of a picture in which many voxels make a pixel."""
NO_SEGMENTS = ShownBodies()


class PresetsRequest(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Names of presets, as ``palpate render`` takes them."""

    presets: Annotated[list[str], msgspec.Meta(min_length=1, max_length=64)]


def preset_pictures_job(
    wanted: PresetsRequest, volume: Volume, still: Callable[[], StillPictures]
) -> Job:
    """Returns the answer with a picture of each preset in turn; leaving it ends the work.

    A line is {"kind": "preset", "preset": name, "png": picture in base64}. The scan is seen as the
    page begins, as edits have left it, without its segments.

    Args:
        wanted: What is asked for.
        volume: The scan of the session.
        still: Returns pictures that make way for those of the page.

    Raises:
        OptionError: There is no preset of a name.
    """
    for name in wanted.presets:
        preset_called(name)

    def work(progress: Progress, emit: Emit) -> None:
        seen = camera_of("first", extent_of(volume), SIZE)
        camera = msgspec.structs.replace(seen, field=MARGIN * seen.field)
        renderer = still()
        try:
            for number, name in enumerate(wanted.presets):
                progress("drawing presets", number / len(wanted.presets))
                picture = renderer.on_screen_at_rest(
                    appearance_of(volume, NO_SEGMENTS, preset=name), camera, SIZE, fineness=FINENESS
                )
                png = b64encode(png_bytes(picture)).decode("ascii")
                emit({"kind": "preset", "preset": name, "png": png})
        finally:
            renderer.close()

    return Job(work)
