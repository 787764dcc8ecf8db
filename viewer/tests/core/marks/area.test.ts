/** Ellipses and rectangles: their size, how they are dragged, and how they are told to other programs. */
import { expect, test } from "vitest";
import { areaBetween, areaOutline, areaSize, draggedArea } from "../../../src/core/marks/area";
import { valueLines } from "../../../src/core/marks/area_values";
import { formatMeasured, lineOf, marksTable, saneMark, withPointAt, type Mark } from "../../../src/core/marks/measure";
import { slicerMarkups } from "../../../src/core/marks/slicer_markups";
import { add, addScaled, distance, dot, rotateAbout, subtract, type Vec3 } from "../../../src/core/geometry/vector";

const turn = (v: Vec3): Vec3 => rotateAbout(v, [0.6, 0, 0.8], 0.4);
const axes = { right: turn([1, 0, 0]), up: turn([0, -1, 0]) };
const corner: Vec3 = [10, -20, 300];
const opposite = add(corner, addScaled(addScaled([0, 0, 0], axes.right, -30), axes.up, 20));
const points = areaBetween(corner, opposite, axes) ?? [];

test("an area lies between two corners, in the plane of the first", () => {
  expect(areaSize("rectangle", points)).toBeCloseTo(600, 9);
  expect(areaSize("ellipse", points)).toBeCloseTo(Math.PI * 150, 9);
  const normal = turn([0, 0, 1]);
  const beyond = areaBetween(corner, addScaled(opposite, normal, 7), axes) ?? [];
  beyond.forEach((point, i) => { expect(distance(point, points[i] ?? [0, 0, 0])).toBeLessThan(1e-9); });
  expect(areaBetween(corner, addScaled(corner, axes.right, 5), axes)).toBeNull();
});

test("its outline goes around it, through its corners or the ends of its half axes", () => {
  const [middle = corner, first = corner] = points;
  const ellipse = areaOutline("ellipse", points);
  expect(distance(ellipse[0] ?? corner, first)).toBeLessThan(1e-9);
  const rectangle = areaOutline("rectangle", points);
  for (const place of [corner, opposite]) {
    expect(Math.min(...rectangle.map((each) => distance(each, place)))).toBeLessThan(1e-9);
  }
  for (const point of [...ellipse, ...rectangle]) {
    expect(dot(subtract(point, middle), turn([0, 0, 1]))).toBeCloseTo(0, 9);
  }
});

test("its middle takes all along; an end changes a half axis, and never turns it about", () => {
  const to: Vec3 = [0, 0, 0];
  const moved = draggedArea(points, 0, to);
  expect(moved[0]).toEqual(to);
  expect(areaSize("rectangle", moved)).toBeCloseTo(600, 9);
  const [middle = corner] = points;
  const wider = draggedArea(points, 1, addScaled(addScaled(middle, axes.right, 40), axes.up, 3));
  expect(areaSize("rectangle", wider)).toBeCloseTo(4 * 40 * 10, 9);
  const through = draggedArea(points, 1, addScaled(middle, axes.right, -40));
  expect(areaSize("rectangle", through)).toBeGreaterThan(0);
  expect(dot(subtract(through[1] ?? corner, middle), axes.right)).toBeGreaterThan(0);
});

const marks: readonly Mark[] = [
  { id: 1, kind: "point", name: "tip", points: [[1, 2, 3]], visible: true },
  { id: 2, kind: "distance", name: "width", points: [[0, 0, 0], [3, 4, 0]], visible: false },
  { id: 3, kind: "ellipse", name: "lesion", points, visible: true },
  { id: 4, kind: "point", name: "end", points: [[-1, -2, -3]], visible: true },
];
const values = { area: 471, count: 12, mean: 40.25, standard_deviation: 3.5, minimum: -20, maximum: 90, cut: false };

test("an area is a mark like others", () => {
  const [ellipse] = saneMark(marks[2], 3);
  expect(ellipse).toEqual(marks[2]);
  expect(saneMark({ ...marks[2], points: points.slice(1) }, 3)).toEqual([]);
  expect(formatMeasured({ kind: "ellipse", points })).toBe("471\u202fmm²");
  const line = lineOf({ kind: "ellipse", points });
  expect(line[0]).toBe(line.at(-1));
  expect(withPointAt(marks, 3, 0, [0, 0, 0])[2]?.points[0]).toEqual([0, 0, 0]);
});

test("values inside are told with their unit, and where there are none", () => {
  const scale = { unit: "HU", span: 4000 };
  expect(valueLines(values, scale)).toEqual(["mean 40.3 ± 3.5\u202fHU", "−20 to 90\u202fHU"]);
  expect(valueLines({ ...values, cut: true }, scale)[1]).toContain("cut");
  const none = { ...values, count: 0, mean: null, standard_deviation: null, minimum: null, maximum: null };
  expect(valueLines(none, scale)).toEqual(["no voxel inside"]);
  expect(valueLines({ ...none, cut: true }, scale)).toEqual(["outside of the scan"]);
});

test("the table has the values of areas in columns of their own", () => {
  const [head, , , lesion] = marksTable(marks, true, "HU", () => values).split("\r\n").map((row) => row.split(","));
  const cell = (name: string): string | undefined => lesion?.[head?.indexOf(name) ?? -1];
  expect([cell("value"), cell("unit")]).toEqual(["471.24", "mm2"]);
  const names = ["mean (HU)", "SD (HU)", "min (HU)", "max (HU)", "voxels"];
  expect(names.map(cell)).toEqual(["40.25", "3.5", "-20", "90", "12"]);
});

test("3D Slicer reads points as one list, lines, and areas as closed curves, all in LPS mm", () => {
  const { markups } = JSON.parse(slicerMarkups(marks, () => "mean 40")) as {
    markups: {
      type: string;
      name: string;
      coordinateSystem: string;
      coordinateUnits: string;
      display: { visibility: boolean };
      controlPoints: { label: string; description: string; position: Vec3; positionStatus: string }[];
    }[];
  };
  expect(markups.map(({ type, name }) => [type, name])).toEqual([
    ["Fiducial", "Points"],
    ["Line", "width"],
    ["ClosedCurve", "lesion"],
  ]);
  expect(new Set(markups.map(({ coordinateSystem: system, coordinateUnits: unit }) => `${system} ${unit}`))).toEqual(
    new Set(["LPS mm"]),
  );
  expect(markups[0]?.controlPoints.map(({ label, position }) => [label, position])).toEqual([
    ["tip", [1, 2, 3]],
    ["end", [-1, -2, -3]],
  ]);
  expect(markups[1]?.display.visibility).toBe(false);
  expect(markups[2]?.controlPoints[0]?.description).toBe("471\u202fmm²; mean 40");
  // the polygon through its points has nearly the area of the ellipse
  const around = markups[2]?.controlPoints.map(({ position }) => position) ?? [];
  expect(around.length).toBeGreaterThan(30);
  const all = markups.flatMap(({ controlPoints }) => controlPoints);
  expect(all.every((each) => each.positionStatus === "defined")).toBe(true);
});
