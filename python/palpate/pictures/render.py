"""Pictures of scans and scenes, drawn by the engine: no display, browser or graphics card."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor

import numpy as np
from numpy.typing import NDArray

from palpate import _core
from palpate.base.errors import OptionError
from palpate.pictures.camera import Camera
from palpate.pictures.choices import Background, Size, View, require_drawable, require_view
from palpate.pictures.extent import extent_of
from palpate.pictures.felt_look import SOLIDS, look_beside
from palpate.pictures.look_of_scan import GREY, appearance_of, require_mode
from palpate.pictures.looks import ANATOMY, Quality, looks
from palpate.pictures.shown_segments import bodies_of
from palpate.pictures.transfer import linear_from_hex
from palpate.pictures.views import camera_of, turned
from palpate.session.engine import option_errors
from palpate.volumes.scene import Scene
from palpate.volumes.volume import Volume

__all__ = ["DrawnScene", "render"]

UNHEARD = 2**63
"""A number above those of all pictures."""


class DrawnScene:
    """A scene that is prepared to be drawn, from any side."""

    def __init__(
        self,
        scene: Scene | Volume,
        *,
        mode: str = "shaded",
        preset: str = ANATOMY,
        touchable_only: bool = False,
    ) -> None:
        """Reads each value once.

        Args:
            scene: A scan, or one with segments.
            mode: As for ``render``.
            preset: As for ``render``.
            touchable_only: As for ``render``.

        Raises:
            OptionError: A name is not known, or there are too many voxels.
        """
        scene = Scene(scene) if isinstance(scene, Volume) else scene
        if not isinstance(scene, Scene):
            raise OptionError(
                f"scene of type {type(scene).__name__} given; allowed: a Scene or a Volume"
            )
        volume = scene.volume
        known_mode = require_mode(mode)
        only = touchable_only and known_mode in SOLIDS
        bodies = bodies_of(scene, touchable_only=only)
        self.extent = extent_of(volume)
        self._bends = mode not in GREY
        alone = appearance_of(volume, bodies, mode=known_mode, preset=preset)
        appearance = look_beside(alone, scene, touchable_only=only)
        with option_errors():
            self._renderer = _core.Renderer(volume._internal, bodies.voxels)  # noqa: SLF001
            self._renderer.set_surfaces(bodies.triangles)
            self._renderer.set_appearance(appearance)

    def camera(self, view: View | Camera, size: Size, *, orthographic: bool = False) -> Camera:
        """Returns the camera of a view.

        Raises:
            OptionError: There is no view of this name.
        """
        if isinstance(view, Camera):
            return view
        known = require_view(view)
        return camera_of(known, self.extent, size, orthographic=orthographic)

    def around(self, camera: Camera, size: Size, count: int) -> list[Camera]:
        """Returns cameras once around the body, beginning with one."""
        return turned(camera, self.extent, size, count=count)

    def draw(
        self,
        camera: Camera,
        size: Size,
        *,
        quality: Quality = "balanced",
        samples: int | None = None,
        background: Background = "dark",
    ) -> NDArray[np.uint8]:
        """Draws a picture; arguments and what is returned are those of ``render``.

        Raises:
            OptionError: A number or a name is not allowed.
        """
        require_drawable(size, quality=quality, samples=samples, background=background)
        fineness = looks().qualities[quality]
        with option_errors(), ThreadPoolExecutor(1) as pool:
            drawing = pool.submit(
                self._renderer.draw,
                camera,
                size,
                steps_per_voxel=fineness.steps_per_voxel,
                samples=fineness.passes if samples is None else samples,
                number=0,
            )
            try:
                picture = drawing.result()
            except KeyboardInterrupt:
                # the engine knows nothing of Ctrl+C
                self._renderer.supersede(UNHEARD)
                raise
        if picture is None:
            raise RuntimeError("the picture was given up")
        return picture.on_screen(_ground(background), bends=self._bends)


def render(
    scene: Scene | Volume,
    *,
    view: View | Camera = "first",
    size: Size = (800, 800),
    mode: str = "shaded",
    preset: str = ANATOMY,
    quality: Quality = "balanced",
    samples: int | None = None,
    background: Background = "dark",
    orthographic: bool = False,
    touchable_only: bool = False,
) -> NDArray[np.uint8]:
    """Draws a picture of a scan, as the page shows it.

    The engine draws it, on all cores: without a display, a browser or a graphics card.

    Args:
        scene: A scan, or one with segments; visible segments are bodies or surfaces in their
            colours, as they are shown. Beside a threshold of bone that can be touched, other bone
            of a CT is only hinted at, as on the page.
        view: Side on which the viewer stands: "anterior", "posterior", "left", "right", "superior"
            or "inferior" of the patient, "first" for the view that the page begins with, or a
            ``palpate.Camera``.
        size: Columns and rows.
        mode: How values along a ray become one colour: "shaded", "composite", "absorption",
            "emission", "mip", "minip", "average" or "iso" (Max, IEEE TVCG 1, 1995).
        preset: Transfer function: "bone-in-tissue", or a preset of the page such as "ct-bone".
        quality: "fast", "balanced", "fine" or "still", as on the page.
        samples: Rays per pixel; by default those of the quality, 4 for "balanced".
        background: "dark" as on the page, "white" or "transparent".
        orthographic: Whether the projection is parallel; of views by name.
        touchable_only: Show only what can be touched: nothing of the scan beside its segments. In
            "shaded", "composite" and "iso"; in the other modes all are values.

    Returns:
        sRGB and opacity, shape [rows, columns, 4]; rows from the top. Colours are not multiplied by
        opacity.

    Raises:
        OptionError: A name is not known, or a number is not allowed; the message tells what is.
    """
    require_drawable(size, quality=quality, samples=samples, background=background)
    drawn = DrawnScene(scene, mode=mode, preset=preset, touchable_only=touchable_only)
    camera = drawn.camera(view, size, orthographic=orthographic)
    return drawn.draw(camera, size, quality=quality, samples=samples, background=background)


def _ground(
    background: Background,
) -> tuple[tuple[float, float, float], tuple[float, float, float]] | None:
    """Returns linear colours in the middle and at the edge."""
    if background == "transparent":
        return None
    if background == "white":
        return (1.0, 1.0, 1.0), (1.0, 1.0, 1.0)
    ground = looks().ground
    return linear_from_hex(ground.centre), linear_from_hex(ground.edge)
