import { expect, test } from "vitest";
import { withDrill } from "../../../src/core/touch/contact_sound";
import { formatMoment } from "../../../src/core/base/format";
import type { Segment } from "../../../src/core/protocol";
import { LastRanges } from "../../../src/core/segments/shown_segments";
import {
  depthRange,
  fittingDepth,
  fittingRadius,
  formatLoad,
  loadShare,
  radiusRange,
  segmentsOf,
} from "../../../src/core/tools/tools";

function segment(id: number, felt = true, range: Segment["range"] = null): Segment {
  return {
    id,
    name: `segment ${String(id)}`,
    colour: [1, 1, 1],
    visible: true,
    touched_while_hidden: false,
    touchable: true,
    felt,
    locked: false,
    range,
    voxels: 1,
    volume_ml: 1,
    pending: false,
    feel: { stiffness: null, friction_static: null, friction_kinetic: null },
    material: null,
    regions: [],
    pose: null,
    grid: null,
    steps: null,
    bounds: null,
    shown_as: "volume",
    surface_from: "intensities",
    made_by: null,
    opacity: 1,
    smoothing: 3,
    wireframe: false,
    ambient: 1,
    specular: 1,
  };
}

const all = [segment(1, false), segment(2), segment(5)];

test("burr and painter pass over what is locked; what is touched is for the engine to refuse", () => {
  const some = [segment(1), { ...segment(2), locked: true }, segment(5)];
  expect(segmentsOf("drill", "touched", some, 2)).toEqual([1, 5]);
  expect(segmentsOf("painter", "touched", some, 2)).toEqual([1, 5]);
  expect(segmentsOf("eraser", "touchable", some, 2)).toEqual([1, 5]);
  expect(segmentsOf("eraser", "touched", some, 2)).toEqual([2]);
});

test("a tool works on what is touched, or was last, or else on the first that can be", () => {
  expect(segmentsOf("eraser", "touched", all, 5)).toEqual([5]);
  expect(segmentsOf("adder", "touched", all, 0)).toEqual([2]);
  // removed meanwhile
  expect(segmentsOf("eraser", "touched", all, 9)).toEqual([2]);
  expect(segmentsOf("eraser", "touched", [], 0)).toEqual([]);
});

test("a drill cuts all that it meets, and any tool the segment that was chosen for it", () => {
  expect(segmentsOf("drill", "touched", all, 5)).toEqual([2, 5]);
  expect(segmentsOf("eraser", "touchable", all, 5)).toEqual([2, 5]);
  expect(segmentsOf("drill", 1, all, 5)).toEqual([1]);
  expect(segmentsOf("eraser", 7, all, 5)).toEqual([5]);
});

test("a segment with a grid of its own has none of the voxels that a drill removes, and can be erased", () => {
  const plate: Segment = { ...segment(8), grid: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1] };
  expect(segmentsOf("drill", "touched", [...all, plate], 8)).toEqual([2, 5]);
  expect(segmentsOf("eraser", "touched", [...all, plate], 8)).toEqual([8]);
});

test("radii reach a voxel from everywhere and stay within what the engine takes", () => {
  // half of the diagonal of 1 × 1 × 2 mm is 1.22 mm
  expect(radiusRange("eraser", [1, 1, 2])).toEqual({ min: 1.3, max: 25 });
  expect(radiusRange("drill", [0.5, 0.5, 0.5])).toEqual({ min: 0.5, max: 8 });
  expect(fittingRadius("drill", [0.5, 0.5, 0.5], null)).toBe(2);
  expect(fittingRadius("drill", [0.5, 0.5, 0.5], 40)).toBe(8);
  expect(fittingRadius("eraser", [10, 10, 10], null)).toBeCloseTo(8.7, 9);
  // where not even that fits, the largest that does
  const { min, max } = radiusRange("eraser", [0.05, 5, 5]);
  expect(min).toBe(max);
});

test("a painter paints all that can be touched, no deeper than the engine does", () => {
  expect(segmentsOf("painter", "touched", all, 5)).toEqual([2, 5]);
  expect(segmentsOf("painter", 5, all, 2)).toEqual([5]);
  expect(depthRange([0.5, 0.5, 2])).toEqual({ min: 1, max: 4 });
  expect([0.1, 3, 9].map((depth) => fittingDepth([0.5, 0.5, 2], depth))).toEqual([1, 3, 4]);
});

test("the load is told in units that can be read", () => {
  expect([0, 840.4, 6000].map(formatLoad)).toEqual(["0\u202fmW", "840\u202fmW", "6.0\u202fW"]);
  expect(loadShare({ on: true, load: 3000 })).toBe(0.5);
  expect(loadShare({ on: false, load: 3000 })).toBe(0);
  expect(loadShare({ on: true, load: NaN })).toBe(0);
});

test("a drill that runs hums, louder and lower under load; no other tool is heard", () => {
  const silent = { strike: null, scrape: { gain: 0, frequency: 170 } };
  const hum = (load: number): { gain: number; frequency: number } =>
    withDrill(silent, { kind: "drill", on: true, load }).scrape;
  expect(hum(0).gain).toBeGreaterThan(0);
  expect(hum(4000).gain).toBeGreaterThan(hum(1000).gain);
  expect(hum(4000).frequency).toBeLessThan(hum(1000).frequency);
  expect(hum(1e9).gain).toBeLessThan(0.5);
  expect(withDrill(silent, { kind: "drill", on: false, load: 0 })).toBe(silent);
  expect(withDrill(silent, { kind: "eraser", on: true, load: 0 })).toBe(silent);
});

test("a moment is told as people write it; what is none stays as it is", () => {
  expect(formatMoment("2026-11-09T16:34:20+01:00")).toBe("2026-11-09, 16:34");
  expect(formatMoment("yesterday")).toBe("yesterday");
});

test("an edited threshold is shown by its last range until its labels are here, and no longer", () => {
  const ranges = new LastRanges();
  expect(ranges.stand(segment(1, true, [10, 20]), false).range).toEqual([10, 20]);
  expect(ranges.stand(segment(1), true).range).toEqual([10, 20]);
  expect(ranges.stand(segment(1), false).range).toBeNull();
  expect(ranges.stand(segment(2), true).range).toBeNull();
});
