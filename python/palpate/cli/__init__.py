"""The command line: one module for each command, and what it does."""

from __future__ import annotations

from palpate.cli.commands import main

__all__ = ["main"]
