import { expect, test } from "vitest";
import { joined, texelsOf } from "../../../src/core/view/region";

test("a region covers its texels and one more to each side", () => {
  expect(texelsOf([0.25, 0.5, 0.5, 0.75], 100, 40)).toEqual({ rows: [19, 31], columns: [24, 51] });
  // of a coarse picture it is a part of a texel
  expect(texelsOf([0.51, 0.51, 0.52, 0.52], 10, 10)).toEqual({ rows: [4, 7], columns: [4, 7] });
});

const beyond = [[[-3, -2, -1, -1]], [[2, 3, 4, 4]], [[-1, -1, 2, 2]]] as const;
test.each(beyond)("of %j what lies in the picture is left", (region) => {
  const { rows, columns } = texelsOf(region, 64, 48);
  for (const [[from, to], size] of [[rows, 48], [columns, 64]] as const) {
    expect(from).toBeGreaterThanOrEqual(0);
    expect(to).toBeGreaterThanOrEqual(from);
    expect(to).toBeLessThanOrEqual(size);
  }
});

test("two regions are joined by what is around both", () => {
  expect(joined([0.1, 0.2, 0.3, 0.4], [0.2, 0.1, 0.25, 0.9])).toEqual([0.1, 0.1, 0.3, 0.9]);
});
