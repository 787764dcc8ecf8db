"""Reports of a registration: figures for programs, a sentence and a picture for people."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from palpate.base.simpleitk import image_on, reason_of, simpleitk
from palpate.base.whole_file import whole_file
from palpate.registration.options import Pairs, Points
from palpate.registration.point_map import points_through
from palpate.registration.registration import Registration
from palpate.volumes.volume import Volume

__all__ = ["landmark_errors", "report_of", "sentence_of", "write_checkerboard"]

TILES = 8
"""Along the longer side of a plane."""
LONGEST = 400
"""Pixels along the longest side of the scan."""
PROBES = 24
"""Places along each axis of the fixed scan by which the middle of what both show is found."""
GAP = 6
"""Between planes [pixels]."""
DARKEST, BRIGHTEST = 1.0, 99.0
"""Percentiles of a scan's values that become black and white."""

Grey = NDArray[np.uint8]


def landmark_errors(pairs: Pairs, found: Registration | None) -> Points:
    """Returns how far each landmark is from its place, before any transform or after [mm]."""
    fixed, moving = (np.asarray(points, np.float64) for points in pairs)
    places = fixed if found is None else found.points(fixed)
    errors: Points = np.linalg.norm(places - moving, axis=1)
    return errors


def report_of(
    found: Registration, fixed: Volume, moving: Volume, *, landmarks: Pairs | None = None
) -> dict[str, Any]:
    """Returns what is known of a registration, ready for JSON; lengths in mm, points in LPS."""
    lengths = np.linalg.norm(found.moved(fixed), axis=1)
    report: dict[str, Any] = {
        "fixed": fixed.name,
        "moving": moving.name,
        "maps": "points of the fixed scan to the moving one, LPS mm",
        "kind": found.kind,
        "metric": found.metric,
        "start": found.start,
        "start_kept": found.start_kept,
        "doubt": found.doubt,
        "metric_before": found.before,
        "metric_after": found.after,
        "overlap_before": found.overlap_before,
        "overlap": found.overlap,
        "moved_mean_mm": float(lengths.mean()),
        "moved_most_mm": float(lengths.max()),
        "matrix": None if found.matrix is None else found.matrix.tolist(),
        "curve": [
            {
                "stage": level.stage,
                "shrink": level.shrink,
                "sampled": level.sampled,
                "values": level.values,
            }
            for level in found.curve
        ],
    }
    if landmarks is not None:
        before, after = landmark_errors(landmarks, None), landmark_errors(landmarks, found)
        report["landmarks_mm"] = {
            "before_mean": float(before.mean()),
            "after_mean": float(after.mean()),
            "after_most": float(after.max()),
        }
    return report


def sentence_of(report: dict[str, Any]) -> str:
    """Returns a report in one sentence."""
    parts = [
        (
            f"{report['kind']}, {report['metric']} {report['metric_before']:.4g} → "
            f"{report['metric_after']:.4g} (less is better), points move by "
            f"{report['moved_mean_mm']:.1f} mm, at most {report['moved_most_mm']:.1f} mm"
        ),
        (
            f"{report['overlap']:.0%} of the fixed scan is covered, "
            f"{report['overlap_before']:.0%} at the start"
        ),
    ]
    if report["start"] == "turned":
        parts.append("found from a turned start, as the usual one leads to where less is alike")
    if report["start_kept"]:
        parts.append("the start was right already and is kept")
    if (landmarks := report.get("landmarks_mm")) is not None:
        parts.append(
            f"landmarks {landmarks['before_mean']:.2f} → {landmarks['after_mean']:.2f} mm, "
            f"at most {landmarks['after_most']:.2f} mm"
        )
    if report.get("interpolation") == "nearest":
        parts.append("resampled by the nearest voxel")
    if (inverse := report.get("inverse")) is not None and not inverse["exact"]:
        parts.append(
            f"the inverse is off by {inverse['error_mean_mm']:.2g} mm on average, 99 of 100 "
            f"points by at most {inverse['error_of_99_in_100_mm']:.2g} mm"
        )
    return "; ".join(parts)


# --- the picture --------------------------------------------------------------------------


def write_checkerboard(found: Registration, fixed: Volume, moving: Volume, *, path: Path) -> None:
    """Writes a PNG of both scans in alternating squares.

    Above as the files place them, below through the transform; from left to right planes across z,
    y and x of the fixed scan, through the middle of what both show in the end, all in one scale.

    Raises:
        OSError: The disk refuses it.
    """
    sitk = simpleitk()
    images = [image_on(volume, volume.array) for volume in (fixed, moving)]
    ends = [
        np.percentile(volume.array[::2, ::2, ::2], [DARKEST, BRIGHTEST])
        for volume in (fixed, moving)
    ]
    middle = _middle_of_both(found, fixed, moving)
    rows = []
    for transform in (sitk.Transform(3, sitk.sitkIdentity), found.transform):
        planes = []
        for axis in (2, 1, 0):
            plane = _plane(fixed, axis, at=middle[axis])
            first, second = (
                _grey(_seen(image, plane, through), *window)
                for image, through, window in zip(
                    images, (sitk.Transform(3, sitk.sitkIdentity), transform), ends, strict=True
                )
            )
            planes.append(_upright(_checkered(first, second), fixed, axis))
        rows.append(_beside(planes))
    picture = np.vstack([rows[0], np.zeros((GAP, rows[0].shape[1]), np.uint8), rows[1]])
    with whole_file(path) as unfinished:
        try:
            sitk.WriteImage(sitk.GetImageFromArray(picture), str(unfinished))
        except RuntimeError as error:
            raise OSError(5, f"cannot be written ({reason_of(error)})", str(path)) from None


def _middle_of_both(found: Registration, fixed: Volume, moving: Volume) -> list[int]:
    """Returns the voxel x, y, z of the fixed scan in the middle of what the moving one covers."""
    shares = (np.arange(PROBES) + 0.5) / PROBES
    voxels = np.stack(np.meshgrid(shares, shares, shares), axis=-1).reshape(-1, 3)
    voxels = voxels * fixed.dimensions
    to_patient, to_grid = fixed.patient_from_grid, np.linalg.inv(moving.patient_from_grid)
    there = points_through(found.transform, voxels @ to_patient[:3, :3].T + to_patient[:3, 3])
    seen = there @ to_grid[:3, :3].T + to_grid[:3, 3]
    covered = np.all((seen >= 0.0) & (seen < moving.dimensions), axis=1)
    both = voxels[covered] if covered.any() else voxels
    return [int(at) for at in both.mean(axis=0)]


def _plane(fixed: Volume, axis: int, *, at: int) -> Any:  # noqa: ANN401  # SimpleITK has no types
    """Returns the grid of a plane: square pixels, its normal along an axis of the scan."""
    sitk = simpleitk()
    lengths = np.multiply(fixed.dimensions, fixed.spacing)
    pixel = float(lengths.max()) / LONGEST
    across, down = [other for other in range(3) if other != axis]
    size = [max(1, round(float(lengths[other]) / pixel)) for other in (across, down)]
    axes = [across, down, axis]
    # of the first pixel's centre, in voxels counted from the lowest corner
    start = np.zeros(4)
    start[3] = 1.0
    for other in (across, down):
        start[other] = 0.5 * pixel / fixed.spacing[other]
    start[axis] = at + 0.5
    plane = sitk.Image([*size, 1], sitk.sitkUInt8)
    plane.SetSpacing([pixel, pixel, pixel])
    plane.SetOrigin((fixed.patient_from_grid @ start)[:3].tolist())
    plane.SetDirection(fixed.direction[:, axes].ravel().tolist())
    return plane


def _seen(image: Any, plane: Any, transform: Any) -> NDArray[np.float32]:  # noqa: ANN401
    sitk = simpleitk()
    lowest = float(sitk.GetArrayViewFromImage(image).min())
    there = sitk.Resample(image, plane, transform, sitk.sitkLinear, lowest, sitk.sitkFloat32)
    seen: NDArray[np.float32] = sitk.GetArrayFromImage(there)[0]
    return seen


def _grey(seen: NDArray[np.float32], low: float, high: float) -> Grey:
    share = np.clip((seen - low) / max(high - low, 1e-6), 0.0, 1.0)
    grey: Grey = np.rint(share * 255.0).astype(np.uint8)
    return grey


def _checkered(first: Grey, second: Grey) -> Grey:
    tile = max(1, max(first.shape) // TILES)
    rows, columns = np.indices(first.shape) // tile
    squares: Grey = np.where((rows + columns) % 2 == 0, first, second)
    return squares


def _upright(plane: Grey, fixed: Volume, axis: int) -> Grey:
    """Returns a plane with the head up, or the front up where it lies across the body."""
    down = 2 if axis < 2 else 1
    toward = fixed.direction[:, down]
    head_first = np.abs(toward).argmax() == 2 and toward[2] > 0.0
    return plane[::-1] if head_first else plane


def _beside(planes: list[Grey]) -> Grey:
    height = max(plane.shape[0] for plane in planes)
    padded = [np.pad(plane, ((0, height - plane.shape[0]), (0, GAP))) for plane in planes]
    return np.hstack(padded)[:, :-GAP]
