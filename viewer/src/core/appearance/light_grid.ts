/**
 * The cells in which light through the scan is worked out: coarse cubes that cover all of it.
 */
import { sizeOf } from "../view/clip";
import { smallestSpacing, type ScanFrame } from "../scan/scan_volume";
import { multiply, type Vec3 } from "../geometry/vector";

export interface LightGrid {
  /** Cells along the scan's axes. */
  readonly counts: Vec3;
  /** Edge of a cell [mm]; along each axis they fill the scan, so they may be a little shorter. */
  readonly edge: number;
}

/** @param most cells along the longest edge of the scan; none is smaller than a voxel and a half. */
export function lightGridOf(frame: ScanFrame, most: number): LightGrid {
  const size = sizeOf(frame);
  const edge = Math.max(Math.max(...size) / most, 1.5 * smallestSpacing(frame));
  const along = (axis: 0 | 1 | 2): number => Math.max(1, Math.ceil(size[axis] / edge - 1e-6));
  return { counts: [along(0), along(1), along(2)], edge };
}

/** Layers of cells along z that the planes `low` to `high` of the grid (half open) reach. */
export function layersReached(
  { dimensions }: ScanFrame,
  { counts }: LightGrid,
  low: number,
  high: number,
): readonly [number, number] {
  const perVoxel = counts[2] / dimensions[2];
  return [Math.max(0, Math.floor(low * perVoxel)), Math.min(counts[2], Math.ceil(high * perVoxel))];
}

/** The way of a cell's edge, as a share of the scan along each of its axes. */
export function cellShares(frame: ScanFrame, { edge }: LightGrid): Vec3 {
  const [x, y, z] = sizeOf(frame);
  return multiply([edge, edge, edge], [1 / x, 1 / y, 1 / z]);
}
