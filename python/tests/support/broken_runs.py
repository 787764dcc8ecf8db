"""Commands on recipes, tables, scans and scenes that are damaged, each in a process of its own.

What is changed is decided by a seed alone: what a recipe says, its bytes, or those of a file that
it reads.
"""

from __future__ import annotations

import multiprocessing
import os
import resource
from collections.abc import Callable
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

import numpy as np
import SimpleITK
import yaml
from palpate.bench.fuzz_import import damaged
from palpate.cli.commands import run
from palpate.io.reading import read
from palpate.saved.scene_file import save_scene
from palpate.session.session import Session, SessionOptions
from palpate.volumes.scene import Scene

SECONDS, MEMORY = 60, 4 << 30
"""Of processor time and address space beyond the start, for one case."""
RECIPE = """\
import: {path: ct.nii.gz, unit: HU}
segment:
  - {threshold: 100, name: block, smooth: 1, keep-largest: true}
  - {threshold: [-500, 50], name: air}
surface:
  - {segment: block, out: block.stl, smoothing: 0.5}
export:
  - {out: labels.nii.gz, only: [block]}
  - {out: all.seg.nrrd}
compare:
  - {reference: mask.nii.gz, segment: block, out: agreement.csv}
landmarks:
  - {segment: block, out: landmarks.csv}
touch:
  - {segment: block, at: superior, depth: 1, radius: 2, speed: 100, material: fat, out: press.csv}
transform:
  - {path: mask.nii.gz, transform: moved.tfm, output: moved.nii.gz}
picture:
  - {out: view.png, size: [64, 64]}
report: report.html
"""
VALUES: tuple[Any, ...] = (
    None, True, 0, -1, 1e308, float("nan"), float("inf"), 10**30, "", " ", "nan", "../none",
    "\x1b[2J", "ct.nii.gz", "work.palpate", "mask.nii.gz", "{scan}", "{", "é\u2028", "a" * 5000,
    "block", "2", [], [1], [1, 2, 3], [[1]], {}, {"a": 1}, [None], ["block", "block"],
    "labels.nii.gz", ".", "/",
)  # fmt: skip
TABLE = "case,scan,low\na,ct.nii.gz,100\nb,mask.nii.gz,0.5\n"
OF_TABLE = """\
import: {path: "{scan}", unit: HU}
segment:
  - {threshold: "{low}", name: block}
report: report.html
"""


def write_files(folder: Path) -> None:
    values = np.full((14, 14, 14), -1000, np.int16)
    values[3:10, 3:10, 3:10] = 300
    image = SimpleITK.GetImageFromArray(values)
    SimpleITK.WriteImage(image, str(folder / "ct.nii.gz"))
    SimpleITK.WriteImage(image > 100, str(folder / "mask.nii.gz"))
    moved = SimpleITK.TranslationTransform(3, (1.0, 0.0, 0.0))
    SimpleITK.WriteTransform(moved, str(folder / "moved.tfm"))
    volume = read(folder / "ct.nii.gz", unit="HU")
    scene = Scene(volume, [volume.threshold(100.0, name="block")])
    with Session(scene, options=SessionOptions(real_time=False)) as session:
        save_scene(folder / "work.palpate", session, copy=True)


def changed(text: str, random: np.random.Generator) -> str:
    """Changes one or two places of a recipe: another value, another name, one more or one less."""
    recipe = yaml.safe_load(text)
    for _ in range(int(random.integers(1, 3))):
        places = list(_places(recipe))
        within, key = places[int(random.integers(len(places)))]
        value = VALUES[int(random.integers(len(VALUES)))]
        kind = int(random.integers(5))
        if kind == 0:
            del within[key]
        elif kind == 1 and isinstance(within, dict):
            within[str(value)] = within.pop(key)
        elif kind == 2 and isinstance(within[key], list):
            within[key] += [*within[key], value]
        else:
            within[key] = value
        if not recipe:
            break
    return str(yaml.safe_dump(recipe, allow_unicode=True))


def _places(held: Any) -> Any:
    for key in list(held) if isinstance(held, dict) else range(len(held)):
        yield held, key
        if isinstance(held[key], dict | list):
            yield from _places(held[key])


def of_recipe(folder: Path, random: np.random.Generator) -> list[str]:
    (folder / "recipe.yaml").write_text(changed(RECIPE, random), "utf-8")
    return ["run", "recipe.yaml"]


def of_bytes(folder: Path, random: np.random.Generator) -> list[str]:
    """Damages the recipe, or a file that it reads."""
    (folder / "recipe.yaml").write_text(RECIPE, "utf-8")
    names = ("recipe.yaml", "ct.nii.gz", "mask.nii.gz", "moved.tfm")
    path = folder / names[int(random.integers(len(names)))]
    path.write_bytes(damaged(path.read_bytes(), int(random.integers(1 << 30))))
    return ["run", "recipe.yaml"]


def of_table(folder: Path, random: np.random.Generator) -> list[str]:
    """Damages a table, a cell of it, or the recipe that it fills."""
    table, recipe = TABLE.encode(), OF_TABLE
    match int(random.integers(3)):
        case 0:
            table = damaged(table, int(random.integers(1 << 30)))
        case 1:
            cells = [line.split(",") for line in TABLE.splitlines()]
            row = cells[int(random.integers(len(cells)))]
            row[int(random.integers(len(row)))] = str(VALUES[int(random.integers(len(VALUES)))])
            table = "\n".join(map(",".join, cells)).encode()
        case _:
            recipe = changed(OF_TABLE, random)
    (folder / "cases.csv").write_bytes(table)
    (folder / "recipe.yaml").write_text(recipe, "utf-8")
    return ["run", "recipe.yaml", "--table", "cases.csv", "-o", "out", "--dry-run"]


def of_scene(folder: Path, random: np.random.Generator) -> list[str]:
    path = folder / "work.palpate"
    path.write_bytes(damaged(path.read_bytes(), int(random.integers(1 << 30))))
    ways = (
        ["export", "work.palpate", "-o", "x.seg.nrrd"],
        ["statistics", "work.palpate"],
        ["share", "work.palpate", "-o", "x.palpate"],
        ["render", "work.palpate", "-o", "x.png"],
    )
    return ways[int(random.integers(len(ways)))]


KINDS: dict[str, Callable[[Path, np.random.Generator], list[str]]] = {
    "recipe": of_recipe, "bytes": of_bytes, "table": of_table, "scene": of_scene,
}  # fmt: skip


def case(kind: str, seed: int, folder: str, results: Connection) -> None:
    """Makes a case, runs the command, and tells how it ended."""
    os.chdir(folder)
    write_files(Path())
    command = KINDS[kind](Path(), np.random.default_rng(seed))
    with open("told", "w+b") as told:  # noqa: PTH123  # its number is needed
        os.dup2(told.fileno(), 2)
        os.dup2(told.fileno(), 1)
    resource.setrlimit(resource.RLIMIT_CPU, (SECONDS, SECONDS + 1))
    results.send((command, run(command)))


def ended(kind: str, seed: int, folder: Path) -> tuple[list[str], int | None, str]:
    """Returns the command, its exit code, and what it said; a code of None for none."""
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload(["palpate.cli.commands", "palpate.recipes.run", __name__])
    mine, theirs = context.Pipe(duplex=False)
    process = context.Process(target=case, args=(kind, seed, str(folder), theirs))
    process.start()
    theirs.close()
    try:
        command, code = mine.recv() if mine.poll(6 * SECONDS) else ([], None)
    except EOFError:
        command, code = [], None
    process.kill() if code is None else None
    process.join()
    said = folder / "told"
    return command, code, said.read_text("utf-8", "replace") if said.exists() else ""
