"""The command line: all commands, each of a module beside this one, and how they fail.

Whatever is wrong with what was given becomes one line on stderr and exit code 2. Heavy
modules are imported inside the commands, so that ``palpate --help`` is quick.
"""

from __future__ import annotations

from pathlib import Path
from threading import current_thread, main_thread
from typing import Annotated, Any

import typer
from typer.exceptions import TyperException

from palpate.base.console import WRONG_INPUT, fail, told_by
from palpate.base.errors import PalpateError
from palpate.base.full_disk import is_full_disk, told_of
from palpate.base.temporary_files import temporary_files
from palpate.cli.bench import (
    bench_cohort,
    bench_deform,
    bench_edit,
    bench_fuzz_import,
    bench_open,
    bench_register,
    bench_render,
    bench_segment,
    bench_session,
    bench_surface,
    bench_truth_cube,
)
from palpate.cli.bench_touch import (
    bench_haptics,
    bench_passivity,
    bench_servo,
    bench_stress,
    bench_touch_quality,
)
from palpate.cli.bids_app import EXAMPLES as BIDS_EXAMPLES
from palpate.cli.bids_app import bids_app
from palpate.cli.compare import EXAMPLES as COMPARE_EXAMPLES
from palpate.cli.compare import compare
from palpate.cli.ended_by_signal import signals_as_ctrl_c
from palpate.cli.export import export
from palpate.cli.flags import as_flags
from palpate.cli.import_scan import EXAMPLES as IMPORT_EXAMPLES
from palpate.cli.import_scan import import_scan
from palpate.cli.info import info
from palpate.cli.landmarks import EXAMPLES as LANDMARKS_EXAMPLES
from palpate.cli.landmarks import landmarks
from palpate.cli.open import demo, open_scan
from palpate.cli.recipe import EXAMPLES as RECIPE_EXAMPLES
from palpate.cli.recipe import run_file
from palpate.cli.reconstruct import EXAMPLES as RECONSTRUCT_EXAMPLES
from palpate.cli.reconstruct import reconstruct
from palpate.cli.record import record
from palpate.cli.recover import EXAMPLES as RECOVER_EXAMPLES
from palpate.cli.recover import recover
from palpate.cli.register import EXAMPLES as REGISTER_EXAMPLES
from palpate.cli.register import register
from palpate.cli.render import EXAMPLES as RENDER_EXAMPLES
from palpate.cli.render import render
from palpate.cli.replay import replay
from palpate.cli.report import report
from palpate.cli.scenario import scenario
from palpate.cli.segment import EXAMPLES, segment
from palpate.cli.series import series
from palpate.cli.share import EXAMPLES as SHARE_EXAMPLES
from palpate.cli.share import share
from palpate.cli.statistics import EXAMPLES as STATISTICS_EXAMPLES
from palpate.cli.statistics import statistics
from palpate.cli.surface import surface
from palpate.cli.touch import EXAMPLES as TOUCH_EXAMPLES
from palpate.cli.touch import touch
from palpate.cli.transform import EXAMPLES as TRANSFORM_EXAMPLES
from palpate.cli.transform import transform
from palpate.cli.written_files import keeping_files

__all__ = ["app", "run"]

SETTINGS: dict[str, Any] = {
    "name": "palpate",
    "help": "Examine medical scans by touch. For research and teaching, not for clinical use.",
    "add_completion": False,
    "no_args_is_help": True,
    "pretty_exceptions_enable": False,
    "context_settings": {"help_option_names": ["-h", "--help"]},
}
app = typer.Typer(**SETTINGS)

STOPPED_BY_PERSON = 130
"""Exit code after Ctrl-C, as shells expect it."""


def run(arguments: list[str]) -> int:
    """Runs the command line with these arguments; returns the exit code."""
    part = _only(arguments)
    with told_by(lambda message: as_flags(message, part, arguments)):
        if current_thread() is not main_thread():
            # neither Ctrl-C nor signals come here
            return _run(part, arguments)
        try:
            with signals_as_ctrl_c(), temporary_files():
                return _run(part, arguments)
        except KeyboardInterrupt:
            return STOPPED_BY_PERSON


def _run(part: typer.Typer, arguments: list[str]) -> int:
    try:
        result = part(args=arguments, prog_name="palpate", standalone_mode=False)
    except TyperException as error:
        # without a command the help was printed instead
        return fail(_usage(error, arguments)) if error.format_message() else WRONG_INPUT
    except (PalpateError, OSError) as error:
        return fail(_system(error) if isinstance(error, OSError) else str(error))
    except MemoryError:
        return fail("not enough memory for this; allowed: a smaller scan, or a bigger machine")
    return result if isinstance(result, int) else 0


def _only(arguments: list[str]) -> typer.Typer:
    """Returns the command line with the command that was typed alone: each takes time to build."""
    one = typer.Typer(**SETTINGS)
    one.registered_callback = app.registered_callback
    one.registered_commands = [
        each for each in app.registered_commands if each.name in arguments[:1]
    ]
    one.registered_groups = [each for each in app.registered_groups if each.name in arguments[:1]]
    return one if one.registered_commands or one.registered_groups else app


def _usage(error: TyperException, arguments: list[str]) -> str:
    """Says what of a command line is wrong, and what is allowed."""
    said = error.format_message().rstrip(".")
    context = getattr(error, "ctx", None)
    if context is None:
        return said
    if said.startswith("Got unexpected extra argument") and "--over" in arguments:
        return (
            "several paths given for --over, as a shell makes them of a pattern without quotes; "
            "allowed: the pattern in quotes, such as --over 'data/*/ct.nii.gz'"
        )
    help_at = f"see {context.command_path} --help"
    given = _given(getattr(error, "param", None), arguments)
    if given is not None:
        return f"{said} (given: {given!r}; {help_at})"
    options = [
        name
        for parameter in context.command.params
        for name in (*parameter.opts, *parameter.secondary_opts)
    ]
    names = [
        *getattr(context.command, "commands", {}),
        *sorted(name for name in options if name.startswith("--")),
    ]
    return f"{said}; allowed: {', '.join(names)} ({help_at})"


def _given(parameter: object, arguments: list[str]) -> str | None:
    """Returns the value that was given for an option, if it was."""
    for option in getattr(parameter, "opts", ()):
        for argument, after in zip(arguments, [*arguments[1:], None], strict=True):
            if argument == option:
                return after
            if argument.startswith(f"{option}="):
                return argument.removeprefix(f"{option}=")
    return None


def _system(error: OSError) -> str:
    """Says what the system refused, and for which file."""
    if error.strerror is None:
        return str(error)
    if is_full_disk(error):
        return told_of(error)
    if isinstance(error, FileNotFoundError) and error.filename is not None:
        folder = Path(error.filename).parent
        if not folder.is_dir():
            return f"folder {str(folder)!r} given; allowed: one that exists"
        return f"{error.filename} does not exist; allowed: an existing file or folder"
    where = error.filename or "the system"
    return f"{where}: {error.strerror}; allowed: what can be read, or written where it is new"


def _print_version(*, asked: bool) -> None:
    if asked:
        from palpate.base.package_version import package_version

        typer.echo(f"palpate {package_version()}")
        raise typer.Exit


@app.callback()
def root(
    *,
    version: Annotated[
        bool,
        typer.Option(
            "--version", is_eager=True, help="Print the version.", callback=_print_version
        ),
    ] = False,
) -> None:
    """Takes the options that stand before a command."""


app.command("open")(open_scan)
app.command("demo")(demo)
app.command("info")(info)
app.command("record")(keeping_files(record))
app.command("replay")(keeping_files(replay))
app.command("export")(keeping_files(export))
app.command("import", epilog=IMPORT_EXAMPLES)(keeping_files(import_scan))
app.command("reconstruct", epilog=RECONSTRUCT_EXAMPLES)(keeping_files(reconstruct))
app.command("register", epilog=REGISTER_EXAMPLES)(keeping_files(register))
app.command("transform", epilog=TRANSFORM_EXAMPLES)(keeping_files(transform))
app.command("render", epilog=RENDER_EXAMPLES)(keeping_files(render))
app.command("series")(series)
app.command("segment", epilog=EXAMPLES)(keeping_files(segment))
app.command("statistics", epilog=STATISTICS_EXAMPLES)(keeping_files(statistics))
app.command("compare", epilog=COMPARE_EXAMPLES)(keeping_files(compare))
app.command("landmarks", epilog=LANDMARKS_EXAMPLES)(keeping_files(landmarks))
app.command("touch", epilog=TOUCH_EXAMPLES)(keeping_files(touch))
app.command("share", epilog=SHARE_EXAMPLES)(keeping_files(share))
app.command("recover", epilog=RECOVER_EXAMPLES)(recover)
app.command("run", epilog=RECIPE_EXAMPLES)(run_file)
app.command("bids", epilog=BIDS_EXAMPLES)(bids_app)
app.command("report")(report)
app.add_typer(surface, name="surface")
app.add_typer(scenario, name="scenario")


bench = typer.Typer(help="Run benchmarks.", no_args_is_help=True)
app.add_typer(bench, name="bench")
bench.command("fuzz-import")(bench_fuzz_import)
bench.command("cohort")(keeping_files(bench_cohort))
bench.command("deform")(keeping_files(bench_deform))
bench.command("open")(keeping_files(bench_open))
bench.command("render")(keeping_files(bench_render))
bench.command("register")(keeping_files(bench_register))
bench.command("segment")(keeping_files(bench_segment))
bench.command("session")(keeping_files(bench_session))
bench.command("truth-cube")(keeping_files(bench_truth_cube))
bench.command("haptics")(keeping_files(bench_haptics))
bench.command("passivity")(keeping_files(bench_passivity))
bench.command("touch-quality")(keeping_files(bench_touch_quality))
bench.command("stress")(keeping_files(bench_stress))
bench.command("servo")(keeping_files(bench_servo))
bench.command("edit")(keeping_files(bench_edit))
bench.command("surface")(keeping_files(bench_surface))
