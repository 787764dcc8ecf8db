import { expect, test } from "vitest";
import {
  affineFromRows,
  invertAffine,
  linearColumnMajor,
  transformPoint,
  transformVector,
} from "../../../src/core/geometry/affine";
import { distance } from "../../../src/core/geometry/vector";
import { Random } from "../../support/random";

/** A frame like a scan's: turned axes with a spacing each, and an origin. */
function randomFrame(random: Random): readonly number[] {
  const rows = Array.from({ length: 12 }, () => random.between(-3, 3));
  return affineFromRows([...rows, 0, 0, 0, 1]);
}

test("the inverse of a frame takes every point back", () => {
  const random = new Random(1);
  for (let i = 0; i < 200; ++i) {
    const map = randomFrame(random);
    const point = random.vector(500);
    const [a, b, c] = [
      transformVector(map, [1, 0, 0]),
      transformVector(map, [0, 1, 0]),
      transformVector(map, [0, 0, 1]),
    ];
    const determinant =
      a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
    if (Math.abs(determinant) < 0.5) {
      continue;
    }
    // rounding of 1e-16 grows by the frame's condition, here below 1e3, and the size of the point
    expect(distance(transformPoint(invertAffine(map), transformPoint(map, point)), point)).toBeLessThan(1e-8);
  }
});

test("a vector does not feel the origin of a frame", () => {
  const map = affineFromRows([2, 0, 0, 100, 0, 3, 0, 200, 0, 0, 4, 300, 0, 0, 0, 1]);
  expect(transformVector(map, [1, 1, 1])).toEqual([2, 3, 4]);
  expect(transformPoint(map, [1, 1, 1])).toEqual([102, 203, 304]);
});

test("columns of the linear part follow one another for WebGL", () => {
  const map = affineFromRows([1, 2, 3, 0, 4, 5, 6, 0, 7, 8, 9, 0, 0, 0, 0, 1]);
  expect(linearColumnMajor(map)).toEqual([1, 4, 7, 2, 5, 8, 3, 6, 9]);
});

test("a frame that is flat or not finite is refused", () => {
  expect(() => invertAffine(affineFromRows([1, 0, 0, 0, 2, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]))).toThrow(RangeError);
  expect(() => affineFromRows([1, 2, 3])).toThrow(/16 finite numbers, got 3/);
  expect(() => affineFromRows(new Array<number>(16).fill(Number.NaN))).toThrow(RangeError);
});
