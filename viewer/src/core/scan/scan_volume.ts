/**
 * A scan as the page holds it: where it lies and its values, perhaps subsampled.
 *
 * With `step` s, value (i, j, k) is that of voxel (s·i, s·j, s·k), whose centre stands at
 * grid (s·i + 0.5, …). Sample coordinates count stored values: c = (grid - 0.5) / s.
 */
import { affineFromRows, invertAffine, transformVector, type Affine } from "../geometry/affine";
import type { Scan } from "../protocol";
import type { Rescale, StoredVolume } from "./stored_values";
import { length, scale, type Vec3 } from "../geometry/vector";

export interface ScanFrame {
  /** Voxels of the whole scan along x, y, z. */
  readonly dimensions: Vec3;
  readonly sceneFromGrid: Affine;
  readonly gridFromScene: Affine;
  /** Size of a voxel [mm] and the directions of the grid's axes, unit vectors in the scene. */
  readonly spacing: Vec3;
  readonly axes: readonly [Vec3, Vec3, Vec3];
  readonly rescale: Rescale;
}

export interface ScanVolume extends StoredVolume {
  readonly frame: ScanFrame;
  /** Every how many voxels along each axis a value is held. */
  readonly step: number;
}

/** Where the scan lies. The scene's frame is the patient frame of the scan. */
export function frameOf(scan: Scan): ScanFrame {
  const sceneFromGrid = affineFromRows(scan.patient_from_grid);
  const edges = ([[1, 0, 0], [0, 1, 0], [0, 0, 1]] as const).map((axis) => transformVector(sceneFromGrid, axis));
  const [x = [1, 0, 0], y = [0, 1, 0], z = [0, 0, 1]] = edges;
  const spacing: Vec3 = [length(x), length(y), length(z)];
  return {
    dimensions: scan.dimensions,
    sceneFromGrid,
    gridFromScene: invertAffine(sceneFromGrid),
    spacing,
    axes: [scale(x, 1 / spacing[0]), scale(y, 1 / spacing[1]), scale(z, 1 / spacing[2])],
    rescale: { slope: scan.slope, intercept: scan.intercept },
  };
}

/** Stored values along each axis for a subsampling step, as the engine sends them. */
export function storedDimensions(dimensions: Vec3, step: number): Vec3 {
  return [Math.ceil(dimensions[0] / step), Math.ceil(dimensions[1] / step), Math.ceil(dimensions[2] / step)];
}

export function smallestSpacing({ spacing }: ScanFrame): number {
  return Math.min(...spacing);
}
