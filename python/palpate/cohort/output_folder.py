"""The output folder of a cohort: a folder a case, which appears once it is whole.

All that a cohort writes or takes away is below this folder; ``CohortFolder.of`` gives the places.
"""

from __future__ import annotations

import json
import re
import shutil
from glob import escape
from pathlib import Path
from typing import Any
from uuid import uuid4

from palpate.base.errors import OptionError
from palpate.base.replacing import agreed_by
from palpate.base.whole_file import is_unfinished, whole_file
from palpate.cohort.case import Case

__all__ = ["CohortFolder"]

MARK = "cohort.json"
"""Says that a folder is a cohort's: in others nothing is replaced."""

PART = re.compile(r"\.[0-9a-f]{8}\.part")
"""What a folder in the making adds to the name of its case."""


class CohortFolder:
    """The output folder."""

    def __init__(self, path: Path) -> None:
        """Takes a folder that is new, empty, or of an earlier run.

        Raises:
            OptionError: It holds something else.
        """
        self._path = path.absolute()
        # in this order: another share of the same cohort may be marking it just now
        if path.exists() and _holds_others(path) and not (path / MARK).is_file():
            raise OptionError(
                f"{path} holds something else; allowed: a new folder, an empty one, or that of an "
                "earlier run"
            )

    def begin(self) -> None:
        """Makes the folder, marked as a cohort's.

        Raises:
            OSError: It cannot be made.
        """
        if self.of(MARK).is_file():
            return
        self._path.mkdir(parents=True, exist_ok=True)
        # another share may have made it meanwhile: it is the same
        with agreed_by(lambda _: None), whole_file(self.of(MARK)) as unfinished:
            unfinished.write_text('{"kind": "palpate cohort"}\n', "utf-8")

    @property
    def mark(self) -> Path:
        """The file that says what the folder is."""
        return self.of(MARK)

    def of(self, *names: str) -> Path:
        """Returns a place within the folder."""
        return self._path.joinpath(*names)

    def told(self, name: str) -> dict[str, Any] | None:
        """Returns what is told of a case that is done; None where it is not."""
        try:
            told = json.loads(self.of(name, "done.json").read_text("utf-8"))
        except (OSError, ValueError):
            return None
        whole = isinstance(told, dict) and all(
            self.of(name, file).exists() for file in told.get("files", [])
        )
        return told if whole else None

    def failed(self, name: str) -> bool:
        """Says whether a case has failed the last time."""
        return self.of(name, "failed.json").is_file()

    def part(self, name: str) -> Path:
        """Returns an empty folder for a case in the making; what was in the making before goes.

        Its name is used once: a worker that was given up for lost, but still runs, cannot meet it.
        """
        old, place = self.of(f"{name}.old"), self.of(name)
        for each in self._path.glob(f"{escape(name)}.*.part"):
            if PART.fullmatch(each.name.removeprefix(name)):
                shutil.rmtree(each, ignore_errors=True)
        # a run that was ended between two renames
        if old.exists() and not place.exists():
            old.rename(place)
        shutil.rmtree(old, ignore_errors=True)
        part = self.of(f"{name}.{uuid4().hex[:8]}.part")
        part.mkdir()
        return part

    def keep(self, name: str, part: Path) -> None:
        """Gives a whole case its name; what an earlier run made of it goes."""
        place, old = self.of(name), self.of(f"{name}.old")
        if place.exists():
            place.rename(old)
        part.rename(place)
        shutil.rmtree(old, ignore_errors=True)

    def fail(self, case: Case, part: Path | None, reason: str) -> None:
        """Tells why a case failed; what an earlier run made of it stays beside that."""
        name, scan = case.name, case.variables.get("scan")
        if part is not None:
            shutil.rmtree(part, ignore_errors=True)
        self.of(name).mkdir(exist_ok=True)
        with whole_file(self.of(name, "failed.json")) as unfinished:
            text = json.dumps({"reason": reason, "scan": scan}, indent=1, ensure_ascii=False)
            unfinished.write_text(text + "\n", "utf-8")


def _holds_others(path: Path) -> bool:
    """Says whether something other than a mark in the making is there."""
    return not path.is_dir() or not all(is_unfinished(each, MARK) for each in path.iterdir())
