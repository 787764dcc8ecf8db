"""Pictures as the page shows them while the view moves, against sharp ones of the same cameras.

Speed must not be bought by fewer steps, less light or fewer pixels than is told. The engine draws
scans as they are opened: in haste, at the coarsest divisor that was seen on the page, as large as
there; and of the same cameras, around the body, with the averaged rays of a view at rest. The worst
of them counts. Pixels around the body, where both show the ground, count as well, as on the page.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from palpate.bench.pictures.on_page import on_page
from palpate.bench.pictures.ssim import grey_of, structural_similarity
from palpate.pictures.appearance import Appearance
from palpate.pictures.camera import Camera
from palpate.pictures.extent import extent_of
from palpate.pictures.look_of_scan import appearance_of
from palpate.pictures.looks import looks
from palpate.pictures.session_pictures import Fineness, SessionPictures
from palpate.pictures.shown_segments import bodies_of
from palpate.pictures.views import camera_of, turned
from palpate.session.session import Session
from palpate.volumes.scene import Scene

__all__ = ["MOVING", "VIEW", "Drawn", "likeness", "moving_quality"]

VIEW = (806, 696)
"""The 3-D view in a window of 1366 × 768 [pixels]."""
MOVING = Fineness(steps_per_voxel=1.0, jitter=True, haste=True)
"""As the server draws while the view moves; a test holds both together."""


@dataclass(frozen=True)
class Drawn:
    """A running session's pictures of a scene, as the page shows it first."""

    pictures: SessionPictures
    look: Appearance
    cameras: list[Camera]
    size: tuple[int, int]

    @classmethod
    def of(
        cls, session: Session, scene: Scene, *, views: int, size: tuple[int, int] = VIEW
    ) -> Drawn:
        """Returns them with a number of cameras around the body, from that of the page on."""
        look = appearance_of(scene.volume, bodies_of(scene))
        extent = extent_of(scene.volume)
        around = turned(camera_of("first", extent, size), extent, size, count=views)
        return cls(SessionPictures(session), look, around, size)

    def draw(
        self, camera: Camera, fineness: Fineness, *, divisor: float = 1.0
    ) -> NDArray[np.float32]:
        """Returns linear colours and opacity of a picture of a divided resolution."""
        columns, rows = (math.ceil(edge / divisor) for edge in self.size)
        picture = self.pictures.draw(
            self.look, camera, (columns, rows), fineness=fineness, number=None
        )
        assert picture is not None  # noqa: S101  # without a number none is given up
        return picture.colours


def moving_quality(
    scene: Scene, *, divisor: float, views: int, size: tuple[int, int] = VIEW
) -> dict[str, float]:
    """Returns how like moving pictures of a scene are to the sharp ones, in the worst view.

    Args:
        scene: As it is opened.
        divisor: Of the resolution while the view moves.
        views: Number of cameras around the body.
        size: Columns and rows of the view.
    """
    resting = looks().qualities["balanced"]
    sharp = Fineness(steps_per_voxel=resting.steps_per_voxel, samples=resting.passes)
    similar, errors = [], []
    with Session(scene) as session:
        drawn = Drawn.of(session, scene, views=views, size=size)
        for camera in drawn.cameras:
            moving = on_page(drawn.draw(camera, MOVING, divisor=divisor), size)
            similarity, error = likeness(moving, on_page(drawn.draw(camera, sharp), size))
            similar.append(similarity)
            errors.append(error)
    return {"divisor": divisor, "ssim": min(similar), "error": max(errors)}


def likeness(one: NDArray[np.float64], other: NDArray[np.float64]) -> tuple[float, float]:
    """Returns structural similarity and mean difference of pictures with values from 0 to 1."""
    return structural_similarity(grey_of(one), grey_of(other)), float(np.abs(one - other).mean())
