import { expect, test } from "vitest";
import { defaultSoftTissueAndBone, transferFunctionOf } from "../../../src/core/appearance/soft_tissue_and_bone";
import { bakeTransferFunction, domainOf, sample } from "../../../src/core/appearance/transfer_function";

const ramp = {
  points: [
    { value: -100, colour: [1, 0, 0], extinction: 0 },
    { value: 100, colour: [0, 1, 0], extinction: 2 },
    { value: 300, colour: [0, 0, 1], extinction: 2 },
  ] as const,
};

test("the baked row holds the function at equal steps, both ends included", () => {
  const row = bakeTransferFunction(ramp, { size: 5 });
  expect([...row.slice(0, 4)]).toEqual([1, 0, 0, 0]);
  expect([...row.slice(4, 8)]).toEqual([0.5, 0.5, 0, 1]);
  expect([...row.slice(16, 20)]).toEqual([0, 0, 1, 2]);
});

test("outside its points a function stays as at its ends", () => {
  expect(sample(ramp.points, -5000).extinction).toBe(0);
  expect(sample(ramp.points, 5000).colour).toEqual([0, 0, 1]);
});

test("what describes no function is refused", () => {
  expect(() => bakeTransferFunction(ramp, { size: 1 })).toThrow(/at least 2 texels, got 1/);
  expect(() => domainOf({ points: [] })).toThrow(RangeError);
  expect(() => domainOf({ points: [ramp.points[0], ramp.points[0]] })).toThrow(RangeError);
});

const anchors = { softTissue: 40, bone: 250 };

test("air is clear, bone is opaque, and soft tissue lies between", () => {
  const { points } = transferFunctionOf(defaultSoftTissueAndBone(anchors));
  expect(sample(points, -1000).extinction).toBe(0);
  expect(sample(points, 40).extinction).toBeGreaterThan(0.01);
  expect(sample(points, 40).extinction).toBeLessThan(0.2);
  expect(sample(points, 1000).extinction).toBeGreaterThan(1);
});

test("the soft-tissue control only ever makes tissue more opaque, from nothing on", () => {
  const at = (softTissue: number): number =>
    sample(transferFunctionOf({ ...defaultSoftTissueAndBone(anchors), softTissue }).points, 40).extinction;
  const steps = [0, 0.2, 0.4, 0.6, 0.8, 1].map(at);
  expect(steps[0]).toBe(0);
  expect([...steps].sort((a, b) => a - b)).toEqual(steps);
});

test("window and level move the curve: the same tissue, other values", () => {
  const usual = transferFunctionOf({ level: 145, window: 210, softTissue: 0.5, bone: 1 });
  const moved = transferFunctionOf({ level: 1145, window: 420, softTissue: 0.5, bone: 1 });
  for (const u of [-1, 0, 0.5, 2]) {
    const a = sample(usual.points, 145 + (u - 0.5) * 210);
    const b = sample(moved.points, 1145 + (u - 0.5) * 420);
    expect(b.extinction).toBeCloseTo(a.extinction, 12);
    expect(b.colour[0]).toBeCloseTo(a.colour[0], 12);
  }
});
