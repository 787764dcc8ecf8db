"""Figures of what a person sees are read off the notes of a page."""

from __future__ import annotations

import pytest
from palpate.bench.goals.seen import SEEN_ROWS, seen_case
from palpate.bench.pictures.seen import drilled_figures, opened_figures, turned_figures
from palpate.bench.pictures.watched_pictures import (
    NotedEdit,
    NotedKey,
    NotedMove,
    NotedPicture,
    NotedTurn,
    Watched,
)


def picture(
    at: float, divisor: float, answers: int | None = None, *, finished: bool = False
) -> NotedPicture:
    return NotedPicture(
        at=at, pieces=round(at), divisor=divisor, finished=finished, answers=answers
    )


def notes(
    *pictures: NotedPicture,
    moves: tuple[tuple[float, int | None] | tuple[float, int | None, int], ...] = (),
    turns: tuple[tuple[float, int], ...] = (),
    edits: tuple[tuple[float, int | None], ...] = (),
    keys: tuple[tuple[float, float], ...] = (),
) -> Watched:
    return Watched(
        now=9e9,
        pictures=list(pictures),
        turns=[NotedTurn(at=at, turns=count) for at, count in turns],
        moves=[
            NotedMove(at=at, requested=requested, turns=drawn[0] if drawn else None)
            for at, requested, *drawn in moves
        ],
        edits=[NotedEdit(at=at, requested=requested) for at, requested in edits],
        keys=[NotedKey(at=at, delay=delay) for at, delay in keys],
    )


def test_a_picture_coarser_than_a_third_is_no_first_picture() -> None:
    opened = notes(
        picture(500, 4), picture(800, 2.5), picture(1500, 1), picture(2500, 1, finished=True)
    )
    assert opened_figures(opened) == {"first": 0.8, "sharp": 1.5, "final": 2.5}
    assert opened_figures(notes(picture(500, 4))) == {}


def test_a_turn_counts_from_its_first_move_to_its_last() -> None:
    turned = notes(
        picture(1100, 3, 1),
        picture(1300, 4, 2),
        picture(1500, 2, 3),
        # the last move was not requested yet when this one was
        picture(2010, 1, 3),
        picture(2100, 2, 4),
        picture(2400, 1, 4),
        picture(3000, 1, 4, finished=True),
        moves=((1000, 0), (1200, 1), (1450, 2), (2000, 3)),
        keys=((1100, 20), (1900, 40), (2500, 5)),
    )
    assert turned_figures(turned) == pytest.approx(
        {
            "rate": 3.0,
            "coarsest": 4.0,
            # 100, 100, 50 and 100 ms
            "mouse median": 0.1,
            "mouse p95": 0.1,
            "rest sharp": 0.4,
            "rest final": 1.0,
            "key turning": 0.039,
            "key resting": 0.005,
        }
    )


def test_turned_pictures_are_counted_apart_from_true_ones() -> None:
    turned = notes(
        picture(1250, 4, 1),
        picture(2300, 4, 2),
        # the first turned one was drawn before the second move
        turns=((1030, 1), (1480, 2), (2020, 3)),
        moves=((1000, 0, 0), (1400, 1, 1), (2000, 1, 2)),
    )
    figures = turned_figures(turned)
    # 30, 80 and 20 ms; true ones come after 250, 900 and 300 ms
    assert figures["turned median"] == pytest.approx(0.03)
    assert figures["mouse median"] == pytest.approx(0.3)
    assert figures["turned rate"] == pytest.approx(2.0)
    assert figures["rate"] == pytest.approx(1.0)


def test_the_browsers_pictures_answer_no_requests_and_have_no_latencies() -> None:
    turned = notes(
        picture(1100, 4), picture(2300, 1, finished=True), moves=((1000, None), (2000, None))
    )
    assert turned_figures(turned) == pytest.approx(
        {"rate": 1.0, "coarsest": 4.0, "rest sharp": 0.3, "rest final": 0.3}
    )


def test_a_hole_is_seen_in_a_picture_of_half_the_resolution_that_was_requested_after_it() -> None:
    drilled = notes(
        picture(1100, 2, 7),
        picture(1200, 3, 8),
        picture(1300, 2, 8),
        picture(1500, 2, 9),
        edits=((1000, 7), (1050, 8), (1400, 9)),
    )
    # the last edit was never seen
    assert drilled_figures(drilled) == pytest.approx({"drill median": 0.375, "drill p95": 0.4425})
    assert drilled_figures(notes(picture(1100, 2, 7), edits=((1000, 7),))) == {}


def test_every_figure_has_its_row_where_the_engine_draws() -> None:
    told = {
        *opened_figures(notes(picture(1, 1, finished=True))),
        *turned_figures(
            notes(
                picture(1.5, 3, 1),
                picture(3, 1, 2, finished=True),
                moves=((1, 0, 0), (2, 1, 1)),
                turns=((1.5, 1), (2.5, 2)),
                keys=((1, 1), (3, 1)),
            )
        ),
        *drilled_figures(notes(picture(2, 1, 1), edits=((1, 0),))),
        "served",
    }
    case = seen_case("CThead", by_engine=True)
    assert {row.key for row in SEEN_ROWS if row.case == case} == told
