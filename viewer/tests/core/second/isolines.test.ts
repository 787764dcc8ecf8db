/**
 * Lines of equal value: which there are, what they are called, and which colours they have.
 */
import { expect, test } from "vitest";
import {
  areIsolines,
  colourOf,
  firstIsolines,
  isolineText,
  mostIsolines,
  percentOf,
  shownIsolines,
  withAnother,
  withLevel,
  type Isolines,
} from "../../../src/core/second/isolines";

const dose: Isolines = { on: true, reference: 14, levels: [95, 80, 50, 30] };

test("of a dose lines are seen at once, by its highest value; of other scans when asked for", () => {
  expect(firstIsolines({ modality: "RTDOSE", range: [0, 14.7] })).toEqual({
    on: true,
    reference: 14.7,
    levels: [95, 80, 50, 30],
  });
  expect(firstIsolines({ modality: "PT", range: [0, 20] }).on).toBe(false);
});

test("lines are drawn from the lowest to the highest, at shares of the reference", () => {
  const shown = shownIsolines(dose);
  expect(shown.map(({ percent }) => percent)).toEqual([30, 50, 80, 95]);
  const values = shown.map(({ value }) => value);
  [4.2, 7, 11.2, 13.3].forEach((value, i) => {
    expect(values[i]).toBeCloseTo(value, 12);
  });
  expect(shownIsolines({ ...dose, on: false })).toEqual([]);
});

test("text has the digits of the reference", () => {
  const [lowest] = shownIsolines(dose);
  expect(lowest && isolineText(lowest, " Gy")).toBe("30\u202f%  4.20 Gy");
  const [high] = shownIsolines({ on: true, reference: 6000, levels: [12.5] });
  expect(high && isolineText(high, "")).toBe("12.5\u202f%  750");
});

test("a level goes elsewhere, where another is not already, or away", () => {
  expect(withLevel(dose, 80, 90).levels).toEqual([95, 90, 50, 30]);
  expect(withLevel(dose, 80, 107).levels).toEqual([107, 95, 50, 30]);
  expect(withLevel(dose, 80, 50).levels).toEqual([95, 50, 30]);
  expect(withLevel(dose, 80, null).levels).toEqual([95, 50, 30]);
  expect(percentOf(12.6, dose)).toBe(90);
});

test("more lines are offered until there are enough", () => {
  let lines: Isolines | null = { ...dose, levels: [] };
  const seen: number[] = [];
  while (lines !== null) {
    seen.push(lines.levels.length);
    expect(areIsolines(lines)).toBe(true);
    lines = withAnother(lines);
  }
  expect(seen.at(-1)).toBe(mostIsolines);
});

test("colours go from blue over green to red, and lines are told apart", () => {
  const [red, green, blue] = [0, 1, 2] as const;
  expect(colourOf(100)[red]).toBeGreaterThan(2 * colourOf(100)[blue]);
  expect(colourOf(60)[green]).toBeGreaterThan(2 * colourOf(60)[red]);
  expect(colourOf(20)[blue]).toBeGreaterThan(2 * colourOf(20)[green]);
  const [a, b] = [colourOf(95), colourOf(105)];
  expect(Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2])).toBeGreaterThan(0.2);
});

test.each([
  null,
  {},
  { ...dose, reference: 0 },
  { ...dose, reference: Number.NaN },
  { ...dose, levels: [0] },
  { ...dose, levels: ["95"] },
  { ...dose, levels: [1, 2, 3, 4, 5, 6, 7, 8, 9] },
])("what was kept and is none is not taken: %j", (kept) => {
  expect(areIsolines(kept)).toBe(false);
});
