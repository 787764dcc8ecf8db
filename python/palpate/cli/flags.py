"""Options that messages name, as flags of the command that runs."""

from __future__ import annotations

from typing import Any

from typer import Typer
from typer.main import get_command

from palpate.base.hints import HINT, retold

__all__ = ["as_flags", "of_import"]

ELSEWHERE = "import"
"""The command that has the options of reading, where another one lacks them."""


def as_flags(message: str, app: Typer, arguments: list[str], *, whole: Typer | None = None) -> str:
    """Returns a message that names options of Python as flags of a command.

    Args:
        message: The message.
        app: The command line, or the part of it with that command.
        arguments: What was typed, which begins with the command.
        whole: The command line, where the other one is a part of it.
    """
    if not HINT.search(message):
        return message
    command: Any = get_command(app)
    for word in arguments:
        if word not in getattr(command, "commands", {}):
            break
        command = command.commands[word]

    def tell(name: str, value: str) -> str:
        parameter = _parameter(command, name)
        if parameter is not None:
            return _flag(parameter, value)
        root: Any = get_command(app if whole is None else whole)
        other = _parameter(root.commands[ELSEWHERE], name)
        if other is None:
            return f"{name.replace('_', ' ')} {value}"
        return f"{_flag(other, value)} of `palpate {ELSEWHERE}`"

    return retold(message, tell)


def of_import(message: str) -> str:
    """Returns a message of a further scan, whose options are not those of the first one."""
    return retold(
        message, lambda name, value: f"--{name.replace('_', '-')} {value} of `palpate {ELSEWHERE}`"
    )


def _parameter(command: Any, name: str) -> Any:  # noqa: ANN401  # Typer's own classes
    found = (each for each in command.params if each.name == name and each.opts[0][:2] == "--")
    return next(found, None)


def _flag(parameter: Any, value: str) -> str:  # noqa: ANN401
    name = max(parameter.opts, key=len)
    return name if parameter.is_flag else f"{name} {value}"
