"""The page's side of the protocol is what the schema generates."""

from __future__ import annotations

import pytest
from palpate.protocol.typescript import OUTPUT, generate


def test_the_checked_in_file_is_the_generated_one() -> None:
    assert OUTPUT.read_text(encoding="utf-8") == generate(), (
        "run `python -m palpate.protocol.typescript`"
    )


@pytest.mark.parametrize(
    "line",
    [
        "export const PROTOCOL_VERSION = 1;",
        "export type Vector = readonly [Coordinate, Coordinate, Coordinate];",
        "  readonly range: readonly [Value, Value] | null;",
        '  readonly level: "info" | "warning" | "error";',
        "const isShare = real({ ge: 0, le: 1 });",
        "  range: nullable(tuple(isValue, isValue)),",
    ],
)
def test_types_and_checks_follow_the_schema(line: str) -> None:
    assert line in generate().splitlines()
