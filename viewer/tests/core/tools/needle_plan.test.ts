import { expect, test } from "vitest";
import { beforeEntry, deviationFrom, passagesAlong } from "../../../src/core/tools/needle_plan";
import type { Vec3 } from "../../../src/core/geometry/vector";

test("a needle on its plan is off by nothing, and says how far it still is", () => {
  const off = deviationFrom([[0, 0, 50], [0, 0, 0]], [0, 0, 20], [0, 0, 1]);
  expect(off).toEqual({ lateral: 0, angle: 0, ahead: 30 });
});

test("aside, askew and beyond the target are told apart", () => {
  const slanted: Vec3 = [0, Math.SQRT1_2, Math.SQRT1_2];
  const off = deviationFrom([[0, 0, 50], [0, 0, 0]], [3, 4, 60], slanted);
  expect(off.lateral).toBeCloseTo(5, 12);
  expect(off.angle).toBeCloseTo(Math.PI / 4, 12);
  expect(off.ahead).toBe(-10);
  expect(deviationFrom([[0, 0, 50], [0, 0, 0]], [0, 0, 0], null).angle).toBeNull();
});

test("before it goes in a needle stands on its line, outside of what is touched", () => {
  const skin = (border: number) => (point: Vec3) => point[2] < border;
  // the entry was clicked 3 mm below the skin, then above it
  expect(beforeEntry([[0, 0, 50], [0, 0, 3]], skin(0))).toEqual([0, 0, -6]);
  expect(beforeEntry([[0, 0, 50], [0, 0, -7]], skin(0))).toEqual([0, 0, -12]);
  // between two bodies there is less room, and in one there is none
  expect(beforeEntry([[0, 0, 50], [0, 0, 3]], ([, , z]) => z < 0 && z > -4)).toEqual([0, 0, -1]);
  expect(beforeEntry([[0, 0, 50], [0, 0, 3]], () => false)).toBeNull();
});

const tissue = { name: "tissue", isSegment: false };

test("what a line passes is named in its order, with lengths that add up", () => {
  const nameAt = ([, , z]: Vec3) => ({ name: z < 3 ? "skin" : z < 20 ? "fat" : "liver", isSegment: false });
  const passed = passagesAlong([0, 0, 0], [0, 0, 50], 0.5, nameAt);
  expect(passed.map(({ name }) => name)).toEqual(["skin", "fat", "liver"]);
  // to within a step
  expect(passed[0]?.length).toBeCloseTo(3, 0);
  expect(passed[1]?.length).toBeCloseTo(17, 0);
  expect(passed.reduce((sum, { length }) => sum + length, 0)).toBeCloseTo(50, 9);
});

test("a line ends where the scan does, and none is of no length", () => {
  const inside = passagesAlong([0, 0, 0], [0, 0, 50], 1, ([, , z]) => (z > 10 ? null : tissue));
  expect(inside).toHaveLength(1);
  expect(inside[0]?.length).toBeCloseTo(10, 9);
  expect(passagesAlong([1, 1, 1], [1, 1, 1], 1, () => tissue)).toEqual([]);
});

test("mixed values at a border are no tissue of their own, a thin segment is", () => {
  const nameAt = ([, , z]: Vec3) =>
    z < 1 ? { name: "lung", isSegment: false }
    : z < 10 ? { name: "fat", isSegment: false }
    : z < 11 ? { name: "fluid", isSegment: false }
    : z < 12 ? { name: "vessel", isSegment: true }
    : { name: "soft tissue", isSegment: false };
  const passed = passagesAlong([0, 0, 0], [0, 0, 20], 0.5, nameAt);
  expect(passed).toEqual([
    { name: "fat", length: 11 },
    { name: "vessel", length: 1 },
    { name: "soft tissue", length: 8 },
  ]);
});
