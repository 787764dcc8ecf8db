"""The options of ``palpate render``, and of pictures in recipes."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from palpate.base.errors import OptionError
from palpate.base.file_suffixes import FILM_SUFFIXES, PICTURE_SUFFIXES
from palpate.base.progress import Progress, silent
from palpate.base.request import Request, words
from palpate.pictures.appearance import Mode
from palpate.pictures.choices import Background, Size, View, require_drawable
from palpate.pictures.looks import ANATOMY, Quality, preset_called

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from palpate.pictures.camera import Camera
    from palpate.pictures.render import DrawnScene
    from palpate.volumes.scene import Scene

__all__ = ["PictureRequest"]

MOST_FRAMES = 3600
"""Of a film; a minute of 60 pictures a second."""


class PictureRequest(Request, frozen=True, kw_only=True):
    """What is drawn of a scan, and where it goes."""

    out: Annotated[
        Path | None,
        words("Picture to write (.png, .jpg).", form="FILE", short="o", writes=PICTURE_SUFFIXES),
    ] = None
    turntable: Annotated[
        Path | None,
        words("Film of one turn to write (.gif, .mp4, .webm).", form="FILE", writes=FILM_SUFFIXES),
    ] = None
    view: Annotated[
        View,
        words(
            "Side of the patient that is seen: anterior, posterior, left, right, superior, "
            "inferior; or first, as the page begins."
        ),
    ] = "first"
    preset: Annotated[
        str, words("Transfer function: bone-in-tissue, or a preset of the page such as ct-bone.")
    ] = ANATOMY
    mode: Annotated[
        Mode,
        words(
            "How it is drawn: shaded, composite, absorption, emission, mip, minip, average, iso."
        ),
    ] = "shaded"
    size: Annotated[str, words("Columns and rows of pixels.", form="WxH")] = "800x800"
    quality: Annotated[
        Quality | None,
        words("How fine: fast, balanced, fine or still; by default balanced, and fast for a film."),
    ] = None
    samples: Annotated[
        int | None, words("Rays per pixel; by default by the quality: 1, 4, 16 or 24.")
    ] = None
    background: Annotated[Background, words("Behind the scan: dark, white or transparent.")] = (
        "dark"
    )
    orthographic: Annotated[bool, words("Draw in parallel projection.")] = False
    touchable_only: Annotated[
        bool,
        words("Show only what can be touched: nothing of the scan beside its segments."),
    ] = False
    seconds: Annotated[float, words("Time of the turn of a film in s.")] = 6.0
    fps: Annotated[float, words("Pictures of a film per second, 1 to 60.")] = 20.0

    def check(self) -> None:
        """Refuses what could not be drawn or written, whatever the scan is.

        Raises:
            OptionError: Nothing is to be written, or an option is not allowed.
        """
        if self.out is None and self.turntable is None:
            raise OptionError("no file to write given; allowed: `out=FILE` or `turntable=FILE`")
        preset_called(self.preset)
        require_drawable(
            self._pixels,
            quality=self.quality or "fast",
            samples=self.samples,
            background=self.background,
        )
        jpeg = self.out is not None and self.out.suffix.lower() != ".png"
        if self.background == "transparent" and (jpeg or self.turntable is not None):
            raise OptionError("background transparent given; allowed for .png only")
        if not 1.0 <= self.fps <= 60.0:
            raise OptionError(f"fps {self.fps:g} given; allowed: 1 to 60")
        if not 2.0 <= self.seconds * self.fps <= MOST_FRAMES:
            raise OptionError(
                f"seconds {self.seconds:g} given; allowed with fps {self.fps:g}: 2 to "
                f"{MOST_FRAMES} pictures"
            )
        if self.turntable is not None:
            from palpate.pictures.film import check_film

            check_film(self.turntable, self._pixels, fps=self.fps)

    def write(self, scene: Scene, *, progress: Progress = silent) -> list[Path]:
        """Draws and writes what is asked for.

        Returns:
            The files that were written.

        Raises:
            OptionError: The scan cannot be drawn.
            OSError: The disk refuses a file.
        """
        from palpate.pictures.picture_file import write_picture
        from palpate.pictures.render import DrawnScene

        progress("preparing the picture", None)
        drawn = DrawnScene(
            scene, mode=self.mode, preset=self.preset, touchable_only=self.touchable_only
        )
        camera = drawn.camera(self.view, self._pixels, orthographic=self.orthographic)
        written = []
        if self.out is not None:
            progress(f"drawing {self.out.name}", None)
            picture = drawn.draw(
                camera,
                self._pixels,
                quality=self.quality or "balanced",
                samples=self.samples,
                background=self.background,
            )
            write_picture(picture, self.out)
            written.append(self.out)
        if self.turntable is not None:
            self._write_turn(drawn, camera, progress=progress)
            written.append(self.turntable)
        return written

    def _write_turn(self, drawn: DrawnScene, camera: Camera, *, progress: Progress) -> None:
        from palpate.pictures.film import write_film

        path, count = self.turntable, self._frames
        assert path is not None  # noqa: S101  # whoever calls looked

        def pictures() -> Iterator[NDArray[np.uint8]]:
            for number, each in enumerate(drawn.around(camera, self._pixels, count)):
                progress(f"drawing {path.name}", number / count)
                yield drawn.draw(
                    each,
                    self._pixels,
                    quality=self.quality or "fast",
                    samples=self.samples,
                    background=self.background,
                )

        write_film(pictures(), path, fps=self.fps, count=count)

    @property
    def _pixels(self) -> Size:
        """Columns and rows.

        Raises:
            OptionError: The size is written otherwise.
        """
        found = re.fullmatch(r"(\d{1,6})\s*[x×]\s*(\d{1,6})", self.size.strip())
        if found is None:
            raise OptionError(f"size {self.size!r} given; allowed: columns and rows, as 1600x1200")
        return int(found[1]), int(found[2])

    @property
    def _frames(self) -> int:
        """Pictures of a film."""
        return round(self.seconds * self.fps)
