import { expect, test } from "vitest";
import { hexFromSrgb, linearFromSrgb, srgbFromHex } from "../../../src/core/base/colour";

test("the middle grey of sRGB is 0.2140 in linear light (IEC 61966-2-1)", () => {
  // the constant has four digits
  expect(linearFromSrgb([0.5, 0.5, 0.5])[0]).toBeCloseTo(0.214, 4);
  expect(linearFromSrgb([0, 1, 0])).toEqual([0, 1, 0]);
});

test("hexadecimal colours survive the way there and back", () => {
  for (const hex of ["#000000", "#5cc8ff", "#f1e6cf", "#ffffff"]) {
    expect(hexFromSrgb(srgbFromHex(hex))).toBe(hex);
  }
  expect(hexFromSrgb([2, -1, 0.5])).toBe("#ff0080");
});

test("what is no colour is refused", () => {
  expect(() => srgbFromHex("red")).toThrow(/#rrggbb/);
});
