"""Pages as one HTML file: no server, no other file; light or dark as the system is."""

from __future__ import annotations

from base64 import b64encode
from html import escape
from pathlib import Path

__all__ = ["data_url", "html_page"]


def html_page(title: str, body: str, *, style: str = "", script: str = "") -> str:
    """Returns a page.

    Args:
        title: Of the window; plain text.
        body: HTML.
        style: CSS beside that of all pages.
        script: JavaScript, run once the body is there.
    """
    shared = Path(__file__).with_suffix(".css").read_text("utf-8")
    run = f"<script>{script}</script>\n" if script else ""
    return f"""<!doctype html>
<html lang="en">
<meta charset="utf-8">
<meta name="viewport" content="width=device-width">
<title>{escape(title)}</title>
<style>{shared}{style}</style>
{body}
{run}</html>
"""


def data_url(kind: str, content: bytes) -> str:
    """Returns the content of a file as an address; ``kind`` is its media type."""
    return f"data:{kind};base64,{b64encode(content).decode('ascii')}"
