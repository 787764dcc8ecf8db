"""Messages on what is kept with the scan: every page has the same, and overwrites no other's."""

from __future__ import annotations

from collections.abc import Collection
from weakref import ReferenceType, ref

from palpate import protocol
from palpate.base.errors import OptionError
from palpate.saved.kept_with_scan import KeptWithScan, Part
from palpate.server.messages.outbox import Outbox
from palpate.server.messages.table import MessageTable, Runs

__all__ = ["KeptMessages"]


class KeptMessages:
    """Takes changes of pages, and tells all others."""

    def __init__(self, kept: KeptWithScan, pages: Collection[Outbox]) -> None:
        """Takes what is kept, and all pages that are served."""
        self._kept = kept
        self._pages = pages
        self._changed_by: dict[str, ReferenceType[Outbox]] = {}

    def add_to(self, table: MessageTable) -> None:
        """Adds the row."""
        table.add(protocol.Keep, self._keep, runs=Runs.ON_LOOP)

    @property
    def message(self) -> list[protocol.KeptPart]:
        """All parts, for a page that was opened."""
        return [_told(name, part) for name, part in self._kept.now().items()]

    def _keep(self, message: protocol.Keep, page: Outbox) -> None:
        name = message.name
        now = self._kept.now().get(name, Part(0, None))
        changed_by = self._changed_by.get(name)
        # a page that drags goes on before it has heard of its last change
        if message.after == now.version or (changed_by is not None and changed_by() is page):
            try:
                now = self._kept.change(name, message.value)
            except OptionError as error:
                page.put(protocol.Notice(level="error", text=str(error)))
            else:
                self._changed_by[name] = ref(page)
                for other in self._pages:
                    if other is not page:
                        other.put(protocol.Kept(_told(name, now), answers=False))
        elif message.value != now.value:
            text = "What you changed was changed on another page meanwhile: that is shown now."
            page.put(protocol.Notice(level="info", text=text))
        page.put(protocol.Kept(_told(name, now), answers=True))


def _told(name: str, part: Part) -> protocol.KeptPart:
    return protocol.KeptPart(name, part.version, part.value)
