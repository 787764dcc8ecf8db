import { expect, test } from "vitest";
import { PlaneInterpolation } from "../../../src/core/scan/plane_interpolation";
import type { Vec3 } from "../../../src/core/geometry/vector";
import { Random } from "../../support/random";

const dimensions: Vec3 = [20, 14, 17];

/** Every third value of a scan, as its place tells. */
function coarseOf(valueAt: (place: Vec3) => number): ConstructorParameters<typeof PlaneInterpolation>[0] {
  const [width, height, depth] = [7, 5, 6];
  const values = Uint16Array.from({ length: width * height * depth }, (_, i) =>
    valueAt([3 * (i % width), 3 * (Math.floor(i / width) % height), 3 * Math.floor(i / (width * height))]),
  );
  return { dimensions: [width, height, depth], step: 3, values };
}

const at = (values: Uint16Array, [x, y, z]: Vec3): number => values[x + dimensions[0] * (y + dimensions[1] * z)] ?? NaN;

test("where a coarse scan has a value, planes made of it have the same", () => {
  const random = new Random(31);
  const coarse = coarseOf(() => random.whole(0, 65535));
  const values = new PlaneInterpolation(coarse, dimensions, 1).make(0, dimensions[2]);
  let i = 0;
  for (let z = 0; z < 17; z += 3) {
    for (let y = 0; y < 14; y += 3) {
      for (let x = 0; x < 20; x += 3) {
        expect(at(values, [x, y, z])).toBe(coarse.values[i++]);
      }
    }
  }
});

test("between them they follow a straight slope without facets, in any order of planes", () => {
  const slope = ([x, y, z]: Vec3): number => 20000 + 300 * x - 200 * y + 500 * z;
  const between = new PlaneInterpolation(coarseOf(slope), dimensions, 1);
  // the last planes are asked for first
  const behind = between.make(8, 14);
  const before = between.make(3, 8);
  for (let z = 3; z <= 12; ++z) {
    for (let y = 3; y <= 9; ++y) {
      for (let x = 3; x <= 15; ++x) {
        // floats of 24 bits, and rounding to a whole number
        expect(
          Math.abs(at(z < 8 ? before : behind, [x, y, z < 8 ? z - 3 : z - 8]) - slope([x, y, z])),
        ).toBeLessThanOrEqual(1);
      }
    }
  }
});

test("beside a steep edge they stay within what a stored value can be", () => {
  const values = new PlaneInterpolation(coarseOf(([x]) => (x < 9 ? 0 : 65535)), dimensions, 1).make(0, 1);
  // a cubic runs a few percent beyond both sides: it would come back as the other extreme
  const row = Array.from({ length: 20 }, (_, x) => at(values, [x, 0, 0]));
  expect(row).toEqual([...row].sort((a, b) => a - b));
});

test("a scan that is itself held at a step has its planes made as finely", () => {
  const coarse = coarseOf(([, , z]) => 1000 * z);
  const values = new PlaneInterpolation(coarse, [10, 7, 9], 2).make(0, 9);
  // plane 3 is that of voxel 6, which the coarse scan has
  expect(values[3 * 70]).toBe(6000);
  expect(values[4 * 70]).toBe(8000);
});
