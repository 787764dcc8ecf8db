"""Methods of a session are those of its parts."""

from __future__ import annotations

import inspect
from typing import Any

import palpate
from palpate.session.part_method import PartMethod
from palpate.session.session import Session


def methods() -> dict[str, PartMethod[Any, Any, Any]]:
    return {name: each for name, each in vars(Session).items() if isinstance(each, PartMethod)}


def test_every_method_is_that_of_the_part_it_names() -> None:
    with Session(palpate.Scene(palpate.phantom((16, 16, 16)).volume)) as session:
        for name, method in methods().items():
            part = getattr(session, method.part)
            assert getattr(session, name) == getattr(part, name), name
            assert method.__wrapped__ is getattr(type(part), name), name


def test_no_public_method_of_a_part_is_left_out() -> None:
    parts = {method.part for method in methods().values()}
    with Session(palpate.Scene(palpate.phantom((16, 16, 16)).volume)) as session:
        offered = {
            name
            for part in parts
            for name, _ in inspect.getmembers(getattr(session, part), inspect.ismethod)
            if not name.startswith("_")
        }
    # a scene file restores a material whatever is known of the unit, and holds values at rest
    assert offered - methods().keys() == {"restore_material", "values_at_rest"}


def test_the_class_shows_signature_and_documentation_of_the_part() -> None:
    assert list(inspect.signature(Session.cut).parameters) == [
        "self",
        "segment_id",
        "point",
        "normal",
    ]
    assert (inspect.getdoc(Session.cut) or "").startswith("Splits a segment by a plane")
