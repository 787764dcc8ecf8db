import { expect, test } from "vitest";
import { levelsAfter, movingPictures, Pace } from "../../src/core/pace";
import { firstQuality } from "../../src/core/quality";

const { frameBudget } = firstQuality(false);
const coarsest = movingPictures.at(-1);

/** A renderer with a fixed latency and a cost per sample [ms]. */
function learned(latency: number, perSample: number, budget = frameBudget): Pace {
  const pace = new Pace(budget, 1e-3);
  for (let i = 0; i < 60; ++i) {
    const samples = i % 3 === 0 ? 2000 : 50000;
    pace.learn(samples, latency + samples * perSample);
  }
  return pace;
}

/** Time of a frame while the view moves [ms], of `samples` at their finest. */
function frameTime(pace: Pace, latency: number, perSample: number, samples: number): number {
  const { divisor, step } = pace.moving(samples);
  return latency + (samples * step * perSample) / divisor ** 2;
}

test("a frame is to take 33 ms where nobody has chosen, on a GPU and on the CPU", () => {
  expect([firstQuality(false).frameBudget, firstQuality(true).frameBudget]).toEqual([33, 33]);
});

test("a quick renderer draws every picture in full", () => {
  const pace = learned(4, 5e-6);
  expect(pace.moving(2e6)).toEqual({ divisor: 1, step: 1 });
  expect(pace.stripRows(1920, 1080, 1)).toBe(1080);
});

test.each([8, 33, 100])("a budget of %i ms is kept by resolution and step, and used", (budget) => {
  for (const perSample of [1e-6, 1e-5, 1e-4, 4e-4]) {
    const samples = 600_000;
    const pace = learned(3, perSample, budget);
    const time = frameTime(pace, 3, perSample, samples);
    const chosen = movingPictures.indexOf(pace.moving(samples));
    expect(time).toBeLessThanOrEqual(1.05 * budget);
    const finer = movingPictures[chosen - 1];
    if (finer !== undefined) {
      expect(3 + (samples * finer.step * perSample) / finer.divisor ** 2).toBeGreaterThan(0.95 * budget);
    }
  }
});

test("steps are coarser only once a quarter of the resolution is too slow, and both to a limit", () => {
  const chosen = [1e-6, 1e-4, 5e-4, 1.3e-3, 2e-3, 1].map((perSample) => learned(1, perSample).moving(600_000));
  expect(chosen.map(({ step }) => step)).toEqual([1, 1, 1, 0.5, 0.5, 0.5]);
  expect(chosen.at(-1)).toEqual(coarsest);
  expect(coarsest).toEqual({ divisor: 8, step: 0.5 });
  const costs = movingPictures.map(({ divisor, step }) => step / divisor ** 2);
  expect(costs).toEqual([...costs].sort((a, b) => b - a));
});

test("what no coarser picture saves makes none coarser than half of the budget asks for", () => {
  const pace = learned(500, 1e-5);
  expect(pace.moving(1e6)).toEqual({ divisor: 1, step: 1 });
  expect(pace.moving(2e6)).toEqual({ divisor: 2, step: 1 });
});

test("latency alone does not make strips thin: it is no cost of samples", () => {
  const pace = learned(60, 2e-5);
  // 33 ms at 2e-5 ms per sample are more than a million; a third is left for slow learning
  expect(pace.stripRows(900, 700, 1)).toBeGreaterThan(350);
});

test("a level is never cut into more than 32 strips for each step", () => {
  const pace = learned(1, 1);
  expect(pace.stripRows(1000, 640, 1)).toBe(20);
  expect(pace.stripRows(1000, 640, 2)).toBe(10);
});

test("every picture ends at full resolution", () => {
  for (const { divisor } of movingPictures) {
    expect(levelsAfter(divisor).at(-1)).toBe(1);
  }
});
