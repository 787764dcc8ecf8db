"""Text that does nothing to a terminal: what files say is shown, never obeyed.

Names, descriptions and messages come from files of strangers. A terminal takes some characters
for orders: to set the clipboard, to hide or rewrite lines, to turn the order of letters. The
command line prints through streams that put ``?`` in their place, so that no command has to
think of it. Only rich, which lays tables and bars out with such orders, writes past them, by the
one console made here.

Sources: ECMA-48 (control functions); Unicode Standard Annex 9 (bidirectional controls); Boucher
& Anderson, "Trojan Source", USENIX Security (2023).
"""

from __future__ import annotations

import re
import sys
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any, TextIO, cast

if TYPE_CHECKING:
    from rich.console import Console

__all__ = ["HarmlessStream", "harmless", "print_harmlessly", "terminal"]

ORDERS = re.compile(
    # C0 but tab and ends of lines, DEL, C1
    r"\r(?!\n)|[\x00-\x08\x0b\x0c\x0e-\x1f\x7f-\x9f"
    # marks, embeddings, overrides and isolates of direction; separators of lines
    "\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069"
    # marks of order of bytes and of annotations, tags; halves of characters cannot be written
    "\ufeff\ufff9-\ufffb\U000e0000-\U000e007f\ud800-\udfff]"
)
"""Characters that a terminal may obey instead of showing them."""


def harmless(text: str) -> str:
    """Returns a text with ``?`` for each character that a terminal may obey."""
    return ORDERS.sub("?", text)


class HarmlessStream:
    """A text stream that writes all text harmlessly to another one."""

    def __init__(self, stream: TextIO) -> None:
        """Writes to ``stream``."""
        self.rich_proxied_file = stream
        """Where rich writes instead: it knows streams before others by this name."""

    def write(self, text: str) -> int:
        """Writes a text; returns its length."""
        self.rich_proxied_file.write(harmless(text))
        return len(text)

    def writelines(self, lines: Iterable[str]) -> None:
        """Writes several texts."""
        for line in lines:
            self.write(line)

    def __getattr__(self, name: str) -> Any:  # noqa: ANN401  # all else is the stream's
        """Returns what the stream itself has."""
        return getattr(self.rich_proxied_file, name)

    @classmethod
    def over(cls, stream: TextIO) -> TextIO:
        """Returns a stream that writes harmlessly to another; itself where it does already."""
        return cast("TextIO", stream if isinstance(stream, cls) else cls(stream))


def print_harmlessly() -> None:
    """From now on all that this process prints is harmless, tracebacks and log lines too."""
    sys.stdout = HarmlessStream.over(sys.stdout)
    sys.stderr = HarmlessStream.over(sys.stderr)


def terminal(*, stderr: bool = False, markup: bool = False) -> Console:
    """Returns a console for tables and bars, with harmless text in them.

    With ``markup`` brackets are styles: for texts of ours.
    """
    from rich.console import Console, ConsoleOptions, RenderableType
    from rich.segment import Segment
    from rich.text import Text

    class Harmless(Console):
        def render_str(self, text: str, **options: Any) -> Text:  # noqa: ANN401  # as rich has it
            # before columns are measured
            return super().render_str(harmless(text), **options)

        def render(
            self, renderable: RenderableType, options: ConsoleOptions | None = None
        ) -> Iterable[Segment]:
            for text, style, control in super().render(renderable, options):
                shown = text if control else harmless(text)
                # an address in a text is no link
                yield Segment(shown, style and style.update_link(), control)

    stream = sys.stderr if stderr else sys.stdout
    shown = getattr(stream, "rich_proxied_file", stream)
    return Harmless(file=shown, markup=markup, emoji=False, highlight=False)
