"""``palpate bench segment --grow``: what one click finds with default settings.

Seeds are taken by rule from labelled organs: the deepest voxel, and random ones of the label
without its border. Each click is judged by its Dice coefficient. Below ``LEAST_DICE`` it has
leaked where more lies outside of the label than is missing, else it is short. Balls with a crisp
border are grown from their middle; the volume is compared with that of the voxels that they were
made of.

Points are in the patient, LPS [mm].
"""

from __future__ import annotations

import time
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from palpate.base.errors import EmptySegmentError, OptionError
from palpate.base.progress import Progress, silent
from palpate.base.simpleitk import simpleitk
from palpate.bench.goals.growing import BALLS, GROW_ROWS, LEAST_DICE, organ_case
from palpate.bench.haptics_data import AMOS, LIDC, LIDC_LABELS, data_file
from palpate.bench.report import Row, rows_in
from palpate.io.reading import read
from palpate.segmentation.mask_shape import Mask, box_of, squared_distance_to
from palpate.segmentation.operations import grown
from palpate.volumes.volume import Volume

__all__ = [
    "ORGANS",
    "Organ",
    "Try",
    "ball_errors",
    "crisp_ball",
    "measure",
    "rows_of",
    "seeds_of",
    "tried",
]

AMOS_LABELS = "amos_0336/labels_from_meshes.nii.gz"

End = Literal["found", "told", "leaked", "short"]
"""What came of a click: the organ, a refusal, or less than ``LEAST_DICE`` of it in silence."""

SEEDS = 3
"""Clicks into each organ."""
DRAW = 1
"""Number that the random ones are drawn by."""
WITHIN = 3.0
"""Least distance of a random seed from the border of the label [mm]."""

NOISES = (0.0, 5.0)
"""Standard deviations of the noise of balls of 150 over 0."""
BALL_RADII = (3.0, 5.0, 7.0, 10.0, 14.0, 20.0)
BALL_SPACINGS = ((1.0, 1.0, 1.0), (1.0, 1.0, 1.5), (0.7, 0.7, 2.5))


@dataclass(frozen=True)
class Organ:
    """A label of a scan."""

    name: str
    scan: str
    labels: str
    label: int


ORGANS = (
    Organ("liver, AMOS", AMOS, AMOS_LABELS, 6),
    Organ("aorta, AMOS", AMOS, AMOS_LABELS, 8),
    Organ("spleen, AMOS", AMOS, AMOS_LABELS, 1),
    Organ("right kidney, AMOS", AMOS, AMOS_LABELS, 2),
    Organ("bladder, AMOS", AMOS, AMOS_LABELS, 14),
    Organ("liver, LIDC", LIDC, LIDC_LABELS, 5),
    Organ("aorta, LIDC", LIDC, LIDC_LABELS, 52),
    Organ("vertebra T12, LIDC", LIDC, LIDC_LABELS, 32),
)


@dataclass(frozen=True)
class Try:
    """What came of a click."""

    seed: tuple[float, float, float]
    end: End
    dice: float
    ratio: float
    """Volume by that of the label."""
    seconds: float
    worked: float
    """Processor time [s]."""
    said: str = ""


def measure(
    organs: Sequence[Organ] = ORGANS, *, draw: int = DRAW, progress: Progress = silent
) -> list[Row]:
    """Clicks into organs and grows balls; returns the rows.

    Raises:
        MissingDataError: A data set is missing.
    """
    tries: list[tuple[Organ, Try]] = []
    for scan, labels in dict.fromkeys((organ.scan, organ.labels) for organ in organs):
        volume = read(data_file(scan))
        marked = simpleitk().GetArrayFromImage(simpleitk().ReadImage(str(data_file(labels))))
        for organ in organs:
            if organ.scan == scan:
                progress(organ.name, None)
                mask = marked == organ.label
                seeds = seeds_of(mask, volume, draw=draw)
                tries += [(organ, tried(volume, mask, seed)) for seed in seeds]
    progress("balls", None)
    return rows_of(tries, max(ball_errors()))


def rows_of(tries: Iterable[tuple[Organ, Try]], ball_error: float) -> list[Row]:
    """Returns the rows of clicks, and of the largest error of a ball's volume."""
    report: dict[str, dict[str, float]] = {BALLS: {"error": ball_error}}
    tries = list(tries)
    for organ, _ in tries:
        own = [one for other, one in tries if other == organ]
        report[organ_case(organ.name)] = _of(own)
    report[organ_case("all")] = _of([one for _, one in tries])
    return rows_in(GROW_ROWS, report)


def seeds_of(
    mask: Mask, volume: Volume, *, count: int = SEEDS, draw: int = DRAW
) -> list[tuple[float, float, float]]:
    """Returns the deepest point of a mask, and random ones of what is not near its border."""
    box = box_of(mask)
    room = squared_distance_to(~mask[box], volume.spacing)
    inner = np.argwhere(room > min(WITHIN**2, 0.25 * room.max()))
    random = np.random.default_rng(draw).choice(len(inner), count - 1, replace=False)
    deepest = np.unravel_index(int(room.argmax()), room.shape)
    places = np.array([deepest, *inner[random]]) + [side.start for side in box]
    grid = places[:, ::-1] + 0.5
    points = grid @ volume.patient_from_grid[:3, :3].T + volume.patient_from_grid[:3, 3]
    return [(float(x), float(y), float(z)) for x, y, z in points]


def tried(volume: Volume, mask: Mask, seed: tuple[float, float, float]) -> Try:
    """Grows from a seed with default settings and compares with a mask."""
    began, worked = time.perf_counter(), time.process_time()
    said, found = "", np.zeros(volume.shape, bool)
    try:
        found = grown(volume, [seed]).mask() != 0
    except (EmptySegmentError, OptionError) as error:
        said = str(error)
    seconds, worked = time.perf_counter() - began, time.process_time() - worked
    own, marked = int(np.count_nonzero(found)), int(np.count_nonzero(mask))
    both = int(np.count_nonzero(found & mask))
    dice = 2.0 * both / (own + marked)
    end: End = "found"
    if said:
        end = "told"
    elif dice < LEAST_DICE:
        end = "leaked" if own - both > marked - both else "short"
    return Try(seed, end, dice, own / marked, seconds, worked, said)


def crisp_ball(
    radius: float, spacing: tuple[float, float, float], *, noise: float = 0.0
) -> tuple[Volume, Mask]:
    """Returns a scan of a ball of 150 over 0 around the middle of its grid, and its voxels."""
    edges = np.array(spacing[::-1])
    shape = 2 * np.ceil((radius + 12.0) / edges).astype(int) + 1
    axes = np.ogrid[tuple(slice(0, int(length)) for length in shape)]
    middle = shape // 2
    off = sum(
        ((axis - place) * edge) ** 2 for axis, place, edge in zip(axes, middle, edges, strict=True)
    )
    mask: Mask = np.asarray(off) <= radius**2
    values = 150.0 * mask + np.random.default_rng(1).normal(0.0, 1.0, mask.shape) * noise
    return Volume(np.rint(values).astype(np.int16), spacing=spacing), mask


def ball_errors() -> Iterator[float]:
    """Returns the errors of volumes of balls, as shares of their volumes."""
    for radius, spacing, noise in product(BALL_RADII, BALL_SPACINGS, NOISES):
        volume, mask = crisp_ball(radius, spacing, noise=noise)
        middle: NDArray[np.float64] = 0.5 * np.array(volume.dimensions)
        seed = volume.patient_from_grid[:3, :3] @ middle + volume.patient_from_grid[:3, 3]
        found = grown(volume, [seed.tolist()]).voxel_count
        yield abs(found / int(np.count_nonzero(mask)) - 1.0)


def _of(tries: list[Try]) -> dict[str, float]:
    """Returns the figures of clicks into one organ, or into all."""
    found = [one for one in tries if not one.said]
    return {
        "found": float(sum(one.end == "found" for one in tries)),
        "told": float(sum(one.end == "told" for one in tries)),
        "leaked": float(sum(one.end == "leaked" for one in tries)),
        "short": float(sum(one.end == "short" for one in tries)),
        "dice": min((one.dice for one in found), default=0.0),
        "seconds": max(one.seconds for one in tries),
        "worked": max(one.worked for one in tries),
    }
