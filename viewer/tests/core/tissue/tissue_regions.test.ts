import { expect, test } from "vitest";
import {
  describeRegions,
  partsOf,
  treatments,
  wholeOf,
  withShared,
  withWhole,
} from "../../../src/core/tissue/tissue_regions";
import type { MatterRegion } from "../../../src/core/protocol";

const nameOf = (id: number): string => (id === 2 ? "Lesion" : "Bone");

test("all of a segment stands before its parts, since of several the last counts", () => {
  const lesion = withShared([], 2, "rigid");
  const all = withWhole(lesion, "empty");
  expect(all.map(({ treatment, shared_with }) => [treatment, shared_with])).toEqual([["empty", null], ["rigid", 2]]);
  expect([wholeOf([]), wholeOf(lesion), wholeOf(all)]).toEqual(["deformable", "deformable", "empty"]);
  expect(withWhole(all, "deformable")).toEqual(lesion);
  expect(partsOf(all)).toEqual(lesion);
});

test("a part is told once, keeps its place and can be left out again", () => {
  const two = withShared(withShared([], 2, "rigid"), 3, "empty");
  const changed = withShared(two, 2, "deformable");
  expect(changed.map(({ treatment, shared_with }) => [treatment, shared_with])).toEqual([
    ["deformable", 2],
    ["empty", 3],
  ]);
  expect(withShared(changed, 2, null)).toEqual(withShared([], 3, "empty"));
});

test("regions are described in a line, and none where all gives way", () => {
  const box: MatterRegion = { treatment: "rigid", shared_with: null, box: [[0, 0, 0], [1, 1, 1]] };
  expect(describeRegions([], nameOf)).toBeNull();
  expect(describeRegions(withWhole(withShared([box], 2, "deformable"), "rigid"), nameOf)).toBe(
    "hard, hard in a box, gives way where Lesion is",
  );
  expect(describeRegions(withShared([], 3, "empty"), nameOf)).toBe("as if empty where Bone is");
  expect(treatments.map(({ value }) => value)).toEqual(["deformable", "rigid", "empty"]);
});
