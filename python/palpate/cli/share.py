"""``palpate share``: a scene or a recording as others may have it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from palpate.base.console import Display, quiet_libraries, warn
from palpate.base.counted import counted
from palpate.cli.written_files import WRITES

if TYPE_CHECKING:
    from palpate.base.progress import Progress
    from palpate.saved.shared_names import SharedNames

__all__ = ["EXAMPLES", "share"]

EXAMPLES = """\b
Examples:
  palpate share work.palpate -o shared.palpate
  palpate share session.palpate-session -o shared.palpate-session

A scene gets its scan, and loses paths, identifiers and the name of the scan; a recording loses that
name and when it was made. Names of segments and marks lose what the headers of the DICOM files say
of the patient. Where there are no headers, names become numbers, unless you have looked at them.
"""


def share(
    path: Annotated[
        Path,
        typer.Argument(
            help="Saved scene (.palpate) or recording (.palpate-session).", metavar="FILE"
        ),
    ],
    *,
    out: Annotated[
        Path,
        typer.Option("--out", "-o", help="File to write, of the same kind.", metavar="FILE"),
        WRITES,
    ],
    names_checked: Annotated[
        bool,
        typer.Option(
            "--names-checked",
            help="Say that you have looked at the names of segments and marks: none names anybody.",
        ),
    ] = False,
    pixels_checked: Annotated[
        bool,
        typer.Option(
            "--pixels-checked",
            help="Say that you have looked for text in the pixels of all images.",
        ),
    ] = False,
) -> None:
    """Write a scene or a recording without what names the patient, or your folders."""
    _check_out(path, out)
    with quiet_libraries(), Display() as display:
        names = _shared(path, out, names=names_checked, pixels=pixels_checked, progress=display)
    if names.replaced:
        warn(
            f"{counted(names.replaced, 'name', 'names')} became numbers: nothing tells whether "
            "they name somebody; allowed: --names-checked once you have looked at them"
        )
    kept = ", ".join(names.kept) or "none"
    typer.echo(f"{out}: {out.stat().st_size / 2**20:.1f} MiB; names in it: {kept}")


def _shared(path: Path, out: Path, *, names: bool, pixels: bool, progress: Progress) -> SharedNames:
    from palpate.saved.ending import ENDING

    if path.suffix == ENDING:
        from palpate.saved.shared_scene import share_scene

        return share_scene(path, out, names_checked=names, pixels_checked=pixels, progress=progress)
    from palpate.saved.shared_recording import share_recording

    return share_recording(path, out, names_checked=names)


def _check_out(path: Path, out: Path) -> None:
    """Refuses what is neither scene nor recording, and a result that would be called otherwise.

    Raises:
        OptionError: It is.
    """
    from palpate.base.errors import OptionError

    endings = (".palpate", ".palpate-session")
    if path.suffix not in endings:
        raise OptionError(
            f"{path} given; allowed: {' or '.join(endings)} files; scans are shared "
            "by `palpate export`"
        )
    if out.suffix != path.suffix:
        raise OptionError(f"{out} given; allowed: a {path.suffix} file")
    if not out.absolute().parent.is_dir():
        raise OptionError(f"folder {str(out.parent)!r} given; allowed: one that exists")
