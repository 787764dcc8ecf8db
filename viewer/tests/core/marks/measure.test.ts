/** Marks: what they measure, and that nothing that was kept can break them. */
import { expect, test } from "vitest";
import { clearOfCorners, labelPlace, placesOnSlice, strengthOf } from "../../../src/core/marks/mark_lines";
import {
  angleAt,
  changedMark,
  formatMeasured,
  marksTable,
  measured,
  saneMark,
  type Mark,
  withMark,
  withoutMark,
  withPointAt,
} from "../../../src/core/marks/measure";
import type { SlicePlane } from "../../../src/core/slices/slice_plane";
import { addScaled, rotateAbout, type Vec3 } from "../../../src/core/geometry/vector";

test("a distance is that of its ends in mm", () => {
  expect(measured({ kind: "distance", points: [[1, 2, 3], [4, 6, 15]] })).toBe(13);
  expect(formatMeasured({ kind: "distance", points: [[0, 0, 0], [0, 12.34, 0]] })).toBe("12.3\u202fmm");
  expect(formatMeasured({ kind: "point", points: [[0, 0, 0]] })).toBe("");
  expect(measured({ kind: "distance", points: [[1, 2, 3]] })).toBeNull();
});

test.each([0, 1e-3, 0.6, Math.PI / 2, 2.8, Math.PI])(
  "an angle of %d is found at its vertex, however long its sides are",
  (angle) => {
    const vertex: Vec3 = [30, -20, 5];
    const side: Vec3 = [1, 2, -2];
    // at right angles to the side
    const axis: Vec3 = [2 / Math.sqrt(5), -1 / Math.sqrt(5), 0];
    const [a, b] = [addScaled(vertex, side, 4), addScaled(vertex, rotateAbout(side, axis, angle), 0.7)];
    // an arc cosine near 1 loses half of the digits
    expect(angleAt(vertex, a, b)).toBeCloseTo(angle, 6);
    expect(measured({ kind: "angle", points: [b, vertex, a] })).toBeCloseTo(angle, 6);
  },
);

test("an angle whose side has no length is 0, not NaN", () => {
  expect(formatMeasured({ kind: "angle", points: [[1, 1, 1], [1, 1, 1], [2, 2, 2]] })).toBe("0.0°");
});

const saneMarks = (list: readonly unknown[]): readonly Mark[] => list.flatMap((each, i) => saneMark(each, i + 1));

test("marks are named by their kind, in the numbers that are free, and can be changed and removed", () => {
  let marks = withMark([], "distance", [[0, 0, 0], [1, 0, 0]], 1);
  marks = withMark(marks, "angle", [[1, 0, 0], [0, 0, 0], [0, 1, 0]]);
  marks = withMark(marks, "distance", [[0, 0, 0], [2, 0, 0]], 3);
  expect(marks.map(({ name }) => name)).toEqual(["Distance 1", "Angle 1", "Distance 2"]);
  expect(new Set(marks.map(({ id }) => id)).size).toBe(3);

  marks = withPointAt(marks, 1, 1, [0, 3, 4]);
  expect(marks.map(formatMeasured)).toEqual(["5.0\u202fmm", "90.0°", "2.0\u202fmm"]);
  marks = changedMark(marks, 1, { name: "  width  " });
  marks = changedMark(marks, 3, { name: " ", visible: false });
  expect(marks.map(({ name, visible }) => [name, visible])).toEqual([
    ["width", true],
    ["Angle 1", true],
    ["Distance 2", false],
  ]);
  expect(withMark(withoutMark(marks, 1), "distance", [[0, 0, 0], [1, 0, 0]]).at(-1)?.name).toBe("Distance 1");
});

test("the table has a line for each mark, and quotes what needs it", () => {
  const marks = saneMarks([
    { kind: "point", name: 'tip, "left"', points: [[1, 2, 3]] },
    { kind: "angle", name: "Angle 1", points: [[1, 0, 0], [0, 0, 0], [0, 1, 0]] },
  ]);
  const [head, point, angle, rest] = marksTable(marks, true).split("\r\n");
  expect(head?.split(",")).toHaveLength(18);
  expect(point).toBe('"tip, ""left""",point,,,1.00,2.00,3.00,,,,,,,,,,,');
  expect(angle).toBe("Angle 1,angle,90.00,deg,1.00,0.00,0.00,0.00,0.00,0.00,0.00,1.00,0.00,,,,,");
  expect(rest).toBe("");
  expect(head).toContain("L1 (mm),P1 (mm),S1 (mm)");
  expect(marksTable(marks, false)).toContain("x1 (mm),y1 (mm),z1 (mm)");
});

test("what is no mark is left out, and numbers are given anew", () => {
  const good = { id: 7, kind: "distance", name: "a", points: [[0, 0, 0], [1, 1, 1]], visible: false };
  const bad = [
    null,
    3,
    {},
    { ...good, kind: "area" },
    { ...good, name: 4 },
    { ...good, points: [[0, 0, 0]] },
    { ...good, points: [[0, 0, 0], [1, Number.NaN, 1]] },
    { ...good, points: [[0, 0, 0], [1, 1]] },
  ];
  const kept = saneMarks([...bad, good, good]);
  expect(kept.map(({ points, visible }) => [points, visible])).toEqual([[good.points, false], [good.points, false]]);
  expect(new Set(kept.map(({ id }) => id)).size).toBe(2);
});

test("a slice shows marks that it meets, those beside it faintly, and others not", () => {
  const plane: SlicePlane = { right: [1, 0, 0], up: [0, 1, 0], toward: [0, 0, 1], centre: [0, 0, 0], pixel: 0.5 };
  const places = (points: readonly Vec3[]) => placesOnSlice(points, plane, { width: 100, height: 100 });
  const through = places([[0, 0, -80], [10, 0, 90]]);
  expect(strengthOf(through)).toBe(1);
  expect(through.map(({ x, y }) => [x, y])).toEqual([[50, 50], [70, 50]]);
  expect(labelPlace("distance", through)).toMatchObject({ x: 60, y: 50 });
  const beside = strengthOf(places([[0, 0, 5], [10, 0, 90]]));
  expect(beside).toBeGreaterThan(0.1);
  expect(beside).toBeLessThan(0.9);
  expect(strengthOf(places([[0, 0, 40], [10, 0, 90]]))).toBe(0);
});

const paneSizes = [[400, 330], [800, 600], [213, 314]] as const;

test("on an enlarged page labels leave more room to what is enlarged with them", () => {
  const pane = { width: 1200, height: 900 };
  const lines = ["471 mm²", "mean 40.3 ± 3.5 HU"];
  expect(clearOfCorners({ x: 110, y: 20 }, lines, pane)).toEqual({ x: 110, y: 20 });
  // the name of the slice is 144 wide and 45 high there, a line of the label 22.5 high
  expect(clearOfCorners({ x: 110, y: 20 }, lines, pane, 1.5)).toEqual({ x: 110, y: 67.5 });
});

test.each(paneSizes)("in a pane of %d × %d labels leave its corners clear", (width, height) => {
  const lines = ["471 mm²", "mean 40.3 ± 3.5 HU", "−20 to 90 HU"];
  const pane = { width, height };
  for (let x = 0; x <= width; x += 20) {
    for (let y = 0; y <= height; y += 20) {
      const label = clearOfCorners({ x, y }, lines, pane);
      // no letter outside, nor where name and read-out stand or what the slice is
      expect(label.x).toBeGreaterThanOrEqual(4);
      expect(label.y - 15).toBeGreaterThanOrEqual(label.x < 96 ? 29 : 0);
      expect(label.y + 30).toBeLessThanOrEqual(label.x < 130 ? height - 60 : height);
    }
  }
  expect(clearOfCorners({ x: width / 2, y: height / 2 }, ["47.1°"], pane)).toEqual({ x: width / 2, y: height / 2 });
});
