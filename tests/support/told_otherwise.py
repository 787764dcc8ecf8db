"""Runs ``palpate`` with a session that tells its page something else about safety.

``python told_otherwise.py '{"violations": 2}' open SCAN ...``: what is given stands in every
state in place of what the engine says. So the page is seen in states that no session without
a fault ever has.
"""

from __future__ import annotations

import json
import sys
from typing import Any

from palpate.cli import main
from palpate.session import Session

honest = Session.frame


def frame(self: Session) -> dict[str, Any]:
    """Returns what is now, with some of it replaced."""
    told = honest(self)
    told["safety"] |= json.loads(OTHERWISE)
    return told


if __name__ == "__main__":
    OTHERWISE = sys.argv.pop(1)
    Session.frame = frame  # type: ignore[method-assign]
    main()
