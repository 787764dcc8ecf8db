import { expect, test } from "vitest";
import { summed } from "../../../src/gl/engine_pictures/picture_texels";

test("differences along rows become values again, also over 65535", () => {
  // 10, 300, 65535 and 5 in one row, 7 and three times 7 in the next
  const differences = [10, 290, 65235, 6, 7, 0, 0, 0];
  const planes = Uint8Array.from([...differences.map((d) => d & 255), ...differences.map((d) => d >> 8)]);
  expect([...summed(planes, [4, 2])]).toEqual([10, 300, 65535, 5, 7, 7, 7, 7]);
});
