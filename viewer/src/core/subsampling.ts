/**
 * How coarsely a scan must be held to fit on the GPU.
 */
import { storedDimensions } from "./scan_volume";
import type { Vec3 } from "./vector";

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
