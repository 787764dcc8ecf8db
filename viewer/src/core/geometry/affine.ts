/**
 * Affine maps between frames, named `target_from_source` by whoever holds them.
 * Row-major 4×4 with the last row 0 0 0 1, as `Scan.patient_from_grid` is sent.
 */
import type { Vec3 } from "./vector";

/** The three rows above the constant last one, 12 numbers. */
export type Affine = readonly number[];

/** Reads a row-major 4×4 matrix. */
export function affineFromRows(rows: readonly number[]): Affine {
  if (rows.length !== 16 || rows.some((value) => !Number.isFinite(value))) {
    throw new RangeError(`a frame needs 16 finite numbers, got ${String(rows.length)}`);
  }
  return rows.slice(0, 12);
}

function at(map: Affine, row: number, column: number): number {
  return map[4 * row + column] ?? Number.NaN;
}

/** Column of the linear part: where the source axis points. */
export function column(map: Affine, axis: 0 | 1 | 2 | 3): Vec3 {
  return [at(map, 0, axis), at(map, 1, axis), at(map, 2, axis)];
}

export function transformVector(map: Affine, v: Vec3): Vec3 {
  const row = (r: number): number => at(map, r, 0) * v[0] + at(map, r, 1) * v[1] + at(map, r, 2) * v[2];
  return [row(0), row(1), row(2)];
}

export function transformPoint(map: Affine, p: Vec3): Vec3 {
  const moved = transformVector(map, p);
  return [moved[0] + at(map, 0, 3), moved[1] + at(map, 1, 3), moved[2] + at(map, 2, 3)];
}

/** The map that first does `inner`, then `outer`. */
export function composed(outer: Affine, inner: Affine): Affine {
  const columns = [
    ...([0, 1, 2] as const).map((axis) => transformVector(outer, column(inner, axis))),
    transformPoint(outer, column(inner, 3)),
  ];
  return ([0, 1, 2] as const).flatMap((row) => columns.map((end) => end[row]));
}

/** The inverse map, by cofactors. */
export function invertAffine(map: Affine): Affine {
  const m = (r: number, c: number): number => at(map, r % 3, c % 3);
  // cyclic indices carry the sign of each cofactor
  const cofactor = (r: number, c: number): number =>
    m(r + 1, c + 1) * m(r + 2, c + 2) - m(r + 1, c + 2) * m(r + 2, c + 1);
  const determinant = m(0, 0) * cofactor(0, 0) + m(0, 1) * cofactor(0, 1) + m(0, 2) * cofactor(0, 2);
  if (!(Math.abs(determinant) > 0)) {
    throw new RangeError("a frame that is flat has no inverse");
  }
  const linear = [0, 1, 2].map((r) => [0, 1, 2].map((c) => cofactor(c, r) / determinant));
  const origin = column(map, 3);
  return linear.flatMap((row) => {
    const [a = 0, b = 0, c = 0] = row;
    return [a, b, c, -(a * origin[0] + b * origin[1] + c * origin[2])];
  });
}

/** The map as a column-major 4×4, as WebGL takes it. */
export function columnMajor(map: Affine): number[] {
  return [0, 1, 2, 3].flatMap((c) => [at(map, 0, c), at(map, 1, c), at(map, 2, c), c === 3 ? 1 : 0]);
}

/** The linear part as a column-major 3×3. */
export function linearColumnMajor(map: Affine): number[] {
  return ([0, 1, 2] as const).flatMap((axis) => [...column(map, axis)]);
}
