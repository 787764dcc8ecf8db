"""Registration: where the points of one scan lie in another, by SimpleITK.

Rigid first, then affine, then B-spline, each from coarse to fine grids, until a metric of the
values says that both scans are alike. The scans themselves are never changed.

Frames: patient of each scan, LPS [mm]. **A transform takes points of the fixed scan to the moving
one**: so the moving scan is drawn on the grid of the fixed one, and so ITK writes ``.tfm`` files.

Sources: mutual information: Mattes et al., IEEE TMI 22(1), 2003; bending: Rueckert et al., IEEE
TMI 18(8), 1999; the way through the levels: Avants et al., Front. Neuroinform. 8, 2014.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np

from palpate.base.errors import OptionError
from palpate.base.interpolation import InterpolationChoice
from palpate.base.progress import Progress, silent
from palpate.base.simpleitk import image_on, reason_of, simpleitk
from palpate.base.whole_file import whole_file
from palpate.registration.image_pair import Compared, check_content
from palpate.registration.inverse import Inverse, inverse_of
from palpate.registration.options import (
    Kind,
    Level,
    Metric,
    MetricChoice,
    Pairs,
    Points,
    RegistrationError,
    SearchOptions,
    Start,
    Watch,
    check_choices,
    checked_landmarks,
    checked_matrix,
    unwatched,
)
from palpate.registration.other_places import OtherPlaces
from palpate.registration.point_map import matrix_of
from palpate.registration.search import Search
from palpate.registration.start import first_guess, guess_of_matrix
from palpate.volumes.resampled import resampled
from palpate.volumes.segment import Segment
from palpate.volumes.volume import Volume

__all__ = [
    "Level",
    "Registration",
    "RegistrationError",
    "SearchOptions",
    "metric_for",
    "register",
    "resampled",
    "write_transform",
]

LEAST_VOXELS = 4
"""Along each axis, for gradients."""
PROBES = 9
"""Points along each axis of the fixed scan at which a transform is looked at."""


@dataclass(frozen=True, kw_only=True)
class Registration:
    """A transform that was found, and how."""

    transform: Any
    """SimpleITK's, from points of the fixed scan to points of the moving one."""
    kind: Kind
    metric: Metric
    start: Start | Literal["matrix", "turned"]
    """Turned is one that leads to where the scans are more alike than the usual one does."""
    before: float
    """The metric at the start; it is made small."""
    after: float
    """The metric in the end, over the same voxels."""
    overlap_before: float
    """Share of the fixed scan, or of its mask, that the moving one covers at the start."""
    overlap: float
    """The same share in the end."""
    curve: tuple[Level, ...]
    """The metric after each step, level by level."""
    start_kept: bool = False
    """Whether the start was right already, and is the answer."""
    doubt: str | None = None
    """What speaks against it: another place where the scans are as alike."""

    def points(self, points: Sequence[Sequence[float]] | Points) -> Points:
        """Returns where points of the fixed scan lie in the moving one, shape [count, 3] [mm]."""
        given = np.asarray(points, np.float64).reshape(-1, 3)
        found = [self.transform.TransformPoint(point.tolist()) for point in given]
        return np.array(found, np.float64).reshape(-1, 3)

    @property
    def matrix(self) -> Points | None:
        """The transform as a homogeneous matrix, shape [4, 4] [mm]; None where it bends."""
        return matrix_of(self.transform) if self.transform.IsLinear() else None

    @property
    def unbent(self) -> Points:
        """The matrix without what bends, shape [4, 4] [mm]: where a next search may begin."""
        bends = not self.transform.IsLinear()
        return matrix_of(self.transform.GetNthTransform(0) if bends else self.transform)

    def moved(self, fixed: Volume) -> Points:
        """Returns how far points all over the fixed scan move, shape [count, 3] [mm]."""
        places = np.linspace(0.0, 1.0, PROBES)
        grid = np.stack(np.meshgrid(places, places, places), axis=-1).reshape(-1, 3)
        voxels = np.hstack([grid * fixed.dimensions, np.ones((len(grid), 1))])
        points = (voxels @ fixed.patient_from_grid.T)[:, :3]
        return self.points(points) - points

    def save(self, path: Path) -> None:
        """Writes the transform as ``.tfm``, which ITK, 3D Slicer and others read; whole or not.

        Raises:
            OptionError: The name ends otherwise.
            OSError: The disk refuses it.
        """
        write_transform(self.transform, path)

    def inverse(self, moving: Volume) -> Inverse:
        """Returns the transform from points of the moving scan to the fixed one, and its error.

        Raises:
            OptionError: There is none: the transform folds.
        """
        return inverse_of(self.transform, moving)

    def save_inverse(self, path: Path, moving: Volume) -> dict[str, Any]:
        """Writes the inverse as ``.tfm``; returns how good it is, ready for JSON.

        Raises:
            OptionError: The name ends otherwise, or there is no inverse.
            OSError: The disk refuses it.
        """
        inverse = self.inverse(moving)
        write_transform(inverse.transform, path)
        return inverse.report

    def resampled(
        self,
        moving: Volume,
        fixed: Volume,
        *,
        interpolation: InterpolationChoice = "automatic",
    ) -> Volume:
        """Returns the moving scan on the grid of the fixed one; beyond it, its lowest value.

        By default label maps take the nearest label, and scans are linear between voxels.
        """
        return resampled(moving, fixed, self.transform, interpolation=interpolation)


def register(  # noqa: PLR0913  # one for each thing that can be chosen
    fixed: Volume,
    moving: Volume,
    *,
    kind: Kind = "rigid",
    metric: MetricChoice = "automatic",
    start: Start | Points | None = None,
    landmarks: Pairs | None = None,
    fixed_mask: Segment | None = None,
    moving_mask: Segment | None = None,
    options: SearchOptions | None = None,
    progress: Progress = silent,
    watch: Watch = unwatched,
) -> Registration:
    """Finds where the points of one scan lie in another.

    Args:
        fixed: The scan that stays.
        moving: The scan that is brought to it; both are left as they are.
        kind: rigid, affine or bspline; each begins with the one before.
        metric: How alike scans are: mutual information also compares CT with MR;
            correlation asks that values of one follow those of the other linearly, mean squares
            that they are the same. Automatic: correlation of two scans by CT, else mutual
            information.
        start: First guess: as the files place both scans; the centres of their grids; the
            centres of mass of what is bright; landmarks; or a matrix from points of the fixed scan
            to the moving one, shape [4, 4] [mm], of which a rigid search takes the turn and the
            shift. By default landmarks where they are given, else the centres of the grids, or a
            turned start where the scans are clearly more alike than where those lead.
        landmarks: Points of the fixed scan and the same places in the moving one, three or more
            that are not on one line, shape [count, 3] each [mm].
        fixed_mask: Only these voxels of the fixed scan are compared.
        moving_mask: Only these of the moving one.
        options: How it is searched.
        progress: Told how far it is; what it raises stops the search and is raised from here.
        watch: Called with the metric so far after each step.

    Raises:
        OptionError: A choice is not known, landmarks do not fit, a scan is too small or has one
            value only, or a mask has no voxels.
        RegistrationError: The scans do not overlap, or did not become more alike.
    """
    matrix = checked_matrix(start) if isinstance(start, np.ndarray) else None
    named: Start = "landmarks" if landmarks is not None else "centre"
    if isinstance(start, str):
        named = start
    check_choices(kind, metric, named)
    for volume in (fixed, moving):
        if min(volume.dimensions) < LEAST_VOXELS:
            size = " x ".join(map(str, volume.dimensions))
            raise OptionError(
                f"{volume.name!r} of {size} voxels is too small; allowed: {LEAST_VOXELS} voxels or "
                "more along each axis"
            )
    chosen = metric_for(fixed, moving) if metric == "automatic" else metric
    images = _image(fixed), _image(moving)
    masks = _mask(fixed_mask), _mask(moving_mask)
    check_content(images, masks)
    wanted = options or SearchOptions()
    compared = Compared(images, masks, metric=chosen, bins=wanted.bins)
    search = Search(compared, options=wanted, progress=progress, watch=watch)
    if matrix is None:
        pairs = checked_landmarks(landmarks, wanted=named == "landmarks")
        first = first_guess(images, masks=masks, start=named, landmarks=pairs)
    else:
        first = guess_of_matrix(images[0], matrix, rigid=kind == "rigid")
    before = search.measure(first)
    progress("looking at turned starts", 0.0)
    others = OtherPlaces(compared, seed=wanted.seed)
    is_free = start is None and landmarks is None
    begun = others.start(first) if is_free else first
    found = search.run(begun, kind, near=begun is not first)
    after = search.measure(found)
    search.check(before, after)
    start_kept = not after.metric < before.metric
    if start_kept:
        # they are registered already, within the noise of a few samples
        search.require_best(first, before, after)
        found, after = first, before
    return Registration(
        transform=found,
        kind=kind,
        metric=chosen,
        start=_start_told(named, matrix, is_turned=begun is not first),
        before=before.metric,
        after=after.metric,
        overlap_before=before.overlap,
        overlap=after.overlap,
        curve=search.curve,
        start_kept=start_kept,
        doubt=others.doubt(first, found),
    )


def _start_told(
    named: Start, matrix: Points | None, *, is_turned: bool
) -> Start | Literal["matrix", "turned"]:
    if is_turned:
        return "turned"
    return named if matrix is None else "matrix"


def metric_for(fixed: Volume, moving: Volume) -> Metric:
    """Returns what compares two scans of these modalities best."""
    both_ct = fixed.modality == "CT" == moving.modality
    return "correlation" if both_ct else "mutual-information"


def write_transform(transform: Any, path: Path) -> None:  # noqa: ANN401  # SimpleITK's
    """Writes a transform as ``.tfm``, whole or not.

    Raises:
        OptionError: The name ends otherwise.
        OSError: The disk refuses it.
    """
    if path.suffix != ".tfm":
        raise OptionError(f"{path.name!r} given; allowed: a name with .tfm")
    with whole_file(path) as unfinished:
        try:
            simpleitk().WriteTransform(transform, str(unfinished))
        except RuntimeError as error:
            raise OSError(5, f"cannot be written ({reason_of(error)})", str(path)) from None


def _image(volume: Volume) -> Any:  # noqa: ANN401  # SimpleITK has no types
    """Returns the values of a scan [its unit] as SimpleITK's image."""
    return image_on(volume, volume.intensities())


def _mask(segment: Segment | None) -> Any:  # noqa: ANN401  # SimpleITK has no types
    return None if segment is None else image_on(segment.volume, segment.mask())
