import { expect, it } from "vitest";
import { outlineOnSlice } from "../../../src/core/slices/slice_outlines";
import type { SlicePlane } from "../../../src/core/slices/slice_plane";
import { boxPatch } from "../../support/box_patch";

const axial: SlicePlane = { right: [1, 0, 0], up: [0, -1, 0], toward: [0, 0, -1], centre: [0, 0, 5], pixel: 0.5 };
const viewport = { width: 200, height: 100 };
const unmoved = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0];

/** Ends of all strokes of a path. */
function ends(path: string): [number, number][] {
  return [...path.matchAll(/[ML](-?[\d.]+) (-?[\d.]+)/g)].map(([, x, y]) => [Number(x), Number(y)]);
}

it("a box is cut in its four sides", () => {
  const strokes = ends(outlineOnSlice([boxPatch([-10, -5, 0], [20, 10, 8])], unmoved, axial, viewport));
  // two triangles a side, each one stroke of two ends
  expect(strokes).toHaveLength(16);
  for (const [x, y] of strokes) {
    const [right, back] = [(x - 100) * 0.5, (y - 50) * 0.5];
    expect(Math.abs(right)).toBeLessThan(10.06);
    expect(Math.abs(back)).toBeLessThan(5.06);
    expect(Math.abs(Math.abs(right) - 10) < 0.06 || Math.abs(Math.abs(back) - 5) < 0.06).toBe(true);
  }
});

it("a moved box is cut where it stands", () => {
  const patch = boxPatch([-10, -5, 0], [20, 10, 8]);
  const away = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 40];
  expect(outlineOnSlice([patch], away, axial, viewport)).toBe("");
  const aside = [0, -1, 0, 15, 1, 0, 0, 0, 0, 0, 1, 0];
  const xs = ends(outlineOnSlice([patch], aside, axial, viewport)).map(([x]) => (x - 100) * 0.5);
  expect(Math.min(...xs)).toBeCloseTo(10, 1);
  expect(Math.max(...xs)).toBeCloseTo(20, 1);
});
