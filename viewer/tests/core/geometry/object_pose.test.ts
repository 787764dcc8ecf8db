import { expect, test } from "vitest";
import { transformPoint } from "../../../src/core/geometry/affine";
import {
  apart,
  boxEdges,
  cornersOf,
  middleOf,
  numbersOf,
  poseOf,
  shifted,
  turned,
  unmoved,
} from "../../../src/core/geometry/object_pose";
import type { Vec3 } from "../../../src/core/geometry/vector";
import { Random } from "../../support/random";
import { segment } from "../../support/volumes";

const sceneFromGrid = [2, 0, 0, 10, 0, 3, 0, 20, 0, 0, 1, 30, 0, 0, 0, 1];
const boxed = { ...segment, bounds: [[0, 0, 0], [4, 4, 4]] as const };
const middle: Vec3 = [14, 26, 32];

test("the middle and the corners of a segment are those of its box in the scan", () => {
  expect(middleOf(boxed, sceneFromGrid)).toEqual(middle);
  const corners = cornersOf(boxed, sceneFromGrid);
  expect(corners[0]).toEqual([10, 20, 30]);
  expect(corners[7]).toEqual([18, 32, 34]);
  expect(boxEdges).toHaveLength(12);
  expect(middleOf(segment, sceneFromGrid)).toBeNull();
  expect(cornersOf(segment, sceneFromGrid)).toEqual([]);
});

test("turning about the middle leaves it where it is, and numbers come back as they were given", () => {
  const random = new Random(11);
  for (let round = 0; round < 200; ++round) {
    const some = (size: number): Vec3 => [
      random.between(-size, size),
      random.between(-size, size),
      random.between(-size, size),
    ];
    // beyond ±90° about P the same turn has other numbers too
    const [l, p, s] = some(1);
    const numbers = { translation: some(100), rotation: [179 * l, 89 * p, 179 * s] as const };
    const pose = poseOf(numbers, middle);
    const back = numbersOf(pose, middle);
    for (const axis of [0, 1, 2] as const) {
      expect(back.translation[axis]).toBeCloseTo(numbers.translation[axis], 9);
      expect(back.rotation[axis]).toBeCloseTo(numbers.rotation[axis], 9);
    }
  }
});

test("a pose that is turned upright about P has finite numbers that mean the same pose", () => {
  const pose = turned(turned(unmoved, middle, [0, 1, 0], Math.PI / 2), middle, [0, 0, 1], 0.7);
  const back = poseOf(numbersOf(pose, middle), middle);
  expect(apart(pose, back, cornersOf(boxed, sceneFromGrid))).toBeLessThan(1e-6);
});

test("many turns leave a rigid motion", () => {
  let pose = unmoved;
  for (let turn = 0; turn < 10000; ++turn) {
    pose = turned(pose, [1, 2, 3], [0.6, 0, 0.8], 0.1);
  }
  const columns = [0, 1, 2].map((c) => [0, 1, 2].map((r) => pose[4 * r + c] ?? 0));
  for (const [i, a] of columns.entries()) {
    for (const [j, b] of columns.entries()) {
      const product = a.reduce((sum, x, k) => sum + x * (b[k] ?? 0), 0);
      expect(product).toBeCloseTo(i === j ? 1 : 0, 12);
    }
  }
});

test("a shift moves every point by as much", () => {
  const pose = shifted(turned(unmoved, middle, [1, 0, 0], 1), [1, -2, 3]);
  expect(transformPoint(pose, middle)).toEqual([15, 24, 35]);
  expect(apart(pose, shifted(pose, [0, 3, 4]), [middle])).toBeCloseTo(5, 12);
});
