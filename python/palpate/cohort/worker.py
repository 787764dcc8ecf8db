"""The process of one case: takes its request on stdin, and leaves done.json or failed.json.

It ends with whoever started it: their end of stdin closes then.
"""

from __future__ import annotations

import json
import os
import sys
from contextlib import suppress
from pathlib import Path
from threading import Thread
from time import monotonic
from typing import Any

from palpate.base.errors import OptionError, PalpateError
from palpate.base.package_version import package_version
from palpate.base.reader_process import warm
from palpate.cohort.case_figures import THUMBNAIL, measured_segments, write_thumbnail
from palpate.cohort.inputs import inputs_of, recipe_hash, told_inputs
from palpate.export.kinds import Kind, kind_of
from palpate.recipes.check import check_options, read_inputs
from palpate.recipes.filled import filled, placed
from palpate.recipes.recipe import recipe_of
from palpate.recipes.run import run_recipe
from palpate.recipes.source import read_source
from palpate.recipes.steps import Recipe

__all__ = ["main"]

HOLD_SEGMENTS: tuple[Kind, ...] = ("seg-nrrd", "labels", "dicom-seg", "dicom-labelmap", "rtstruct")


def main() -> None:
    """Runs the case that stdin names."""
    warm()
    line = sys.stdin.buffer.readline()
    if not line:
        return
    Thread(target=_end_with_parent, daemon=True).start()
    request = json.loads(line)
    part = Path(request["part"])
    _limit(request["memory"])
    try:
        told, name = _run(request, part), "done.json"
    except MemoryError:
        reason = "not enough memory; a higher memory limit gives it more"
        told, name = {"reason": reason}, "failed.json"
    except (PalpateError, OSError) as error:
        told, name = {"reason": str(error)}, "failed.json"
    except Exception as error:  # noqa: BLE001  # a case that fails is told, whatever it is
        told, name = {"reason": f"{type(error).__name__}: {error}"}, "failed.json"
    text = json.dumps(told, indent=1, ensure_ascii=False) + "\n"
    (part / name).write_text(text, "utf-8")
    # threads of libraries are not waited for
    os._exit(0)


def _run(request: dict[str, Any], part: Path) -> dict[str, Any]:
    begun = monotonic()
    scan = request["scan"]
    source = read_source(Path(request["recipe"]))
    source = filled(source, request["variables"], scan=None if scan is None else Path(scan))
    inputs = told_inputs(inputs_of(source))
    recipe = placed(recipe_of(source), source, part)
    check_options(recipe, source)
    try:
        made = run_recipe(recipe, read_inputs(recipe, source))
    except PalpateError as error:
        raise OptionError(source.said(str(error))) from error
    measured, of_names = measured_segments(made.scene, made.measures.columns)
    write_thumbnail(made.scene, part / THUMBNAIL)
    return {
        "recipe_sha256": recipe_hash(source),
        "inputs": inputs,
        "palpate": package_version(),
        "wall_s": round(monotonic() - begun, 3),
        "cpu_s": round(sum(os.times()[:4]), 3),
        "peak_memory_bytes": _peak_memory(),
        "warnings": [source.said(sentence) for sentence in (*made.told, *of_names)],
        "files": [path.relative_to(part).as_posix() for path in made.written],
        "labels": _labels(recipe, part),
        "scan": None if recipe.scan is None else str(recipe.scan.path),
        "segments": measured,
    }


def _labels(recipe: Recipe, part: Path) -> str | None:
    """Returns the first file that holds the segments: `palpate open --segments` takes it."""
    for export in recipe.export:
        kind = export.kind or kind_of(export.out, has_segments=bool(recipe.segment))
        if kind in HOLD_SEGMENTS:
            return export.out.relative_to(part).as_posix()
    return None


def _peak_memory() -> int | None:
    if sys.platform == "win32":
        return None
    import resource

    peak = max(
        resource.getrusage(who).ru_maxrss
        for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)
    )
    return peak if sys.platform == "darwin" else peak * 1024


def _limit(memory: int | None) -> None:
    """Sets how much memory this process may take for data [bytes]; Linux alone counts that."""
    if memory is not None and sys.platform == "linux":
        import resource

        resource.setrlimit(resource.RLIMIT_DATA, (memory, memory))


def _end_with_parent() -> None:
    with suppress(OSError):
        sys.stdin.buffer.read()
    os._exit(1)


if __name__ == "__main__":
    main()
