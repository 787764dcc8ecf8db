"""Matter that gives way, as pages ask for it: told to all of them, taken back, kept in scenes."""

from __future__ import annotations

from typing import Any

import pytest

CONSTANTS = {
    "young": 7000.0,
    "poisson": 0.3,
    "density": 1200.0,
    "fracture_energy": None,
    "friction": 0.35,
    "stiffening": 6.5,
}


def material(constants: dict[str, Any] | None, preset: str | None = None) -> dict[str, Any]:
    """Returns the message by which a page tells what the ball is made of."""
    told = {"type": "set_material", "id": 1, "preset": preset, "constants": constants}
    return told | {"undoable": True}


def ball_of(page: Any, **wanted: Any) -> Any:
    """Waits until a page is told a ball with such properties."""

    def fits(message: Any) -> bool:
        (ball,) = message["segments"]
        return all(ball[name] == value for name, value in wanted.items())

    return page.receive("segments", until=fits)["segments"][0]


def test_all_constants_of_a_material_reach_all_pages_and_are_undone(server: Any) -> None:
    made = {"preset": None, "low": pytest.approx(CONSTANTS), "high": pytest.approx(CONSTANTS)}
    with server.page() as page, server.page() as other:
        page.send(material(None, "liver"))
        page.send(material(CONSTANTS))
        for each in (page, other):
            ball_of(each, material=made)
        other.send({"type": "undo"})
        for each in (page, other):
            liver = each.receive(
                "segments", until=lambda m: (m["segments"][0]["material"] or {}).get("preset")
            )["segments"][0]["material"]
            assert (liver["preset"], liver["low"]["density"]) == ("liver", pytest.approx(1060.0))


@pytest.mark.parametrize(
    ("constants", "refused"),
    [
        ({"young": 0.0}, "Expected `float` >= 1.0 - at `$.constants.young`"),
        ({"poisson": 0.5}, "Expected `float` < 0.5 - at `$.constants.poisson`"),
        ({"fracture_energy": 0.0}, "Expected `float` > 0.0 - at `$.constants.fracture_energy`"),
        ({"friction": -0.1}, "Expected `float` >= 0.0 - at `$.constants.friction`"),
        ({"stiffening": 101.0}, "Expected `float` <= 100.0 - at `$.constants.stiffening`"),
    ],
)
def test_constants_that_no_matter_has_are_refused(
    shared_server: Any, constants: dict[str, float], refused: str
) -> None:
    with shared_server.page() as page:
        page.send(material(CONSTANTS | constants))
        assert refused in page.receive("notice")["text"]
        assert shared_server.session.segments()[0]["material"] is None


def test_regions_reach_all_pages(server: Any) -> None:
    rigid = {"treatment": "rigid", "shared_with": None, "box": None}
    part = {"treatment": "empty", "shared_with": None, "box": [[10, 10, 10], [20, 20, 20]]}
    with server.page() as page, server.page() as other:
        page.send({"type": "set_regions", "id": 1, "regions": [rigid, part]})
        for each in (page, other):
            ball_of(each, regions=[rigid, part])
        # who comes later is told too
        with server.page() as late:
            assert late.receive("hello")["segments"][0]["regions"] == [rigid, part]
        other.send({"type": "set_regions", "id": 1, "regions": []})
        ball_of(page, regions=[])


@pytest.mark.parametrize(
    ("region", "refused"),
    [
        ({"treatment": "rigid", "shared_with": 7, "box": None}, "segment 7"),
        ({"treatment": "soft", "shared_with": None, "box": None}, "Invalid enum value 'soft'"),
    ],
)
def test_what_is_no_region_is_refused(
    shared_server: Any, region: dict[str, Any], refused: str
) -> None:
    with shared_server.page() as page:
        page.send({"type": "set_regions", "id": 1, "regions": [region]})
        assert refused in page.receive("notice")["text"]
        assert shared_server.session.regions(1) == ()


def test_what_is_felt_of_matter_reaches_all_pages(server: Any) -> None:
    with server.page() as page, server.page() as other:
        for source in ("voxels", "matter"):
            page.send({"type": "set_force_source", "source": source})
            for each in (page, other):
                each.receive("state", until=lambda m, s=source: m["matter"]["force_source"] == s)
        page.send({"type": "set_force_source", "source": "skin"})
        assert "Invalid enum value 'skin'" in page.receive("notice")["text"]
