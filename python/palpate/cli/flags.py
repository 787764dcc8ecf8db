"""Options that messages name, as flags of the command that runs."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from typer import Typer
from typer.main import get_command

from palpate.base.hints import HINT, elsewhere, file_of, retold

__all__ = ["as_flags", "of_import"]


def as_flags(message: str, app: Typer, arguments: list[str]) -> str:
    """Returns a message that names options of Python as flags of a command.

    Where the command lacks one, another command is told with the file that the message is about.

    Args:
        message: The message.
        app: The command line, or the part of it with that command.
        arguments: What was typed, which begins with the command.
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
        typed = [word.rpartition("=")[2] for word in arguments[1:]]
        files = [Path(word) for word in typed if word and Path(word).exists()]
        return elsewhere(name, value, file_of(message, files))

    return retold(message, tell)


def of_import(message: str, path: Path) -> str:
    """Returns a message of a further scan, whose options are not those of the first one."""
    return retold(message, lambda name, value: elsewhere(name, value, str(path)))


def _parameter(command: Any, name: str) -> Any:  # noqa: ANN401  # Typer's own classes
    found = (each for each in command.params if each.name == name and each.opts[0][:2] == "--")
    return next(found, None)


def _flag(parameter: Any, value: str) -> str:  # noqa: ANN401
    name = max(parameter.opts, key=len)
    return name if parameter.is_flag else f"{name} {value}"
