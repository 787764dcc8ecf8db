/** Pairs of points in two scans, and what is said of a registration. */
import { expect, test } from "vitest";
import { affineFromRows } from "../../../src/core/geometry/affine";
import {
  apart,
  curveColumns,
  pairsOfDistances,
  saidOf,
  sanePairs,
  seenAt,
} from "../../../src/core/second/registration";

/** Turned by 90 degrees about z and shifted. */
const place = affineFromRows([0, -1, 0, 5, 1, 0, 0, -2, 0, 0, 1, 7, 0, 0, 0, 1]);

test("a point of the second scan is seen where the first one has it", () => {
  expect(apart([[1, 2, 3], [3, -1, 10]], place)).toBeCloseTo(0);
  expect(apart([[1, 2, 3], [3, 3, 13]], place)).toBeCloseTo(5);
  seenAt([3, -1, 10], place).forEach((value, axis) => { expect(value).toBeCloseTo([1, 2, 3][axis] ?? NaN); });
});

test("measured distances are pairs, other marks are not", () => {
  const mark = { id: 1, name: "", visible: true };
  const pairs = pairsOfDistances(
    [
      { ...mark, kind: "distance", points: [[0, 0, 0], [1, 2, 3]] },
      { ...mark, kind: "point", points: [[4, 4, 4]] },
    ],
    place,
  );
  expect(pairs).toEqual([[[0, 0, 0], [3, -1, 10]]]);
});

test("what was remembered is taken only as far as it is pairs", () => {
  expect(sanePairs([[[1, 2, 3], [4, 5, 6]], [[1, 2], [4, 5, 6]], 7])).toEqual([[[1, 2, 3], [4, 5, 6]]]);
  expect(sanePairs("pairs")).toEqual([]);
});

test("levels of a curve are lines of their own", () => {
  const curve = [
    { name: "rigid, 2 times coarser", values: [-1, -2] },
    { name: "rigid", values: [-3] },
  ];
  expect(curveColumns(curve)).toEqual([[1, 2, 3], [-1, -2, null], [null, null, -3]]);
});

test("what was found is said with units", () => {
  const found = {
    kind: "rigid",
    metric: "correlation",
    before: -0.41234,
    after: -0.98765,
    overlap_before: 1,
    overlap: 0.334,
    start_kept: false,
    moved_mean: 34.86,
    moved_most: 51.04,
  } as const;
  expect(saidOf(found)).toEqual([
    "Correlation −0.412 → −0.988, less is better; 33\u202f% of the first scan covered, 100\u202f% at the start.",
    "Points moved by 34.9\u202fmm, at most 51.0\u202fmm.",
  ]);
  expect(saidOf({ ...found, start_kept: true })[0]).toContain("It lay right already and is kept.");
});
