/**
 * How coarsely a scan must be held to fit on the GPU.
 */
import { storedDimensions } from "./scan_volume";
import type { Vec3 } from "../geometry/vector";

export interface VolumeLimits {
  /** Texels along one edge of a 3-D texture. */
  readonly edge: number;
  /** Values altogether. */
  readonly values: number;
}

/** The smallest step at which the scan fits. */
export function subsamplingStep(dimensions: Vec3, limits: VolumeLimits): number {
  for (let step = 1; ; ++step) {
    const [x, y, z] = storedDimensions(dimensions, step);
    if (Math.max(x, y, z) <= limits.edge && x * y * z <= limits.values) {
      return step;
    }
  }
}

/** Scans with more values are shown coarsely first: to bring all of them takes seconds. */
const quicklyBrought = 2 ** 25;
/** Values of what is shown first. */
const preview = 2 ** 22;

/** The step of the coarse scan that is shown first; null where all of it, at `step`, comes quickly enough. */
export function previewStep(dimensions: Vec3, step: number): number | null {
  const [x, y, z] = storedDimensions(dimensions, step);
  const edge = Math.max(...dimensions);
  return x * y * z <= quicklyBrought ? null : subsamplingStep(dimensions, { edge, values: preview });
}
