/**
 * The scan as a continuous field: trilinear values and central differences on the CPU.
 * The shaders compute the same (`gl/shaders/scan/field.glsl`); this side serves picking.
 */
import type { ScanVolume } from "./scan_volume";
import { physical } from "./stored_values";
import { length, type Vec3 } from "../geometry/vector";

/** Biased value at a point of the grid; outside the scan as at its border. */
export function biasedAt(volume: ScanVolume, grid: Vec3): number {
  const { values, dimensions, step } = volume;
  const [width, height] = dimensions;
  const [x0, x1, fx] = neighbours((grid[0] - 0.5) / step, width);
  const [y0, y1, fy] = neighbours((grid[1] - 0.5) / step, height);
  const [z0, z1, fz] = neighbours((grid[2] - 0.5) / step, dimensions[2]);

  const at = (x: number, y: number, z: number): number => values[x + width * (y + height * z)] ?? 0;
  const mix = (a: number, b: number, share: number): number => a + (b - a) * share;
  const row = (y: number, z: number): number => mix(at(x0, y, z), at(x1, y, z), fx);
  const plane = (z: number): number => mix(row(y0, z), row(y1, z), fy);
  return mix(plane(z0), plane(z1), fz);
}

/** Physical value between voxels, trilinear; null outside the scan. */
export function valueBetweenVoxels(volume: ScanVolume, grid: Vec3): number | null {
  return isOutside(volume, grid) ? null : physical(biasedAt(volume, grid), volume.frame.rescale);
}

/** Physical value of the voxel that holds a point of the grid; null outside the scan. */
export function valueInVoxel(volume: ScanVolume, grid: Vec3): number | null {
  const { values, dimensions, step, frame } = volume;
  if (isOutside(volume, grid)) {
    return null;
  }
  const place = (axis: 0 | 1 | 2): number => Math.min(Math.round(Math.floor(grid[axis]) / step), dimensions[axis] - 1);
  const biased = values[place(0) + dimensions[0] * (place(1) + dimensions[1] * place(2))] ?? 0;
  return physical(biased, frame.rescale);
}

function isOutside({ frame }: ScanVolume, grid: Vec3): boolean {
  return grid.some((c, axis) => c < 0 || c >= (frame.dimensions[axis] ?? 0));
}

/** The two samples around a coordinate and the share of the second. */
function neighbours(coordinate: number, size: number): readonly [number, number, number] {
  const inside = Math.min(Math.max(coordinate, 0), size - 1);
  const first = Math.min(Math.floor(inside), Math.max(0, size - 2));
  return [first, Math.min(first + 1, size - 1), inside - first];
}

/** Magnitude of the field's gradient [value per mm], central differences of one sample each way. */
export function gradientMagnitude(volume: ScanVolume, grid: Vec3): number {
  const { step, frame } = volume;
  const along = (axis: 0 | 1 | 2): number => {
    const offset = (sign: number): Vec3 => [
      grid[0] + (axis === 0 ? sign * step : 0),
      grid[1] + (axis === 1 ? sign * step : 0),
      grid[2] + (axis === 2 ? sign * step : 0),
    ];
    const difference = biasedAt(volume, offset(1)) - biasedAt(volume, offset(-1));
    return difference / (2 * step * frame.spacing[axis]);
  };
  return Math.abs(frame.rescale.slope) * length([along(0), along(1), along(2)]);
}
