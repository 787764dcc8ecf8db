/**
 * A transfer function as people draw it: points of opacity and stops of colour over the values.
 * Opacity is that of 1 mm of tissue, so it does not depend on the ray's step.
 */
import { hexFromSrgb, linearFromHex, srgbFromLinear } from "../base/colour";
import { sample, type ControlPoint, type TransferFunction } from "./transfer_function";

export interface OpacityPoint {
  readonly value: number;
  /** Of 1 mm, 0..1. */
  readonly opacity: number;
}

export interface ColourStop {
  readonly value: number;
  /** "#rrggbb" */
  readonly colour: string;
}

/** By rising value, at least two of each. */
export interface Curve {
  readonly opacities: readonly OpacityPoint[];
  readonly colours: readonly ColourStop[];
}

/** Whether something that was kept is a curve. */
export function isCurve(kept: unknown): kept is Curve {
  const rows = (name: "opacities" | "colours", fits: (point: Record<string, unknown>) => boolean): boolean => {
    const row = typeof kept === "object" && kept !== null ? (kept as Record<string, unknown>)[name] : null;
    return (
      Array.isArray(row) &&
      row.length >= 2 &&
      row.every(
        (point: unknown) =>
          typeof point === "object" &&
          point !== null &&
          Number.isFinite((point as ColourStop).value) &&
          fits(point as Record<string, unknown>),
      )
    );
  };
  return (
    rows("opacities", ({ opacity }) => typeof opacity === "number" && opacity >= 0 && opacity <= 1) &&
    rows("colours", ({ colour }) => typeof colour === "string" && /^#[0-9a-f]{6}$/i.test(colour))
  );
}

/** More opaque is not told from opaque. */
export const mostOpacity = 0.995;

/** Straight pieces that stand for a straight line of opacity, whose extinction is none. */
const pieces = 6;

export function extinctionOf(opacity: number): number {
  return -Math.log(1 - Math.min(mostOpacity, Math.max(0, opacity)));
}

export function opacityOf(extinction: number): number {
  return Math.min(mostOpacity, 1 - Math.exp(-extinction));
}

/** The function of a curve; outside of its points it stays as at its ends. */
export function transferFunctionOfCurve({ opacities, colours }: Curve): TransferFunction {
  const asPoints = colours.map(({ value, colour }): ControlPoint => ({
    value,
    colour: linearFromHex(colour),
    extinction: 0,
  }));
  const asOpacities = opacities.map(({ value, opacity }): ControlPoint => ({
    value,
    colour: [0, 0, 0],
    extinction: opacity,
  }));
  const ends = [...asPoints, ...asOpacities].map(({ value }) => value).sort((a, b) => a - b);
  const values = ends.flatMap((value, i) => {
    const next = ends[i + 1];
    return next === undefined || next === value
      ? [value]
      : Array.from({ length: pieces }, (_, piece) => value + ((next - value) * piece) / pieces);
  });
  return {
    points: [...new Set(values)].map((value) => ({
      value,
      colour: sample(asPoints, value).colour,
      extinction: extinctionOf(sample(asOpacities, value).extinction),
    })),
  };
}

/** A curve through the points of a function. */
export function curveOfFunction({ points }: TransferFunction): Curve {
  return {
    opacities: points.map(({ value, extinction }) => ({ value, opacity: opacityOf(extinction) })),
    colours: points.map(({ value, colour }) => ({ value, colour: hexFromSrgb(srgbFromLinear(colour)) })),
  };
}

/** The same curve at other values: shifted, and stretched about its middle. */
export function placedCurve({ opacities, colours }: Curve, shift: number, stretch: number): Curve {
  const values = opacities.map(({ value }) => value);
  const middle = (Math.min(...values) + Math.max(...values)) / 2;
  const move = <T extends { readonly value: number }>(point: T): T => ({
    ...point,
    value: middle + (point.value - middle) * stretch + shift,
  });
  return { opacities: opacities.map(move), colours: colours.map(move) };
}

/** A row with one of its entries at another place; it stays between its neighbours. */
export function moved<T extends { readonly value: number }>(
  row: readonly T[],
  i: number,
  part: Partial<T>,
  gap: number,
): T[] {
  const [before, after] = [row[i - 1]?.value ?? -Infinity, row[i + 1]?.value ?? Infinity];
  return row.map((point, j) => {
    const other = { ...point, ...part };
    const room = Math.min(gap, (after - before) / 4);
    return j === i ? { ...other, value: Math.min(after - room, Math.max(before + room, other.value)) } : point;
  });
}

/** A row with one more entry; with its place in it. */
export function added<T extends { readonly value: number }>(
  row: readonly T[],
  point: T,
): { readonly row: T[]; readonly at: number } {
  const found = row.findIndex(({ value }) => value > point.value);
  const at = found === -1 ? row.length : found;
  return { row: [...row.slice(0, at), point, ...row.slice(at)], at };
}

/** A row without one of its entries; two are always left. */
export function removed<T>(row: readonly T[], i: number): readonly T[] {
  return row.length <= 2 ? row : row.filter((_, j) => j !== i);
}

/** Nearest of what a person is likely to mean: a multiple of `step`. */
export function snapped(value: number, step: number): number {
  return Math.round(value / step) * step;
}

/** A round step of about a hundredth of a span: 1, 2 or 5 times a power of ten. */
export function roundStep(span: number): number {
  const raw = Math.max(span / 100, 1e-9);
  const power = 10 ** Math.floor(Math.log10(raw));
  return power * ([1, 2, 5].find((factor) => factor * power >= raw) ?? 10);
}
