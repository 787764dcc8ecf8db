/** What turns of the wheel mean, as browsers and devices tell them. */
import { expect, test } from "vitest";
import { wheelNotches, wheelPixels } from "../../../src/ui/widgets/mouse";

const still = { deltaX: 0, deltaY: 0, deltaMode: 0, shiftKey: false };

test.each([
  ["Chromium on Linux", { deltaY: 120, wheelDeltaY: -120 }, 1],
  ["Chromium on Windows", { deltaY: -100, wheelDeltaY: 120 }, -1],
  ["two notches told at once", { deltaY: 240, wheelDeltaY: -240 }, 2],
  ["a page zoomed to a half", { deltaY: 240, wheelDeltaY: -120 }, 1],
  ["Firefox, which counts lines", { deltaY: 3, deltaMode: 1, wheelDeltaY: -120 }, 1],
  ["Firefox, a line a notch", { deltaY: -1, deltaMode: 1, wheelDeltaY: 40 }, -1],
  ["a wheel that turns pages", { deltaY: 1, deltaMode: 2 }, 1],
  ["a wheel of fine steps", { deltaY: 15, wheelDeltaY: -15 }, 1 / 8],
])("a notch is a notch: %s", (_, turn, notches) => {
  expect(wheelNotches({ ...still, ...turn })).toBeCloseTo(notches, 9);
});

test("small moves on a trackpad add up, whatever their size", () => {
  const moved = (deltas: readonly number[]): number =>
    deltas.reduce((sum, deltaY) => sum + wheelNotches({ ...still, deltaY, wheelDeltaY: -3 * deltaY }), 0);
  const small = moved(Array.from({ length: 200 }, () => 2));
  expect(small).toBeCloseTo(moved([400]), 9);
  expect(small).toBeCloseTo(10, 9);
  expect(Math.abs(moved([2]))).toBeLessThan(0.1);
});

test("a swipe to the side turns nothing; with Shift a sideways wheel is the wheel", () => {
  expect(wheelNotches({ ...still, deltaX: 80, deltaY: 6, wheelDeltaY: -18 })).toBe(0);
  expect(wheelPixels({ ...still, deltaX: -80, deltaY: 20 })).toBe(0);
  expect(wheelPixels({ ...still, deltaX: 120, shiftKey: true })).toBe(120);
  expect(wheelPixels({ ...still, deltaX: 6, deltaY: 80 })).toBe(80);
});
