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

/**
 * Windows of CT in HU, in the order of their keys 1 to 9. Abdomen, lung, bone and brain are those of 3D Slicer's Volumes
 * module; soft tissue, liver, mediastinum and temporal bone those of Radiopaedia (Murphy, "Windowing (CT)", rID 52108);
 * that of angiography is usual in archives.
 */
export const windowPresets: readonly WindowPreset[] = [
  { name: "Abdomen", window: 350, level: 40 },
  { name: "Lung", window: 1400, level: -500 },
  { name: "Bone", window: 1000, level: 400 },
  { name: "Brain", window: 100, level: 50 },
  { name: "Soft tissue", window: 400, level: 40 },
  { name: "Liver", window: 150, level: 30 },
  { name: "Mediastinum", window: 350, level: 50 },
  { name: "Angiography", window: 600, level: 300 },
  { name: "Temporal bone", window: 2800, level: 600 },
];

/** Upper ends of windows of PET, which begin at 0 [SUV]. */
const uptakes = [5, 7, 10, 15, 20] as const;

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

/** Windows for a scan, at most nine: of CT by tissue, of PET by uptake, of others by the values that it has. */
export function windowsFor(scan: Pick<Scan, "unit" | "histogram" | "range">): readonly WindowPreset[] {
  if (scan.unit === "HU") {
    return windowPresets;
  }
  const between = (name: string, low: number, high: number): WindowPreset => ({
    name,
    window: Math.max(high - low, 1e-6),
    level: (low + high) / 2,
  });
  const [low, high] = spread(scan);
  const ofValues = [between("Automatic", low, high), between("Full range", ...scan.range)];
  if (scan.unit.startsWith("SUV")) {
    return [...ofValues, ...uptakes.map((most) => between(`0 to ${String(most)}`, 0, most))];
  }
  const middle = (low + high) / 2;
  return [...ofValues, between("Dark half", low, middle), between("Bright half", middle, high)];
}

/** The window of a list that is meant by width and level; undefined where none is. */
export function namedWindow(presets: readonly WindowPreset[], shown: WindowLevel): WindowPreset | undefined {
  return presets.find(({ window, level }) => window === shown.window && level === shown.level);
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
