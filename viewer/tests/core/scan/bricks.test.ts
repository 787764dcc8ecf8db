import { expect, test } from "vitest";
import { boundsOf, brickEdge, brickRanges, distanceToFilled, filledBricks } from "../../../src/core/scan/bricks";
import { DrawnValues } from "../../../src/core/appearance/drawn_values";
import { sample } from "../../../src/core/appearance/transfer_function";
import type { Vec3 } from "../../../src/core/geometry/vector";
import { Random } from "../../support/random";

const dimensions: Vec3 = [21, 17, 26];

function randomVolume(seed: number): Uint16Array {
  const random = new Random(seed);
  return Uint16Array.from({ length: 21 * 17 * 26 }, () => random.whole(0, 65535));
}

test("a brick's range holds exactly the voxels that interpolation inside it reads", () => {
  const values = randomVolume(11);
  const { counts, low, high } = brickRanges({ dimensions, values });
  expect(counts).toEqual([3, 3, 4]);
  for (let bz = 0; bz < counts[2]; ++bz) {
    for (let by = 0; by < counts[1]; ++by) {
      for (let bx = 0; bx < counts[0]; ++bx) {
        const seen: number[] = [];
        const within = (v: number, b: number): boolean => v >= brickEdge * b - 1 && v <= brickEdge * (b + 1);
        for (let z = 0; z < dimensions[2]; ++z) {
          for (let y = 0; y < dimensions[1]; ++y) {
            for (let x = 0; x < dimensions[0]; ++x) {
              if (within(x, bx) && within(y, by) && within(z, bz)) {
                seen.push(values[x + dimensions[0] * (y + dimensions[1] * z)] ?? 0);
              }
            }
          }
        }
        const i = bx + counts[0] * (by + counts[1] * bz);
        expect(low[i]).toBe(Math.min(...seen));
        expect(high[i]).toBe(Math.max(...seen));
      }
    }
  }
});

test("distances to filled bricks are those that a search of all bricks finds", () => {
  const random = new Random(12);
  const counts: Vec3 = [9, 7, 5];
  for (let trial = 0; trial < 20; ++trial) {
    const filled = Uint8Array.from({ length: 315 }, () => (random.between(0, 1) < 0.02 ? 1 : 0));
    const found = distanceToFilled(filled, counts);
    const place = (i: number): Vec3 => [i % 9, Math.floor(i / 9) % 7, Math.floor(i / 63)];
    filled.forEach((_, i) => {
      let nearest = 255;
      filled.forEach((full, j) => {
        const [a, b] = [place(i), place(j)];
        const away = Math.max(Math.abs(a[0] - b[0]), Math.abs(a[1] - b[1]), Math.abs(a[2] - b[2]));
        nearest = full > 0 ? Math.min(nearest, away) : nearest;
      });
      expect(found[i]).toBe(nearest);
    });
  }
});

const rescale = { slope: 1, intercept: 0 };
const peak = {
  points: [
    { value: 100, colour: [1, 1, 1], extinction: 0 },
    { value: 103, colour: [1, 1, 1], extinction: 1 },
    { value: 106, colour: [1, 1, 1], extinction: 0 },
  ] as const,
};

test("no range that holds a drawn value is called empty", () => {
  const drawn = new DrawnValues(peak, rescale, [[40000, 40005]]);
  const random = new Random(13);
  let empty = 0;
  for (let i = 0; i < 3000; ++i) {
    const low = random.whole(32768, 41000);
    const high = low + random.whole(0, 60);
    let holds = false;
    for (let value = low; value <= high; ++value) {
      holds ||= sample(peak.points, value - 32768).extinction > 1e-6 || (value >= 40000 && value <= 40005);
    }
    if (holds) {
      expect(drawn.any(low, high)).toBe(true);
    }
    empty += drawn.any(low, high) ? 0 : 1;
  }
  // and most ranges are empty, else nothing would be skipped
  expect(empty).toBeGreaterThan(2500);
});

test("only bricks that hold something drawn are filled", () => {
  const values = new Uint16Array(21 * 17 * 26).fill(32768);
  values[4 + 21 * (4 + 17 * 4)] = 32768 + 103;
  const ranges = brickRanges({ dimensions, values });
  const drawn = new DrawnValues(peak, rescale);
  const filled = filledBricks(ranges, (low, high) => drawn.any(low, high));
  expect([...filled.keys()].filter((i) => filled[i] === 1)).toEqual([0]);
});

test("bounds hold the first and the last filled brick along each axis", () => {
  const counts: Vec3 = [3, 4, 5];
  const filled = new Uint8Array(60);
  expect(boundsOf(filled, counts)).toBeNull();
  filled[1 + 3 * (2 + 4 * 3)] = 1;
  expect(boundsOf(filled, counts)).toEqual({ low: [1, 2, 3], high: [1, 2, 3] });
  filled[2 + 3 * (0 + 4 * 4)] = 1;
  expect(boundsOf(filled, counts)).toEqual({ low: [1, 0, 3], high: [2, 2, 4] });
});
