"""``palpate render``: files that it writes, and what it refuses."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from imageio_ffmpeg import count_frames_and_secs
from palpate.base.request import options_of
from palpate.cli.commands import run
from palpate.pictures.film import write_film
from palpate.pictures.looks import looks
from palpate.pictures.request import PictureRequest
from PIL import Image, ImageSequence


@pytest.fixture
def scan(write_image: Any) -> Path:
    z, y, x = np.ogrid[-10:10, -12:12, -14:14]
    values = np.where(x**2 + y**2 + z**2 < 70, 700, -1000).astype(np.int16)
    return Path(write_image(values, "ball.mha"))


def given(scan: Path, *options: str) -> list[str]:
    return ["render", str(scan), "--unit", "HU", "--size", "40x30", "--quality", "fast", *options]


def test_a_picture_is_written_as_png_and_jpeg(scan: Path, tmp_path: Path, capsys: Any) -> None:
    for name, kind in (("head.png", "PNG"), ("head.jpg", "JPEG")):
        file = tmp_path / name
        assert run(given(scan, "-o", str(file), "--view", "left", "--preset", "CT-Bone")) == 0
        assert f"{file}: 40x30 pixels" in capsys.readouterr().out
        with Image.open(file) as picture:
            assert (picture.size, picture.format, picture.mode) == ((40, 30), kind, "RGB")
            grey = np.asarray(picture.convert("L"))
            assert grey.min() < 40
            assert grey.max() > 120


def test_opacity_is_kept_in_png(scan: Path, tmp_path: Path) -> None:
    file = tmp_path / "clear.png"
    assert run(given(scan, "-o", str(file), "--background", "transparent")) == 0
    with Image.open(file) as picture:
        assert picture.mode == "RGBA"
        opacity = np.asarray(picture)[..., 3]
        assert opacity[0, 0] == 0
        assert opacity[15, 20] == 255


def test_a_turn_is_a_gif_of_its_time(scan: Path, tmp_path: Path) -> None:
    file = tmp_path / "turn.gif"
    assert run(given(scan, "--turntable", str(file), "--seconds", "0.5", "--fps", "16")) == 0
    with Image.open(file) as film:
        times = [frame.info["duration"] for frame in ImageSequence.Iterator(film)]
        assert film.size == (40, 30)
        assert film.info["loop"] == 0
    # equal pictures may be one that stays longer
    assert sum(times) == 500


@pytest.mark.parametrize("name", ["turn.mp4", "turn.webm"])
def test_a_turn_is_a_video(scan: Path, tmp_path: Path, name: str) -> None:
    file = tmp_path / name
    assert run(given(scan, "--turntable", str(file), "--seconds", "0.5", "--fps", "16")) == 0
    frames, seconds = count_frames_and_secs(str(file))
    assert frames == 8
    assert seconds == pytest.approx(0.5, abs=0.1)


def test_a_film_that_is_given_up_leaves_nothing(tmp_path: Path) -> None:
    file = tmp_path / "turn.gif"
    file.write_bytes(b"before")

    def pictures() -> Any:
        yield np.zeros((4, 4, 4), np.uint8)
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        write_film(pictures(), file, fps=10.0, count=2)
    assert [each.name for each in tmp_path.iterdir()] == ["turn.gif"]
    assert file.read_bytes() == b"before"


def test_segments_are_drawn(scan: Path, tmp_path: Path) -> None:
    plain, with_segment = tmp_path / "plain.png", tmp_path / "bone.png"
    assert run(given(scan, "-o", str(plain), "--preset", "ct-lung")) == 0
    assert run(given(scan, "-o", str(with_segment), "--preset", "ct-lung", "--threshold", "0")) == 0
    assert plain.read_bytes() != with_segment.read_bytes()


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ([], "no file to write given; allowed: --out FILE or --turntable FILE"),
        (["-o", "a.bmp"], "'a.bmp' given; allowed: a name with .png, .jpg, .jpeg"),
        (["--turntable", "a.avi"], "'a.avi' given; allowed: a name with .gif, .mp4, .webm"),
        (["-o", "a.png", "--view", "lefft"], "view 'lefft' given (did you mean 'left'?); allowed"),
        (["-o", "a.png", "--preset", "bones"], "preset 'bones' given"),
        (["-o", "a.png", "--size", "100"], "size '100' given; allowed: columns and rows, as 1600x"),
        (["-o", "a.png", "--samples", "0"], "samples 0 given; allowed: 1 to 64"),
        (["-o", "a.jpg", "--background", "transparent"], "background transparent given; allowed"),
        (["--turntable", "a.gif", "--fps", "60"], "fps 60 given; allowed for .gif: up to 50"),
        (["--turntable", "a.gif", "--seconds", "0"], "seconds 0 given; allowed with fps 20: 2 to"),
        (["--turntable", "a.gif", "--seconds", "nan"], "seconds nan given; allowed"),
    ],
)
def test_what_cannot_be_written_is_refused(
    scan: Path, tmp_path: Path, monkeypatch: Any, capsys: Any, options: list[str], said: str
) -> None:
    monkeypatch.chdir(tmp_path)
    before = sorted(tmp_path.iterdir())
    base = given(scan)
    if "--size" in options:
        base = ["render", str(scan)]
    assert run([*base, *options]) == 2
    told = capsys.readouterr().err
    assert said in told
    assert told.count("\n") == 1
    assert sorted(tmp_path.iterdir()) == before


def test_a_film_without_ffmpeg_is_refused_before_anything_is_read(
    capsys: Any, monkeypatch: Any, tmp_path: Path
) -> None:
    monkeypatch.setattr("palpate.pictures.film.find_spec", lambda _: None)
    assert run(["render", "gone.mha", "--turntable", str(tmp_path / "a.mp4")]) == 2
    assert "FFmpeg is not installed; allowed: .gif, or with it (`pip install 'palpate[film]'`)" in (
        capsys.readouterr().err
    )


def test_a_video_of_odd_size_is_refused(capsys: Any, monkeypatch: Any, tmp_path: Path) -> None:
    monkeypatch.setattr("palpate.pictures.film.find_spec", lambda _: object())
    options = ["--turntable", str(tmp_path / "a.mp4"), "--size", "41x30"]
    assert run(["render", "gone.mha", *options]) == 2
    assert "size 41x30 given; allowed for .mp4: even numbers" in capsys.readouterr().err


def test_the_help_names_every_quality() -> None:
    told = {each.field: each.told for each in options_of(PictureRequest)}
    assert all(name in told["quality"] for name in looks().qualities)
