import { expect, test } from "vitest";
import { cutSheet } from "../../../src/core/segments/cut_sheet";
import { cross, distance, dot, normalize, subtract, type Vec3 } from "../../../src/core/geometry/vector";

/** Of a box of 20 mm around a point 100 mm before the eye. */
const corners = [0, 1, 2, 3, 4, 5, 6, 7].map(
  (place): Vec3 => [place & 1 ? 10 : -10, place & 2 ? 10 : -10, 100 + (place & 4 ? 10 : -10)],
);
const seen = { eye: [0, 0, 0], view: [0, 0, 1] } as const;

test("a sheet lies along the lines of sight of its line, from before the segment to behind it", () => {
  const line = { ...seen, points: [[2, -3, 50], [2, 3, 50]] as const, closed: false };
  const sheet = cutSheet(line, corners);
  for (const [near, far] of sheet) {
    // one line of sight, in the plane that holds the eye and the line
    expect(dot(normalize(near), normalize(far))).toBeCloseTo(1, 12);
    expect(near[0] / near[2]).toBeCloseTo(2 / 50, 12);
    expect(near[2]).toBeLessThan(90);
    expect(far[2]).toBeGreaterThan(110);
  }
});

test("an open line goes on beyond the segment at both ends, straight", () => {
  const line = { ...seen, points: [[0, -1, 100], [0, 1, 100]] as const, closed: false };
  const sheet = cutSheet(line, corners);
  const middles = sheet.map(([near, far]): Vec3 => [0, (near[1] / near[2]) * 100, far[2] - 100]);
  expect(sheet).toHaveLength(4);
  expect(middles[0]?.[1]).toBeLessThan(-10);
  expect(middles.at(-1)?.[1]).toBeGreaterThan(10);
});

test("a closed line is a tube, and one that passes by is not carried on", () => {
  const points: readonly Vec3[] = [[-1, -1, 100], [1, -1, 100], [0, 1, 100]];
  const tube = cutSheet({ ...seen, points, closed: true }, corners);
  expect(tube).toHaveLength(4);
  expect(distance(tube[0]?.[0] ?? [1, 1, 1], tube.at(-1)?.[0] ?? [0, 0, 0])).toBe(0);
  const aside = cutSheet({ ...seen, points: [[80, 0, 100], [90, 0, 100]], closed: false }, corners);
  const [a, b, c] = [aside[0]?.[0], aside[1]?.[0], aside[2]?.[0]];
  expect(aside.length).toBe(3);
  // toward the segment it goes on, in the same plane
  const turned = cross(subtract(b ?? [0, 0, 0], a ?? [0, 0, 0]), subtract(c ?? [0, 0, 0], a ?? [0, 0, 0]));
  expect(Math.hypot(...turned)).toBeLessThan(1e-9);
});
