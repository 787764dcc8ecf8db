"""``palpate recover``: changes that were set aside, listed, brought back or removed."""

from __future__ import annotations

import shlex
from typing import TYPE_CHECKING, Annotated, Any

import typer

from palpate.base.errors import OptionError

if TYPE_CHECKING:
    from palpate.saved.set_aside import SetAside

__all__ = ["EXAMPLES", "recover"]

EXAMPLES = """\b
Examples:
  palpate recover                                   (lists what is set aside)
  palpate recover --restore 20260301-1415
  palpate recover --remove 20260301-1415

Changes are set aside where the question whether to bring them back is answered with no, and where a
damaged file could not be followed. A name may be shortened as long as it is the only one.
"""


def recover(
    *,
    restore: Annotated[
        str | None,
        typer.Option(help="Have the next start with the scan offer these changes.", metavar="NAME"),
    ] = None,
    remove: Annotated[
        str | None, typer.Option(help="Remove these changes for good.", metavar="NAME")
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print a JSON list.")] = False,
) -> None:
    """List, restore or remove changes that were set aside."""
    from palpate.saved.set_aside import set_aside

    if restore is not None and remove is not None:
        raise OptionError("--restore and --remove given; allowed: one of both")
    found = set_aside()
    if restore is not None:
        one = _named(restore, found)
        one.restore()
        typer.echo(f"{one.name} is offered at the next start: {_how(one)}")
    elif remove is not None:
        one = _named(remove, found)
        one.remove()
        typer.echo(f"{one.name} is removed")
    elif as_json:
        import json

        typer.echo(json.dumps([_described(one) for one in found], indent=2))
    else:
        _print(found)


def _named(name: str, found: list[SetAside]) -> SetAside:
    """Returns the one of that name, or whose name begins so.

    Raises:
        OptionError: There is none, or several.
    """
    those = [one for one in found if one.name.startswith(name)]
    if not name or len(those) != 1:
        names = ", ".join(one.name for one in those or found) or "nothing is set aside"
        raise OptionError(f"{name!r} given; allowed: {names}")
    return those[0]


def _how(one: SetAside) -> str:
    place = None if one.scan is None else one.scan.place
    if place is None:
        return "open its scan again"
    return f"palpate open {shlex.quote(str(place))}"


def _described(one: SetAside) -> dict[str, Any]:
    return {
        "name": one.name,
        "scan": None if one.scan is None else one.scan.name,
        "path": None if one.scan is None else one.scan.path,
        "changed": one.changed.isoformat(timespec="seconds"),
        "until": one.until.isoformat(timespec="seconds"),
        "bytes": one.bytes,
    }


def _print(found: list[SetAside]) -> None:
    if not found:
        typer.echo("nothing is set aside")
        return
    typer.echo(f"{'name':24}{'last change':20}{'kept until':14}{'size':>10}  scan")
    for one in found:
        scan = "unknown" if one.scan is None else one.scan.name
        size = f"{one.bytes / 2**20:.1f} MiB"
        days = f"{one.changed:%Y-%m-%d %H:%M}    {one.until:%Y-%m-%d}    "
        typer.echo(f"{one.name:24}{days}{size:>10}  {scan}")
