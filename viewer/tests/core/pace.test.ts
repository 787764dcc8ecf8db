import { expect, test } from "vitest";
import { divisors, levelsAfter, Pace } from "../../src/core/pace";

const options = { frameBudget: 33, stripBudget: 25, pixelCost: 1e-3 };

/** A renderer with a fixed latency and a cost per pixel [ms]. */
function learned(latency: number, perPixel: number): Pace {
  const pace = new Pace(options);
  for (let i = 0; i < 60; ++i) {
    const pixels = i % 3 === 0 ? 2000 : 50000;
    pace.learn(pixels, latency + pixels * perPixel);
  }
  return pace;
}

test("a quick renderer draws every picture in full", () => {
  const pace = learned(4, 5e-6);
  expect(pace.movingDivisor(2e6)).toBe(1);
  expect(pace.stripRows(1920, 1080)).toBe(1080);
});

test("a slow renderer moves at a resolution that fits its budget", () => {
  const pace = learned(20, 1e-3);
  const divisor = pace.movingDivisor(600_000);
  expect(divisors).toContain(divisor);
  expect(pace.expected(600_000 / divisor ** 2)).toBeLessThanOrEqual(options.frameBudget);
  expect(divisor).toBeGreaterThan(2);
});

test("latency alone does not make strips thin: it is no cost of pixels", () => {
  const pace = learned(60, 2e-5);
  // 25 ms at 2e-5 ms per pixel are a million pixels; a third is left for slow learning
  expect(pace.stripRows(900, 700)).toBeGreaterThan(350);
});

test("a level is never cut into more than 32 strips", () => {
  const pace = learned(1, 1);
  expect(pace.stripRows(1000, 640)).toBe(20);
});

test("every picture ends at full resolution", () => {
  for (const divisor of divisors) {
    expect(levelsAfter(divisor).at(-1)).toBe(1);
  }
});
