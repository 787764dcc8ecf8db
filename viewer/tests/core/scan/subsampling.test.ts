import { expect, test } from "vitest";
import { previewStep, subsamplingStep } from "../../../src/core/scan/subsampling";

test("a scan that comes quickly is shown as it is at once", () => {
  expect(previewStep([256, 256, 157], 1)).toBeNull();
  expect(previewStep([512, 512, 128], 1)).toBeNull();
});

test("of a large scan a coarse one comes first, which is quick", () => {
  expect(previewStep([512, 512, 275], 1)).toBe(3);
  // as few values however large it is, also where the GPU holds less of it
  expect(previewStep([1024, 1024, 1024], 2)).toBe(7);
  expect(previewStep([1024, 1024, 256], 4)).toBeNull();
});

test("a scan is held as finely as the GPU has room for", () => {
  expect(subsamplingStep([100, 100, 100], { edge: 100, values: 1e6 })).toBe(1);
  expect(subsamplingStep([101, 100, 100], { edge: 100, values: 1e9 })).toBe(2);
  expect(subsamplingStep([100, 100, 100], { edge: 100, values: 1e6 - 1 })).toBe(2);
});
