import { expect, test } from "vitest";
import { screenDivisor } from "../../../src/core/view/screen_divisor";

// a half of 1366×768 is 0.26 M pixels, few enough; a quarter of 3840×2160 is 0.52 M, where a picture divided by 4
// leaves no more than a half; of 7680×4320 an eighth is 0.52 M
test.each([
  [1366 * 768, 16, 2],
  [3840 * 2160, 16, 4],
  [3840 * 2160, 8, 4],
  [3840 * 2160, 4, 2],
  [7680 * 4320, 16, 8],
])(
  "a screen of %i pixels, with pictures that are divided by %i, divides its own by %i",
  (pixels, divisor, expected) => {
    expect(screenDivisor(pixels, divisor)).toBe(expected);
  },
);
