"""The player of scenarios on the page in a real browser: a needle's run on a real scan."""

from __future__ import annotations

import json
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from browser import ROOT, TOOL, Browser, browser, palpate

pytestmark = [pytest.mark.browser, pytest.mark.data]

OUTPUT = ROOT / "tests" / "output"
TIME = "document.querySelector('[data-testid=run-time]')"
SIZE = {"width": 1366, "height": 768}


@pytest.fixture(scope="module")
def scan(data_folder: Path) -> Path:
    """CThead."""
    return data_folder / "cthead_stanford" / "CThead.mha"


@pytest.fixture(scope="module")
def file(scan: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The run of a needle through what covers the skull."""
    path = tmp_path_factory.mktemp("run") / "needle.json"
    subprocess.run([*TOOL, "scenario", "needle-skull", scan, "--json", path], check=True)
    return path


@pytest.fixture(scope="module")
def page(scan: Path, file: Path) -> Iterator[Browser]:
    """The run on the page, with a slice beside the view."""
    with palpate("scenario", "play", file, scan) as command, browser() as opened:
        assert opened.do("open", url=command.url, **SIZE)["firstPicture"] is not None
        yield opened
        assert opened.complaints == []


def go_to(page: Browser, time: float) -> dict[str, Any]:
    """Moves the player to a time [s]; returns the tool as it is shown."""
    page.read(
        f"void ({TIME}.value = {time},"
        f" {TIME}.dispatchEvent(new Event('input', {{ bubbles: true }})))"
    )
    page.frames()
    shown: dict[str, Any] = page.read("window.palpate.played")
    return shown


def test_the_tool_stands_where_it_stood_and_its_force_is_told(page: Browser, file: Path) -> None:
    run = json.loads(file.read_text(encoding="utf-8"))
    samples = {name: np.array(column) for name, column in run["samples"].items()}
    page.shows("player", "text.includes('needle-skull')")
    for row in (0, int(np.argmax(samples["tip"])), len(run["phase"]) - 1):
        shown = go_to(page, samples["time"][row])
        there = [samples[axis][row] for axis in "xyz"]
        assert shown["proxy"] == pytest.approx(there, abs=1e-6)
        # the hand is pushed out, by as much as the run says
        inward = np.array([0.0, 1.0, 0.0])
        assert np.array(shown["force"]) @ -inward == pytest.approx(samples["force"][row], abs=1e-3)
        # slices go where the tool is
        assert page.read("window.palpate.crosshair") == pytest.approx(there, abs=0.06)
        page.shows(
            "felt", f"text.includes('{samples['force'][row]:.2f} N')".replace("-0.00", "0.00")
        )
        # the panel of touch tells what is played, and not the probe at rest
        felt = abs(samples["force"][row])
        page.shows("force", f"Math.abs(parseFloat(text) - {felt}) < 0.006")
        page.shows("status-force", f"Math.abs(parseFloat(text) - {felt}) < 0.006")
        page.shows("touched", "text.startsWith('needle-skull: ')")
        page.shows("played", "text === 'scenario'")
        assert page.read("document.querySelector('[data-testid=depth]')") is None
    page.shows("felt", "text.includes('outside')")


def test_the_tool_is_seen_in_the_picture_where_it_is(page: Browser, file: Path) -> None:
    times = json.loads(file.read_text(encoding="utf-8"))["samples"]["time"]
    page.read("window.palpate.setView('R')")
    go_to(page, times[0])
    before = page.picture(OUTPUT / "scenario_start.png")
    deep = go_to(page, times[len(times) // 2])
    after = page.picture(OUTPUT / "scenario_deep.png")
    changed = np.argwhere(np.abs(after - before).max(axis=-1) > 0.15)
    # seen from the right, y runs to the left or right by as many pixels as the tool has moved
    pixel = page.read(f"window.palpate.pixelSizeAt({deep['proxy']})")
    assert len(changed) > 30
    assert np.ptp(changed[:, 1]) > 22.0 / pixel


def test_it_plays_to_its_end_and_touch_takes_over(page: Browser, file: Path) -> None:
    end = json.loads(file.read_text(encoding="utf-8"))["samples"]["time"][-1]
    go_to(page, 0.0)
    page.read(
        "void (() => { const speed = document.querySelector('[data-testid=player] select');"
        " speed.value = '16'; speed.dispatchEvent(new Event('change', { bubbles: true })); })()"
    )
    page.do("click", testid="play")
    page.wait(f"Math.abs(window.palpate.played.time - {end}) < 1e-6")
    page.wait("document.querySelector('[data-testid=play]').ariaLabel === 'Play'")
    page.do("screenshot", path=str(OUTPUT / "scenario_player.png"))
    page.read("window.palpate.place([147, 40, 48])")
    page.wait("window.palpate.played === null")
    page.do("click", testid="play")
    page.wait("window.palpate.played !== null")


def test_the_player_keeps_to_its_room_and_its_chart_is_clicked_where_it_is(page: Browser) -> None:
    page.wait("document.querySelector('[data-testid=play]').ariaLabel === 'Play'")
    # between both panels
    page.do("resize", width=900, height=700)
    page.wait(
        "(({ scrollWidth, clientWidth }) => clientWidth < 500 && scrollWidth === clientWidth)"
        "(document.querySelector('main'))"
    )
    # enlarged with its chart, as on large screens
    enlarged = "document.documentElement.style.setProperty('--enlarged'"
    over = "document.querySelector('[data-testid=player] .u-over').getBoundingClientRect()"
    height = page.read(f"{over}.height")
    page.read(f"void {enlarged}, '1.25')")
    page.wait(f"{over}.height > 1.2 * {height}")
    page.frames()
    x, y = page.read(f"(({{ left, top, width }}) => [left + 0.25 * width, top + 20])({over})")
    page.read(
        "void document.querySelector('[data-testid=player] .chart').dispatchEvent("
        f"new PointerEvent('pointermove', {{ clientX: {x}, clientY: {y}, buttons: 1,"
        " bubbles: true }))"
    )
    page.wait(f"Math.abs({TIME}.valueAsNumber / {TIME}.max - 0.25) < 0.001")
    page.wait(
        "Math.abs(document.querySelector('[data-testid=player] .now')"
        f".getBoundingClientRect().left - {x}) < 2"
    )
    page.read(f"void {enlarged}, '')")
    page.do("resize", **SIZE)


def test_a_file_that_is_no_run_is_refused_and_the_run_stays(page: Browser, tmp_path: Path) -> None:
    wrong = tmp_path / "wrong.json"
    wrong.write_text('{"format": "other"}', encoding="utf-8")
    page.do("give", testid="run-file", path=str(wrong))
    page.wait("document.body.textContent.includes('wrong.json cannot be played')")
    page.shows("player", "text.includes('needle-skull')")


def test_a_closed_player_gives_its_place_back_and_a_file_opens_it(
    page: Browser, file: Path
) -> None:
    height = "document.querySelector('[data-testid=canvas]').clientHeight"
    with_player = page.read(height)
    page.do("click", testid="close-player")
    page.wait(f"{height} > {with_player}")
    page.do("give", testid="run-file", path=str(file))
    page.wait("window.palpate.played !== null")
