/**
 * The scan's values as page and GPU hold them: unsigned 16 bit, stored value + 32768.
 *
 * x runs fastest, then y, then z. On a little-endian machine the same bytes serve as R16
 * texels and as RG8 texels (red the low byte, green the high one).
 */
import type { Vec3 } from "../geometry/vector";

/** Added to a signed stored value. */
export const bias = 32768;

/** Largest biased value; a texture gives `biased / 65535`. */
export const largest = 65535;

/** How physical values come from stored ones: value = slope · stored + intercept. */
export interface Rescale {
  readonly slope: number;
  readonly intercept: number;
}

export interface StoredVolume {
  readonly dimensions: Vec3;
  /** Biased values, shape [z, y, x]. */
  readonly values: Uint16Array;
}

/** Turns signed 16-bit values into biased ones in place, whole or in part. */
export function biasInPlace(values: Uint16Array): void {
  for (let i = 0; i < values.length; ++i) {
    values[i] = (values[i] ?? 0) ^ bias;
  }
}

/** Physical value of a biased one. */
export function physical(biased: number, { slope, intercept }: Rescale): number {
  return slope * (biased - bias) + intercept;
}

/** A value with two decimals, or where stored ones are nearer to each other, with as many as they tell. */
export function withoutNoise(value: number, { slope }: Pick<Rescale, "slope">): number {
  const decimals = Math.min(Math.max(Math.floor(-Math.log10(Math.abs(slope))), 2), 20);
  return Number(value.toFixed(decimals));
}

/** Biased value (a real number) of a physical one. */
export function biasedOf(value: number, { slope, intercept }: Rescale): number {
  return (value - intercept) / slope + bias;
}

/** Error of `slope · stored + intercept` as float32, relative to its parts. In sync with `stored_values.py`. */
const floatError = 4 * 2 ** -23;

/**
 * A physical range as a rising biased range, also where the slope is negative. An end that is a stored value but for
 * rounding is that.
 */
export function biasedRange(low: number, high: number, rescale: Rescale): readonly [number, number] {
  const a = biasedLimit(low, rescale);
  const b = biasedLimit(high, rescale);
  return a <= b ? [a, b] : [b, a];
}

function biasedLimit(value: number, rescale: Rescale): number {
  const biased = biasedOf(value, rescale);
  const error = (floatError * (Math.abs(value) + Math.abs(rescale.intercept))) / Math.abs(rescale.slope);
  return Math.abs(biased - Math.round(biased)) <= Math.min(error, 0.01) ? Math.round(biased) : biased;
}
