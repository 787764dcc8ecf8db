"""Names of the parts of cut segments."""

import pytest
from palpate.server.messages.part_name import part_name


@pytest.mark.parametrize(
    ("offset", "side"),
    [
        ((30.0, 5.0, -5.0), "left part"),
        ((-30.0, 5.0, -5.0), "right part"),
        ((1.0, 30.0, -5.0), "back part"),
        ((1.0, -30.0, -5.0), "front part"),
        ((1.0, 5.0, 30.0), "upper part"),
        ((1.0, 5.0, -30.0), "lower part"),
        # out of the middle of the rest, and where no side is known
        ((1.0, 5.0, -6.0), "part"),
        (None, "part"),
    ],
)
def test_a_part_is_named_by_its_side_of_the_body(
    offset: tuple[float, float, float] | None, side: str
) -> None:
    assert part_name("bone", offset, 100.0, taken=["bone"]) == f"bone, {side}"


def test_no_two_segments_have_one_name() -> None:
    taken = ["bone"]
    for expected in ("bone, left part", "bone, left part 2", "bone, left part 3"):
        taken.append(part_name("bone", (50.0, 0.0, 0.0), 100.0, taken=taken))
        assert taken[-1] == expected


def test_long_names_keep_room_for_the_side() -> None:
    name = part_name("x" * 200, (50.0, 0.0, 0.0), 100.0, taken=[])
    assert name.endswith(", left part")
    assert len(name) < 100
