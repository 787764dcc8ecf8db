import { expect, test } from "vitest";
import { sliderStep, sliderValue } from "../../../src/core/segments/threshold_slider";

const ranges = [
  [-1024.5, 3071.2],
  [0, 1],
  [0, 0.0031],
  [0, 2e-9],
  [-1024, 3071],
] as const;

test.each(ranges)("the last step of a slider from %d to %d is the highest value", (low, high) => {
  const step = sliderStep([low, high]);
  const last = Math.floor((high - low) / step + 1e-9);
  expect(sliderValue(low + last * step, [low, high])).toBe(high);
  const before = low + (last - 1) * step;
  expect(sliderValue(before, [low, high])).toBe(before);
  expect(sliderValue(low, [low, high])).toBe(low);
});

test("a scan of one value has a slider that stands at it", () => {
  expect(sliderStep([5, 5])).toBe(1);
  expect(sliderValue(5, [5, 5])).toBe(5);
});
