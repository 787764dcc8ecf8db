"""``palpate bench fuzz-import``: readers of scans, segments and meshes on damaged real files.

Each case damages one small real file, decided by its seed alone, and reads it in a process of its
own with limits of memory and time. A reader may succeed, or refuse the file with a message; a
crash, a hang, or any other exception is a violation, and its seed repeats it.
"""

from __future__ import annotations

import multiprocessing
import os
import shutil
import signal
import sys
import traceback
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import count
from multiprocessing.connection import Connection
from multiprocessing.context import ForkServerContext
from pathlib import Path
from tempfile import TemporaryDirectory
from time import monotonic

import numpy as np
from numpy.typing import NDArray

from palpate.base.errors import OptionError, PalpateError
from palpate.base.progress import Progress, silent
from palpate.base.reader_process import in_this_process
from palpate.bench.fuzz_samples import Sample, samples_in
from palpate.bench.structured_damage import restructured
from palpate.io.browse import browsed, previews
from palpate.io.headerless import headerless_pictures
from palpate.io.reading import read
from palpate.labels.kind import labels_told
from palpate.labels.labels import read_labels
from palpate.recipes.recipe import read_recipe
from palpate.saved.scene_file import open_scene
from palpate.volumes.mesh_read import read_mesh

__all__ = [
    "Found",
    "Limits",
    "damaged",
    "laid",
    "measure",
    "read_sample",
    "sample_of",
    "tried",
]

MOST_VOXELS = 1 << 25
EXTREMES = (0, 1, 0x7F, 0x80, 0xFF, 0x7FFF, 0x8000, 0xFFFF, 0x7FFF_FFFF, 0x8000_0000, 0xFFFF_FFFF)
"""Extreme numbers that replace lengths and sizes."""


@dataclass(frozen=True)
class Limits:
    """Limits of one case."""

    memory: int = 2 << 30
    """Memory beyond what the process holds at its start [bytes]."""
    processor: int = 30
    """Processor time [s]."""
    wall: float = 300.0
    """Elapsed time, for what waits without working [s]."""


@dataclass
class Found:
    """Results of all cases."""

    outcomes: Counter[str] = field(default_factory=Counter)
    violations: list[tuple[int, str, str]] = field(default_factory=list)
    """Seed, sample, and what happened."""

    @property
    def cases(self) -> int:
        """Number of cases."""
        return sum(self.outcomes.values())


def measure(
    folder: Path,
    *,
    seed: int = 1,
    cases: int | None = None,
    seconds: float | None = None,
    only: Sequence[str] = (),
    limits: Limits | None = None,
    progress: Progress = silent,
) -> Found:
    """Runs cases with increasing seeds, up to a number or a time, of all kinds or ``only`` some.

    Raises:
        OptionError: The folder has no file to damage, a kind is unknown, or the system has no
            limits for processes.
    """
    if sys.platform == "win32":
        raise OptionError("this system has no limits for processes; allowed: Linux or macOS")
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload(["palpate.bench.fuzz_import"])
    found = Found()
    ends = None if seconds is None else monotonic() + seconds
    with TemporaryDirectory(prefix="palpate-") as made:
        samples = _of_kinds(samples_in(folder, Path(made)), only)
        for number in count() if cases is None else range(cases):
            if ends is not None and monotonic() > ends:
                break
            progress(f"case {number + 1}", None if cases is None else number / cases)
            case = seed + number
            sample = sample_of(samples, case)
            outcome = tried(sample, case, limits=limits or Limits(), context=context)
            kind = outcome.split(":", 1)[0]
            found.outcomes[kind] += 1
            if kind not in ("read", "refused"):
                found.violations.append((case, sample.said, outcome))
    return found


# --- what is damaged ----------------------------------------------------------------------


def _of_kinds(samples: list[Sample], only: Sequence[str]) -> list[Sample]:
    there = sorted({sample.kind for sample in samples})
    unknown = [kind for kind in only if kind not in there]
    if unknown:
        raise OptionError(f"kind {unknown[0]!r} given; allowed: {', '.join(there)}")
    return [sample for sample in samples if not only or sample.kind in only]


def sample_of(samples: list[Sample], seed: int) -> Sample:
    """Returns the sample of a case; all kinds are equally frequent."""
    generator = np.random.default_rng([seed, 0])
    kinds = sorted({sample.kind for sample in samples})
    kind = kinds[int(generator.integers(len(kinds)))]
    of_kind = [sample for sample in samples if sample.kind == kind]
    return of_kind[int(generator.integers(len(of_kind)))]


def damaged(content: bytes, seed: int) -> bytes:
    """Returns content with one to three damages, decided by the seed alone.

    In half of the cases they know what the file is made of.
    """
    generator = np.random.default_rng([seed, 1])
    structured = bool(generator.integers(2))
    for _ in range(int(generator.integers(1, 4))):
        if not content:
            break
        damage = DAMAGES[int(generator.integers(len(DAMAGES)))]
        changed = restructured(content, generator) if structured else content
        # of some files no structure is known
        content = damage(content, generator) if changed == content else changed
    return content


def _place(content: bytes, generator: np.random.Generator) -> int:
    """Returns a position, in the header more often than elsewhere."""
    head = generator.random() < 0.7
    return int(generator.integers(min(len(content), 4096) if head else len(content)))


def _truncated(content: bytes, generator: np.random.Generator) -> bytes:
    return content[: _place(content, generator)]


def _flipped(content: bytes, generator: np.random.Generator) -> bytes:
    changed = bytearray(content)
    for _ in range(int(generator.integers(1, 9))):
        changed[_place(content, generator)] ^= 1 << int(generator.integers(8))
    return bytes(changed)


def _extreme(content: bytes, generator: np.random.Generator) -> bytes:
    """Sets two or four bytes to an extreme number, as of a length or a size."""
    width = (2, 4)[int(generator.integers(2))]
    number = EXTREMES[int(generator.integers(len(EXTREMES)))] & (1 << 8 * width) - 1
    place = _place(content, generator)
    put = number.to_bytes(width, "little" if generator.integers(2) else "big")
    return content[:place] + put + content[place + width :]


def _swapped(content: bytes, generator: np.random.Generator) -> bytes:
    """Exchanges two neighbouring pieces, like tags in the wrong order."""
    first, width = _place(content, generator), int(generator.integers(1, 64))
    one, two = content[first : first + width], content[first + width : first + 2 * width]
    return content[:first] + two + one + content[first + 2 * width :]


def _doubled(content: bytes, generator: np.random.Generator) -> bytes:
    first, width = _place(content, generator), int(generator.integers(1, 512))
    return content[: first + width] + content[first:]


def _taken_out(content: bytes, generator: np.random.Generator) -> bytes:
    first, width = _place(content, generator), int(generator.integers(1, 64))
    return content[:first] + content[first + width :]


def _digits(content: bytes, generator: np.random.Generator) -> bytes:
    """Changes a number that is written as text."""
    bytes_of = np.frombuffer(content[:8192], np.uint8)
    places: NDArray[np.intp] = np.flatnonzero((bytes_of >= ord("0")) & (bytes_of <= ord("9")))
    if not places.size:
        return content
    place = int(places[int(generator.integers(places.size))])
    texts = (b"0", b"-1", b"99999999", b"1e308", b"nan", b"4294967296", b".", b"")
    return content[:place] + texts[int(generator.integers(len(texts)))] + content[place + 1 :]


DAMAGES = (_truncated, _flipped, _extreme, _swapped, _doubled, _taken_out, _digits)


# --- one case -----------------------------------------------------------------------------


def tried(sample: Sample, seed: int, *, limits: Limits, context: ForkServerContext) -> str:
    """Returns what a reader does with a damaged sample: read, refused, or what went wrong."""
    with TemporaryDirectory(prefix="palpate-") as folder:
        place = laid(sample, seed, Path(folder))
        mine, theirs = context.Pipe(duplex=False)
        process = context.Process(
            target=_child, args=((sample, place), limits, theirs), daemon=True
        )
        process.start()
        # the end of the process then ends the pipe
        theirs.close()
        try:
            result = str(mine.recv()) if mine.poll(limits.wall) else None
            if result is None:
                process.kill()
        except EOFError:
            result = ""
        process.join()
        mine.close()
    if result:
        return result
    if result is None or process.exitcode == -signal.SIGXCPU:
        return f"hang: more than {limits.processor} s of work, or {limits.wall:g} s of waiting"
    return f"crash: the process ended with code {process.exitcode}"


def laid(sample: Sample, seed: int, folder: Path) -> Path:
    """Writes a damaged sample with the files that belong to it; returns the path to read."""
    content = damaged(sample.path.read_bytes(), seed)
    place = folder / sample.path.name
    for path in sample.beside:
        shutil.copyfile(path, folder / path.name)
    place.write_bytes(content)
    if sample.path.suffix == ".csv":
        # a table is read with the map beside it
        return place.with_suffix(".mha")
    return folder if sample.as_folder else place


def _child(case: tuple[Sample, Path], limits: Limits, results: Connection) -> None:
    """Reads a file in a process of its own, within limits; reports the result."""
    import resource

    os.dup2(os.open(os.devnull, os.O_WRONLY), 2)
    in_this_process()
    held = resource.getrlimit(resource.RLIMIT_AS)[1]
    begun = _address_space() + limits.memory
    most = begun if held == resource.RLIM_INFINITY else min(begun, held)
    resource.setrlimit(resource.RLIMIT_AS, (most, held))
    resource.setrlimit(resource.RLIMIT_CPU, (limits.processor, limits.processor + 1))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    try:
        read_sample(*case)
    except (PalpateError, OSError, MemoryError) as error:
        results.send(f"refused: {error}")
    except BaseException:  # noqa: BLE001  # that is what is looked for
        results.send(f"uncaught: {traceback.format_exc()}")
    else:
        results.send("read")


def _address_space() -> int:
    """Returns the address space of this process [bytes]; 0 where the system does not report it."""
    try:
        pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[0])
    except OSError:
        return 0
    return pages * os.sysconf("SC_PAGE_SIZE")


def read_sample(sample: Sample, place: Path) -> None:
    """Reads what was laid, in each of the ways that its kind is read in.

    Raises:
        PalpateError: It is refused.
        OSError: It cannot be read.
    """
    if sample.kind == "mesh":
        read_mesh(place, frame="LPS", unit="mm")
    elif sample.kind == "scene":
        open_scene(place)
    elif sample.kind == "recipe":
        read_recipe(place)
    elif sample.kind == "pictures":
        try:
            headerless_pictures(place)
        finally:
            read(place, voxel_size=(1.0, 1.0, 1.0), max_voxels=MOST_VOXELS, fill=0.0)
    elif sample.scan is not None:
        read_labels(place, read(sample.scan))
    else:
        # of several volumes in a file one is read too
        frame = 1 if sample.kind == "neuro" else None
        try:
            read(place, max_voxels=MOST_VOXELS, fill=0.0, frame=frame)
        finally:
            labels_told(place)
            with browsed(place) as choices:
                list(previews(choices))
