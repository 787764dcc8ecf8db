/**
 * Lines of equal value of the second scan in slices: isodose lines of a dose, or of any scan.
 * Levels are shares of a reference, such as the prescribed dose, in percent.
 */
import { srgbFromHue } from "../base/colour";
import { formatValue, formatWithin } from "../base/format";
import type { Vec3 } from "../geometry/vector";
import type { Scan } from "../protocol";

/** In sync with `shaders/second/second_lines.glsl`. */
export const mostIsolines = 8;

export interface Isolines {
  readonly on: boolean;
  /** Value that is 100 % [unit of the scan]. */
  readonly reference: number;
  /** [%], each once. */
  readonly levels: readonly number[];
}

/** A line as it is drawn. */
export interface Isoline {
  readonly percent: number;
  /** [unit of the scan]. */
  readonly value: number;
  /** sRGB. */
  readonly colour: Vec3;
}

/** Levels [%] that are seen first, and what others are offered. */
const firstLevels = [95, 80, 50, 30] as const;
const offeredLevels = [70, 90, 20, 60, 40, 10, 100, 105, 110, 5] as const;

/** Lines that fit a scan: of a dose they are seen at once. */
export function firstIsolines({ modality, range }: Pick<Scan, "modality" | "range">): Isolines {
  return { on: modality === "RTDOSE", reference: range[1], levels: firstLevels };
}

/** Whether something that was kept is what this module takes. */
export function areIsolines(kept: unknown): kept is Isolines {
  if (typeof kept !== "object" || kept === null) {
    return false;
  }
  const { on, reference, levels } = kept as Partial<Record<keyof Isolines, unknown>>;
  return (
    typeof on === "boolean" &&
    isReference(reference) &&
    Array.isArray(levels) &&
    levels.length <= mostIsolines &&
    levels.every(isLevel)
  );
}

/** The lines, the lowest first, so that the highest is drawn over all others. */
export function shownIsolines({ on, reference, levels }: Isolines): readonly Isoline[] {
  return on
    ? [...levels]
        .sort((a, b) => a - b)
        .map((percent) => ({ percent, value: (percent / 100) * reference, colour: colourOf(percent) }))
    : [];
}

/** From blue at 20 % through green and yellow to red at 100 %, and on to magenta: the same for each dose. */
export function colourOf(percent: number): Vec3 {
  const turns = (100 - Math.min(Math.max(percent, 20), 120)) / 80;
  return srgbFromHue(240 * turns);
}

/** The lines with one of their levels at another share [%]; null takes it away. */
export function withLevel(lines: Isolines, level: number, other: number | null): Isolines {
  const rest = lines.levels.filter((one) => one !== level);
  return { ...lines, levels: other === null ? rest : ordered([...rest, other]) };
}

/** The lines with one more; null where they are enough. */
export function withAnother(lines: Isolines): Isolines | null {
  const next = offeredLevels.find((level) => !lines.levels.includes(level));
  return next === undefined || lines.levels.length >= mostIsolines
    ? null
    : { ...lines, levels: ordered([...lines.levels, next]) };
}

/** The share [%] that a value is, without digits that no one reads. */
export function percentOf(value: number, { reference }: Pick<Isolines, "reference">): number {
  return Number(((100 * value) / reference).toPrecision(6));
}

/** "95 %  13.95 Gy"; digits fit the reference, which is 100 %. */
export function isolineText({ percent, value }: Isoline, unit: string): string {
  return `${formatValue(percent, "%")}  ${formatWithin(value, (100 * value) / percent)}${unit}`;
}

export function isReference(value: unknown): value is number {
  return typeof value === "number" && Number.isFinite(value) && value > 0;
}

export function isLevel(value: unknown): value is number {
  return typeof value === "number" && Number.isFinite(value) && value > 0 && value <= 1000;
}

function ordered(levels: readonly number[]): readonly number[] {
  return [...new Set(levels)].sort((a, b) => b - a);
}
