import { expect, test } from "vitest";
import { biasedOf, biasedRange, biasInPlace, physical, withoutNoise } from "../../../src/core/scan/stored_values";

test("biasing turns signed values into unsigned ones of the same order", () => {
  const signed = Int16Array.from([-32768, -1024, -1, 0, 1, 3071, 32767]);
  const values = new Uint16Array(signed.buffer);
  biasInPlace(values);
  expect([...values]).toEqual([0, 31744, 32767, 32768, 32769, 35839, 65535]);
});

test("the bytes of biased values are RG8 texels with the low byte in red", () => {
  const values = Uint16Array.from([0x1234]);
  expect([...new Uint8Array(values.buffer)]).toEqual([0x34, 0x12]);
});

test("physical values come back from biased ones, also with a slope and an intercept", () => {
  const rescale = { slope: 0.5, intercept: -1000 };
  expect(physical(32768, rescale)).toBe(-1000);
  expect(biasedOf(physical(40000, rescale), rescale)).toBe(40000);
});

test("a range stays rising where the slope is negative", () => {
  expect(biasedRange(10, 20, { slope: -1, intercept: 0 })).toEqual([32748, 32758]);
});

test("an end of a range that is a stored value but for rounding is that", () => {
  const tenth = Math.fround(0.1);
  for (const rescale of [0.1, tenth, -0.1].map((slope) => ({ slope, intercept: 5 }))) {
    for (let stored = -3000; stored <= 3000; stored += 7) {
      const typed = Number((Math.sign(rescale.slope) * 0.1 * stored + 5).toFixed(1));
      expect(biasedRange(typed, typed, rescale)).toEqual([32768 + stored, 32768 + stored]);
    }
  }
  // between two of them it stays
  expect(biasedRange(250.5, 300.25, { slope: 1, intercept: 0 })).toEqual([33018.5, 33068.25]);
});

test("values are read with two decimals, and small ones with the digits that stored ones tell", () => {
  expect(withoutNoise(-512.4999, { slope: 1 })).toBe(-512.5);
  expect(withoutNoise(1288.3400001, { slope: -2 })).toBe(1288.34);
  // 16 bits over 0 to 0.003, half a step off
  expect(withoutNoise(0.0007 + 2.2e-8, { slope: 4.58e-8 })).toBe(0.0007);
  expect(withoutNoise(0.25001, { slope: 1e-5 })).toBe(0.25001);
});
