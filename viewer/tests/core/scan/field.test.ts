import { expect, test } from "vitest";
import { biasedAt, gradientMagnitude } from "../../../src/core/scan/field";
import { Random } from "../../support/random";
import { scanOf, volumeOf } from "../../support/volumes";

const scan = scanOf([30, 24, 20], [0.7, 0.7, 2.5]);

test.each([1, 2, 3])("a linear field is interpolated exactly at subsampling step %i", (step) => {
  const volume = volumeOf(scan, ([x, y, z]) => 30 * x - 20 * y + 50 * z, step);
  const random = new Random(21);
  for (let i = 0; i < 500; ++i) {
    // inside the outermost sample centres, where nothing is clamped
    const grid = [random.between(3.5, 24), random.between(3.5, 19), random.between(3.5, 15)] as const;
    // values are whole numbers only at voxel centres: half of a 3 × 0.5 rounding
    expect(biasedAt(volume, grid) - 32768).toBeCloseTo(30 * grid[0] - 20 * grid[1] + 50 * grid[2], 6);
  }
});

test.each([1, 2])("the gradient is measured per millimetre on each axis at step %i", (step) => {
  const volume = volumeOf(scan, ([x, y, z]) => 70 * x - 140 * y + 250 * z, step);
  // 70 / 0.7, -140 / 0.7, 250 / 2.5 per mm
  expect(gradientMagnitude(volume, [12, 10, 9])).toBeCloseTo(Math.hypot(100, 200, 100), 6);
});

test("outside the scan the field is that of its border", () => {
  const volume = volumeOf(scan, ([x]) => 10 * x);
  expect(biasedAt(volume, [-5, 10, 10]) - 32768).toBe(5);
  expect(biasedAt(volume, [99, 10, 10]) - 32768).toBe(295);
});
