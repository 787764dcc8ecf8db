import { expect, test } from "vitest";
import { ForceHistory } from "../../../src/core/touch/force_history";

test("the plotted seconds are kept, older samples go", () => {
  const history = new ForceHistory(5, 100);
  for (let i = 0; i <= 80; ++i) {
    history.add([[i / 10, 3, 0, 4]]);
  }
  const [times, magnitudes] = history.series();
  expect(times[0]).toBeCloseTo(-5);
  expect(times.at(-1)).toBe(0);
  expect(new Set(magnitudes)).toEqual(new Set([5]));
});

test("a ring that is full keeps its newest samples in order", () => {
  const history = new ForceHistory(5, 4);
  for (let i = 0; i < 10; ++i) {
    history.add([[i / 100, i, 0, 0]]);
  }
  expect(history.series()[1]).toEqual([6, 7, 8, 9]);
});

test("a new session begins a new plot", () => {
  const history = new ForceHistory(5, 10);
  history.add([[50, 1, 0, 0], [51, 1, 0, 0]]);
  history.add([[0.1, 2, 0, 0]]);
  expect(history.series()).toEqual([[0], [2]]);
});
