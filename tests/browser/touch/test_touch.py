"""Touch on the page in a real browser: settings, what is seen, heard, felt and recorded.

The scan is a flat block, written here: where its surface is, and what must be felt on it, is
known without any code of Palpate.
"""

from __future__ import annotations

import signal
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from browser import ROOT, Browser, Command, browser, free_port, palpate
from numpy.typing import NDArray
from palpate.session.recording import Recording

pytestmark = pytest.mark.browser

OUTPUT = ROOT / "tests" / "output"
EDGE = 48
"""Voxels along the scan, each 1 mm."""
SURFACE = 23.5
"""Where the block begins along y [mm]; it fills everything from there to the back."""
MIDDLE = EDGE / 2
OPTIONS = ("--threshold", "500", "--unit", "HU")
PAD = (
    "(() => { const buttons = () => Array.from({length: 17}, () => ({pressed: false, value: 0}));"
    " const pad = {id: 'Test Pad (Vendor: 045e)', index: 0, connected: true, timestamp: 1,"
    " mapping: 'standard', axes: [0, 0, 0, 0], buttons: buttons(), vibrationActuator: {"
    " playEffect: (kind, effect) => { window.__effects.push({kind, ...effect});"
    " return Promise.resolve('complete'); },"
    " reset: () => { window.__effects.push({kind: 'reset'}); return Promise.resolve(); } } };"
    " window.__effects = []; window.__pad = pad;"
    " Object.defineProperty(navigator, 'getGamepads', {configurable: true,"
    " value: () => window.__pad === null ? [] : [window.__pad]});"
    " window.dispatchEvent(new Event('gamepadconnected')); })()"
)
"""Plugs a gamepad in that remembers what its motors were told."""


@pytest.fixture(scope="module")
def block(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A scan of a flat block in air."""
    import SimpleITK

    values = np.full((EDGE, EDGE, EDGE), -1000, np.int16)
    values[:, EDGE // 2 :, :] = 1000
    path = tmp_path_factory.mktemp("block") / "block.mha"
    SimpleITK.WriteImage(SimpleITK.GetImageFromArray(values), str(path))
    return path


@pytest.fixture(scope="module")
def command(block: Path) -> Iterator[Command]:
    """The block, served."""
    with palpate("open", block, *OPTIONS, "--port", "0") as started:
        yield started


@pytest.fixture(scope="module")
def opened(command: Command) -> Iterator[Browser]:
    """The block on the page, seen from before."""
    with browser() as page:
        assert page.do("open", url=command.url, width=800, height=480)["firstPicture"] is not None
        page.read("window.palpate.setView('A')")
        yield page


@pytest.fixture
def page(opened: Browser) -> Iterator[Browser]:
    """The page, with the probe before the block, nothing pressed and touch as it began."""
    reset(opened)
    leave(opened)
    yield opened
    assert opened.complaints == []


def reset(page: Browser) -> None:
    """Gives touch its defaults back."""
    if not page.read("document.querySelector('[data-testid=reset-touch]').disabled"):
        page.do("click", testid="reset-touch")


def leave(page: Browser) -> None:
    """Brings probe and hand before the block."""
    page.read(f"window.palpate.place({[MIDDLE, SURFACE - 10, MIDDLE]})")
    page.all_done()
    page.wait(f"Math.abs(window.palpate.state.hand[1] - {SURFACE - 10}) < 1")
    page.wait("window.palpate.state.contact === false")


def press(page: Browser, *, depth: float = 3.0, x: float = MIDDLE) -> dict[str, Any]:
    """Pulls the hand into the block and returns the state once everything rests."""
    wanted = [x, SURFACE + depth, MIDDLE]
    page.read(f"window.palpate.hand({wanted})")
    # the device takes it in its own thread, which a busy machine may hold up while the servo runs
    page.wait(f"window.palpate.state.hand.every((c, i) => Math.abs(c - {wanted}[i]) < 0.01)")
    page.wait("window.palpate.state.contact")
    return page.settled()


def force(state: dict[str, Any]) -> NDArray[np.float64]:
    return np.array(state["force"])


def stiffness_felt(page: Browser, stiffness: float, *, within: float) -> None:
    """Waits until the force over the depth is a stiffness [N/mm], to a share of it."""
    page.wait(
        "(() => { const { force, depth } = window.palpate.state;"
        f" return Math.abs(Math.hypot(...force) / depth / {stiffness} - 1) < {within}; }})()"
    )


def held(page: Browser, name: str) -> Any:
    """Returns a setting as the engine holds it, once the page shows that."""
    page.all_done()
    page.wait("window.palpate.settingsHold")
    return page.read(f"window.palpate.settings.{name}")


# --- settings while touching ------------------------------------------------------------


def test_stiffness_changes_the_force_while_touching(page: Browser) -> None:
    soft = press(page)
    ratio = np.linalg.norm(force(soft)) / soft["depth"]
    assert ratio == pytest.approx(held(page, "stiffness"), rel=0.02)

    page.do("slide", testid="stiffness", value=float(np.log(1.8)))
    # a step of the slider is one percent, its thumb can be set to a pixel: two percent
    stiffer = held(page, "stiffness")
    assert stiffer == pytest.approx(1.8, rel=0.05)
    stiffness_felt(page, stiffer, within=0.02)

    page.do("press", key="[")
    assert held(page, "stiffness") == pytest.approx(1.44, rel=0.05)


def test_damping_is_moved_while_touching_and_held_by_the_engine(page: Browser) -> None:
    press(page)
    before = held(page, "damping")
    with page.settings():
        page.do("slide", testid="damping", value=0.012)
    # a step of the slider, whose thumb can be set to a pixel
    assert held(page, "damping") == pytest.approx(0.012, abs=0.001)
    assert before < 0.011

    damped = page.settled()
    assert damped["contact"]
    assert damped["safety"]["violations"] == 0


def test_a_ball_stands_its_radius_before_the_surface(page: Browser) -> None:
    point = press(page)
    assert point["proxy"][1] == pytest.approx(SURFACE, abs=0.1)
    leave(page)

    page.do("slide", testid="radius", value=4.0)
    radius = held(page, "probe_radius")
    assert radius == pytest.approx(4.0, abs=0.15)
    ball = press(page)
    # a ball's middle is never nearer than its radius, and less than a voxel farther
    assert SURFACE - radius - 1.0 < ball["proxy"][1] <= SURFACE - radius + 0.01

    # a radius that is raised in contact is admitted by pushing the probe, or waits
    page.do("press", key="+")
    larger = held(page, "probe_radius")
    assert larger > radius
    pushed = page.settled()
    assert pushed["pending"] > 0 or pushed["proxy"][1] <= SURFACE - larger + 0.01
    assert pushed["safety"]["violations"] == 0


def test_friction_holds_the_probe_back_sideways(page: Browser) -> None:
    def sideways(state: dict[str, Any]) -> float:
        across = force(state)
        return float(np.hypot(across[0], across[2]) / across[1])

    press(page)
    smooth = press(page, x=MIDDLE + 1.0)
    assert abs(sideways(smooth)) < 0.05, "a flat surface without friction pushes straight back"
    leave(page)

    page.do("slide", testid="friction", value=0.5)
    friction = held(page, "friction_static")
    assert friction == pytest.approx(0.5, abs=0.02)
    assert held(page, "friction_kinetic") == pytest.approx(0.8 * friction)
    press(page)
    stuck = press(page, x=MIDDLE + 1.0)
    # one of three millimetres sideways is inside of the cone of 0.5: the probe sticks
    assert abs(sideways(stuck)) == pytest.approx(1.0 / 3.0, abs=0.1)
    assert stuck["proxy"][0] == pytest.approx(MIDDLE, abs=0.5)


def test_model_and_surface_are_chosen_while_touching_and_the_printed_models_warn(
    page: Browser,
) -> None:
    press(page)
    assert page.read("document.querySelector('[data-testid=model-warning]')") is None
    for model in ("thesis-original", "thesis-improved"):
        with page.settings():
            page.do("choose", testid="model", value=model)
        assert held(page, "model") == model
        page.shows("model-warning", "text.includes('thesis')")
        page.wait("window.palpate.state.contact")
    with page.settings():
        page.do("choose", testid="model", value="exact")
    assert held(page, "model") == "exact"

    page.do("press", key="v")
    assert held(page, "smoothing") == "off"
    stairs = press(page)
    # without smoothing the force comes from the probe itself
    offset = np.array(stairs["contact_point"]) - np.array(stairs["proxy"])
    assert np.linalg.norm(offset) < 1e-6
    page.do("press", key="v")
    assert held(page, "smoothing") == "intensities"


def test_what_was_set_comes_back_with_the_page_and_can_be_reset(block: Path) -> None:
    port = str(free_port())
    with browser() as page:
        with palpate("open", block, *OPTIONS, "--port", port) as first:
            page.do("open", url=first.url, width=800, height=480)
            default = held(page, "stiffness")
            page.do("press", key="]")
            page.do("press", key="]")
            chosen = held(page, "stiffness")
            assert chosen > 1.3 * default
            assert first.stop() == 0

        # another engine at the same address knows nothing of it, the page tells it
        with palpate("open", block, *OPTIONS, "--port", port) as second:
            page.do("open", url=second.url, width=800, height=480)
            page.wait(f"window.palpate.settings.stiffness === {chosen}")
            assert held(page, "stiffness") == chosen
            leave(page)
            state = press(page)
            ratio = np.linalg.norm(force(state)) / state["depth"]
            assert ratio == pytest.approx(chosen, rel=0.02)

            reset(page)
            assert held(page, "stiffness") == default
            page.do("open", url=second.url, width=800, height=480)
            assert held(page, "stiffness") == default


def test_a_segment_feels_in_its_own_way(page: Browser) -> None:
    page.do("resize", width=1100, height=600)
    if not page.read("document.querySelector('[data-testid=own-stiffness]') !== null"):
        page.read("document.querySelector('[aria-label=\"Scan and segments\"]').click()")
    press(page)
    page.do("click", testid="own-stiffness")
    page.wait("document.querySelector('[data-testid=segment-stiffness]') !== null")
    page.do("slide", testid="segment-stiffness", value=float(np.log(0.4)))
    stiffness_felt(page, 0.4, within=0.05)
    page.do("click", testid="own-stiffness")
    page.wait("document.querySelector('[data-testid=segment-stiffness]') === null")
    stiffness_felt(page, held(page, "stiffness"), within=0.02)
    page.do("resize", width=800, height=480)


# --- seen -------------------------------------------------------------------------------


def changed(before: NDArray[np.float64], after: NDArray[np.float64]) -> NDArray[np.int64]:
    """Returns the pixels (row, column) that clearly differ, shape [n, 2]."""
    return np.argwhere(np.abs(after - before).max(axis=2) > 0.1)


def place_of(page: Browser, point: NDArray[np.float64], shape: tuple[int, ...]) -> Any:
    """Returns where the page's camera shows a point, (row, column)."""
    camera = page.read("window.palpate.camera")
    right, up, back = (np.array(camera[axis]) for axis in ("right", "up", "back"))
    offset = point - np.array(camera["target"])
    size = 2 * (camera["distance"] - offset @ back) * np.tan(camera["field"] / 2) / shape[0]
    return np.array([shape[0] / 2 - offset @ up / size, shape[1] / 2 + offset @ right / size])


def test_the_contact_normal_is_drawn_out_of_the_surface_and_can_be_hidden(page: Browser) -> None:
    # from the side the block's front, and an arrow out of it, is seen edge on
    page.read("window.palpate.setView('L')")
    state = press(page, depth=1.0)
    assert np.array(state["normal"]) == pytest.approx([0.0, -1.0, 0.0], abs=0.05)
    shown = page.picture(OUTPUT / "normal_shown.png")
    page.do("press", key="n")
    hidden = page.picture(OUTPUT / "normal_hidden.png")
    page.do("press", key="n")

    pixels = changed(hidden, shown)
    assert len(pixels) > 40, "an arrow of 60 pixels and a ring"
    foot = place_of(page, np.array(state["contact_point"]), shown.shape)
    page.read("window.palpate.setView('A')")
    offsets = pixels - foot
    # anterior is on the left, seen from the patient's left; the arrow is 60 pixels long
    assert -66 < offsets[:, 1].min() < -50
    assert offsets[:, 1].max() < 20
    assert np.abs(offsets[:, 0]).max() < 20


def test_the_ball_is_drawn_and_can_be_hidden(page: Browser) -> None:
    page.read("window.palpate.setView('A')")
    page.do("slide", testid="radius", value=6.0)
    radius = held(page, "probe_radius")
    shown = page.picture(OUTPUT / "ball_shown.png")
    with page.settings():
        page.do("click", testid="show-ball")
    hidden = page.picture(OUTPUT / "ball_hidden.png")
    with page.settings():
        page.do("click", testid="show-ball")
    proxy = np.array(page.read("window.palpate.state.proxy"))
    rim = place_of(page, proxy + np.array([radius, 0.0, 0.0]), shown.shape)
    middle = place_of(page, proxy, shown.shape)
    columns = changed(hidden, shown)[:, 1]
    # the ball's rim is soft, and a pixel is a pixel
    assert columns.max() - middle[1] == pytest.approx(rim[1] - middle[1], abs=2.5)
    reset(page)


@pytest.mark.long
def test_the_way_of_the_probe_is_drawn_and_can_be_hidden(block: Path) -> None:
    # the engine stands still for the pictures, since the way of some seconds before is forgotten
    with palpate("open", block, *OPTIONS, "--port", "0") as command, browser() as page:
        page.do("open", url=command.url, width=800, height=480)
        page.read("window.palpate.setView('A')")
        # without a graphics card the way is off until it is asked for
        page.do("press", key="p")
        page.read(
            "void (() => { window.__seen = []; const look = () => {"
            " const { time, proxy } = window.palpate.state; window.__seen.push([time, proxy[0]]);"
            " requestAnimationFrame(look); }; look(); })()"
        )
        for _ in range(100):
            leave(page)
            page.read(f"window.palpate.hand({[MIDDLE + 12, SURFACE - 10, MIDDLE]})")
            page.wait(f"window.palpate.state.proxy[0] > {MIDDLE + 11}")
            command.process.send_signal(signal.SIGSTOP)
            # what is on its way still arrives
            page.frames()
            page.frames()
            times, places = np.transpose(page.read("window.__seen"))
            # of the four seconds that are shown
            if places[times > times[-1] - 3.5].min() < MIDDLE + 0.5:
                break
            command.process.send_signal(signal.SIGCONT)
        # that nothing answers stands over the picture
        message = "document.querySelector('[data-testid=message]')"
        page.wait(f"{message} !== null")
        page.read(f"{message}.style.display = 'none'")
        shown = page.picture(OUTPUT / "way_shown.png")
        page.do("press", key="p")
        without = page.picture(OUTPUT / "way_hidden.png")
        on_line = changed(without, shown)
        left = place_of(page, np.array([MIDDLE + 2, SURFACE - 10, MIDDLE]), without.shape)
        near = np.abs(on_line - left).max(axis=1) < 4
        assert near.any(), "the line passes where the probe was"


# --- force checks -----------------------------------------------------------------------


def test_the_light_is_green_opens_what_is_counted_and_has_a_name(page: Browser) -> None:
    press(page)
    # all at once: where the servo is late, the force is off and the light is amber for a moment
    page.wait(
        "(() => { const of = name => document.querySelector(`[data-testid=${name}]`);"
        " const light = of('status-light');"
        " return of('light').dataset.colour === 'green' && light.textContent.trim() === "
        "'Force checks passed' && /Force checks.*green/.test(light.ariaLabel); })()"
    )

    # by the keyboard alone: G opens it, Escape closes it
    opened = "document.querySelector('[data-testid=guarantees]').matches(':popover-open')"
    page.do("press", key="Shift+G")
    assert page.read(opened)
    assert "inside of anything solid" in page.text("guarantees")
    page.do("press", key="Escape")
    assert not page.read(opened)
    # by a click it opens beside the light that was clicked
    page.do("click", testid="light")
    page.wait(opened)
    assert page.read(
        "(({ right }) => right > innerWidth / 2)"
        "(document.querySelector('[data-testid=guarantees]').getBoundingClientRect())"
    )
    page.do("press", key="Escape")


# --- heard and felt ---------------------------------------------------------------------


def test_contact_is_heard_once_a_person_has_asked_for_it(page: Browser) -> None:
    assert page.read("window.palpate.sound") == {"running": False, "level": 0}
    with page.settings():
        page.do("click", testid="sound")
    page.wait("window.palpate.sound.running")
    assert page.read("window.palpate.sound.level") == 0.0
    # a small picture is drawn quickly: nothing is heard of states half a second apart
    page.do("resize", width=480, height=240)

    page.read(
        "window.__loudest = 0; void setInterval(() => { window.__loudest ="
        " Math.max(window.__loudest, window.palpate.sound.level); }, 10)"
    )
    # a page that is late for a moment does not hear the tap: tap again
    for _ in range(60):
        press(page, depth=8.0)
        if page.read("window.__loudest") > 0.001:
            break
        page.read(f"window.palpate.hand({[MIDDLE, SURFACE - 6.0, MIDDLE]})")
        page.wait("!window.palpate.state.contact")
    assert page.read("window.__loudest") > 0.001
    # at rest it is quiet again
    page.wait("window.palpate.sound.level < 1e-4")
    page.do("resize", width=800, height=480)
    with page.settings():
        page.do("click", testid="sound")
    assert not page.read("window.palpate.sound.running")


def test_a_gamepad_is_found_moves_the_hand_and_rumbles_in_contact(page: Browser) -> None:
    page.read(PAD)
    with page.settings():
        page.wait("document.querySelector('[data-testid=gamepad]') !== null")
        assert page.text("gamepad") == "Test Pad: moves the hand"
    before = page.settled()
    assert page.read("window.__effects") == []

    # to the right on the screen is the patient's left, seen from before
    page.read("void (window.__pad.axes = [1, 0, 0, 0])")
    page.wait(f"window.palpate.state.hand[0] > {before['hand'][0] + 2}")
    page.read("void (window.__pad.axes = [0, 0, 0, 0])")

    # the right trigger presses it into the block
    page.read("void (window.__pad.buttons[7] = {pressed: true, value: 1})")
    page.wait("window.palpate.state.contact && window.palpate.state.depth > 1")
    page.read("void (window.__pad.buttons[7] = {pressed: false, value: 0})")
    page.wait(
        "window.__effects.some(effect => effect.kind === 'dual-rumble'"
        " && effect.strongMagnitude > 0)"
    )
    strengths = page.read(
        "window.__effects.flatMap(effect => effect.kind === 'reset' ? [] :"
        " [effect.strongMagnitude, effect.weakMagnitude])"
    )
    assert 0.0 <= min(strengths) <= max(strengths) <= 1.0

    # the lower button takes the hand from the sticks, and they turn the picture
    page.read("void (window.__pad.buttons[0] = {pressed: true, value: 1})")
    with page.settings():
        page.shows("gamepad", "text.includes('turns')")
    page.read("void (window.__pad.buttons[0] = {pressed: false, value: 0})")
    hand = page.settled()["hand"]
    camera = page.read("window.palpate.camera")
    page.read("void (window.__pad.axes = [1, 0, 0, 0])")
    page.wait(f"window.palpate.camera.right[0] < {camera['right'][0] - 0.01}")
    page.read("void (window.__pad.axes = [0, 0, 0, 0])")
    assert page.read("window.palpate.state.hand") == pytest.approx(hand, abs=1e-6)

    page.read("window.__pad = null; void window.dispatchEvent(new Event('gamepaddisconnected'))")
    with page.settings():
        page.wait("document.querySelector('[data-testid=gamepad]') === null")
    page.read("window.palpate.setView('A')")


# --- kept -------------------------------------------------------------------------------


def test_a_recording_is_made_saved_and_read_again(page: Browser, tmp_path: Path) -> None:
    page.do("click", testid="record")
    page.wait("window.palpate.state.recording > 0.2")
    page.wait("document.querySelector('[data-testid=record]').ariaLabel === 'Stop recording'")
    pressed = press(page)
    page.do("press", key="Shift+R")
    page.wait("document.querySelector('[data-testid=save-recording]') !== null")
    assert page.read("window.palpate.state.recording") is None

    file = tmp_path / "saved.palpate-session"
    name = page.do("download", testid="save-recording", path=str(file))["name"]
    assert name == "block.palpate-session"
    recording = Recording.load(file)
    assert recording.seconds > 0.2
    # where the device is late for a tick there is no contact in it
    last = int(np.flatnonzero(recording.contacts)[-1])
    assert recording.forces[last] == pytest.approx(pressed["force"], abs=0.05)
    assert not recording.contacts[0]


# --- room -------------------------------------------------------------------------------


@pytest.mark.parametrize("width", [480, 640, 960, 1280, 1920, 3840])
def test_nothing_is_cut_off_or_overlaps_at_any_width(opened: Browser, width: int) -> None:
    opened.do("resize", width=width, height=700)
    opened.wait(f"window.innerWidth === {width}")
    opened.frames()
    page_overflows = "document.scrollingElement.scrollWidth > window.innerWidth"
    assert not opened.read(page_overflows)
    room = "document.querySelector('[data-testid=canvas]').getBoundingClientRect().width"
    # the picture is never squeezed away between the panels
    opened.wait(f"{room} > 200")
    cut = opened.read(
        "[...document.querySelectorAll('header, header button, aside, aside button, aside select,"
        " aside label')].filter(e => e.scrollWidth > e.clientWidth + 1)"
        ".map(e => `${e.tagName} ${e.className} ${e.textContent.slice(0, 40)}`)"
    )
    assert cut == []
    opened.do("screenshot", path=str(OUTPUT / f"width_{width}.png"))
    opened.do("resize", width=800, height=480)
