"""The engine's pictures beside those of VTK's ray caster and of vtk.js, at equal quality.

All draw the same values with the same transfer function and camera, shaded from gradients, without
what only Palpate has: shadows, ambient occlusion, clearer homogeneous tissue and segments. The
engine takes its whole light along in one more row. VTK draws the size of the page's view; vtk.js,
which draws in the browser and takes many seconds for a fine picture in software, a smaller one.
"""

from __future__ import annotations

import base64
import json
import time
from collections.abc import Callable
from dataclasses import dataclass

import msgspec
import numpy as np

from palpate.bench.page import Page
from palpate.bench.pictures.equal_quality import TimedPicture, compared, times_of
from palpate.bench.pictures.moving_quality import VIEW
from palpate.bench.pictures.on_page import screen_from_linear
from palpate.bench.pictures.vtk_caster import VtkCaster
from palpate.pictures.appearance import Appearance
from palpate.pictures.camera import Camera
from palpate.pictures.extent import extent_of
from palpate.pictures.look_of_scan import appearance_of
from palpate.pictures.session_pictures import Fineness, SessionPictures
from palpate.pictures.shown_segments import bodies_of
from palpate.pictures.views import camera_of
from palpate.session.session import Session
from palpate.volumes.scene import Scene
from palpate.volumes.volume import Volume

__all__ = ["beside_vtk", "beside_vtk_js"]


@dataclass(frozen=True)
class Engine:
    """The engine before one scan, without segments."""

    pictures: SessionPictures
    look: Appearance
    camera: Camera
    size: tuple[int, int]

    @classmethod
    def of(cls, session: Session, volume: Volume, size: tuple[int, int]) -> Engine:
        """Returns it with the first view and look of the page."""
        look = appearance_of(volume, bodies_of(Scene(volume)))
        camera = camera_of("first", extent_of(volume), size)
        return cls(SessionPictures(session), look, camera, size)

    def plain(self) -> Engine:
        """Returns it with the light that other renderers have, too."""
        light = msgspec.structs.replace(self.look.lighting, edges=0.0, occlusion=0.0, shadow=0.0)
        look = msgspec.structs.replace(self.look, lighting=light)
        return Engine(self.pictures, look, self.camera, self.size)

    def draw(self, steps: float) -> TimedPicture:
        """Draws with so many steps for each smallest voxel edge."""
        began = time.perf_counter()
        picture = self.pictures.draw(
            self.look,
            self.camera,
            self.size,
            fineness=Fineness(steps_per_voxel=steps),
            number=None,
        )
        seconds = time.perf_counter() - began
        assert picture is not None  # noqa: S101  # without a number none is given up
        return TimedPicture(seconds, screen_from_linear(picture.colours[..., :3]))


def beside_vtk(volume: Volume, *, rounds: int, size: tuple[int, int] = VIEW) -> dict[str, float]:
    """Compares the engine with VTK's ray caster.

    Raises:
        OptionError: VTK is not installed, or finds no OpenGL.
    """
    with Session(Scene(volume)) as session:
        engine = Engine.of(session, volume, size)
        plain = engine.plain()
        caster = VtkCaster(volume, plain.look, plain.camera, size=size)
        found = compared(plain.draw, caster.draw, rounds=rounds).report()
        (whole,) = times_of([lambda: engine.draw(1.0).seconds], rounds)
    return found | {"whole": whole}


def beside_vtk_js(
    volume: Volume, page: Page, script: str, *, rounds: int, size: tuple[int, int]
) -> dict[str, float]:
    """Compares the engine with vtk.js in a page that shows the same scan.

    Args:
        volume: The scan.
        page: A page that does nothing else.
        script: What draws with vtk.js, as the source tree builds it.
        rounds: Number of timed rounds.
        size: Columns and rows.
    """
    with Session(Scene(volume)) as session:
        plain = Engine.of(session, volume, size).plain()
        page.read("void window.palpate.suspendDrawing(true)")
        page.read(f"void (() => {{ {script} }})()")
        page.read(f"void window.vtkDoor.open({_scene(plain)})")
        return compared(plain.draw, _drawing_of(page, size), rounds=rounds).report()


def _scene(engine: Engine) -> str:
    """Returns JavaScript of what vtk.js is to draw: the page's values, and the engine's view."""
    camera = engine.camera
    eye = np.array(camera.target) + camera.distance * np.array(camera.back)
    points = [
        {
            "value": value,
            # it blends colours as the screen has them
            "colour": screen_from_linear(np.array(colour)).tolist(),
            "extinction": engine.look.density * extinction,
        }
        for value, colour, extinction in engine.look.transfer
    ]
    seen = {
        "eye": eye.tolist(),
        "target": camera.target,
        "up": camera.up,
        "field": camera.field,
        "points": points,
    }
    return f"{{...window.palpate.bench.scene(), ...{json.dumps(seen)}}}"


def _drawing_of(page: Page, size: tuple[int, int]) -> Callable[[float], TimedPicture]:
    columns, rows = size

    def draw(steps: float) -> TimedPicture:
        wish = f"{{width: {columns}, height: {rows}, stepsPerVoxel: {steps}}}"
        milliseconds, bytes_ = page.read(DRAWN % wish)
        screen = np.frombuffer(base64.b64decode(bytes_), np.uint8).reshape(rows, columns, 3)
        return TimedPicture(milliseconds / 1e3, screen / 255.0)

    return draw


DRAWN = """(() => {
  const { milliseconds, colours } = window.vtkDoor.draw("shaded", %s);
  let bytes = "";
  for (const value of colours) bytes += String.fromCharCode(Math.round(255 * value));
  return [milliseconds, btoa(bytes)];
})()"""
"""Draws with vtk.js: the time [ms], and the bytes of the picture in base 64."""
