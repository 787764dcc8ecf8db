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
import zipfile
from collections import Counter
from collections.abc import Iterator
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
from palpate.base.simpleitk import simpleitk
from palpate.bench.structured_damage import restructured
from palpate.io.browse import browsed, previews
from palpate.io.dicom.series import is_dicom
from palpate.io.headerless import headerless_pictures
from palpate.io.image_file import FORMATS
from palpate.io.reading import read
from palpate.labels.kind import labels_told
from palpate.labels.labels import read_labels
from palpate.recipes.recipe import read_recipe
from palpate.saved.scene_file import open_scene, save_scene
from palpate.session.appearance import appearances_of, keep_appearances
from palpate.session.session import Session, SessionOptions
from palpate.volumes.mesh_read import read_mesh
from palpate.volumes.scene import Scene
from palpate.volumes.volume import Volume

__all__ = ["Found", "Limits", "Sample", "damaged", "measure", "samples_in", "tried"]

LARGEST_SAMPLE = 600_000
"""Largest file [bytes]; larger ones take long and would be damaged in the same places."""
MOST_VOXELS = 1 << 25
MOST_OF_A_FOLDER = 6
ENDINGS = tuple(ending for some in FORMATS.values() for ending in some)
MESHES = (".stl", ".ply", ".obj", ".glb")
RECIPE = """import:
  path: scan.mha
  unit: HU
segment:
  - threshold: [200, 400]
    keep-largest: true
    name: ball
surface:
  - segment: ball
    out: ball.stl
export:
  - out: labels.nii.gz
    only: [ball]
report: report.html
"""
EXTREMES = (0, 1, 0x7F, 0x80, 0xFF, 0x7FFF, 0x8000, 0xFFFF, 0x7FFF_FFFF, 0x8000_0000, 0xFFFF_FFFF)
"""Extreme numbers that replace lengths and sizes."""


@dataclass(frozen=True)
class Sample:
    """A real file, and how it is read."""

    path: Path
    kind: str
    """scan, series, archive, labels, mesh, pictures, scene or recipe."""
    scan: Path | None = None
    """Scan to which labels belong."""

    @property
    def said(self) -> str:
        """Name in reports."""
        return f"{self.kind} {self.path.parent.name}/{self.path.name}"


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
    limits: Limits | None = None,
    progress: Progress = silent,
) -> Found:
    """Runs cases with increasing seeds, up to a number or a time.

    Raises:
        OptionError: The folder has no file to damage, or the system has no limits for processes.
    """
    if sys.platform == "win32":
        raise OptionError("this system has no limits for processes; allowed: Linux or macOS")
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload(["palpate.bench.fuzz_import"])
    found = Found()
    ends = None if seconds is None else monotonic() + seconds
    with TemporaryDirectory(prefix="palpate-") as made:
        samples = samples_in(folder, Path(made))
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


def samples_in(folder: Path, made: Path) -> list[Sample]:
    """Lists small real files below a folder with the ways to read them, always in the same order.

    Formats that are missing are written into ``made``.

    Raises:
        OptionError: There is no file.
    """
    files = sorted(
        path
        for path in folder.rglob("*")
        if path.is_file() and 0 < path.stat().st_size <= LARGEST_SAMPLE
    )
    dicom = [path for path in files if is_dicom(path)]
    images = [path for path in files if path.name.lower().endswith(ENDINGS)]
    scans = sorted({path.parent for path in dicom if path.parent.name in ("image", "ct-3slice")})
    samples = [Sample(path, "scan") for path in [*dicom, *images]]
    samples += [Sample(path, "series") for path in dicom if path.parent in scans]
    samples += [
        Sample(path, "labels", scan)
        for path in [*dicom, *images]
        for scan in scans
        if scan.parent in path.parents and path.parent != scan
    ]
    samples += [Sample(path, "mesh") for path in files if path.suffix in MESHES]
    for scan in scans:
        samples.append(Sample(_archive(scan, made / f"{scan.parent.name}.zip"), "archive"))
    small = [path for path in images if path.name.endswith(".nii.gz")][:1]
    samples += [Sample(path, "scan") for image in small for path in _rewritten(image, made)]
    if not samples:
        raise OptionError(
            f"{folder} holds no scan, label or mesh of at most {LARGEST_SAMPLE} bytes; "
            "allowed: a folder with some"
        )
    return samples + _made(made)


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


def _archive(folder: Path, target: Path) -> Path:
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as archive:
        for path in sorted(folder.iterdir())[:MOST_OF_A_FOLDER]:
            # one moment for all: the same bytes on every run
            archive.writestr(zipfile.ZipInfo(path.name), path.read_bytes())
    return target


def _made(made: Path) -> list[Sample]:
    """Writes pictures, a scene, a recipe and a label map with its table."""
    sitk = simpleitk()
    values = np.arange(12 * 10 * 8, dtype=np.int16).reshape(8, 10, 12)
    pages, picture, scene, recipe, scan, labels = (
        made / name
        for name in ("p.tif", "p.png", "s.palpate", "r.yaml", "labels/scan.mha", "labels/a.mha")
    )
    scan.parent.mkdir()
    sitk.WriteImage(sitk.GetImageFromArray(values), str(pages))
    sitk.WriteImage(sitk.GetImageFromArray(values[0].astype(np.uint8)), str(picture))
    sitk.WriteImage(sitk.GetImageFromArray(values), str(scan))
    sitk.WriteImage(sitk.GetImageFromArray(values // 300), str(labels))
    volume = Volume(values, spacing=(1.0, 1.0, 2.0))
    with Session(
        Scene(volume, [volume.threshold(500.0)]), options=SessionOptions(real_time=False)
    ) as session:
        looks = keep_appearances(session, appearances_of(session).__getitem__)
        save_scene(scene, session, looks=looks, copy=True)
    recipe.write_text(RECIPE, "utf-8")
    table = scan.with_name("a.csv")
    table.write_text("id,structure,red,green,blue\n1,one,1,0,0\n2,two,0,1,0.5\n", "utf-8")
    return [
        Sample(pages, "pictures"),
        Sample(picture, "pictures"),
        Sample(scene, "scene"),
        Sample(recipe, "recipe"),
        Sample(labels, "labels", scan),
        Sample(table, "labels", scan),
    ]


def _rewritten(image: Path, made: Path) -> Iterator[Path]:
    """Writes a corner of an image in each format."""
    sitk = simpleitk()
    corner = sitk.ReadImage(str(image))[:16, :16, :16]
    for name in ("a.nii", "b.mha", "c.nrrd", "d.mhd", "e.nhdr"):
        sitk.WriteImage(corner, str(made / name), name == "c.nrrd")
        yield made / name


# --- one case -----------------------------------------------------------------------------


def tried(sample: Sample, seed: int, *, limits: Limits, context: ForkServerContext) -> str:
    """Returns what a reader does with a damaged sample: read, refused, or what went wrong."""
    with TemporaryDirectory(prefix="palpate-") as folder:
        place = _laid(sample, seed, Path(folder))
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


def _laid(sample: Sample, seed: int, folder: Path) -> Path:
    """Writes a damaged sample with the files that belong to it; returns the path to read."""
    content = damaged(sample.path.read_bytes(), seed)
    place = folder / sample.path.name
    if sample.kind == "series" or sample.scan == sample.path.with_name("scan.mha"):
        for path in sorted(sample.path.parent.iterdir())[:MOST_OF_A_FOLDER]:
            shutil.copyfile(path, folder / path.name)
    for ending in (".raw", ".zraw"):
        voxels = sample.path.with_suffix(ending)
        if voxels.is_file():
            shutil.copyfile(voxels, folder / voxels.name)
    place.write_bytes(content)
    if sample.path.suffix == ".csv":
        # a table is read with the map beside it
        return place.with_suffix(".mha")
    return folder if sample.kind == "series" else place


def _child(laid: tuple[Sample, Path], limits: Limits, results: Connection) -> None:
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
        _read(*laid)
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


def _read(sample: Sample, place: Path) -> None:
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
        try:
            read(place, max_voxels=MOST_VOXELS, fill=0.0)
        finally:
            labels_told(place)
            with browsed(place) as choices:
                list(previews(choices))
