import { expect, test } from "vitest";
import { areUsual, fadingBy, formatShare, usualOptions } from "../../src/core/model_options";

test("what is as usual is told from what is chosen", () => {
  expect(areUsual(usualOptions)).toBe(true);
  const chosen = [{ edge: 11 }, { binding: 0 }, { walls: true }, { prony: { share: 0.5, time: 1 } }, { yield_strain: 0.1 }];
  expect(chosen.map((change) => areUsual({ ...usualOptions, ...change }))).toEqual(chosen.map(() => false));
});

test("where no share fades nothing does", () => {
  expect(fadingBy(0, { share: 0.4, time: 3 })).toBeNull();
  expect(fadingBy(0.5, null)).toEqual({ share: 0.5, time: 1 });
});

test("the time of what fades stays where its share is moved", () => {
  expect(fadingBy(0.5, { share: 0.4, time: 3 })).toEqual({ share: 0.5, time: 3 });
});

test("shares are written in percent", () => {
  expect(formatShare(0.05)).toBe("5 %");
});
