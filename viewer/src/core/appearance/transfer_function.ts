/**
 * Transfer function: value of the scan -> colour and extinction, baked into one texture row.
 *
 * Values are in the units of the scan (HU for CT). Colours are linear RGB, 0..1.
 * Extinction is per mm, so the picture does not depend on the ray's step.
 * This module is pure; the upload is in `gl/textures/lookup_textures.ts`.
 *
 * Source: Engel et al., "Real-Time Volume Graphics" (2006), ch. 4.
 */
import type { Vec3 } from "../geometry/vector";

export interface ControlPoint {
  readonly value: number;
  /** Linear RGB, 0..1. */
  readonly colour: Vec3;
  /** [1/mm] */
  readonly extinction: number;
}

/** A function between its first and last point; outside it stays as at its ends. */
export interface TransferFunction {
  /** At least two, by rising value. */
  readonly points: readonly ControlPoint[];
}

export interface BakeOptions {
  /** Texels of the row, >= 2. */
  readonly size: number;
}

export const defaultBakeOptions: BakeOptions = { size: 1024 };

/** Lowest and highest value that the row describes. */
export function domainOf({ points }: TransferFunction): readonly [number, number] {
  const low = points[0];
  const high = points.at(-1);
  if (low === undefined || high === undefined || !(low.value < high.value)) {
    throw new RangeError("a transfer function needs at least two points of rising value");
  }
  return [low.value, high.value];
}

/**
 * Samples the function at equal steps over its domain.
 *
 * @returns RGBA floats, shape [size, 4]; alpha holds the extinction [1/mm].
 * @throws RangeError where the points or the size cannot describe a function.
 */
export function bakeTransferFunction(
  transferFunction: TransferFunction,
  options: BakeOptions = defaultBakeOptions,
): Float32Array {
  const [low, high] = domainOf(transferFunction);
  const { size } = options;
  if (!Number.isInteger(size) || size < 2) {
    throw new RangeError(`a row needs at least 2 texels, got ${String(size)}`);
  }

  const row = new Float32Array(4 * size);
  for (let i = 0; i < size; ++i) {
    const value = low + ((high - low) * i) / (size - 1);
    const { colour, extinction } = sample(transferFunction.points, value);
    row.set([...colour, extinction], 4 * i);
  }
  return row;
}

/**
 * Running integrals of a baked row over its coordinate from 0 to 1, by trapezoids.
 *
 * @returns RGBA floats, shape [size, 4]: colour times extinction, and extinction.
 */
export function integrateRow(row: Float32Array): Float32Array {
  const size = row.length / 4;
  const integrals = new Float32Array(row.length);
  const sums = [0, 0, 0, 0];
  const weighted = (texel: number, channel: number): number =>
    (row[4 * texel + 3] ?? 0) * (channel === 3 ? 1 : (row[4 * texel + channel] ?? 0));
  for (let i = 1; i < size; ++i) {
    for (let c = 0; c < 4; ++c) {
      sums[c] = (sums[c] ?? 0) + (0.5 * (weighted(i - 1, c) + weighted(i, c))) / (size - 1);
    }
    integrals.set(sums, 4 * i);
  }
  return integrals;
}

/** The function at a value, straight between its points. */
export function sample(points: readonly ControlPoint[], value: number): ControlPoint {
  const above = points.findIndex((point) => point.value >= value);
  const next = points[above === -1 ? points.length - 1 : above];
  const previous = points[above - 1] ?? next;
  if (next === undefined || previous === undefined) {
    throw new RangeError("a transfer function needs points");
  }
  const span = next.value - previous.value;
  const share = span > 0 ? Math.min(1, (value - previous.value) / span) : 0;
  const mix = (a: number, b: number): number => a + (b - a) * share;
  return {
    value,
    colour: [
      mix(previous.colour[0], next.colour[0]),
      mix(previous.colour[1], next.colour[1]),
      mix(previous.colour[2], next.colour[2]),
    ],
    extinction: mix(previous.extinction, next.extinction),
  };
}
