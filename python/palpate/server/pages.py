"""Pages that the server writes itself, for people who cannot be shown the real one."""

from __future__ import annotations

from html import escape

from starlette.responses import HTMLResponse

__all__ = ["page", "refusal"]

FRAME = """<!doctype html>
<html lang="en"><head><meta charset="utf-8"><title>Palpate</title><style>
body {{ background: #14171a; color: #d8dcdf; font: 16px/1.5 system-ui, sans-serif;
  display: grid; place-content: center; min-height: 90vh; margin: 0 24px }}
main {{ max-width: 36em }} h1 {{ font-size: 20px; color: #fff }} code {{ color: #7fd1c7 }}
</style></head><body><main><h1>{title}</h1><p>{text}</p></main></body></html>
"""


def page(title: str, text: str, *, status: int) -> HTMLResponse:
    """Returns a page with a title and a sentence; both are plain text."""
    return HTMLResponse(FRAME.format(title=escape(title), text=escape(text)), status_code=status)


def refusal(reason: str) -> HTMLResponse:
    """Returns the page of those who are not let in."""
    text = f"Not let in: {reason}. Open the address that `palpate open` printed, token and all."
    return page("Palpate did not open this page", text, status=403)
