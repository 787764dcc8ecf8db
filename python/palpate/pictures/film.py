"""Films of pictures in turn: GIF by Pillow; MP4 and WebM by FFmpeg, which is an extra."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import closing
from importlib.util import find_spec
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from palpate.base.errors import OptionError
from palpate.base.whole_file import whole_file
from palpate.pictures.picture_file import image_of

__all__ = ["check_film", "write_film"]

NOT_INSTALLED = "FFmpeg is not installed; allowed: .gif, or with it (`pip install 'palpate[film]'`)"
CODECS = {".mp4": "libx264", ".webm": "libvpx-vp9"}
LOSSES = {".mp4": ["-crf", "18"], ".webm": ["-crf", "30", "-b:v", "0"]}
"""Constant rate factors with which hardly any loss is seen."""

MOST_OF_GIF = 50.0
"""Pictures per second; players show a GIF with more slowly."""


def check_film(path: Path, size: tuple[int, int], *, fps: float) -> None:
    """Refuses a film that could not be written, before anything is drawn.

    Raises:
        OptionError: What writes it is not installed, or its size or rate does not fit the format.
    """
    if path.suffix.lower() == ".gif":
        if fps > MOST_OF_GIF:
            raise OptionError(f"fps {fps:g} given; allowed for .gif: up to {MOST_OF_GIF:g}")
        return
    if find_spec("imageio_ffmpeg") is None:
        raise OptionError(f"{path.name!r} given, but {NOT_INSTALLED}")
    if size[0] % 2 or size[1] % 2:
        raise OptionError(
            f"size {size[0]}x{size[1]} given; allowed for {path.suffix}: even numbers"
        )


def write_film(
    pictures: Iterable[NDArray[np.uint8]], path: Path, *, fps: float, count: int
) -> None:
    """Writes a film that begins again at its end where a player allows it.

    Args:
        pictures: Of one size, each of shape [rows, columns, 4]; their opacity is not kept.
        path: The new file; its name tells the format.
        fps: Pictures per second.
        count: How many there are.

    Raises:
        OSError: The disk or FFmpeg refuses it.
    """
    with whole_file(path) as unfinished:
        if path.suffix.lower() == ".gif":
            _write_gif(iter(pictures), unfinished, times=_times(count, fps))
        else:
            _write_video(iter(pictures), unfinished, fps=fps)


def _times(count: int, fps: float) -> list[int]:
    """Returns how long each picture stays [ms]: whole hundredths of a second, as GIF counts."""
    return [10 * (round(100 * (i + 1) / fps) - round(100 * i / fps)) for i in range(count)]


def _write_gif(pictures: Iterator[NDArray[np.uint8]], path: Path, *, times: list[int]) -> None:
    frames = (image_of(each).convert("RGB") for each in pictures)
    first = next(frames)
    # one palette for all: another for each would flicker
    palette = first.quantize(256)
    rest = (each.quantize(palette=palette) for each in frames)
    with path.open("wb") as file:
        palette.save(file, "GIF", save_all=True, append_images=rest, duration=times, loop=0)


def _write_video(pictures: Iterator[NDArray[np.uint8]], path: Path, *, fps: float) -> None:
    from imageio_ffmpeg import write_frames

    first = next(pictures)
    rows, columns = first.shape[:2]
    suffix = path.suffix.lower()
    writer = write_frames(
        str(path),
        (columns, rows),
        pix_fmt_in="rgba",
        fps=fps,
        codec=CODECS[suffix],
        quality=None,
        macro_block_size=1,
        output_params=LOSSES[suffix],
    )
    with closing(writer):
        writer.send(None)
        writer.send(np.ascontiguousarray(first))
        for each in pictures:
            writer.send(np.ascontiguousarray(each))
