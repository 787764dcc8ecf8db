/**
 * Lowest and highest value of each brick of 8×8×8 voxels, and how far empty space reaches.
 *
 * A brick's range also covers the voxels around it that interpolation inside it reads, so a
 * brick whose whole range is clear can be skipped without changing one pixel. For each empty
 * brick the distance to the nearest filled one is kept (in bricks, Chebyshev), so that a ray
 * leaps over several bricks at once.
 *
 * Source: Cohen & Sheffer, "Proximity clouds", The Visual Computer 11 (1994).
 */
import type { StoredVolume } from "./stored_values";
import type { Vec3 } from "../geometry/vector";

export const brickEdge = 8;

export interface BrickRanges {
  /** Bricks along x, y, z; x runs fastest in both arrays. */
  readonly counts: Vec3;
  readonly low: Uint16Array;
  readonly high: Uint16Array;
}

/** Finds the range of every brick; reads each voxel about twice. */
export function brickRanges(volume: StoredVolume): BrickRanges {
  const ranges = noRanges(volume.dimensions);
  widenRanges(ranges, volume, 0);
  return ranges;
}

/** Ranges of bricks that hold nothing yet. */
export function noRanges(dimensions: Vec3): BrickRanges {
  const counts = dimensions.map((n) => Math.ceil(n / brickEdge)) as unknown as Vec3;
  const total = counts[0] * counts[1] * counts[2];
  return { counts, low: new Uint16Array(total).fill(65535), high: new Uint16Array(total) };
}

/** Takes whole planes of voxels into the ranges; `first` is the number of the first one in its scan. */
export function widenRanges({ counts, low, high }: BrickRanges, planes: StoredVolume, first: number): void {
  const { values } = planes;
  const [width, height, depth] = planes.dimensions;
  // one row of voxels at a time, into every brick row whose interpolation reads it
  const rowLow = new Uint16Array(counts[0]);
  const rowHigh = new Uint16Array(counts[0]);
  for (let z = 0; z < depth; ++z) {
    for (let y = 0; y < height; ++y) {
      rangesOfRow(values, width * (y + height * z), width, rowLow, rowHigh);
      for (const bz of bricksReading(first + z, counts[2])) {
        for (const by of bricksReading(y, counts[1])) {
          const row = counts[0] * (by + counts[1] * bz);
          for (let bx = 0; bx < counts[0]; ++bx) {
            const i = row + bx;
            low[i] = Math.min(low[i] ?? 0, rowLow[bx] ?? 0);
            high[i] = Math.max(high[i] ?? 0, rowHigh[bx] ?? 0);
          }
        }
      }
    }
  }
}

/** The least ranges that cover both of two of the same scan. */
export function coveringRanges(one: BrickRanges, other: BrickRanges): BrickRanges {
  return {
    counts: one.counts,
    low: one.low.map((value, i) => Math.min(value, other.low[i] ?? value)),
    high: one.high.map((value, i) => Math.max(value, other.high[i] ?? value)),
  };
}

function rangesOfRow(values: Uint16Array, start: number, width: number, low: Uint16Array, high: Uint16Array): void {
  for (let brick = 0; brick < low.length; ++brick) {
    const from = Math.max(0, brick * brickEdge - 1);
    const to = Math.min(width, (brick + 1) * brickEdge + 1);
    let least = 65535;
    let most = 0;
    for (let x = start + from; x < start + to; ++x) {
      const value = values[x] ?? 0;
      least = value < least ? value : least;
      most = value > most ? value : most;
    }
    low[brick] = least;
    high[brick] = most;
  }
}

/** The range of one brick, as `brickRanges` finds it. */
export function rangeOfBrick({ dimensions, values }: StoredVolume, brick: Vec3): readonly [number, number] {
  const from = (axis: 0 | 1 | 2): number => Math.max(0, brick[axis] * brickEdge - 1);
  const to = (axis: 0 | 1 | 2): number => Math.min(dimensions[axis], (brick[axis] + 1) * brickEdge + 1);
  let low = 65535;
  let high = 0;
  for (let z = from(2); z < to(2); ++z) {
    for (let y = from(1); y < to(1); ++y) {
      const row = dimensions[0] * (y + dimensions[1] * z);
      for (let x = from(0); x < to(0); ++x) {
        const value = values[row + x] ?? 0;
        low = value < low ? value : low;
        high = value > high ? value : high;
      }
    }
  }
  return [low, high];
}

/** Bricks along one axis whose interpolation reads voxel `i`. */
function bricksReading(i: number, count: number): number[] {
  const own = Math.floor(i / brickEdge);
  const inside = i % brickEdge;
  const bricks = [own];
  if (inside === 0 && own > 0) {
    bricks.push(own - 1);
  }
  if (inside === brickEdge - 1 && own + 1 < count) {
    bricks.push(own + 1);
  }
  return bricks;
}

/** Bricks whose range touches a value that is drawn. 1: filled, 0: empty. */
export function filledBricks(ranges: BrickRanges, drawn: (low: number, high: number) => boolean): Uint8Array {
  const filled = new Uint8Array(ranges.low.length);
  for (let i = 0; i < filled.length; ++i) {
    filled[i] = drawn(ranges.low[i] ?? 0, ranges.high[i] ?? 0) ? 1 : 0;
  }
  return filled;
}

/** The first and the last of filled bricks along each axis; null where none is. */
export function boundsOf(filled: Uint8Array, counts: Vec3): { readonly low: Vec3; readonly high: Vec3 } | null {
  const [columns, rows] = counts;
  const low = [Infinity, Infinity, Infinity] as [number, number, number];
  const high = [-1, -1, -1] as [number, number, number];
  filled.forEach((full, i) => {
    if (full > 0) {
      const brick = [i % columns, Math.floor(i / columns) % rows, Math.floor(i / (columns * rows))] as const;
      brick.forEach((place, axis) => {
        low[axis] = Math.min(low[axis] ?? place, place);
        high[axis] = Math.max(high[axis] ?? place, place);
      });
    }
  });
  return high[0] < 0 ? null : { low, high };
}

/** Bricks in which any voxel has a label. 1: some has, 0: none. */
export function labelledBricks(ids: Uint8Array, dimensions: Vec3): Uint8Array {
  const [width, height, depth] = dimensions;
  const [columns, rows, slabs] = dimensions.map((n) => Math.ceil(n / brickEdge)) as unknown as Vec3;
  const labelled = new Uint8Array(columns * rows * slabs);
  let i = 0;
  for (let z = 0; z < depth; ++z) {
    for (let y = 0; y < height; ++y) {
      const first = columns * (Math.floor(y / brickEdge) + rows * Math.floor(z / brickEdge));
      for (let x = 0; x < width; ++x, ++i) {
        if (ids[i] !== 0) {
          labelled[first + Math.floor(x / brickEdge)] = 1;
        }
      }
    }
  }
  return labelled;
}

/** Distance to the nearest filled brick, 0 where filled itself, at most 255. */
export function distanceToFilled(filled: Uint8Array, counts: Vec3): Uint8Array {
  // along one axis after the other: within a box of radius r means within r on every axis
  let nearest: Uint8Array = filled.map((f) => (f > 0 ? 0 : 255));
  const strides = [1, counts[0], counts[0] * counts[1]] as const;
  for (const axis of [0, 1, 2] as const) {
    nearest = spreadAlong(nearest, counts, strides[axis], counts[axis]);
  }
  return nearest;
}

/** For every line along an axis: min over its cells of max(value there, distance to it). */
function spreadAlong(values: Uint8Array, counts: Vec3, stride: number, size: number): Uint8Array {
  const result = new Uint8Array(values.length);
  const line = new Uint8Array(size);
  const total = counts[0] * counts[1] * counts[2];
  for (let start = 0; start < total; ++start) {
    // the first cell of each line
    if (Math.floor(start / stride) % size !== 0) {
      continue;
    }
    for (let i = 0; i < size; ++i) {
      line[i] = values[start + i * stride] ?? 255;
    }
    for (let i = 0; i < size; ++i) {
      result[start + i * stride] = nearestOnLine(line, i);
    }
  }
  return result;
}

function nearestOnLine(line: Uint8Array, i: number): number {
  let best = line[i] ?? 255;
  const farthest = Math.max(i, line.length - 1 - i);
  for (let away = 1; away < best && away <= farthest; ++away) {
    const before = i - away >= 0 ? (line[i - away] ?? 255) : 255;
    const after = i + away < line.length ? (line[i + away] ?? 255) : 255;
    best = Math.min(best, Math.max(away, Math.min(before, after)));
  }
  return best;
}
