import { expect, test } from "vitest";
import { toldOf } from "../../../src/ui/app/filter_sentence";

test("what was refused is told with how far it was off", () => {
  expect(toldOf({ format: "r16", errors: { r16: 0.01 } })).toBe(
    "The graphics interpolate the scan from 16-bit texels.",
  );
  expect(toldOf({ format: "texels", errors: { r16: 16.4, rg8: 261.8 } })).toBe(
    "The page interpolates the scan itself, which takes twice as long: " +
      "measured otherwise, values are off by up to 16 and 262 of 65 536.",
  );
});
