"""A guarantee that is really broken is noticed: by the light of the page and by the stress test.

One engine is built with a fault in its contact (``support/planted_fault.py``), and goes the same
ways as the usual one, which must stay green there.
"""

from __future__ import annotations

import json
import re
import subprocess
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from browser import ROOT, TOOL, Browser, browser, palpate
from planted_fault import faulty_tool

pytestmark = [pytest.mark.browser, pytest.mark.long]

OUTPUT = ROOT / "tests" / "output"
EDGE = 48
"""Voxels along the scan, each 1 mm; the block fills the back half."""
MIDDLE = EDGE / 2
SURFACE = MIDDLE - 0.5
LIGHTS = ("light", "status-light")


@pytest.fixture(scope="module")
def faulty(tmp_path_factory: pytest.TempPathFactory) -> tuple[str | Path, ...]:
    """The command line of the faulty build."""
    return faulty_tool(tmp_path_factory.mktemp("planted_fault"))


@pytest.fixture(scope="module")
def block(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A scan of a flat block in air."""
    import SimpleITK

    values = np.full((EDGE, EDGE, EDGE), -1000, np.int16)
    values[:, EDGE // 2 :, :] = 1000
    path = tmp_path_factory.mktemp("block") / "block.mha"
    SimpleITK.WriteImage(SimpleITK.GetImageFromArray(values), str(path))
    return path


def colour_of(page: Browser, light: str) -> str:
    return str(page.read(f"document.querySelector('[data-testid={light}]').dataset.colour"))


def wait_for(page: Browser, colour: str) -> None:
    for light in LIGHTS:
        element = f"document.querySelector('[data-testid={light}]')"
        page.wait(f"{element}?.dataset.colour === {colour!r}")


def press_hard(page: Browser) -> None:
    """Opens the light's list, leads the hand to the block, and pulls it 16 mm into it."""
    # forces fade in for two seconds, and the light is amber meanwhile
    wait_for(page, "green")
    page.read(f"window.palpate.place({[MIDDLE, SURFACE - 5, MIDDLE]})")
    page.wait(f"Math.abs(window.palpate.state.hand[1] - {SURFACE - 5}) < 1")
    page.read("void (window.__pressed = window.palpate.state.tick)")
    page.read(f"window.palpate.hand({[MIDDLE, SURFACE + 16, MIDDLE]})")
    # half a second of pressing
    page.wait("window.palpate.state.tick >= window.__pressed + 500")


def test_the_light_turns_red_where_walls_give_way_and_says_how_often(
    block: Path, faulty: Sequence[str | Path]
) -> None:
    options = ("--threshold", "500", "--unit", "HU", "--port", "0")
    with palpate("open", block, *options, tool=faulty) as command, browser() as page:
        page.do("open", url=command.url, width=800, height=480)
        press_hard(page)
        wait_for(page, "red")
        for light in LIGHTS:
            page.shows(light, r"/^[\d ]+ failed checks?$/.test(text)")
            label = page.read(f"document.querySelector('[data-testid={light}]').ariaLabel")
            assert "red" in label
        page.do("click", testid="light")
        words = page.text("guarantees")
        assert re.search(r"failed (once|[\d ]+ times) since the start", words), words
        assert "inside of something solid" in words
        page.do("screenshot", path=str(OUTPUT / "light_red.png"))

        # the count is the engine's, and only a new start takes it back
        page.read(f"window.palpate.place({[MIDDLE, SURFACE - 5, MIDDLE]})")
        page.wait("window.palpate.state.contact === false")
        count = page.settled()["safety"]["violations"]
        assert count > 0
        page.shows("status-light", f"parseInt(text.replaceAll('\u2009', '')) === {count}")
        assert colour_of(page, "light") == "red"


def test_the_usual_build_stays_green_under_the_same_press(block: Path) -> None:
    options = ("--threshold", "500", "--unit", "HU", "--port", "0")
    with palpate("open", block, *options) as command, browser() as page:
        page.do("open", url=command.url, width=800, height=480)
        press_hard(page)
        state = page.settled()
        assert state["contact"]
        assert state["depth"] > 2.0, "as deep as walls of the other build give way"
        assert state["safety"]["violations"] == 0
        # where the servo is late, the force is off and the light is amber for a moment
        wait_for(page, "green")
        page.do("click", testid="light")
        assert "never inside of anything solid" in page.text("guarantees")


def stress(tool: Sequence[str | Path], *options: str | Path) -> tuple[int, str]:
    """Returns exit code and output of ``palpate bench stress``."""
    command = (*tool, "bench", "stress", *options)
    ended = subprocess.run(command, check=False, capture_output=True, text=True, timeout=1200)
    return ended.returncode, ended.stdout + ended.stderr


def test_stress_finds_the_fault_exits_1_and_replays_the_case(
    faulty: Sequence[str | Path], tmp_path: Path
) -> None:
    case, figures = tmp_path / "case.json", tmp_path / "figures.json"
    code, told = stress(faulty, "--moves", "20000", "--case", case, "--json", figures)
    assert code == 1
    assert "guarantee 1 violated" in told
    assert f"--replay {case}" in told
    rows: list[dict[str, Any]] = json.loads(figures.read_text(encoding="utf-8"))["rows"]
    assert {row["metric"]: row["value"] for row in rows}["violations"] == 1.0

    # again by the file alone, at the same move
    written = json.loads(case.read_text(encoding="utf-8"))
    code, told = stress(faulty, "--replay", case)
    assert code == 1
    assert f"run {written['run']} of seed {written['seed']} after {written['move']} moves" in told

    # and not with walls that hold
    code, told = stress(TOOL, "--replay", case)
    assert code == 0, told
