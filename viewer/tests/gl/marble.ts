/** A field without symmetry, for pages and tests alike. */
import { distance, type Vec3 } from "../../src/core/geometry/vector";

/** Something without symmetry: waves of several lengths in a ball that fades into air [HU]. */
export function marble([x, y, z]: Vec3): number {
  const waves =
    300 * Math.sin(0.31 * x + 0.2 * z) + 250 * Math.sin(0.23 * y - 0.17 * x) + 200 * Math.cos(0.37 * z + 0.11 * y);
  const inside = Math.min(1, Math.max(0, (22 - distance([x, y, z], [24, 24, 24])) / 10));
  return Math.round(-1000 + inside * (1000 + waves));
}
