"""Messages on touch: the hand, the force and the settings."""

from __future__ import annotations

from datetime import datetime
from typing import Any

import numpy as np
import pytest


def test_the_hand_presses_the_probe_against_the_ball(server: Any) -> None:
    with server.page() as page:
        # above the ball: free, with the device there
        page.send({"type": "place", "point": [20.0, 20.0, 34.0]})
        page.receive("state", until=lambda m: abs(m["proxy"][2] - 34.0) < 0.5)
        page.send({"type": "hand", "target": [20.0, 20.0, 24.0]})
        state = page.receive("state", until=lambda m: m["touched"] == 1 and m["force"][2] > 0.5)

        # on the ball's top step or the next, never in it; the spring pushes up
        assert state["contact"]
        assert state["depth"] > 0.5
        assert state["proxy"][2] == pytest.approx(28.0, abs=0.51)
        assert not server.session.segment(1).contains(state["proxy"])[0]

        # away again: no force
        page.send({"type": "hand", "target": [20.0, 20.0, 34.0]})
        state = page.receive("state", until=lambda m: not m["contact"])
        state = page.receive("state", until=lambda m: m["force"] == [0.0, 0.0, 0.0])
        assert state["safety"]["violations"] == 0


def test_samples_of_the_force_are_told_once_and_in_order(shared_server: Any) -> None:
    times: list[float] = []
    with shared_server.page() as page:
        page.receive("state")
        while len(times) < 100:
            times += [sample[0] for sample in page.receive("state")["samples"]]
    steps = np.diff(times)
    # by the servo's clock, which runs on where a thread is late: no sample told twice or out of
    # order. That none is left out is tested in lock-step (crates/engine/tests/session/offline.rs)
    assert steps.min() > 0.0


def test_settings_are_told_as_the_engine_holds_them(server: Any) -> None:
    wanted = {
        "model": "exact",
        "stiffness": 0.5,
        "damping": 0.0,
        "friction_static": 0.3,
        "friction_kinetic": 0.2,
        "smoothing": "off",
        "probe_radius": 1.5,
        "force_limit": 2.0,
        "gain": 2.0,
    }
    with server.page() as page:
        page.send({"type": "change_settings", "settings": wanted})
        assert page.receive("settings_changed")["settings"] == wanted
        # there is room for the ball where the probe is
        page.receive("state", until=lambda m: m["probe_radius"] == 1.5)
        # where the servo is late the force is off for a moment, and comes back
        page.receive("state", until=lambda m: m["safety"]["off"] in {None, "waiting"})
    with server.page() as page:
        assert page.receive("hello")["settings"] == wanted


def press(x: float, *, pressure: float = 1.0) -> dict[str, Any]:
    """A press on the ball from above."""
    ray = {"origin": [x, 20.0, 100.0], "direction": [0.0, 0.0, -1.0]}
    return {"type": "press", **ray, "pressure": pressure}


def newtons(state: dict[str, Any]) -> float:
    return float(np.linalg.norm(state["force"]))


def test_a_press_touches_what_is_on_the_ray_with_its_force_until_it_is_lifted(server: Any) -> None:
    with server.page() as page:
        page.send(press(20.0))
        page.receive("state", until=lambda m: m["contact"] and abs(newtons(m) - 1.0) < 0.1)
        # the latest holds
        page.send(press(20.0, pressure=2.0))
        state = page.receive("state", until=lambda m: abs(newtons(m) - 2.0) < 0.2)
        assert np.linalg.norm(np.subtract(state["proxy"][:2], [20.0, 20.0])) < 1.0
        page.send({"type": "lift"})
        state = page.receive("state", until=lambda m: not m["contact"])
        state = page.receive("state", until=lambda m: m["force"] == [0.0, 0.0, 0.0])
        assert state["safety"]["violations"] == 0


def test_a_page_that_goes_while_it_presses_lifts_the_hand(server: Any) -> None:
    with server.page() as left:
        with server.page() as page:
            page.send(press(20.0))
            page.receive("state", until=lambda m: m["contact"] and newtons(m) > 0.9)
        left.receive("state", until=lambda m: not m["contact"] and newtons(m) == 0.0)


def test_only_the_page_that_presses_lifts_and_the_latest_press_wins(server: Any) -> None:
    with server.page() as first, server.page() as second:
        first.send(press(20.0))
        first.receive("state", until=lambda m: m["contact"] and newtons(m) > 0.9)
        second.send(press(20.0, pressure=2.0))
        second.receive("state", until=lambda m: abs(newtons(m) - 2.0) < 0.2)
        first.send({"type": "lift"})
        now = first.receive("state")["tick"]
        state = first.receive("state", until=lambda m: m["tick"] > now + 500)
        assert state["contact"]
        # a hand that is led elsewhere ends it
        first.send({"type": "hand", "target": [20.0, 20.0, 36.0]})
        first.receive("state", until=lambda m: not m["contact"] and m["proxy"][2] > 35.0)


@pytest.mark.parametrize("pressure", [0.0, -1.0, 5.5, float("nan")])
def test_a_pressure_that_no_mouse_has_is_refused(shared_server: Any, pressure: float) -> None:
    with pytest.raises(ValueError, match="pressure"):
        shared_server.session.press((20.0, 20.0, 100.0), (0.0, 0.0, -1.0), pressure=pressure)
    with pytest.raises(ValueError, match="direction"):
        shared_server.session.press((20.0, 20.0, 100.0), (0.0, 0.0, 0.0), pressure=1.0)


def test_all_pages_are_told_of_what_is_cut_away_from_touch(server: Any) -> None:
    planes = [[[0.0, 0.0, 1.0], 20.0]]
    with server.page() as page:
        page.send({"type": "change_touch_clip", "planes": planes})
        assert page.receive("touch_clip_changed")["planes"] == planes
        # the ball's top is at 28 mm: what is above 20 mm is not there
        page.send({"type": "place", "point": [20.0, 20.0, 34.0]})
        page.send({"type": "hand", "target": [20.0, 20.0, 18.0]})
        state = page.receive("state", until=lambda m: m["contact"] and m["force"][2] > 0.5)
        assert state["proxy"][2] == pytest.approx(20.5, abs=0.51)
        with server.page() as later:
            assert later.receive("touch_clip_changed")["planes"] == planes
        # refused, the page learns what holds
        page.send({"type": "change_touch_clip", "planes": [[[0.0, 0.0, 3.0], 20.0]]})
        assert page.receive("touch_clip_changed")["planes"] == planes
        page.send({"type": "change_touch_clip", "planes": []})
        assert page.receive("touch_clip_changed")["planes"] == []


def test_pages_are_told_which_of_them_moves_the_hand(server: Any) -> None:
    with server.page() as first:
        first.send({"type": "hand", "target": [20.0, 20.0, 34.0]})
        assert first.receive("hand_led")["opened"] is None
        with server.page() as second:
            opened = second.receive("hand_led")["opened"]
            assert datetime.fromisoformat(opened) <= datetime.now().astimezone()
            second.send(
                {
                    "type": "press",
                    "origin": [20.0, 20.0, 60.0],
                    "direction": [0.0, 0.0, -1.0],
                    "pressure": 1.0,
                }
            )
            assert second.receive("hand_led")["opened"] is None
            assert datetime.fromisoformat(
                first.receive("hand_led")["opened"]
            ) >= datetime.fromisoformat(opened)
        # nobody moves it once that page has gone
        assert first.receive("hand_led")["opened"] is None
