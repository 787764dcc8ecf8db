/** A part of a picture, whatever its size. */
import type { Rows } from "./middle_out";

/** Left, lower, right and upper border, as shares of width and height from the lower left corner. */
export type Region = readonly [number, number, number, number];

/** All of a picture. */
export const everywhere: Region = [0, 0, 1, 1];

/** Around two regions. */
export function joined(one: Region, other: Region): Region {
  return [
    Math.min(one[0], other[0]),
    Math.min(one[1], other[1]),
    Math.max(one[2], other[2]),
    Math.max(one[3], other[3]),
  ];
}

/** Rows and columns of a picture [texels] that cover a region, and one more to each side. */
export function texelsOf(
  region: Region,
  width: number,
  height: number,
): { readonly rows: Rows; readonly columns: Rows } {
  const [left, lower, right, upper] = region;
  const covering = (from: number, to: number, size: number): Rows => {
    const first = Math.min(size, Math.max(0, Math.floor(from * size) - 1));
    return [first, Math.max(first, Math.min(size, Math.ceil(to * size) + 1))];
  };
  return { rows: covering(lower, upper, height), columns: covering(left, right, width) };
}
