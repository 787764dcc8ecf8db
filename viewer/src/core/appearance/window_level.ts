/**
 * Window and level of slices: which values are black and which are white.
 */
import type { Scan } from "../protocol";

/** Values from `level - window / 2` (black) to `level + window / 2` (white). */
export interface WindowLevel {
  readonly window: number;
  readonly level: number;
}

export interface WindowPreset extends WindowLevel {
  readonly name: string;
}

/** Windows of CT in HU, by the names that the field uses. */
export const windowPresets: readonly WindowPreset[] = [
  { name: "Abdomen", window: 350, level: 40 },
  { name: "Bone", window: 1000, level: 400 },
  { name: "Brain", window: 100, level: 50 },
  { name: "Liver", window: 150, level: 60 },
  { name: "Lung", window: 1400, level: -500 },
  { name: "Mediastinum", window: 400, level: 40 },
  { name: "Angiography", window: 600, level: 300 },
];

/** Share of the voxels that is left out at each end where a scan has no unit. */
const outliers = 0.01;

/** The window in which a scan is shown first: all its tissue where values have no unit. */
export function firstWindow(scan: Pick<Scan, "unit" | "histogram" | "range">): WindowLevel {
  if (scan.unit === "HU") {
    return { window: 400, level: 40 };
  }
  const [low, high] = spread(scan);
  return { window: Math.max(high - low, 1e-6), level: (low + high) / 2 };
}

/** Values between which all but a few voxels lie. */
function spread({ histogram, range }: Pick<Scan, "histogram" | "range">): readonly [number, number] {
  const { counts } = histogram;
  const total = counts.reduce((sum, count) => sum + count, 0);
  let below = 0;
  let first = 0;
  let last = counts.length - 1;
  counts.forEach((count, i) => {
    first = below <= outliers * total ? i : first;
    last = below <= (1 - outliers) * total ? i : last;
    below += count;
  });
  const size = (histogram.high - histogram.low) / Math.max(1, counts.length);
  const found = [histogram.low + first * size, histogram.low + (last + 1) * size] as const;
  return found[1] > found[0] ? found : range;
}

/** The window after a drag: to the right wider, upward brighter; a picture's height is a whole window. */
export function draggedWindow({ window, level }: WindowLevel, right: number, down: number): WindowLevel {
  const perPixel = Math.max(window, 1e-6) / 300;
  return { window: Math.max(window + right * perPixel, 1e-6), level: level + down * perPixel };
}
