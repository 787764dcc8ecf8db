/**
 * What an edit changes in the voxels that the page holds: a box of values, of labels, or both.
 *
 * A box counts stored values (every `step`-th voxel, core/scan/scan_volume.ts), half open; arrays
 * run x fastest. What arrives is checked before anything of it is taken.
 */
import { brickEdge, rangeOfBrick, type BrickRanges } from "./bricks";
import type { ChangedVoxels } from "../protocol";
import type { ScanVolume } from "./scan_volume";
import { biasInPlace, type StoredVolume } from "./stored_values";
import type { Vec3 } from "../geometry/vector";

export interface Box {
  readonly low: Vec3;
  readonly high: Vec3;
}

export interface VoxelChange {
  readonly box: Box;
  /** Biased values of the box; null where they stay. */
  readonly values: Uint16Array | null;
  /** Segment of each voxel of the box; null where they stay. */
  readonly labels: Uint8Array | null;
}

/** The segment of each stored voxel, and for each brick of them whether it holds any. */
export interface LabelVolume {
  /** 0 where there is no segment. */
  readonly ids: Uint8Array;
  readonly dimensions: Vec3;
  /** 1 for each brick that holds a segment. */
  readonly bricks: Uint8Array;
}

/** A change that does not fit to the scan, or to itself. */
export class ChangeError extends Error {
  override name = "ChangeError";
}

/**
 * Reads a box of voxels of an edit; null where it changes none that the page holds.
 *
 * @throws ChangeError where the box lies outside of the scan, or bytes are missing.
 */
export function decodeVoxels(changed: ChangedVoxels, { frame, step }: ScanVolume): VoxelChange | null {
  const { low, high, stored, labels } = changed;
  const axes = [0, 1, 2] as const;
  const fits = axes.every((axis) => 0 <= low[axis] && low[axis] <= high[axis] && high[axis] <= frame.dimensions[axis]);
  expect(fits, `its box is ${low.join(", ")} to ${high.join(", ")}; allowed: inside of ${frame.dimensions.join(", ")}`);
  const voxels = volumeOf({ low, high });
  for (const [bytes, each] of [[stored, 2], [labels, 1]] as const) {
    const length = bytes?.length ?? voxels * each;
    expect(
      length === voxels * each,
      `${String(length)} bytes for a box of ${String(voxels)} voxels, ${String(each)} each`,
    );
  }
  const held: Box = { low: mapped(low, (i) => Math.ceil(i / step)), high: mapped(high, (i) => Math.ceil(i / step)) };
  if (volumeOf(held) === 0 || (stored === null && labels === null)) {
    return null;
  }
  const whole: Box = { low, high };
  const count = volumeOf(held);
  // a copy that begins where numbers of two bytes may begin
  const words = stored === null ? null : new Uint16Array(new Uint8Array(stored).buffer);
  const values = words === null ? null : everyStep(words, new Uint16Array(count), whole, held, step);
  if (values !== null) {
    biasInPlace(values);
  }
  const ids = labels === null ? null : everyStep(labels, new Uint8Array(count), whole, held, step);
  return { box: held, values, labels: ids };
}

/** Writes a box into an array of the whole scan. */
export function writeBox(
  target: Uint16Array | Uint8Array,
  dimensions: Vec3,
  { low, high }: Box,
  source: ArrayLike<number>,
): void {
  const width = high[0] - low[0];
  let from = 0;
  for (let z = low[2]; z < high[2]; ++z) {
    for (let y = low[1]; y < high[1]; ++y) {
      const to = low[0] + dimensions[0] * (y + dimensions[1] * z);
      for (let x = 0; x < width; ++x) {
        target[to + x] = source[from++] ?? 0;
      }
    }
  }
}

/** Bricks whose interpolation reads a voxel of the box. */
export function bricksReadingBox({ low, high }: Box, counts: Vec3): Box {
  return {
    low: mapped(low, (i) => Math.max(0, Math.ceil((i - brickEdge) / brickEdge))),
    high: mapped(high, (i, axis) => Math.min(counts[axis], Math.floor(i / brickEdge) + 1)),
  };
}

/** Finds the ranges of the bricks that a box changes again. */
export function updateBricks(bricks: BrickRanges, volume: StoredVolume, box: Box): void {
  forEachCell(bricksReadingBox(box, bricks.counts), bricks.counts, (i, brick) => {
    const [low, high] = rangeOfBrick(volume, brick);
    bricks.low[i] = low;
    bricks.high[i] = high;
  });
}

/** Number of the segment at a point of the scan's grid, of which every `step`-th voxel is held; 0 for none. */
export function labelAtPoint({ ids, dimensions }: LabelVolume, grid: Vec3, step: number): number {
  const [x, y, z] = mapped(grid, (place, axis) =>
    Math.min(dimensions[axis] - 1, Math.max(0, Math.round((place - 0.5) / step))),
  );
  return ids[x + dimensions[0] * (y + dimensions[1] * z)] ?? 0;
}

/** Writes labels into the page's and finds again which bricks hold any. */
export function updateLabels({ ids, dimensions, bricks }: LabelVolume, box: Box, labels: Uint8Array): void {
  writeBox(ids, dimensions, box, labels);
  const counts = mapped(dimensions, (n) => Math.ceil(n / brickEdge));
  const touched: Box = {
    low: mapped(box.low, (i) => Math.floor(i / brickEdge)),
    high: mapped(box.high, (i) => Math.ceil(i / brickEdge)),
  };
  forEachCell(touched, counts, (i, brick) => {
    const voxels: Box = {
      low: mapped(brick, (b) => b * brickEdge),
      high: mapped(brick, (b, axis) => Math.min(dimensions[axis], (b + 1) * brickEdge)),
    };
    let held = 0;
    forEachCell(voxels, dimensions, (voxel) => {
      held |= ids[voxel] ?? 0;
    });
    bricks[i] = held === 0 ? 0 : 1;
  });
}

/** Calls back with each cell of a box: its number in a grid, and its place. */
export function forEachCell({ low, high }: Box, grid: Vec3, visit: (i: number, place: Vec3) => void): void {
  for (let z = low[2]; z < high[2]; ++z) {
    for (let y = low[1]; y < high[1]; ++y) {
      for (let x = low[0]; x < high[0]; ++x) {
        visit(x + grid[0] * (y + grid[1] * z), [x, y, z]);
      }
    }
  }
}

/** The values of a box that a subsampled scan holds, into an array of their number. */
function everyStep<T extends Uint16Array | Uint8Array>(values: T, chosen: T, whole: Box, held: Box, step: number): T {
  const size = mapped(whole.high, (end, axis) => end - whole.low[axis]);
  let i = 0;
  forEachCell(held, [0, 0, 0], (_, place) => {
    const [x, y, z] = mapped(place, (stored, axis) => stored * step - whole.low[axis]);
    chosen[i++] = values[x + size[0] * (y + size[1] * z)] ?? 0;
  });
  return chosen;
}

function volumeOf({ low, high }: Box): number {
  return (high[0] - low[0]) * (high[1] - low[1]) * (high[2] - low[2]);
}

function mapped(v: Vec3, change: (value: number, axis: 0 | 1 | 2) => number): Vec3 {
  return [change(v[0], 0), change(v[1], 1), change(v[2], 2)];
}

function expect(holds: boolean, told: string): void {
  if (!holds) {
    throw new ChangeError(told);
  }
}
