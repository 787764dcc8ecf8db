import { expect, test } from "vitest";
import { MiddleOut } from "../../../src/core/view/middle_out";

test.each([1, 7, 40, 1000])("strips of up to %i rows cover each row once, from the middle to both ends", (count) => {
  const rows = new MiddleOut([3, 104]);
  const taken: number[] = [];
  const distances: number[] = [];
  while (!rows.done) {
    const [from, to] = rows.take(count);
    expect(to - from).toBeGreaterThan(0);
    expect(to - from).toBeLessThanOrEqual(count);
    taken.push(...Array.from({ length: to - from }, (_, i) => from + i));
    distances.push(Math.min(Math.abs(from - 53), Math.abs(to - 53)));
  }
  expect(taken.sort((a, b) => a - b)).toEqual(Array.from({ length: 101 }, (_, i) => i + 3));
  expect(distances).toEqual([...distances].sort((a, b) => a - b));
});

test("of no rows all are taken at once", () => {
  expect(new MiddleOut([5, 5]).done).toBe(true);
});
